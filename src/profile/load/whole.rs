//! What the meter as a whole says about being written and told.

use std::collections::BTreeMap;

use toml::Spanned;
use wildmatch::WildMatch;

use super::point::number;
use super::{Source, unknown};
use crate::codec::value::RegisterType;
use crate::codec::{FunctionCode, RegisterAddress};
use crate::profile::error::{Problem, ProfileError};
use crate::profile::format::{ClockTable, DistinctTable, ProfileFile};
use crate::profile::model::Limits;
use crate::profile::point::Point;
use crate::profile::writing::{ClockPoints, CommandRegisters, Distinct};

/// The registers that take operations by number.
pub(super) fn command_registers(
    source: &Source<'_>,
    file: &ProfileFile,
    limits: &Limits,
) -> Result<Option<CommandRegisters>, ProfileError> {
    let Some(found) = &file.command_registers else {
        return Ok(None);
    };
    let several = FunctionCode::WriteMultipleRegisters;
    if !limits.functions.contains(&several) {
        let problem = Problem::Conflict("of no use without 16 in limits.functions");
        return Err(source.error(found.span(), "command_registers", problem));
    }
    let table = found.as_ref();
    let address = *table.address.as_ref();
    if address == u16::MAX {
        let expected = "an address with another behind it, for the number";
        return Err(source.value(&table.address, "command_registers.address", expected));
    }
    Ok(Some(CommandRegisters {
        address: RegisterAddress(address),
        code: table.code,
    }))
}

/// The points that set the clock, next to each other.
pub(super) fn clock(
    source: &Source<'_>,
    file: &ProfileFile,
    points: &[Point],
) -> Result<Option<ClockPoints>, ProfileError> {
    let Some(ClockTable { time, date }) = &file.clock else {
        return Ok(None);
    };
    let of_kind = |name: &Spanned<String>, kind: RegisterType, key: &str| {
        let found = points.iter().find(|point| point.name == *name.as_ref());
        let point = found.ok_or_else(|| unknown(source, name, "point", key))?;
        if point.kind == kind && point.access.writable() {
            return Ok(point);
        }
        let expected = format!("a point of type {kind} that can be written");
        Err(source.value(name, key, expected))
    };
    let first = of_kind(time, RegisterType::Time, "clock.time")?;
    let second = of_kind(date, RegisterType::Date, "clock.date")?;
    if first.range.end() != u32::from(second.range.start().get()) {
        let expected = format!("right behind {}: both are set by one write", first.name);
        return Err(source.value(date, "clock.date", expected));
    }
    Ok(Some(ClockPoints {
        time: first.name.clone(),
        date: second.name.clone(),
    }))
}

/// Names of the bits that function 07 answers.
pub(super) fn status_bits(
    source: &Source<'_>,
    file: &ProfileFile,
    limits: &Limits,
) -> Result<BTreeMap<u8, String>, ProfileError> {
    let mut bits = BTreeMap::new();
    let key = "status_bits";
    let Some(table) = &file.status_bits else {
        return Ok(bits);
    };
    if !limits
        .functions
        .contains(&FunctionCode::ReadExceptionStatus)
    {
        let problem = Problem::Conflict("of no use without 7 in limits.functions");
        return Err(source.error(table.span(), key, problem));
    }
    let mut rows: Vec<_> = table.as_ref().iter().collect();
    rows.sort_by_key(|(mask, _)| mask.span().start);
    for (mask, name) in rows {
        let bit = number(mask.as_ref()).and_then(|mask| u8::try_from(mask).ok());
        let Some(bit) = bit.filter(|bit| bit.is_power_of_two()) else {
            return Err(source.value(mask, key, "one bit of eight: 0x01, 0x02, 0x04 to 0x80"));
        };
        if let Some(first) = bits.insert(bit, name.clone()) {
            let problem = Problem::LabelClash {
                code: mask.as_ref().clone(),
                first,
                second: name.clone(),
            };
            return Err(source.error(mask.span(), key, problem));
        }
    }
    Ok(bits)
}

/// Points of which no two may hold the same, by address.
pub(super) fn distinct(
    source: &Source<'_>,
    file: &ProfileFile,
    points: &[Point],
) -> Result<Vec<Distinct>, ProfileError> {
    let key = "distinct.of";
    let rules = file.distinct.iter().map(|table| {
        let DistinctTable { of, except, about } = table;
        let mut globs = Vec::with_capacity(of.as_ref().len());
        for pattern in of.as_ref() {
            let glob = WildMatch::new(pattern.as_ref());
            let mut matches = points
                .iter()
                .filter(|point| glob.matches(&point.name))
                .peekable();
            if matches.peek().is_none() {
                return Err(unknown(source, pattern, "point", key));
            }
            let is_unfit = |point: &Point| {
                point.kind.registers() != 1
                    || !point.kind.is_integer()
                    || !point.access.readable()
                    || !point.access.writable()
            };
            if matches.any(is_unfit) {
                let expected = "integers of one register that can be read and written";
                return Err(source.value(pattern, key, expected));
            }
            globs.push(glob);
        }
        let is_named = |point: &&Point| globs.iter().any(|glob| glob.matches(&point.name));
        let named: Vec<String> = points
            .iter()
            .filter(is_named)
            .map(|point| point.name.clone())
            .collect();
        if named.len() < 2 {
            return Err(source.value(of, key, "a list of two points or more"));
        }
        Ok(Distinct {
            points: named,
            except: except.clone(),
            about: about.clone(),
        })
    });
    rules.collect()
}
