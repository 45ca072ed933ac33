//! What a client asks: the protocol data units of requests.

use super::address::{RegisterAddress, RegisterRange};
use super::cursor::Cursor;
use super::error::DecodeError;
use super::function::{FunctionCode, ReadFunction};
use super::registers::RegisterBlock;

/// Value field of function 05 for "on" (AP 6.5).
pub(super) const COIL_ON: u16 = 0xFF00;

/// Sub-function of function 08: Return Query Data (AP 6.8.1).
pub(super) const RETURN_QUERY_DATA: u16 = 0x0000;

/// A request to one unit.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Request {
    /// 3 (03h) Read Holding Registers or 4 (04h) Read Input Registers.
    Read {
        /// Which of the two.
        function: ReadFunction,
        /// The registers wanted.
        range: RegisterRange,
    },
    /// One of the writes.
    Write(Write),
    /// 7 (07h) Read Exception Status.
    ReadExceptionStatus,
    /// 8 (08h) Diagnostics, sub-function 0 Return Query Data: the unit sends the word back.
    ReturnQueryData(u16),
}

/// A request that changes something; the only kind that can be broadcast.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Write {
    /// 5 (05h) Write Single Coil: `FF00` for on, `0000` for off.
    Coil {
        /// The coil; on a PQM the number of the operation.
        address: RegisterAddress,
        /// On or off.
        on: bool,
    },
    /// 6 (06h) Write Single Register.
    Register {
        /// The register.
        address: RegisterAddress,
        /// Its new value.
        value: u16,
    },
    /// 16 (10h) Write Multiple Registers.
    Registers(RegisterBlock),
}

impl Request {
    /// The function code it goes out with.
    pub const fn function(&self) -> FunctionCode {
        match self {
            Self::Read {
                function: ReadFunction::HoldingRegisters,
                ..
            } => FunctionCode::ReadHoldingRegisters,
            Self::Read {
                function: ReadFunction::InputRegisters,
                ..
            } => FunctionCode::ReadInputRegisters,
            Self::Write(write) => write.function(),
            Self::ReadExceptionStatus => FunctionCode::ReadExceptionStatus,
            Self::ReturnQueryData(_) => FunctionCode::Diagnostics,
        }
    }

    /// The same read with the other of the functions 03 and 04; `None` for what is no read.
    pub fn with_other_function(&self) -> Option<Self> {
        match self {
            Self::Read { function, range } => Some(Self::Read {
                function: function.other(),
                range: *range,
            }),
            _ => None,
        }
    }

    /// Appends the data unit, function code first: 1 to 252 bytes.
    pub fn encode(&self, into: &mut Vec<u8>) {
        match self {
            Self::Read { range, .. } => {
                into.push(self.function().get());
                push(into, range.start().get());
                push(into, range.count());
            }
            Self::Write(write) => write.encode(into),
            Self::ReadExceptionStatus => into.push(self.function().get()),
            Self::ReturnQueryData(word) => {
                into.push(self.function().get());
                push(into, RETURN_QUERY_DATA);
                push(into, *word);
            }
        }
    }

    /// Reads a data unit, function code first. Every byte must belong to it.
    ///
    /// # Errors
    /// [`DecodeError`] names the field that is cut, contradictory or out of bounds.
    pub fn decode(unit: &[u8]) -> Result<Self, DecodeError> {
        let mut fields = Cursor::new(unit);
        let function = FunctionCode::try_from(fields.u8("function code")?)?;
        let request = match function {
            FunctionCode::ReadHoldingRegisters => {
                read(&mut fields, ReadFunction::HoldingRegisters)?
            }
            FunctionCode::ReadInputRegisters => read(&mut fields, ReadFunction::InputRegisters)?,
            FunctionCode::WriteSingleCoil => {
                let (address, on) = coil(&mut fields)?;
                Self::Write(Write::Coil { address, on })
            }
            FunctionCode::WriteSingleRegister => Self::Write(Write::Register {
                address: RegisterAddress(fields.u16("register address")?),
                value: fields.u16("register value")?,
            }),
            FunctionCode::ReadExceptionStatus => Self::ReadExceptionStatus,
            FunctionCode::Diagnostics => Self::ReturnQueryData(query_data(&mut fields)?),
            FunctionCode::WriteMultipleRegisters => Self::Write(registers(&mut fields)?),
            other @ FunctionCode::Other(_) => return Err(DecodeError::Function(other)),
        };
        fields.finish()?;
        Ok(request)
    }
}

