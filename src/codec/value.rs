//! Registers as values: numbers in every width and byte order, text, dates and times.

mod encode;

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};
use thiserror::Error;

pub use encode::{encode, encode_integer};

/// How the bytes of a value lie in its registers, named by where the bytes A (most significant)
/// to D of a 32-bit value are found. Wider and narrower values follow the same two choices.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum ByteOrder {
    /// High word first, high byte first: the standard's own order.
    #[default]
    Abcd,
    /// Low word first, high byte first.
    Cdab,
    /// High word first, low byte first.
    Badc,
    /// Low word first, low byte first.
    Dcba,
}

impl ByteOrder {
    const ALL: [(Self, &'static str); 4] = [
        (Self::Abcd, "ABCD"),
        (Self::Cdab, "CDAB"),
        (Self::Badc, "BADC"),
        (Self::Dcba, "DCBA"),
    ];

    const fn low_word_first(self) -> bool {
        matches!(self, Self::Cdab | Self::Dcba)
    }

    const fn low_byte_first(self) -> bool {
        matches!(self, Self::Badc | Self::Dcba)
    }

    /// The most significant register of a value, high byte first; `None` without registers.
    pub fn high_word(self, registers: &[u16]) -> Option<u16> {
        self.arrange(registers).first().copied()
    }

    /// Turns registers from this order into high word, high byte first, or back: it undoes itself.
    fn arrange(self, registers: &[u16]) -> Vec<u16> {
        let mut words = registers.to_vec();
        if self.low_word_first() {
            words.reverse();
        }
        if self.low_byte_first() {
            for word in &mut words {
                *word = word.swap_bytes();
            }
        }
        words
    }
}

impl fmt::Display for ByteOrder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = Self::ALL.iter().find(|(order, _)| order == self);
        f.write_str(name.map_or("", |(_, name)| name))
    }
}

/// A word that names neither a type nor an order.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("unknown {what} '{found}', expected {expected}")]
pub struct UnknownName {
    what: &'static str,
    found: String,
    expected: &'static str,
}

impl FromStr for ByteOrder {
    type Err = UnknownName;

    fn from_str(text: &str) -> Result<Self, UnknownName> {
        Self::ALL
            .iter()
            .find(|(_, name)| name.eq_ignore_ascii_case(text))
            .map(|(order, _)| *order)
            .ok_or_else(|| UnknownName {
                what: "byte order",
                found: text.to_owned(),
                expected: "ABCD, CDAB, BADC or DCBA",
            })
    }
}

/// What a run of registers holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum RegisterType {
    /// Unsigned, one register.
    U16,
    /// Two's complement, one register.
    I16,
    /// Unsigned, two registers.
    U32,
    /// Two's complement, two registers.
    I32,
    /// Unsigned, four registers.
    U64,
    /// Two's complement, four registers.
    I64,
    /// IEEE 754 single, two registers.
    F32,
    /// IEEE 754 double, four registers.
    F64,
    /// One register, shown as it is in hex.
    Hex,
    /// One register of sixteen flags.
    Bits,
    /// Text of this many characters, two a register, high byte first.
    Ascii(u8),
    /// Two registers of four decimal digits each, high + low: `high * 10000 + low`.
    Mod10000,
    /// One register, 1 for A to 26 for Z.
    Letter,
    /// Two registers: hour and minute, then milliseconds in the minute (PQM F22, F23).
    Time,
    /// Two registers: month and day, then the year (PQM F24, F25).
    Date,
}

