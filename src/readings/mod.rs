//! Readings: points of a meter read once, each with a value or the reason why there is none.
//!
//! [`take`](take::take) carries out a read plan through a client; what it returns is what the
//! outputs print.

pub mod fault;
pub mod take;
pub mod verify;

use jiff::Timestamp;

use crate::codec::Unit;
use crate::profile::Value;

pub use fault::Fault;
pub use take::{Trouble, take};

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
