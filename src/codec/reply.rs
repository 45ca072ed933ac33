//! What a meter says: the protocol data units of responses and exceptions.

use super::address::RegisterAddress;
use super::cursor::Cursor;
use super::error::DecodeError;
use super::exception::ExceptionCode;
use super::function::{FunctionCode, ReadFunction};
use super::registers::{ReadValues, WrittenRange};
use super::request::{self, Request, Write};

/// A meter's reply: what was asked for, or why not.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Reply {
    /// A normal response.
    Normal(Response),
    /// An exception response (AP 7).
    Exception {
        /// The function that was refused.
        function: FunctionCode,
        /// Why.
        code: ExceptionCode,
    },
}

impl Reply {
    /// The function it answers.
    pub fn function(&self) -> FunctionCode {
        match self {
            Self::Normal(response) => response.function(),
            Self::Exception { function, .. } => *function,
        }
    }

    /// Why it refuses; `None` for a normal response.
    pub const fn exception(&self) -> Option<ExceptionCode> {
        match self {
            Self::Normal(_) => None,
            Self::Exception { code, .. } => Some(*code),
        }
    }
}

/// A normal response.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Response {
    /// The registers of function 03 or 04.
    Registers {
        /// Which of the two functions answered.
        function: ReadFunction,
        /// The values in address order.
        values: ReadValues,
    },
    /// Function 05: the request repeated.
    Coil {
        /// The coil, or on a PQM the number of the operation.
        address: RegisterAddress,
        /// On or off.
        on: bool,
    },
    /// Function 06: the request repeated, with the value the meter stored.
    Register {
        /// The register.
        address: RegisterAddress,
        /// Its value.
        value: u16,
    },
    /// Function 07: eight bits whose meaning the meter gives.
    ExceptionStatus(u8),
    /// Function 08, sub-function 0: the word of the request.
    QueryData(u16),
    /// Function 16: which registers were written.
    RegistersWritten(WrittenRange),
}

impl Reply {
    /// Appends the data unit, function code first.
    pub fn encode(&self, into: &mut Vec<u8>) {
        match self {
            Self::Exception { function, code } => {
                into.extend_from_slice(&[function.exception(), code.0]);
            }
            Self::Normal(response) => response.encode(into),
        }
    }

    /// Reads a data unit, function code first. Every byte must belong to it.
    ///
    /// # Errors
    /// [`DecodeError`] names the field that is cut, contradictory or out of bounds.
    pub fn decode(unit: &[u8]) -> Result<Self, DecodeError> {
        let mut fields = Cursor::new(unit);
        let code = fields.u8("function code")?;
        let reply = if code & 0x80 == 0 {
            Self::Normal(Response::decode(
                FunctionCode::try_from(code)?,
                &mut fields,
            )?)
        } else {
            Self::Exception {
                function: FunctionCode::try_from(code & 0x7F)?,
                code: ExceptionCode(fields.u8("exception code")?),
            }
        };
        fields.finish()?;
        Ok(reply)
    }
}

impl Response {
    /// The function code it comes with.
    pub fn function(&self) -> FunctionCode {
        match self {
            Self::Registers { function, .. } => FunctionCode::from(*function),
            Self::Coil { .. } => FunctionCode::WriteSingleCoil,
            Self::Register { .. } => FunctionCode::WriteSingleRegister,
            Self::ExceptionStatus(_) => FunctionCode::ReadExceptionStatus,
            Self::QueryData(_) => FunctionCode::Diagnostics,
            Self::RegistersWritten(_) => FunctionCode::WriteMultipleRegisters,
        }
    }

    fn encode(&self, into: &mut Vec<u8>) {
        match self {
            Self::Registers { values, .. } => {
                into.push(self.function().get());
                request::push_counted(into, values.as_slice());
            }
            // These two repeat their request byte for byte (AP 6.5, 6.6).
            Self::Coil { address, on } => Write::Coil {
                address: *address,
                on: *on,
            }
            .encode(into),
            Self::Register { address, value } => Write::Register {
                address: *address,
                value: *value,
            }
            .encode(into),
            Self::ExceptionStatus(bits) => {
                into.extend_from_slice(&[self.function().get(), *bits]);
            }
            Self::QueryData(word) => Request::ReturnQueryData(*word).encode(into),
            Self::RegistersWritten(range) => {
                into.push(self.function().get());
                request::push(into, range.start().get());
                request::push(into, range.count());
            }
        }
    }

    fn decode(function: FunctionCode, fields: &mut Cursor<'_>) -> Result<Self, DecodeError> {
        Ok(match function {
            FunctionCode::ReadHoldingRegisters => {
                registers(fields, ReadFunction::HoldingRegisters)?
            }
            FunctionCode::ReadInputRegisters => registers(fields, ReadFunction::InputRegisters)?,
            FunctionCode::WriteSingleCoil => {
                let (address, on) = request::coil(fields)?;
                Self::Coil { address, on }
            }
            FunctionCode::WriteSingleRegister => Self::Register {
                address: RegisterAddress(fields.u16("register address")?),
                value: fields.u16("register value")?,
            },
            FunctionCode::ReadExceptionStatus => Self::ExceptionStatus(fields.u8("output data")?),
            FunctionCode::Diagnostics => Self::QueryData(request::query_data(fields)?),
            FunctionCode::WriteMultipleRegisters => {
                let start = fields.u16("starting address")?;
                let count = fields.u16("quantity of registers")?;
                Self::RegistersWritten(WrittenRange::new(start, count)?)
            }
            other @ FunctionCode::Other(_) => return Err(DecodeError::Function(other)),
        })
    }
}

fn registers(fields: &mut Cursor<'_>, function: ReadFunction) -> Result<Response, DecodeError> {
    let values = ReadValues::new(request::counted(fields, "register value")?)?;
    Ok(Response::Registers { function, values })
}