impl RegisterType {
    const NAMED: [(Self, &'static str); 14] = [
        (Self::U16, "u16"),
        (Self::I16, "i16"),
        (Self::U32, "u32"),
        (Self::I32, "i32"),
        (Self::U64, "u64"),
        (Self::I64, "i64"),
        (Self::F32, "f32"),
        (Self::F64, "f64"),
        (Self::Hex, "hex"),
        (Self::Bits, "bits"),
        (Self::Mod10000, "mod10000"),
        (Self::Letter, "letter"),
        (Self::Time, "time"),
        (Self::Date, "date"),
    ];

    /// The longest text one point can be: what one read carries.
    const MOST_CHARACTERS: u8 = 250;

    /// How many registers it takes, 1 to 125.
    pub const fn registers(self) -> u16 {
        match self {
            Self::U16 | Self::I16 | Self::Hex | Self::Bits | Self::Letter => 1,
            Self::U32 | Self::I32 | Self::F32 | Self::Mod10000 | Self::Time | Self::Date => 2,
            Self::U64 | Self::I64 | Self::F64 => 4,
            Self::Ascii(characters) => (characters as u16).div_ceil(2),
        }
    }

    /// Whether it is a whole number in the registers, so that a scale makes a decimal of it.
    pub const fn is_integer(self) -> bool {
        matches!(
            self,
            Self::U16 | Self::I16 | Self::U32 | Self::I32 | Self::U64 | Self::I64 | Self::Mod10000
        )
    }

    /// Whether it is a number at all: an integer or a float.
    pub const fn is_number(self) -> bool {
        self.is_integer() || matches!(self, Self::F32 | Self::F64)
    }

    /// The lowest and highest raw integer it holds; `None` for what is not an integer.
    pub const fn bounds(self) -> Option<(i128, i128)> {
        Some(match self {
            Self::U16 | Self::Hex | Self::Bits => (0, u16::MAX as i128),
            Self::I16 => (i16::MIN as i128, i16::MAX as i128),
            Self::U32 => (0, u32::MAX as i128),
            Self::I32 => (i32::MIN as i128, i32::MAX as i128),
            Self::U64 => (0, u64::MAX as i128),
            Self::I64 => (i64::MIN as i128, i64::MAX as i128),
            Self::Mod10000 => (0, 9999_9999),
            Self::Letter => (1, 26),
            Self::F32 | Self::F64 | Self::Ascii(_) | Self::Time | Self::Date => return None,
        })
    }
}

impl fmt::Display for RegisterType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Self::Ascii(characters) = self {
            return write!(f, "ascii/{characters}");
        }
        let name = Self::NAMED.iter().find(|(kind, _)| kind == self);
        f.write_str(name.map_or("", |(_, name)| name))
    }
}

impl FromStr for RegisterType {
    type Err = UnknownName;

    fn from_str(text: &str) -> Result<Self, UnknownName> {
        let named = Self::NAMED
            .iter()
            .find(|(_, name)| *name == text)
            .map(|(kind, _)| *kind);
        let ascii = || {
            let characters = text.strip_prefix("ascii/")?.parse().ok()?;
            (1..=Self::MOST_CHARACTERS)
                .contains(&characters)
                .then_some(Self::Ascii(characters))
        };
        named.or_else(ascii).ok_or_else(|| UnknownName {
            what: "type",
            found: text.to_owned(),
            expected: "u16, i16, u32, i32, u64, i64, f32, f64, hex, bits, mod10000, letter, \
                       time, date or ascii/N with N characters, 1 to 250",
        })
    }
}

/// What registers hold, before scale and labels.
#[derive(Debug, Clone, PartialEq)]
pub enum Raw {
    /// A whole number of any width.
    Integer(i128),
    /// A single float.
    Single(f32),
    /// A double float.
    Double(f64),
    /// One register as it is, for hex and bits.
    Word(u16),
    /// Text: trailing spaces and NULs are dropped, what is not ASCII shows as `\xE9`.
    Text(String),
    /// A time of day.
    Time(jiff::civil::Time),
    /// A date.
    Date(jiff::civil::Date),
}

/// Registers that cannot be what they are said to hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum ValueError {
    /// Not as many registers as the type takes.
    #[error("{found} registers, the type takes {expected}")]
    Length {
        /// How many were given.
        found: usize,
        /// How many the type takes.
        expected: u16,
    },
    /// A word with a value that the type does not have.
    #[error("{part} is {found}")]
    Impossible {
        /// Which part of the value.
        part: &'static str,
        /// What it holds.
        found: u16,
    },
    /// A date of which both words are 0: never set. A time of zeros is midnight.
    #[error("never set")]
    Unset,
}

/// Reads registers as a value.
///
/// # Errors
/// [`ValueError`] when the number of registers is wrong or a word holds what the type cannot.
pub fn decode(kind: RegisterType, order: ByteOrder, registers: &[u16]) -> Result<Raw, ValueError> {
    if registers.len() != usize::from(kind.registers()) {
        return Err(ValueError::Length {
            found: registers.len(),
            expected: kind.registers(),
        });
    }
    // Text runs in address order whatever the order of words: only its bytes can be swapped.
    if matches!(kind, RegisterType::Ascii(_)) {
        return Ok(Raw::Text(text(kind, order, registers)));
    }
    let words = order.arrange(registers);
    let bits = words
        .iter()
        .fold(0_u64, |bits, word| bits << 16 | u64::from(*word));
    from_bits(kind, bits)
}

