//! Reading back what was confirmed.

use super::carry_out::Receipt;
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
    replies: Vec<Receipt>,
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
            let unread = match unreadable(&change.point) {
                Some(unread) if is_asked || unread == Unread::Moved => unread,
                _ => Unread::NotAsked,
            };
            match (found(index), reply) {
                (_, Receipt::NotTried) => Fate::NotTried,
                (_, Receipt::Unwritten(why)) => Fate::Unwritten(why),
                (_, Receipt::Torn(why)) => Fate::Torn(why),
                (Some(Ok(value)), reply) => {
                    compared(change, &value, &now, matches!(reply, Receipt::Accepted))
                }
                (_, Receipt::Stored(value)) => Fate::Otherwise(stored(change, value, scales)),
                (_, Receipt::Accepted) => Fate::Accepted,
                (Some(Err(fault)), Receipt::Confirmed) => Fate::Confirmed(Unread::Failed(fault)),
                (None, Receipt::Confirmed) => Fate::Confirmed(unread),
            }
        })
        .collect()
}

/// What became of something that leaves nothing to read back.
pub fn unread(reply: Receipt) -> Fate {
    match reply {
        Receipt::Confirmed => Fate::Confirmed(Unread::Momentary),
        Receipt::Stored(value) => Fate::Otherwise(format!("0x{value:04X}")),
        Receipt::Accepted => Fate::Accepted,
        Receipt::Unwritten(why) => Fate::Unwritten(why),
        Receipt::Torn(why) => Fate::Torn(why),
        Receipt::NotTried => Fate::NotTried,
    }
}

impl Receipt {
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
    } else if point.writing().moves.is_some() {
        Some(Unread::Moved)
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
