//! What a meter does when it is told to, and what else there is to say about writing to it, as JSON.

use std::collections::BTreeMap;

use serde::Serialize;

use super::point::{Labels, filled};
use super::{CodesObject, codes};
use crate::output::json::Exact;
use crate::output::profile::terms;
use crate::profile::writing::{Action, Distinct};
use crate::profile::{Operation, Point, Profile};

/// Every key is always there; `null` where an operation has nothing of the kind.
#[derive(Serialize)]
pub(super) struct OperationObject<'a> {
    name: &'a str,
    about: &'a str,
    number: Option<u16>,
    register: Option<u16>,
    value: Option<u16>,
    data: Option<DataObject<'a>>,
    hazard: Option<&'a str>,
    broadcast: Option<&'static str>,
    only_with: Option<CodesObject<'a>>,
    verified: bool,
    page: Option<&'a str>,
}

/// What goes with the number.
#[derive(Serialize)]
struct DataObject<'a> {
    #[serde(rename = "type")]
    kind: String,
    address: u16,
    registers: u16,
    about: Option<&'a str>,
    range: Option<[Exact<i128>; 2]>,
    labels: Option<Labels<'a>>,
}

pub(super) fn operation(operation: &Operation) -> OperationObject<'_> {
    let (number, register, value) = match &operation.action {
        Action::Number { number, .. } => (Some(*number), None, None),
        Action::Register { address, value } => (None, Some(address.get()), Some(*value)),
    };
    OperationObject {
        name: &operation.name,
        about: &operation.about,
        number,
        register,
        value,
        data: operation.data().map(data),
        hazard: operation.hazard.as_deref(),
        broadcast: terms::broadcast(operation.broadcast),
        only_with: operation.only_with.as_ref().map(codes),
        verified: operation.verified,
        page: filled(&operation.page),
    }
}

fn data(point: &Point) -> DataObject<'_> {
    let labels = terms::labels(point);
    DataObject {
        kind: point.kind.to_string(),
        address: point.range.start().get(),
        registers: point.range.count(),
        about: filled(&point.about),
        range: point.limits.map(|(low, high)| [low, high].map(Exact)),
        labels: (!labels.is_empty()).then_some(Labels(labels)),
    }
}

#[derive(Serialize)]
pub(super) struct CommandsObject {
    address: u16,
    code: u16,
}

pub(super) fn commands(profile: &Profile) -> Option<CommandsObject> {
    let commands = profile.command_registers?;
    Some(CommandsObject {
        address: commands.address.get(),
        code: commands.code,
    })
}

#[derive(Serialize)]
pub(super) struct ClockObject<'a> {
    time: &'a str,
    date: &'a str,
}

pub(super) fn clock(profile: &Profile) -> Option<ClockObject<'_>> {
    let clock = profile.clock.as_ref()?;
    Some(ClockObject {
        time: &clock.time,
        date: &clock.date,
    })
}

/// Names by masks such as `0x01`; `null` where there are none.
pub(super) fn status_bits(profile: &Profile) -> Option<BTreeMap<String, &str>> {
    let bits = profile.status_bits.iter();
    let bits: BTreeMap<String, &str> = bits
        .map(|(mask, name)| (format!("0x{mask:02X}"), name.as_str()))
        .collect();
    (!bits.is_empty()).then_some(bits)
}

#[derive(Serialize)]
pub(super) struct DistinctObject<'a> {
    of: &'a [String],
    except: &'a [u16],
    about: &'a str,
}

pub(super) fn distinct(rule: &Distinct) -> DistinctObject<'_> {
    DistinctObject {
        of: &rule.points,
        except: &rule.except,
        about: &rule.about,
    }
}
