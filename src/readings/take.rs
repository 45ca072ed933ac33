//! Reads a unit: fetches the registers of all points, then says what they mean.

use super::gather::gather;
use super::{Fault, Memory, Row};
use crate::client::{Client, Failure, Patience};
use crate::codec::{ExceptionCode, ReadFunction, Unit};
use crate::profile::plan::{Cost, PlannedRead};
use crate::profile::{Missing, Point, Scales, Value};

/// What is asked of a unit.
#[derive(Debug, Clone, Copy)]
pub struct Inquiry<'a> {
    /// The unit.
    pub unit: Unit,
    /// The meter's name; empty for raw registers of an unknown one.
    pub meter: &'a str,
    /// What is read.
    pub points: &'a [Point],
    /// The function for points that have none of their own.
    pub function: ReadFunction,
    /// What reads cost on this line while the meter's answer time has not been measured.
    pub cost: Cost,
    /// How patient to be.
    pub patience: Patience,
}

/// Something that went wrong while points were read.
#[derive(Debug)]
pub enum Trouble {
    /// A read brought nothing.
    Unread {
        /// The read.
        read: PlannedRead,
        /// Why.
        failure: Failure,
        /// How many further reads were not tried because the unit was silent or the port gone.
        untried: usize,
    },
    /// The meter refused points, each of them when it was asked for by itself, or all of them for
    /// another reason than their registers.
    Refused {
        /// Which, as indices into those that were asked for.
        points: Vec<usize>,
        /// What it said.
        code: ExceptionCode,
    },
    /// Registers arrived and hold what the point's type cannot.
    Impossible {
        /// The point's name.
        point: String,
        /// Its type.
        kind: String,
        /// The registers.
        registers: Vec<u16>,
    },
}

/// Reads the points of one unit, in as few requests as it is known to allow. A unit that does not
/// answer at all, or stops answering, is not asked further: every other read would cost a time-out
/// as well.
pub fn take(
    client: &mut Client,
    inquiry: &Inquiry<'_>,
    memory: &mut Memory,
) -> (Row, Vec<Trouble>) {
    let time = client.utc_now();
    let (registers, mut troubles) = gather(client, inquiry, memory);
    let row = Row {
        time,
        meter: inquiry.meter.to_owned(),
        unit: inquiry.unit,
        readings: interpret(inquiry.points, &registers, &mut troubles),
    };
    (row, troubles)
}

/// What the registers of points mean, each in its place.
fn interpret(
    points: &[Point],
    registers: &[Result<Vec<u16>, Fault>],
    troubles: &mut Vec<Trouble>,
) -> Vec<Result<Value, Fault>> {
    let mut value = |(point, registers): (&Point, &Result<Vec<u16>, Fault>)| {
        let registers = registers.as_deref().map_err(|fault| *fault)?;
        point.interpret(registers, Scales::none()).map_err(|missing| {
            if missing == Missing::Mismatch {
                troubles.push(Trouble::Impossible {
                    point: point.name.clone(),
                    kind: point.kind.to_string(),
                    registers: registers.to_vec(),
                });
            }
            Fault::from(missing)
        })
    };
    points.iter().zip(registers).map(&mut value).collect()
}
