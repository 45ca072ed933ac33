//! Dates and times as the PQM shows them: UTC, in whole milliseconds.

use jiff::Timestamp;
use jiff::civil::{self, Date, DateTime};
use jiff::tz::TimeZone;

use crate::codec::value::Raw;
use crate::sim::model::Content;

fn utc(time: Timestamp) -> DateTime {
    TimeZone::UTC.to_datetime(time)
}

/// The time of day.
pub(super) fn time_of(at: Timestamp) -> Content {
    let at = utc(at).time();
    let milliseconds = i32::from(at.millisecond()) * 1_000_000;
    time(civil::time(
        at.hour(),
        at.minute(),
        at.second(),
        milliseconds,
    ))
}

/// A time of day of whole milliseconds.
pub(super) const fn time(time: civil::Time) -> Content {
    Content::Other(Raw::Time(time))
}

/// The day.
pub(super) fn date_of(at: Timestamp) -> Content {
    date(utc(at).date())
}

/// A day.
pub(super) const fn date(date: Date) -> Content {
    Content::Other(Raw::Date(date))
}
