//! From what a point reads as back to its registers: the inverse of [`Point::interpret`].
//!
//! A value is written as it is shown: a number in the point's unit, a label, names of bits, text, a
//! date or a time. Codes, hex and bits can be given as numbers as well. What comes out means what
//! was asked for, or there is an error: nothing is rounded into the nearest register.
//!
//! Of an integer, `0x...` is the raw number, before scale and labels: where the scale is 0.1, `0x00C8`
//! writes 200 and shows as 20.0. A negative one is given by its bits: `0xFFFF` is -1 as i16. It is for
//! numbers that a manual gives, and that no scale leads to.

mod flags;
mod number;

use std::str::FromStr;

use jiff::civil;
use rust_decimal::Decimal;
use thiserror::Error;

use super::point::{Labels, Point};
use super::setup::Scales;
use super::value::Missing;
use crate::codec::value::{Raw, RegisterType, encode};

/// Why a value cannot be put into a point's registers.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum EncodeError {
    /// Not of the kind that the point holds.
    #[error("'{found}' is not {expected}")]
    Kind {
        /// What was given.
        found: String,
        /// What can be given.
        expected: String,
    },
    /// Between two raw numbers.
    #[error("{found} is between two steps: the nearest are {below} and {above}")]
    BetweenSteps {
        /// What was given.
        found: Decimal,
        /// The next value below.
        below: Decimal,
        /// The next value above.
        above: Decimal,
    },
    /// Beyond what the registers hold.
    #[error("{found} is not within {lowest} to {highest}")]
    OutOfRange {
        /// What was given.
        found: String,
        /// The lowest value.
        lowest: Decimal,
        /// The highest value.
        highest: Decimal,
    },
    /// A raw number that the registers cannot hold.
    #[error("{found} is not within 0x0 to {highest:#X}, as raw numbers")]
    RawRange {
        /// What was given.
        found: String,
        /// The highest raw number.
        highest: u64,
    },
    /// A number that no raw number gives on a scale that is not the same everywhere.
    #[error("{found} is on no step of {scale}")]
    NoStep {
        /// What was given.
        found: Decimal,
        /// The scale.
        scale: String,
    },
    /// There is no scale with the setup of the meter.
    #[error("there is no {factor} to scale it by with this setup")]
    NoScale {
        /// The number that is lacking.
        factor: String,
    },
    /// The point means nothing with the setup of the meter.
    #[error("it means nothing while {point} holds what it does")]
    MeansNothing {
        /// The point that decides.
        point: String,
    },
    /// The registers would be those that stand for no value.
    #[error("'{found}' would read as {}", reads_as(*.missing))]
    Marker {
        /// What was given.
        found: String,
        /// What it would read as.
        missing: Missing,
    },
}

const fn reads_as(missing: Missing) -> &'static str {
    match missing {
        Missing::Overflow => "out of range",
        Missing::Absent => "no value",
        Missing::Mismatch => "no value of this point",
    }
}

impl Point {
    /// The registers in which this point holds `value` on a meter that is set up like this. Whether
    /// it may be written there is another question: see [`Point::access`] and [`Point::limits`].
    ///
    /// A float is the nearest there is; all else is exact.
    ///
    /// # Errors
    /// [`EncodeError`] tells what was given and what can be given.
    pub fn encode(&self, value: &str, scales: &Scales) -> Result<Vec<u16>, EncodeError> {
        if let Some(with) = &self.only_with
            && !scales
                .setting(&with.point)
                .is_ok_and(|setting| with.means_something(setting))
        {
            return Err(EncodeError::MeansNothing {
                point: with.point.clone(),
            });
        }
        let raw = self.raw_of(value, scales)?;
        let registers = encode(self.kind, self.order, &raw);
        let registers = registers.ok_or_else(|| self.no_such(value))?;
        // The marker of no value is a raw number like any other: only reading tells. What was given
        // raw need not mean anything with this setup.
        let read = if self.kind.is_integer() && hex(value.trim()).is_some() {
            self.raw_value(&registers).map(drop)
        } else {
            self.interpret(&registers, scales).map(drop)
        };
        match read {
            Ok(()) => Ok(registers),
            Err(missing) => Err(EncodeError::Marker {
                found: value.to_owned(),
                missing,
            }),
        }
    }

