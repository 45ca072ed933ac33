//! What a point reads as.

use std::fmt;

use rust_decimal::Decimal;
use serde::{Deserialize, Serialize};

/// A value with a meaning: scaled, labelled, exact.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// A scaled integer: exact, with the digits its scale gives it.
    Decimal(Decimal),
    /// A single float as the meter sent it; finite.
    Single(f32),
    /// A double float; finite.
    Double(f64),
    /// A label, a set of flags, text, a date or a time.
    Text(String),
}

impl Value {
    /// Whether it is a number, so that JSON writes it without quotes.
    pub const fn is_number(&self) -> bool {
        !matches!(self, Self::Text(_))
    }
}

impl fmt::Display for Value {
    /// Numbers without rounding; floats in the shortest form that reads back the same, the very
    /// large and the very small with an exponent.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Decimal(number) => number.fmt(f),
            Self::Single(number) if is_plain(f64::from(*number)) => number.fmt(f),
            Self::Single(number) => write!(f, "{number:e}"),
            Self::Double(number) if is_plain(*number) => number.fmt(f),
            Self::Double(number) => write!(f, "{number:e}"),
            Self::Text(text) => f.write_str(text),
        }
    }
}

/// Whether a float is of a size that is written without an exponent.
fn is_plain(number: f64) -> bool {
    number == 0.0 || (1e-5..1e16).contains(&number.abs())
}

/// Why registers that arrived whole hold no value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Missing {
    /// The meter says that the quantity is beyond what it measures.
    Overflow,
    /// The meter says that there is nothing: never set, not fitted, not a number.
    Absent,
    /// The registers hold what the type cannot: month 13, say.
    Mismatch,
}
