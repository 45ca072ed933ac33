//! What can be wrong with an address or a frame.

use thiserror::Error;

use super::function::FunctionCode;

/// An address, a unit or a count that the standard does not allow.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum AddressError {
    /// Address 0 is broadcast: nobody answers it, so it is not a unit.
    #[error("unit 0 is the broadcast address, which no meter answers")]
    UnitZero,
    /// A unit above what the meter allows.
    #[error("unit {found} is above {highest}, the highest this meter can have")]
    UnitTooHigh {
        /// The number given.
        found: u16,
        /// The highest one allowed.
        highest: u8,
    },
    /// No registers, or more than fit in one message.
    #[error("{found} registers: a {what} carries 1 to {most}")]
    Count {
        /// The kind of message.
        what: &'static str,
        /// The number asked for.
        found: usize,
        /// The most that one message carries.
        most: u16,
    },
    /// A range that runs past the last register address.
    #[error("{count} registers from 0x{start:04X} run past 0xFFFF, the last address")]
    PastEnd {
        /// The first address.
        start: u16,
        /// The number of registers.
        count: u16,
    },
}

/// Why bytes are not the frame or data unit they should be.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum DecodeError {
    /// The bytes end before the named field.
    #[error("ends before its {field}")]
    Truncated {
        /// The field that is missing or cut.
        field: &'static str,
    },
    /// Bytes are left over after the last field.
    #[error("has {extra} bytes too many")]
    Trailing {
        /// How many are left over.
        extra: usize,
    },
    /// More bytes than a frame can have.
    #[error("{found} bytes are more than the 256 of a frame")]
    TooLong {
        /// The number of bytes.
        found: usize,
    },
    /// The check does not match the bytes.
    #[error("CRC is {found:02X?}, computed {computed:02X?}")]
    Crc {
        /// The two bytes received, in wire order.
        found: [u8; 2],
        /// The two bytes the rest of the frame asks for, in wire order.
        computed: [u8; 2],
    },
    /// A function this codec does not know in this direction.
    #[error("{0} is not handled")]
    Function(FunctionCode),
    /// Broadcast, but not with a write.
    #[error("{0} cannot be broadcast")]
    Broadcast(FunctionCode),
    /// A byte count that contradicts the rest of the frame.
    #[error("byte count is {found}, expected {expected}")]
    ByteCount {
        /// The byte count in the frame.
        found: u8,
        /// What the rest of the frame implies.
        expected: usize,
    },
    /// A field with a value that the standard does not allow.
    #[error("{field} is 0x{found:04X}")]
    Field {
        /// The field.
        field: &'static str,
        /// Its value.
        found: u16,
    },
    /// An address or a count out of bounds.
    #[error(transparent)]
    Address(#[from] AddressError),
}
