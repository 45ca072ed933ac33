//! Who is spoken to and which registers are meant.
//!
//! Meter manuals call the unit "slave address" and holding registers "setpoints". A register
//! address is the 0-based address on the wire everywhere in this crate.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::error::AddressError;

/// Which unit numbers a meter can have.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum UnitRange {
    /// 1 to 247, as the standard has it (SL 2.2).
    #[default]
    Standard,
    /// 1 to 255: some meters, the PQM among them, use the reserved numbers 248 to 255 as well.
    Extended,
}

impl UnitRange {
    /// The highest unit number.
    pub const fn highest(self) -> u8 {
        match self {
            Self::Standard => 247,
            Self::Extended => 255,
        }
    }
}

/// The address of one meter on the line, 1 to 247, or to 255 where the meter allows it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Unit(u8);

impl Unit {
    /// Checks a unit number against what the meter allows.
    ///
    /// # Errors
    /// [`AddressError::UnitZero`] for 0, [`AddressError::UnitTooHigh`] above the range.
    pub const fn new(number: u16, range: UnitRange) -> Result<Self, AddressError> {
        if number == 0 {
            return Err(AddressError::UnitZero);
        }
        let highest = range.highest();
        if number > highest as u16 {
            return Err(AddressError::UnitTooHigh {
                found: number,
                highest,
            });
        }
        #[expect(
            clippy::cast_possible_truncation,
            reason = "the range ends at 255 or below"
        )]
        Ok(Self(number as u8))
    }

    /// The number on the wire.
    pub const fn get(self) -> u8 {
        self.0
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

/// Address 0: every meter obeys, none answers (SL 2.1). A type of its own, so that what must be
/// answered cannot be broadcast: [`super::rtu::encode_broadcast`] takes only a
/// [`super::Write`].
///
/// ```
/// use meterpoll::codec::{Broadcast, ReadFunction, RegisterRange, Request, Unit, UnitRange, rtu};
/// let meter = Unit::new(17, UnitRange::Standard).unwrap();
/// let range = RegisterRange::new(0, 1).unwrap();
/// let read = Request::Read { function: ReadFunction::HoldingRegisters, range };
/// rtu::encode_request(meter, &read);
/// ```
///
/// The same to all meters does not compile:
///
/// ```compile_fail,E0308
/// use meterpoll::codec::{Broadcast, ReadFunction, RegisterRange, Request, Unit, UnitRange, rtu};
/// let meter = Broadcast;
/// let range = RegisterRange::new(0, 1).unwrap();
/// let read = Request::Read { function: ReadFunction::HoldingRegisters, range };
/// rtu::encode_request(meter, &read);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Broadcast;

/// A register's 0-based protocol address.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct RegisterAddress(pub u16);

impl RegisterAddress {
    /// The number on the wire.
    pub const fn get(self) -> u16 {
        self.0
    }
}

impl fmt::Display for RegisterAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "0x{:04X}", self.0)
    }
}

/// Consecutive registers that one read can ask for: 1 to 125 of them (AP 6.3, 6.4), none past
/// address 0xFFFF.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(try_from = "(u16, u16)", into = "(u16, u16)")]
pub struct RegisterRange {
    start: RegisterAddress,
    count: u16,
}

impl RegisterRange {
    /// The most registers one read carries (AP 6.3).
    pub const MOST: u16 = 125;

    /// Checks a start and a count.
    ///
    /// # Errors
    /// [`AddressError::Count`] for 0 or more than 125 registers, [`AddressError::PastEnd`] when the
    /// last one would lie past 0xFFFF.
    pub const fn new(start: u16, count: u16) -> Result<Self, AddressError> {
        if count == 0 || count > Self::MOST {
            return Err(AddressError::Count {
                what: "read",
                found: count as usize,
                most: Self::MOST,
            });
        }
        if start as u32 + count as u32 > 0x1_0000 {
            return Err(AddressError::PastEnd { start, count });
        }
        Ok(Self {
            start: RegisterAddress(start),
            count,
        })
    }

    /// The first register.
    pub const fn start(self) -> RegisterAddress {
        self.start
    }

    /// The number of registers, 1 to 125.
    pub const fn count(self) -> u16 {
        self.count
    }

    /// One past the last register: at most 0x10000, so wider than an address.
    pub const fn end(self) -> u32 {
        self.start.0 as u32 + self.count as u32
    }

    /// Whether a register of `other` is one of these.
    pub const fn overlaps(self, other: Self) -> bool {
        (self.start.0 as u32) < other.end() && (other.start.0 as u32) < self.end()
    }

    /// Whether every register of `other` is one of these.
    pub const fn contains(self, other: Self) -> bool {
        self.start.0 <= other.start.0 && other.end() <= self.end()
    }
}

/// A start and a count.
impl TryFrom<(u16, u16)> for RegisterRange {
    type Error = AddressError;

    fn try_from((start, count): (u16, u16)) -> Result<Self, AddressError> {
        Self::new(start, count)
    }
}

impl From<RegisterRange> for (u16, u16) {
    fn from(range: RegisterRange) -> Self {
        (range.start.0, range.count)
    }
}

impl fmt::Display for RegisterRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}+{}", self.start, self.count)
    }
}
