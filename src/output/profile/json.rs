//! A meter as one JSON object, its keys and words those of a profile's file.

mod operations;
mod point;

use std::collections::BTreeMap;
use std::io;

use humantime::format_duration as time;
use rust_decimal::Decimal;
use serde::Serialize;

use crate::codec::FunctionCode;
use crate::output::json::{Exact, line};
use crate::profile::identity::{Identity, Law};
use crate::profile::point::OnlyWith;
use crate::profile::scaling::{Operand, Rule};
use crate::profile::{Point, Profile};

/// The object: a line for each key, group, factor, point, identity and operation.
pub(super) fn json(profile: &Profile, points: &[Point]) -> io::Result<String> {
    let groups = profile.groups.iter().map(|group| {
        let members = group.members.iter();
        let members: Vec<&str> = members
            .filter_map(|index| profile.points.get(*index))
            .map(|point| point.name.as_str())
            .collect();
        Ok(format!("{}: {}", line(&group.name)?, line(&members)?))
    });
    let factors = profile.factors.iter().map(|factor| {
        let rule = line(&self::factor(&factor.rule))?;
        Ok(format!("{}: {rule}", line(&factor.name)?))
    });
    let identities = profile
        .identities
        .iter()
        .map(|known| line(&identity(known)));
    let points = points.iter().map(|known| line(&point::point(known)));
    let operations = profile.operations.iter();
    let operations = operations.map(|known| line(&operations::operation(known)));
    let distinct = profile.distinct.iter();
    let distinct = distinct.map(|rule| line(&operations::distinct(rule)));
    let parts = [
        ("name", line(&profile.name)?),
        ("title", line(&profile.title)?),
        ("manual", line(&profile.manual)?),
        ("line", line(&settings(profile))?),
        ("limits", line(&limits(profile))?),
        ("identification", line(&identification(profile))?),
        ("groups", lines('{', groups, '}')?),
        ("factors", lines('{', factors, '}')?),
        ("points", lines('[', points, ']')?),
        ("identities", lines('[', identities, ']')?),
        ("operations", lines('[', operations, ']')?),
        ("command_registers", line(&operations::commands(profile))?),
        ("clock", line(&operations::clock(profile))?),
        ("status_bits", line(&operations::status_bits(profile))?),
        ("distinct", lines('[', distinct, ']')?),
    ];
    let parts = parts.map(|(key, value)| format!("\"{key}\": {value}"));
    Ok(format!("{{\n{}\n}}\n", parts.join(",\n")))
}

/// Values between brackets, one a line.
fn lines(
    opening: char,
    values: impl Iterator<Item = io::Result<String>>,
    closing: char,
) -> io::Result<String> {
    let values: Vec<String> = values.collect::<Result<_, _>>()?;
    Ok(match values.len() {
        0 => format!("{opening}{closing}"),
        _ => format!("{opening}\n{}\n{closing}", values.join(",\n")),
    })
}

#[derive(Serialize)]
struct LineObject {
    baud: u32,
    parity: String,
    stop_bits: u8,
}

fn settings(profile: &Profile) -> LineObject {
    LineObject {
        baud: profile.line.baud,
        parity: profile.line.parity.to_string(),
        stop_bits: profile.line.stop_bits.count(),
    }
}

#[derive(Serialize)]
struct LimitsObject {
    highest_unit: u8,
    functions: Vec<u8>,
    interchangeable_reads: bool,
    broadcast_functions: Vec<u8>,
    broadcast: &'static str,
    loopback_data: String,
    read_registers: u16,
    write_registers: u16,
    read_holes: bool,
    table_registers: Option<u16>,
    typical_answer: String,
    longest_answer: String,
    pause: String,
}

