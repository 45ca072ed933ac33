//! A simulated meter: the server side of the codec.

use std::ops::RangeInclusive;

use jiff::Timestamp;

use super::pqm::Pqm;
use crate::codec::value::encode_integer;
use crate::codec::{
    AddressError, DecodeError, ExceptionCode, Frame, FunctionCode, ReadFunction, ReadValues,
    RegisterRange, Reply, Request, Response, Unit, Write, rtu,
};
use crate::profile::{Point, Profile, builtin};

/// What a meter of one kind holds and measures. The profile says where its points lie.
pub trait Model: Send + Sync {
    /// The registers that can be read; those of them that no point names read as 0.
    fn readable(&self) -> &[RangeInclusive<u16>];

    /// The bits that function 07 answers.
    fn status(&self, now: Timestamp) -> u8;

    /// Measures everything at one instant.
    fn measure(&self, now: Timestamp) -> Box<dyn Measured + '_>;
}

/// All that a meter knows at one instant.
pub trait Measured {
    /// What the point of this name holds; `None` for a point the model knows nothing of.
    fn content(&self, point: &str) -> Option<Content>;
}

/// What a point holds, before it is laid into registers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Content {
    /// A raw integer, before scale: the point's type and byte order make registers of it.
    Number(i128),
    /// Registers as they are: text, dates, times.
    Words(Vec<u16>),
}

/// A meter on the simulated line.
pub struct Meter {
    unit: Unit,
    profile: Profile,
    model: Box<dyn Model>,
}

impl Meter {
    /// A meter that answers as `unit`, with the points and limits of `profile` and the values of
    /// `model`.
    pub fn new(unit: Unit, profile: Profile, model: Box<dyn Model>) -> Self {
        Self {
            unit,
            profile,
            model,
        }
    }

    /// A PQM with the built-in profile; its load comes from `seed`.
    ///
    /// # Panics
    /// Never: `pqm` is one of the built-in meters, and tests make this one.
    pub fn pqm(unit: Unit, seed: u64) -> Self {
        #[expect(clippy::expect_used, reason = "pqm.toml is built in")]
        let builtin = builtin::find("pqm").expect("pqm is a built-in meter");
        Self::new(unit, builtin.profile(), Box::new(Pqm::new(seed)))
    }

    /// The unit it answers as.
    pub const fn unit(&self) -> Unit {
        self.unit
    }

    /// Its points and limits.
    pub const fn profile(&self) -> &Profile {
        &self.profile
    }

    /// What it answers to the bytes it heard, at the time of day `now`. `None` is silence: the
    /// CRC is wrong, the frame is cut, or it is for another unit or for all of them.
    pub fn answer(&self, frame: &[u8], now: Timestamp) -> Option<Frame> {
        let (address, data_unit) = rtu::open(frame).ok()?;
        if address != self.unit.get() {
            return None;
        }
        // From 80h on it is the exception response of somebody with the same number.
        let function = FunctionCode::try_from(*data_unit.first()?).ok()?;
        let reply = match self.obey(function, data_unit, now) {
            Ok(response) => Reply::Normal(response),
            Err(Refusal::Exception(code)) => Reply::Exception { function, code },
            Err(Refusal::Silence) => return None,
        };
        Some(rtu::encode_reply(self.unit, &reply))
    }

    fn obey(
        &self,
        function: FunctionCode,
        data_unit: &[u8],
        now: Timestamp,
    ) -> Result<Response, Refusal> {
        let limits = &self.profile.limits;
        if !limits.functions.contains(&function) {
            return Err(ExceptionCode::ILLEGAL_FUNCTION.into());
        }
        // Counts and values come before addresses, as in the state diagrams of AP 6.
        match Request::decode(data_unit)? {
            Request::Read { function, range } if range.count() <= limits.read_registers => {
                self.read(function, range, now)
            }
            Request::ReadExceptionStatus => Ok(Response::ExceptionStatus(self.model.status(now))),
            Request::ReturnQueryData(0) => Ok(Response::QueryData(0)),
            Request::Write(Write::Registers(block)) if block.count() > limits.write_registers => {
                Err(ExceptionCode::ILLEGAL_DATA_VALUE.into())
            }
            // Nothing here can be written yet.
            Request::Write(_) => Err(ExceptionCode::ILLEGAL_DATA_ADDRESS.into()),
            Request::Read { .. } | Request::ReturnQueryData(_) => {
                Err(ExceptionCode::ILLEGAL_DATA_VALUE.into())
            }
        }
    }

    fn read(
        &self,
        function: ReadFunction,
        range: RegisterRange,
        now: Timestamp,
    ) -> Result<Response, Refusal> {
        let first = u32::from(range.start().get());
        let within = |area: &RangeInclusive<u16>| {
            u32::from(*area.start()) <= first && range.end() <= u32::from(*area.end()) + 1
        };
        if !self.model.readable().iter().any(within) {
            return Err(ExceptionCode::ILLEGAL_DATA_ADDRESS.into());
        }
        let measured = self.model.measure(now);
        let mut values = vec![0; usize::from(range.count())];
        for point in self.points(function, range) {
            let start = u32::from(point.range.start().get());
            for (address, word) in (start..).zip(registers(point, measured.as_ref())) {
                // Words of the point before or after the range have no place in it.
                if let Some(index) = address.checked_sub(first)
                    && let Some(value) = values.get_mut(index as usize)
                {
                    *value = word;
                }
            }
        }
        Ok(Response::Registers {
            function,
            // As many as the range, which is never too long for a read.
            values: ReadValues::new(values).map_err(DecodeError::from)?,
        })
    }

    /// The points that this function can read and that share registers with `range`.
    fn points(&self, function: ReadFunction, range: RegisterRange) -> impl Iterator<Item = &Point> {
        self.profile.points.iter().filter(move |point| {
            point.access.readable()
                && point.function.is_none_or(|only| only == function)
                && u32::from(point.range.start().get()) < range.end()
                && u32::from(range.start().get()) < point.range.end()
        })
    }
}

/// The registers of a point; none when the model has nothing that fits them.
fn registers(point: &Point, measured: &dyn Measured) -> Vec<u16> {
    match measured.content(&point.name) {
        Some(Content::Number(number)) => encode_integer(point.kind, point.order, number),
        Some(Content::Words(words)) => Some(words),
        None => None,
    }
    .unwrap_or_default()
}

/// Why there is no normal response.
enum Refusal {
    Silence,
    Exception(ExceptionCode),
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
