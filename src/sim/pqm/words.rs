//! Values as the PQM writes them into registers.

use jiff::Timestamp;
use jiff::civil::{Date, DateTime};
use jiff::tz::TimeZone;

use crate::sim::model::Content;

/// The nearest whole step.
#[expect(
    clippy::cast_possible_truncation,
    reason = "the nearest integer is the point; every value here is far inside i128"
)]
pub(super) fn rounded(value: f64) -> i128 {
    value.round() as i128
}

/// A counter shows whole units that are full, and starts at 0 in 2020.
pub(super) fn counter(value: f64) -> Content {
    Content::Number(rounded(value.floor().max(0.0)))
}

/// Two characters a register, the first in the high byte (F10).
pub(super) fn text(text: &str) -> Content {
    let words = text.as_bytes().chunks(2).map(|pair| match pair {
        [first, second] => u16::from_be_bytes([*first, *second]),
        [first] => u16::from_be_bytes([*first, b' ']),
        _ => 0,
    });
    Content::Words(words.collect())
}

fn utc(time: Timestamp) -> DateTime {
    TimeZone::UTC.to_datetime(time)
}

/// Hour and minute (F22), then milliseconds in the minute (F23), UTC.
pub(super) fn time_of(time: Timestamp) -> Content {
    let time = utc(time).time();
    // At most 59 999.
    let milliseconds = i32::from(time.second()) * 1000 + i32::from(time.millisecond());
    Content::Words(vec![
        pair(time.hour(), time.minute()),
        u16::try_from(milliseconds).unwrap_or_default(),
    ])
}

/// Month and day (F24), then the year (F25), UTC.
pub(super) fn date_of(time: Timestamp) -> Content {
    date(utc(time).date())
}

/// Month and day, then the year.
pub(super) fn date(date: Date) -> Content {
    Content::Words(vec![
        pair(date.month(), date.day()),
        // A year before the common era has no register value; no clock shows one.
        u16::try_from(date.year()).unwrap_or_default(),
    ])
}

/// Two parts of a date or a time, none of them negative.
fn pair(high: i8, low: i8) -> u16 {
    u16::from_be_bytes([high.unsigned_abs(), low.unsigned_abs()])
}
