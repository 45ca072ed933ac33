//! Registers as messages carry them: never none, never more than one message has room for.

use super::address::{RegisterAddress, RegisterRange};
use super::error::AddressError;

/// What one read of function 03 or 04 brings: the values of 1 to 125 registers (AP 6.3, 6.4).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ReadValues(Vec<u16>);

impl ReadValues {
    /// The most registers one read carries (AP 6.3).
    pub const MOST: u16 = RegisterRange::MOST;

    /// Checks the number of values.
    ///
    /// # Errors
    /// [`AddressError::Count`] for none or more than 125.
    pub fn new(values: Vec<u16>) -> Result<Self, AddressError> {
        if values.is_empty() || values.len() > usize::from(Self::MOST) {
            return Err(AddressError::Count {
                what: "read",
                found: values.len(),
                most: Self::MOST,
            });
        }
        Ok(Self(values))
    }

    /// The values, in address order.
    pub fn as_slice(&self) -> &[u16] {
        &self.0
    }

    /// The values, in address order.
    pub fn into_vec(self) -> Vec<u16> {
        self.0
    }

    /// How many there are, 1 to 125.
    #[expect(clippy::cast_possible_truncation, reason = "`new` takes 125 at most")]
    pub const fn count(&self) -> u16 {
        self.0.len() as u16
    }
}

/// Which registers one write of function 16 is about: 1 to 123 of them (AP 6.12), none past
/// address 0xFFFF.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct WrittenRange(RegisterRange);

impl WrittenRange {
    /// The most registers one write carries (AP 6.12).
    pub const MOST: u16 = 123;

    /// Checks a start and a count.
    ///
    /// # Errors
    /// [`AddressError::Count`] for 0 or more than 123 registers, [`AddressError::PastEnd`] when the
    /// last one would lie past 0xFFFF.
    pub const fn new(start: u16, count: u16) -> Result<Self, AddressError> {
        if count == 0 || count > Self::MOST {
            return Err(AddressError::Count {
                what: "write",
                found: count as usize,
                most: Self::MOST,
            });
        }
        match RegisterRange::new(start, count) {
            Ok(range) => Ok(Self(range)),
            Err(error) => Err(error),
        }
    }

    /// The first register.
    pub const fn start(self) -> RegisterAddress {
        self.0.start()
    }

    /// The number of registers, 1 to 123.
    pub const fn count(self) -> u16 {
        self.0.count()
    }
}

/// What one write of function 16 stores: 1 to 123 values (AP 6.12), and from which register on;
/// none past address 0xFFFF.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RegisterBlock {
    range: WrittenRange,
    /// As many as `range` counts.
    values: Vec<u16>,
}

impl RegisterBlock {
    /// The most registers one write carries (AP 6.12).
    pub const MOST: u16 = WrittenRange::MOST;

    /// Checks the number of values and where the last one goes.
    ///
    /// # Errors
    /// [`AddressError::Count`] for none or more than 123, [`AddressError::PastEnd`] when the last
    /// one would lie past 0xFFFF.
    pub fn new(start: u16, values: Vec<u16>) -> Result<Self, AddressError> {
        let count = u16::try_from(values.len()).map_err(|_| AddressError::Count {
            what: "write",
            found: values.len(),
            most: Self::MOST,
        })?;
        let range = WrittenRange::new(start, count)?;
        Ok(Self { range, values })
    }

    /// Which registers are written.
    pub const fn range(&self) -> WrittenRange {
        self.range
    }

    /// The first register.
    pub const fn start(&self) -> RegisterAddress {
        self.range.start()
    }

    /// The values, in address order.
    pub fn values(&self) -> &[u16] {
        &self.values
    }

    /// How many there are, 1 to 123.
    pub const fn count(&self) -> u16 {
        self.range.count()
    }
}