/// A value of up to 64 bits, high word first.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    reason = "the type says how many low bits there are; reading them as signed is the point"
)]
fn from_bits(kind: RegisterType, bits: u64) -> Result<Raw, ValueError> {
    let (high, low) = ((bits >> 16) as u16, bits as u16);
    Ok(match kind {
        RegisterType::U16 | RegisterType::U32 | RegisterType::U64 => Raw::Integer(i128::from(bits)),
        RegisterType::I16 => Raw::Integer(i128::from(bits as i16)),
        RegisterType::I32 => Raw::Integer(i128::from(bits as i32)),
        RegisterType::I64 => Raw::Integer(i128::from(bits as i64)),
        RegisterType::F32 => Raw::Single(f32::from_bits(bits as u32)),
        RegisterType::F64 => Raw::Double(f64::from_bits(bits)),
        RegisterType::Hex | RegisterType::Bits | RegisterType::Ascii(_) => Raw::Word(low),
        RegisterType::Mod10000 => {
            let high = at_most(high, 9999, "high word")?;
            let low = at_most(low, 9999, "low word")?;
            Raw::Integer(i128::from(high) * 10_000 + i128::from(low))
        }
        RegisterType::Letter => match u8::try_from(low) {
            Ok(number @ 1..=26) => Raw::Text(char::from(b'A' - 1 + number).to_string()),
            _ => return Err(impossible("letter", low)),
        },
        RegisterType::Time => Raw::Time(time(high, low)?),
        RegisterType::Date => Raw::Date(date(high, low)?),
    })
}

const fn impossible(part: &'static str, found: u16) -> ValueError {
    ValueError::Impossible { part, found }
}

const fn at_most(found: u16, most: u16, part: &'static str) -> Result<u16, ValueError> {
    if found > most {
        return Err(impossible(part, found));
    }
    Ok(found)
}

/// Hour and minute, then milliseconds in the minute. Midnight is all zeros and a real time.
fn time(hour_minute: u16, milliseconds: u16) -> Result<jiff::civil::Time, ValueError> {
    let [hour, minute] = hour_minute.to_be_bytes().map(u16::from);
    let hour = at_most(hour, 23, "hour")?;
    let minute = at_most(minute, 59, "minute")?;
    let milliseconds = i32::from(at_most(milliseconds, 59_999, "milliseconds in the minute")?);
    // Every field is in range by now: hour and minute fit i8, the rest is below a minute.
    jiff::civil::Time::new(
        i8::try_from(hour).unwrap_or_default(),
        i8::try_from(minute).unwrap_or_default(),
        i8::try_from(milliseconds / 1000).unwrap_or_default(),
        milliseconds % 1000 * 1_000_000,
    )
    .map_err(|_| impossible("hour and minute", hour_minute))
}

/// Month and day, then the year.
fn date(month_day: u16, year: u16) -> Result<jiff::civil::Date, ValueError> {
    if month_day == 0 && year == 0 {
        return Err(ValueError::Unset);
    }
    // The manual's year has four digits, and there is no year 0.
    let Ok(civil_year @ 1..=9999) = i16::try_from(year) else {
        return Err(impossible("year", year));
    };
    let [month, day] = month_day.to_be_bytes().map(i8::try_from);
    match (month, day) {
        (Ok(month), Ok(day)) => jiff::civil::Date::new(civil_year, month, day).ok(),
        _ => None,
    }
    .ok_or(impossible("month and day", month_day))
}

fn text(kind: RegisterType, order: ByteOrder, registers: &[u16]) -> String {
    let RegisterType::Ascii(characters) = kind else {
        return String::new();
    };
    let text: String = registers
        .iter()
        .flat_map(|word| {
            if order.low_byte_first() {
                word.to_le_bytes()
            } else {
                word.to_be_bytes()
            }
        })
        .take(usize::from(characters))
        .flat_map(shown)
        .collect();
    text.trim_end_matches([' ', '\0']).to_owned()
}

/// A byte of text: itself in ASCII, else `\xE9`, so that no two bytes look the same.
fn shown(byte: u8) -> Vec<char> {
    if byte.is_ascii() {
        vec![char::from(byte)]
    } else {
        format!("\\x{byte:02X}").chars().collect()
    }
}
