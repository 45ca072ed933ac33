//! Readings: points of a meter read once, each with a value or the reason why there is none.
//!
//! [`take`](take::take) reads a unit through a client; what it returns is what the outputs print.
//!
//! * `gather` fetches the registers of all points: it plans the reads and copes with a meter that
//!   does not give them as planned; `harvest` is what it has so far.
//! * [`memory`] keeps what that taught, for as long as the program runs; `lesson` is one such thing.
//! * [`take`](mod@take) reads a unit with all that belongs to it; `meaning` says what its registers
//!   mean.
//! * [`echo`] finds out whether the line sends our own bytes back.
//! * [`loopback`] sends words to a unit and tells whether the line is good.
//! * [`verify`] puts readings to the test of physical laws.

pub mod echo;
pub mod fault;
mod gather;
mod harvest;
mod lesson;
pub mod loopback;
mod meaning;
pub mod memory;
pub mod take;
pub mod verify;

use jiff::Timestamp;

use crate::codec::Unit;
use crate::profile::Value;

pub use fault::Fault;
pub use memory::Memory;
pub use take::{Inquiry, Taken, Trouble, take};

/// One meter read once.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// When reading it began.
    pub time: Timestamp,
    /// The meter's name; empty for raw registers of an unknown one.
    pub meter: String,
    /// Its unit.
    pub unit: Unit,
    /// A value or a fault for each point asked for, in their order.
    pub readings: Vec<Result<Value, Fault>>,
}

impl Row {
    /// A row of `points` readings that are all missing for one reason.
    pub fn missing(time: Timestamp, meter: &str, unit: Unit, points: usize, fault: Fault) -> Self {
        Self {
            time,
            meter: meter.to_owned(),
            unit,
            readings: vec![Err(fault); points],
        }
    }

    /// The worst fault of the row; `None` when every value is there.
    pub fn worst(&self) -> Option<Fault> {
        self.faults().max()
    }

    /// Every fault of the row.
    pub fn faults(&self) -> impl Iterator<Item = Fault> {
        self.readings
            .iter()
            .filter_map(|reading| reading.as_ref().err().copied())
    }
}
