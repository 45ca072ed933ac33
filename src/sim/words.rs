//! Values as all meters write them into registers.

use super::model::Content;

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

/// Two characters a register, the first in the high byte; 0 where the last register has none left.
pub(super) fn text(text: &str) -> Content {
    let words = text.as_bytes().chunks(2).map(|pair| match pair {
        [first, second] => u16::from_be_bytes([*first, *second]),
        [first] => u16::from_be_bytes([*first, 0]),
        _ => 0,
    });
    Content::Words(words.collect())
}
