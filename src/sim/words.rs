//! Values as all meters write them into registers.

use super::model::Content;
use crate::codec::value::Raw;

/// The nearest whole step.
#[expect(
    clippy::cast_possible_truncation,
    reason = "the nearest integer is the point; every value here is far inside i128"
)]
pub(super) fn rounded(value: f64) -> i128 {
    value.round() as i128
}

/// A counter shows whole units that are full, and starts at 0 in 2020.
pub(super) fn counter(value: f64) -> i128 {
    rounded(value.floor().max(0.0))
}

/// Text, filled up with spaces where the point is longer.
pub(super) fn text(text: &str) -> Content {
    Content::Other(Raw::Text(text.to_owned()))
}
