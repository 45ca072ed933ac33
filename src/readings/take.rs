//! Carries out a read plan.

use log::info;

use super::{Fault, Row};
use crate::client::{Client, Failure, Patience};
use crate::codec::{Response, Unit};
use crate::profile::plan::PlannedRead;
use crate::profile::{Missing, Plan, Point, Scales, Value};

/// A unit that leaves this many reads in a row unanswered is not asked further.
const MOST_SILENT_READS: usize = 2;

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

/// Reads `points` of one unit as `plan` says; the plan is one made for these very points. A unit
/// that does not answer at all, or stops answering, is not asked further: every other read would
/// cost a time-out as well.
pub fn take(
    client: &mut Client,
    unit: Unit,
    meter: &str,
    points: &[Point],
    plan: &Plan,
    patience: Patience,
) -> (Row, Vec<Trouble>) {
    let mut row = Row::missing(client.utc_now(), meter, unit, points.len(), Fault::Timeout);
    let mut troubles = Vec::new();
    let mut answered = false;
    let mut silent = 0;
    for (index, read) in plan.reads.iter().enumerate() {
        info!("unit {unit}: reading {}", read.range);
        let failure = match registers(client, unit, read, patience) {
            Ok(registers) => {
                answered = true;
                silent = 0;
                fill(&mut row, points, read, &registers, &mut troubles);
                continue;
            }
            Err(failure) => failure,
        };
        let fault = Fault::from(&failure);
        answered |= matches!(failure, Failure::Exception(_));
        silent = if fault == Fault::Timeout {
            silent + 1
        } else {
            0
        };
        let gives_up = match fault {
            Fault::Port => true,
            Fault::Timeout => !answered || silent == MOST_SILENT_READS,
            _ => false,
        };
        let (_, rest) = plan.reads.split_at(index + 1);
        let untried = if gives_up { rest } else { &[] };
        for point in untried.iter().chain([read]).flat_map(|read| &read.points) {
            row.readings[*point] = Err(fault);
        }
        troubles.push(Trouble::Unread {
            read: read.clone(),
            failure,
            untried: untried.len(),
        });
        if gives_up {
            break;
        }
    }
    (row, troubles)
}

fn registers(
    client: &mut Client,
    unit: Unit,
    read: &PlannedRead,
    patience: Patience,
) -> Result<Vec<u16>, Failure> {
    match client.request(unit, &read.request(), patience)? {
        Response::Registers { values, .. } => Ok(values.into_vec()),
        // The client believes only what answers the request, and a read is answered by registers.
        other => Err(Failure::Mismatch {
            found: format!("{other:?}"),
        }),
    }
}

/// Puts the values of one read into the row.
fn fill(
    row: &mut Row,
    points: &[Point],
    read: &PlannedRead,
    registers: &[u16],
    troubles: &mut Vec<Trouble>,
) {
    for index in &read.points {
        let point = &points[*index];
        let value = value(point, read, registers);
        if value == Err(Missing::Mismatch) {
            troubles.push(Trouble::Impossible {
                point: point.name.clone(),
                kind: point.kind.to_string(),
                registers: own(point, read, registers).unwrap_or_default().to_vec(),
            });
        }
        row.readings[*index] = value.map_err(Fault::from);
    }
}

/// The value of one point among the registers of a read that covers it.
fn value(point: &Point, read: &PlannedRead, registers: &[u16]) -> Result<Value, Missing> {
    let registers = own(point, read, registers).ok_or(Missing::Mismatch)?;
    point.interpret(registers, Scales::none())
}

/// The registers of one point among those of a read that covers it.
fn own<'a>(point: &Point, read: &PlannedRead, registers: &'a [u16]) -> Option<&'a [u16]> {
    let offset = point
        .range
        .start()
        .get()
        .checked_sub(read.range.start().get())?;
    let offset = usize::from(offset);
    registers.get(offset..offset + usize::from(point.range.count()))
}
