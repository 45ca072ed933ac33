//! Reading back what was confirmed.

use super::carry_out::Reply;
use super::fate::{Fate, Unread};
use crate::client::Client;
use crate::profile::point::Point;
use crate::profile::write_plan::Change;
use crate::profile::{Scales, Value};
use crate::readings::{Inquiry, Memory, take};

/// What became of each change, whose writes came to these `replies`. `inquiry` says how to read them
/// back; `None` leaves that out.
pub fn check(
    client: &mut Client,
    changes: &[Change],
    replies: Vec<Reply>,
    inquiry: Option<(&Inquiry<'_, '_>, &mut Memory)>,
    scales: &Scales,
) -> Vec<Fate> {
    let is_asked = inquiry.is_some();
    let wanted: Vec<usize> = replies
        .iter()
        .zip(changes)
        .enumerate()
        .filter(|(_, (reply, change))| reply.has_reached() && unreadable(&change.point).is_none())
        .map(|(index, _)| index)
        .collect();
    let points: Vec<Point> = wanted
        .iter()
        .filter_map(|index| changes.get(*index))
        .map(|change| change.point.clone())
        .collect();
    let taken = inquiry
        .filter(|_| !points.is_empty())
        .map(|(inquiry, memory)| {
            let inquiry = Inquiry {
                points: &points,
                ..*inquiry
            };
            let taken = take(client, &inquiry, memory);
            (taken.row.readings, taken.scales)
        });
    let (readings, now) = taken.unwrap_or_default();
    let found = |index: usize| {
        let place = wanted.iter().position(|wanted| *wanted == index)?;
        readings.get(place).cloned()
    };
    let fates = replies.into_iter().zip(changes).enumerate();
    fates
        .map(|(index, (reply, change))| {
            let unread = unreadable(&change.point).unwrap_or(Unread::NotAsked);
            let unread = if is_asked { unread } else { Unread::NotAsked };
            match (found(index), reply) {
                (_, Reply::NotTried) => Fate::NotTried,
                (_, Reply::Unwritten(why)) => Fate::Unwritten(why),
                (_, Reply::Torn(why)) => Fate::Torn(why),
                (Some(Ok(value)), reply) => {
                    compared(change, &value, &now, matches!(reply, Reply::Accepted))
                }
                (_, Reply::Stored(value)) => Fate::Otherwise(stored(change, value, scales)),
                (_, Reply::Accepted) => Fate::Accepted,
                (Some(Err(_)), Reply::Confirmed) if change.point.writing().moves => {
                    Fate::Confirmed(Unread::Moved)
                }
                (Some(Err(fault)), Reply::Confirmed) => Fate::Confirmed(Unread::Failed(fault)),
                (None, Reply::Confirmed) => Fate::Confirmed(unread),
            }
        })
        .collect()
}

/// What became of something that leaves nothing to read back.
pub fn unread(reply: Reply) -> Fate {
    match reply {
        Reply::Confirmed => Fate::Confirmed(Unread::Momentary),
        Reply::Stored(value) => Fate::Otherwise(format!("0x{value:04X}")),
        Reply::Accepted => Fate::Accepted,
        Reply::Unwritten(why) => Fate::Unwritten(why),
        Reply::Torn(why) => Fate::Torn(why),
        Reply::NotTried => Fate::NotTried,
    }
}

impl Reply {
    /// Whether the meter has taken something.
    const fn has_reached(&self) -> bool {
        matches!(self, Self::Confirmed | Self::Stored(_) | Self::Accepted)
    }
}

/// Why reading a point back would not tell.
fn unreadable(point: &Point) -> Option<Unread> {
    if !point.access.readable() {
        Some(Unread::WriteOnly)
    } else if point.writing().momentary {
        Some(Unread::Momentary)
    } else {
        None
    }
}

fn compared(change: &Change, found: &Value, scales: &Scales, is_at_work: bool) -> Fate {
    match change.point.interpret(&change.registers, scales) {
        Ok(wanted) if wanted == *found => Fate::ReadBack,
        _ if is_at_work => Fate::Accepted,
        _ => Fate::Otherwise(found.to_string()),
    }
}

/// What the meter said it has stored in one of the registers of a point.
fn stored(change: &Change, value: u16, scales: &Scales) -> String {
    let shown = match change.registers.as_slice() {
        [_] => change.point.interpret(&[value], scales).ok(),
        _ => None,
    };
    shown.map_or_else(
        || format!("0x{value:04X} in a register"),
        |value| value.to_string(),
    )
}
