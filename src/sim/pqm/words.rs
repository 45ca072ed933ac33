//! Dates and times as the PQM writes them into registers.

use jiff::Timestamp;
use jiff::civil::{Date, DateTime};
use jiff::tz::TimeZone;

use crate::sim::model::Content;
use crate::sim::words::text;

/// Text in as many characters as the point has, the rest of them spaces.
pub(super) fn padded(content: &str, length: usize) -> Content {
    text(&format!("{content:<length$}"))
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
