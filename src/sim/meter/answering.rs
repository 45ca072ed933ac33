//! What a meter answers to a request that is for it: a response, an exception, or nothing.

use jiff::Timestamp;

use super::Kind;
use super::fixed::Fixed;
use crate::codec::{
    AddressError, DecodeError, ExceptionCode, FunctionCode, ReadValues, RegisterRange, Request,
    Response, Write, WrittenRange,
};

/// Why there is no normal response.
pub(super) enum Refusal {
    /// It does not answer at all.
    Silence,
    /// It says why not.
    Exception(ExceptionCode),
}

impl Kind {
    /// Does what a request asks for, and says what comes of it.
    pub(super) fn obey(
        &mut self,
        function: FunctionCode,
        data_unit: &[u8],
        fixed: &mut Fixed,
        now: Timestamp,
    ) -> Result<Response, Refusal> {
        // Functions 20 and 21, which a real PM290 has, are in no profile.
        if !self.profile.limits.functions.contains(&function) {
            return Err(ExceptionCode::ILLEGAL_FUNCTION.into());
        }
        let request = Request::decode(data_unit)?;
        // Counts and values come before addresses, as in the state diagrams of AP 6.
        if !self.takes(&request) {
            return Err(ExceptionCode::ILLEGAL_DATA_VALUE.into());
        }
        if registers(&request).is_some_and(|range| self.model.is_busy(range, now)) {
            return Err(ExceptionCode::SERVER_DEVICE_BUSY.into());
        }
        match request {
            Request::Read { function, range } => Ok(Response::Registers {
                function,
                // As many as the range, which is never too long for a read.
                values: ReadValues::new(self.read(function, range, fixed, now)?)
                    .map_err(DecodeError::from)?,
            }),
            Request::ReadExceptionStatus => Ok(Response::ExceptionStatus(self.model.status(now))),
            Request::ReturnQueryData(word) => Ok(Response::QueryData(word)),
            Request::Write(write) => {
                self.write(&write, fixed, now)?;
                Ok(done(&write)?)
            }
        }
    }

    /// Whether the counts and values of a request are any that this meter takes. Which exception
    /// tells of too many registers is not in every manual: it is 03 on all of them here, as in the
    /// state diagrams of AP 6.
    fn takes(&self, request: &Request) -> bool {
        let limits = &self.profile.limits;
        match request {
            Request::Read { range, .. } => range.count() <= limits.read_registers,
            Request::Write(Write::Registers(block)) => block.count() <= limits.write_registers,
            Request::ReturnQueryData(word) => limits.loopback_data.takes(*word),
            Request::Write(_) | Request::ReadExceptionStatus => true,
        }
    }
}

/// The response to a write that was carried out: for a single register the request again, also
/// where the meter stored another value, since all manuals call it an echo.
fn done(write: &Write) -> Result<Response, DecodeError> {
    Ok(match write {
        Write::Coil { address, on } => Response::Coil {
            address: *address,
            on: *on,
        },
        Write::Register { address, value } => Response::Register {
            address: *address,
            value: *value,
        },
        Write::Registers(block) => {
            let range = WrittenRange::new(block.start().get(), block.count())?;
            Response::RegistersWritten(range)
        }
    })
}

/// The registers a request touches.
fn registers(request: &Request) -> Option<RegisterRange> {
    let (start, count) = match request {
        Request::Read { range, .. } => return Some(*range),
        Request::Write(Write::Register { address, .. }) => (*address, 1),
        Request::Write(Write::Registers(block)) => (block.start(), block.count()),
        Request::Write(Write::Coil { .. })
        | Request::ReadExceptionStatus
        | Request::ReturnQueryData(_) => return None,
    };
    // What can be written at once can be read at once.
    RegisterRange::new(start.get(), count).ok()
}

impl From<ExceptionCode> for Refusal {
    fn from(code: ExceptionCode) -> Self {
        Self::Exception(code)
    }
}

impl From<DecodeError> for Refusal {
    /// A request of the wrong length is damage that the CRC let through; any other fault is the
    /// client's own.
    fn from(error: DecodeError) -> Self {
        match error {
            DecodeError::Function(_) => ExceptionCode::ILLEGAL_FUNCTION.into(),
            DecodeError::Address(AddressError::PastEnd { .. }) => {
                ExceptionCode::ILLEGAL_DATA_ADDRESS.into()
            }
            DecodeError::Address(_) | DecodeError::Field { .. } => {
                ExceptionCode::ILLEGAL_DATA_VALUE.into()
            }
            DecodeError::ByteCount { .. }
            | DecodeError::Truncated { .. }
            | DecodeError::Trailing { .. }
            | DecodeError::TooLong { .. }
            | DecodeError::Crc { .. }
            | DecodeError::Broadcast(_) => Self::Silence,
        }
    }
}
