//! Function codes: what a request asks for.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::error::DecodeError;

/// A function code, 0 to 127; the standard gives 0 no meaning. Codes this crate does not speak
/// survive and print as numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(try_from = "u8", into = "u8")]
pub enum FunctionCode {
    /// 3 (03h), Read Holding Registers (AP 6.3).
    ReadHoldingRegisters,
    /// 4 (04h), Read Input Registers (AP 6.4).
    ReadInputRegisters,
    /// 5 (05h), Write Single Coil (AP 6.5). The PQM runs an operation with it.
    WriteSingleCoil,
    /// 6 (06h), Write Single Register (AP 6.6).
    WriteSingleRegister,
    /// 7 (07h), Read Exception Status (AP 6.7). The PQM answers with its device status.
    ReadExceptionStatus,
    /// 8 (08h), Diagnostics (AP 6.8); here with sub-function 0, Return Query Data.
    Diagnostics,
    /// 16 (10h), Write Multiple Registers (AP 6.12).
    WriteMultipleRegisters,
    /// Any other code.
    Other(OtherFunction),
}

/// A function code, 0 to 127, that is none of those with a name in [`FunctionCode`]; that is where
/// it is made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct OtherFunction(u8);

impl FunctionCode {
    /// The code on the wire of a request or a normal response.
    pub const fn get(self) -> u8 {
        match self {
            Self::ReadHoldingRegisters => 3,
            Self::ReadInputRegisters => 4,
            Self::WriteSingleCoil => 5,
            Self::WriteSingleRegister => 6,
            Self::ReadExceptionStatus => 7,
            Self::Diagnostics => 8,
            Self::WriteMultipleRegisters => 16,
            Self::Other(code) => code.0,
        }
    }

    /// The code an exception response to this function carries: this one + 80h (AP 7).
    pub const fn exception(self) -> u8 {
        self.get() | 0x80
    }

    /// The standard's name, word for word; `None` for a code this crate does not speak.
    pub const fn name(self) -> Option<&'static str> {
        Some(match self {
            Self::ReadHoldingRegisters => "Read Holding Registers",
            Self::ReadInputRegisters => "Read Input Registers",
            Self::WriteSingleCoil => "Write Single Coil",
            Self::WriteSingleRegister => "Write Single Register",
            Self::ReadExceptionStatus => "Read Exception Status",
            Self::Diagnostics => "Diagnostics",
            Self::WriteMultipleRegisters => "Write Multiple Registers",
            Self::Other(_) => return None,
        })
    }
}

impl TryFrom<u8> for FunctionCode {
    type Error = DecodeError;

    /// From 80h on it is no function code but that of an exception response: a
    /// [`DecodeError::Field`].
    fn try_from(code: u8) -> Result<Self, DecodeError> {
        Ok(match code {
            3 => Self::ReadHoldingRegisters,
            4 => Self::ReadInputRegisters,
            5 => Self::WriteSingleCoil,
            6 => Self::WriteSingleRegister,
            7 => Self::ReadExceptionStatus,
            8 => Self::Diagnostics,
            16 => Self::WriteMultipleRegisters,
            0x80.. => {
                return Err(DecodeError::Field {
                    field: "function code",
                    found: u16::from(code),
                });
            }
            other => Self::Other(OtherFunction(other)),
        })
    }
}

impl From<FunctionCode> for u8 {
    fn from(code: FunctionCode) -> Self {
        code.get()
    }
}

impl fmt::Display for FunctionCode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.name() {
            Some(name) => write!(f, "function {:02} ({name})", self.get()),
            None => write!(f, "function 0x{:02X}", self.get()),
        }
    }
}

/// The two functions that read registers. On many meters they are interchangeable; the standard
/// keeps two tables.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default, Serialize, Deserialize,
)]
pub enum ReadFunction {
    /// 3 (03h), Read Holding Registers.
    #[default]
    HoldingRegisters,
    /// 4 (04h), Read Input Registers.
    InputRegisters,
}

impl ReadFunction {
    /// The other of the two.
    #[must_use]
    pub const fn other(self) -> Self {
        match self {
            Self::HoldingRegisters => Self::InputRegisters,
            Self::InputRegisters => Self::HoldingRegisters,
        }
    }
}

impl From<ReadFunction> for FunctionCode {
    fn from(function: ReadFunction) -> Self {
        match function {
            ReadFunction::HoldingRegisters => Self::ReadHoldingRegisters,
            ReadFunction::InputRegisters => Self::ReadInputRegisters,
        }
    }
}