    fn raw_of(&self, value: &str, scales: &Scales) -> Result<Raw, EncodeError> {
        let trimmed = value.trim();
        match self.kind {
            RegisterType::Ascii(_) => Ok(Raw::Text(value.to_owned())),
            RegisterType::Letter => Ok(Raw::Text(trimmed.to_owned())),
            RegisterType::Time => self.parsed::<civil::Time>(trimmed).map(Raw::Time),
            RegisterType::Date => self.parsed::<civil::Date>(trimmed).map(Raw::Date),
            RegisterType::F32 => self.float(trimmed).map(Raw::Single),
            RegisterType::F64 => self.float(trimmed).map(Raw::Double),
            RegisterType::Hex | RegisterType::Bits => {
                let word = flags::word(&self.labels, trimmed);
                word.map(Raw::Word).ok_or_else(|| self.no_such(value))
            }
            RegisterType::U16
            | RegisterType::I16
            | RegisterType::U32
            | RegisterType::I32
            | RegisterType::U64
            | RegisterType::I64
            | RegisterType::Mod10000 => self.integer_of(trimmed, scales).map(Raw::Integer),
        }
    }

    fn integer_of(&self, value: &str, scales: &Scales) -> Result<i128, EncodeError> {
        if let Some(code) = flags::code(&self.labels, value) {
            return Ok(match self.kind {
                // Labels go by the register, which holds a negative number as well.
                RegisterType::I16 => code.cast_signed().into(),
                _ => code.into(),
            });
        }
        if let Some(digits) = hex(value) {
            return number::from_hex(self.kind, digits, value)
                .ok_or_else(|| self.no_such(value))?;
        }
        let figure = Decimal::from_str_exact(value);
        let figure = figure.map_err(|_| self.no_such(value))?;
        number::raw(self, figure, value, scales)
    }

    fn parsed<T: FromStr>(&self, value: &str) -> Result<T, EncodeError> {
        value.parse().map_err(|_| self.no_such(value))
    }

    /// A float of the registers that shows as this, or the nearest there is.
    fn float<T: FromStr + ToString + IsFinite>(&self, value: &str) -> Result<T, EncodeError> {
        let scale = self.constant_scale().unwrap_or(Decimal::ONE);
        let unscaled = if scale == Decimal::ONE {
            value.to_owned()
        } else {
            let figure = Decimal::from_str_exact(value).map_err(|_| self.no_such(value))?;
            let unscaled = figure.checked_div(scale);
            unscaled.ok_or_else(|| self.no_such(value))?.to_string()
        };
        let float: T = self.parsed(&unscaled)?;
        if float.is_finite() {
            Ok(float)
        } else {
            Err(self.no_such(value))
        }
    }

    fn no_such(&self, found: &str) -> EncodeError {
        EncodeError::Kind {
            found: found.to_owned(),
            expected: self.expected(),
        }
    }

    /// What can be given, in words.
    pub fn expected(&self) -> String {
        match self.kind {
            RegisterType::Ascii(most) => {
                format!("text of at most {most} characters, all of them ASCII")
            }
            RegisterType::Letter => "a letter from A to Z".to_owned(),
            RegisterType::Time => "a time of day such as 23:59:59.999".to_owned(),
            RegisterType::Date => "a date such as 2026-11-22".to_owned(),
            RegisterType::Hex | RegisterType::Bits => {
                let register = "a register such as 0x00FF, 0b101 or 255";
                match &self.labels {
                    Labels::None => register.to_owned(),
                    Labels::Codes(names) => format!("{register}, {}", flags::one_of(names)),
                    Labels::Bits(names) => {
                        format!(
                            "{register}, or any of {} with '|' between",
                            flags::listed(names)
                        )
                    }
                }
            }
            _ => match &self.labels {
                Labels::None | Labels::Bits(_) => "a number".to_owned(),
                Labels::Codes(names) => format!("a number, {}", flags::one_of(names)),
            },
        }
    }
}

/// The digits of a number in hex.
fn hex(value: &str) -> Option<&str> {
    value
        .strip_prefix("0x")
        .or_else(|| value.strip_prefix("0X"))
}

/// What both kinds of floats can be asked.
trait IsFinite {
    fn is_finite(&self) -> bool;
}

impl IsFinite for f32 {
    fn is_finite(&self) -> bool {
        Self::is_finite(*self)
    }
}

impl IsFinite for f64 {
    fn is_finite(&self) -> bool {
        Self::is_finite(*self)
    }
}
