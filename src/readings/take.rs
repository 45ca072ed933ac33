//! Carries out a read plan.

use log::info;

use super::{Fault, Row};
use crate::client::{Client, Failure, Patience};
use crate::codec::{Response, Unit};
use crate::profile::plan::PlannedRead;
use crate::profile::{Plan, Point};

/// A read of the plan that brought nothing.
#[derive(Debug)]
pub struct Failed {
    /// The read.
    pub read: PlannedRead,
    /// Why.
    pub failure: Failure,
    /// How many further reads were not tried because the unit was silent or the port gone.
    pub untried: usize,
}

/// Reads `points` of one unit as `plan` says. A unit that has not answered at all is not asked
/// further: its other points would cost a time-out each.
pub fn take(
    client: &mut Client,
    unit: Unit,
    meter: &str,
    points: &[Point],
    plan: &Plan,
    patience: Patience,
) -> (Row, Vec<Failed>) {
    let mut row = Row {
        time: client.today(),
        meter: meter.to_owned(),
        unit,
        readings: vec![Err(Fault::Timeout); points.len()],
    };
    let mut failures = Vec::new();
    let mut answered = false;
    for (index, read) in plan.reads.iter().enumerate() {
        info!("unit {unit}: reading {}", read.range);
        match registers(client, unit, read, patience) {
            Ok(registers) => {
                answered = true;
                for point in &read.points {
                    row.readings[*point] = value(&points[*point], read, &registers);
                }
            }
            Err(failure) => {
                let fault = Fault::from(&failure);
                answered |= matches!(failure, Failure::Exception(_));
                let gives_up = fault == Fault::Port || (fault == Fault::Timeout && !answered);
                let rest = if gives_up {
                    &plan.reads[index + 1..]
                } else {
                    &[]
                };
                for point in read
                    .points
                    .iter()
                    .chain(rest.iter().flat_map(|read| &read.points))
                {
                    row.readings[*point] = Err(fault);
                }
                failures.push(Failed {
                    read: read.clone(),
                    failure,
                    untried: rest.len(),
                });
                if gives_up {
                    break;
                }
            }
        }
    }
    (row, failures)
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

/// The value of one point among the registers of a read that covers it.
fn value(
    point: &Point,
    read: &PlannedRead,
    registers: &[u16],
) -> Result<crate::profile::Value, Fault> {
    let offset = usize::from(point.range.start().get() - read.range.start().get());
    let registers = registers
        .get(offset..offset + usize::from(point.range.count()))
        .ok_or(Fault::Mismatch)?;
    Ok(point.interpret(registers)?)
}