fn limits(profile: &Profile) -> LimitsObject {
    let limits = &profile.limits;
    let codes = |functions: &[FunctionCode]| functions.iter().map(|code| code.get()).collect();
    LimitsObject {
        highest_unit: limits.units.highest(),
        functions: codes(&limits.functions),
        interchangeable_reads: limits.interchangeable_reads,
        broadcast_functions: codes(&limits.broadcast_functions),
        broadcast: if limits.broadcasts_marked_only {
            "marked"
        } else {
            "any"
        },
        loopback_data: limits.loopback_data.to_string(),
        read_registers: limits.read_registers,
        write_registers: limits.write_registers,
        read_holes: limits.read_holes,
        table_registers: limits.table_registers,
        typical_answer: time(limits.typical_answer).to_string(),
        longest_answer: time(limits.longest_answer).to_string(),
        pause: time(limits.pause).to_string(),
    }
}

/// A point that holds one of a few codes, or any value.
#[derive(Serialize)]
struct CodesObject<'a> {
    point: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    codes: Option<&'a [u16]>,
}

fn codes(with: &OnlyWith) -> CodesObject<'_> {
    CodesObject {
        point: &with.point,
        codes: with.codes.as_deref(),
    }
}

fn identification(profile: &Profile) -> Option<CodesObject<'_>> {
    let known = profile.identification.as_ref()?;
    Some(CodesObject {
        point: &known.point,
        codes: Some(&known.codes),
    })
}

#[derive(Serialize)]
#[serde(untagged)]
enum OperandValue {
    Number(Exact<Decimal>),
    Name(String),
}

fn operand(operand: &Operand) -> OperandValue {
    match operand {
        Operand::Number(number) => OperandValue::Number(Exact(*number)),
        Operand::Named { .. } => OperandValue::Name(operand.to_string()),
    }
}

#[derive(Serialize)]
#[serde(untagged)]
enum FactorObject<'a> {
    Product {
        product: Vec<OperandValue>,
    },
    Choice {
        by: &'a str,
        cases: BTreeMap<u16, OperandValue>,
        otherwise: Option<OperandValue>,
    },
}

fn factor(rule: &Rule) -> FactorObject<'_> {
    match rule {
        Rule::Product(operands) => FactorObject::Product {
            product: operands.iter().map(operand).collect(),
        },
        Rule::Choice {
            by,
            cases,
            otherwise,
        } => FactorObject::Choice {
            by,
            cases: cases
                .iter()
                .map(|(code, case)| (*code, operand(case)))
                .collect(),
            otherwise: otherwise.as_ref().map(operand),
        },
    }
}

#[derive(Serialize)]
struct IdentityObject<'a> {
    #[serde(flatten)]
    law: LawKeys<'a>,
    tolerance: Exact<Decimal>,
}

#[derive(Serialize)]
#[serde(untagged)]
enum LawKeys<'a> {
    Sum {
        sum: &'a str,
        of: &'a [String],
    },
    Mean {
        mean: &'a str,
        of: &'a [String],
    },
    Apparent {
        apparent: &'a str,
        real: &'a str,
        reactive: &'a str,
    },
    PowerFactor {
        power_factor: &'a str,
        real: &'a str,
        apparent: &'a str,
    },
    LineVoltage {
        line_voltage: &'a str,
        between: &'a [String; 2],
    },
    Near {
        near: &'a str,
        one_of: Vec<Exact<Decimal>>,
    },
}

fn identity(identity: &Identity) -> IdentityObject<'_> {
    let law = match &identity.law {
        Law::Sum { whole, parts } => LawKeys::Sum {
            sum: whole,
            of: parts,
        },
        Law::Mean { mean, parts } => LawKeys::Mean { mean, of: parts },
        Law::Apparent {
            apparent,
            real,
            reactive,
        } => LawKeys::Apparent {
            apparent,
            real,
            reactive,
        },
        Law::PowerFactor {
            power_factor,
            real,
            apparent,
        } => LawKeys::PowerFactor {
            power_factor,
            real,
            apparent,
        },
        Law::LineVoltage { line, phases } => LawKeys::LineVoltage {
            line_voltage: line,
            between: phases,
        },
        Law::Near { point, targets } => LawKeys::Near {
            near: point,
            one_of: targets.iter().copied().map(Exact).collect(),
        },
    };
    IdentityObject {
        law,
        tolerance: Exact(identity.tolerance),
    }
}