impl Write {
    /// The function code it goes out with.
    pub const fn function(&self) -> FunctionCode {
        match self {
            Self::Coil { .. } => FunctionCode::WriteSingleCoil,
            Self::Register { .. } => FunctionCode::WriteSingleRegister,
            Self::Registers(_) => FunctionCode::WriteMultipleRegisters,
        }
    }

    /// Appends the data unit, function code first.
    pub fn encode(&self, into: &mut Vec<u8>) {
        into.push(self.function().get());
        match self {
            Self::Coil { address, on } => {
                push(into, address.get());
                push(into, if *on { COIL_ON } else { 0 });
            }
            Self::Register { address, value } => {
                push(into, address.get());
                push(into, *value);
            }
            Self::Registers(block) => {
                push(into, block.start().get());
                push(into, block.count());
                push_counted(into, block.values());
            }
        }
    }
}

/// Appends a 16-bit field, high byte first.
pub(super) fn push(into: &mut Vec<u8>, field: u16) {
    into.extend_from_slice(&field.to_be_bytes());
}

/// Appends a byte count and the registers it counts: what a [`RegisterBlock`] or a
/// [`super::ReadValues`] holds.
pub(super) fn push_counted(into: &mut Vec<u8>, registers: &[u16]) {
    #[expect(
        clippy::cast_possible_truncation,
        reason = "neither type holds more than 125 registers, so there are 250 bytes at most"
    )]
    into.push(2 * registers.len() as u8);
    for register in registers {
        push(into, *register);
    }
}

fn read(fields: &mut Cursor<'_>, function: ReadFunction) -> Result<Request, DecodeError> {
    let start = fields.u16("starting address")?;
    let count = fields.u16("quantity of registers")?;
    Ok(Request::Read {
        function,
        range: RegisterRange::new(start, count)?,
    })
}

/// Address and value of function 05, the same in both directions.
pub(super) fn coil(fields: &mut Cursor<'_>) -> Result<(RegisterAddress, bool), DecodeError> {
    let address = RegisterAddress(fields.u16("output address")?);
    match fields.u16("output value")? {
        COIL_ON => Ok((address, true)),
        0 => Ok((address, false)),
        found => Err(DecodeError::Field {
            field: "output value",
            found,
        }),
    }
}

/// Sub-function and data of function 08, the same in both directions.
pub(super) fn query_data(fields: &mut Cursor<'_>) -> Result<u16, DecodeError> {
    match fields.u16("sub-function")? {
        RETURN_QUERY_DATA => fields.u16("data"),
        found => Err(DecodeError::Field {
            field: "sub-function",
            found,
        }),
    }
}

fn registers(fields: &mut Cursor<'_>) -> Result<Write, DecodeError> {
    let start = fields.u16("starting address")?;
    let count = fields.u16("quantity of registers")?;
    let values = counted(fields, "register value")?;
    if usize::from(count) != values.len() {
        return Err(DecodeError::Field {
            field: "quantity of registers",
            found: count,
        });
    }
    Ok(Write::Registers(RegisterBlock::new(start, values)?))
}

/// A byte count and exactly that many bytes of registers, to the end of the data unit.
pub(super) fn counted(
    fields: &mut Cursor<'_>,
    field: &'static str,
) -> Result<Vec<u16>, DecodeError> {
    let found = fields.u8("byte count")?;
    let expected = fields.remaining();
    if usize::from(found) != expected {
        return Err(DecodeError::ByteCount { found, expected });
    }
    if !expected.is_multiple_of(2) {
        return Err(DecodeError::Field {
            field: "byte count",
            found: u16::from(found),
        });
    }
    (0..expected / 2).map(|_| fields.u16(field)).collect()
}
