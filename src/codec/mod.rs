//! Modbus as bytes: pure functions between frames and typed values.
//!
//! Nothing here reads a clock, a port or a log, and nothing here imports the rest of the crate.
//!
//! * [`address`]: units, broadcast, register addresses and ranges, each with its limits.
//! * [`function`] and [`exception`]: the codes of the standard, open to unknown values.
//! * [`registers`]: the registers that one message carries.
//! * [`request`] and [`reply`]: protocol data units in both directions.
//! * [`length`]: how long each frame is, per function and direction.
//! * [`rtu`]: unit and CRC around a data unit.
//! * [`mbap`]: the header of Modbus TCP before a data unit.
//! * [`value`]: registers as numbers, text, dates and times.
//!
//! Sources: "Modbus Application Protocol Specification V1.1b3" (AP below) and "Modbus over Serial
//! Line V1.02" (SL below).

pub mod address;
mod cursor;
mod error;
pub mod exception;
pub mod function;
pub mod length;
pub mod mbap;
pub mod registers;
pub mod reply;
pub mod request;
pub mod rtu;
pub mod value;

pub use address::{Broadcast, RegisterAddress, RegisterRange, Unit, UnitRange};
pub use error::{AddressError, DecodeError};
pub use exception::ExceptionCode;
pub use function::{FunctionCode, OtherFunction, ReadFunction};
pub use registers::{ReadValues, RegisterBlock, WrittenRange};
pub use reply::{Reply, Response};
pub use request::{Request, Write};
pub use rtu::{Destination, Frame};
