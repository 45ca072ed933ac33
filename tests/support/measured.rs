//! What a simulated PQM measures, point by point.

#![allow(dead_code, reason = "each test takes what it needs")]

use jiff::{SignedDuration, Timestamp};
use meterpoll::sim::{Content, Measured, Model, Pqm};

/// A moment, in UTC.
pub(crate) fn at(time: &str) -> Timestamp {
    time.parse().unwrap()
}

/// A span of time.
pub(crate) fn seconds(seconds: i64) -> SignedDuration {
    SignedDuration::from_secs(seconds)
}

/// The raw integer of a point at one instant.
pub(crate) fn number(measured: &dyn Measured, point: &str) -> i128 {
    match measured.content(point) {
        Some(Content::Number(number)) => number,
        other => panic!("{point} holds {other:?}"),
    }
}

pub(crate) fn raw(pqm: &Pqm, point: &str, now: Timestamp) -> i128 {
    number(pqm.measure(now).as_ref(), point)
}

/// The registers of a point that is not a number.
pub(crate) fn words(pqm: &Pqm, point: &str, now: Timestamp) -> Vec<u16> {
    match pqm.measure(now).content(point) {
        Some(Content::Words(words)) => words,
        other => panic!("{point} holds {other:?}"),
    }
}

/// A raw integer to calculate with.
pub(crate) fn float(number: i128) -> f64 {
    f64::from(i32::try_from(number).unwrap())
}
