//! Which requests write a set of points: as few as the meter takes, in the order given.

use thiserror::Error;

use super::model::{Limits, Profile};
use super::point::Point;
use super::writing::WriteFunction;
use crate::codec::{AddressError, FunctionCode, RegisterAddress, RegisterBlock, Write};

/// A point and the registers it is to hold.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Change {
    /// The point.
    pub point: Point,
    /// The name of the meter's own point there; that of registers by address is their address.
    pub name: String,
    /// Its registers, in address order.
    pub registers: Vec<u16>,
}

/// One request.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PlannedWrite {
    /// The request.
    pub write: Write,
    /// The changes it makes, or is a part of, as indices.
    pub changes: Vec<usize>,
}

/// What may be asked of a meter when it is written to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WriteRules {
    /// The meter, as messages name it.
    meter: String,
    takes_single: bool,
    takes_multiple: bool,
    most: u16,
    table: Option<u16>,
    /// What was asked for, whatever else would do.
    insisted: Option<WriteFunction>,
    /// Neighbours go in one request where that can be.
    apart: bool,
}

/// Why points cannot be written like that.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum WritePlanError {
    /// The meter does not have the function.
    #[error("{meter} does not have {}{}", FunctionCode::from(*.function), .name.as_ref().map(|name| format!(" for {name}")).unwrap_or_default())]
    Function {
        /// The meter.
        meter: String,
        /// The function.
        function: WriteFunction,
        /// The point that needs it.
        name: Option<String>,
    },
    /// The meter writes nothing at all.
    #[error("{meter} has no function that writes registers")]
    NoFunction {
        /// The meter.
        meter: String,
    },
    /// The point takes another function alone.
    #[error("{name} is written with {} alone", FunctionCode::from(*.function))]
    OtherFunction {
        /// The point.
        name: String,
        /// The function it takes.
        function: WriteFunction,
    },
    /// More registers than one request carries.
    #[error("{found} registers at once from {first} on, and {meter} takes {most}")]
    TooMany {
        /// The meter.
        meter: String,
        /// The point that comes first.
        first: String,
        /// How many registers.
        found: usize,
        /// How many it takes.
        most: u16,
    },
    /// Registers that cannot be.
    #[error(transparent)]
    Address(#[from] AddressError),
}

impl WriteRules {
    /// What a meter takes; both functions where nothing is known of it.
    pub fn new(profile: Option<&Profile>) -> Self {
        let has =
            |function| profile.is_none_or(|profile| profile.limits.functions.contains(&function));
        let limits = profile.map(|profile| &profile.limits);
        Self {
            meter: profile
                .map_or("the standard", |profile| &profile.name)
                .to_owned(),
            takes_single: has(FunctionCode::WriteSingleRegister),
            takes_multiple: has(FunctionCode::WriteMultipleRegisters),
            most: limits.map_or(RegisterBlock::MOST, |limits| limits.write_registers),
            table: limits.and_then(|limits| limits.table_registers),
            insisted: None,
            apart: false,
        }
    }

    /// The same for a broadcast, which only some functions may be.
    #[must_use]
    pub fn broadcasting(self, limits: Option<&Limits>) -> Self {
        let may =
            |function| limits.is_none_or(|limits| limits.broadcast_functions.contains(&function));
        Self {
            takes_single: self.takes_single && may(FunctionCode::WriteSingleRegister),
            takes_multiple: self.takes_multiple && may(FunctionCode::WriteMultipleRegisters),
            ..self
        }
    }

    /// The same with this function and no other.
    #[must_use]
    pub fn insisting(self, function: Option<WriteFunction>) -> Self {
        Self {
            insisted: function,
            ..self
        }
    }

    /// The same with a request of its own for each point.
    #[must_use]
    pub fn apart(self, apart: bool) -> Self {
        Self { apart, ..self }
    }

    fn takes(&self, function: WriteFunction) -> bool {
        match function {
            WriteFunction::SingleRegister => self.takes_single,
            WriteFunction::MultipleRegisters => self.takes_multiple,
        }
    }

    /// The function for a point.
    fn function(&self, point: &Point) -> Result<Option<WriteFunction>, WritePlanError> {
        let own = point.writing().function;
        let function = match (self.insisted, own) {
            (Some(insisted), Some(own)) if insisted != own => {
                return Err(WritePlanError::OtherFunction {
                    name: point.name.clone(),
                    function: own,
                });
            }
            (insisted, own) => insisted.or(own),
        };
        let Some(function) = function else {
            return Ok(None);
        };
        if self.takes(function) {
            return Ok(Some(function));
        }
        Err(WritePlanError::Function {
            meter: self.meter.clone(),
            function,
            name: own.map(|_| point.name.clone()),
        })
    }
}

/// The requests that make these changes: neighbours that follow each other go in one, with
/// function 16; a register by itself goes with 06. Where the meter has no function 16, every register
/// goes by itself, and a point of several is not written at once.
///
/// # Errors
/// [`WritePlanError`] tells what the meter does not take.
pub fn plan(changes: &[Change], rules: &WriteRules) -> Result<Vec<PlannedWrite>, WritePlanError> {
    if !rules.takes_single && !rules.takes_multiple {
        return Err(WritePlanError::NoFunction {
            meter: rules.meter.clone(),
        });
    }
    let mut planned = Vec::new();
    let mut run: Vec<usize> = Vec::new();
    for (index, change) in changes.iter().enumerate() {
        let follows = run
            .last()
            .and_then(|last| changes.get(*last))
            .is_some_and(|before| rules.joins(&before.point, &change.point));
        if !follows && !run.is_empty() {
            finish(&run, changes, rules, &mut planned)?;
            run.clear();
        }
        run.push(index);
    }
    finish(&run, changes, rules, &mut planned)?;
    Ok(planned)
}

impl WriteRules {
    /// Whether two points can go in one request, one behind the other.
    fn joins(&self, before: &Point, after: &Point) -> bool {
        let may = |function: Option<WriteFunction>| {
            function.is_none_or(|function| function == WriteFunction::MultipleRegisters)
        };
        let table = |address: u32| address.checked_div(u32::from(self.table?));
        let (start, end) = (u32::from(after.range.start().get()), before.range.end());
        !self.apart
            && self.takes_multiple
            && may(self.insisted)
            && may(before.writing().function)
            && may(after.writing().function)
            && end == start
            && table(end - 1) == table(start)
    }
}

fn finish(
    run: &[usize],
    changes: &[Change],
    rules: &WriteRules,
    planned: &mut Vec<PlannedWrite>,
) -> Result<(), WritePlanError> {
    let members = || run.iter().filter_map(|index| changes.get(*index));
    let Some(first) = members().next() else {
        return Ok(());
    };
    let registers: Vec<u16> = members()
        .flat_map(|change| change.registers.iter().copied())
        .collect();
    let start = first.point.range.start();
    let mut wanted = None;
    for change in members() {
        wanted = wanted.or(rules.function(&change.point)?);
    }
    let function = wanted.unwrap_or(if registers.len() == 1 && rules.takes_single {
        WriteFunction::SingleRegister
    } else if rules.takes_multiple {
        WriteFunction::MultipleRegisters
    } else {
        WriteFunction::SingleRegister
    });
    match function {
        WriteFunction::SingleRegister => {
            let addresses = start.get()..=u16::MAX;
            planned.extend(
                addresses
                    .zip(registers)
                    .map(|(address, value)| PlannedWrite {
                        write: Write::Register {
                            address: RegisterAddress(address),
                            value,
                        },
                        changes: run.to_vec(),
                    }),
            );
        }
        WriteFunction::MultipleRegisters => {
            if registers.len() > usize::from(rules.most) {
                return Err(WritePlanError::TooMany {
                    meter: rules.meter.clone(),
                    first: first.point.name.clone(),
                    found: registers.len(),
                    most: rules.most,
                });
            }
            planned.push(PlannedWrite {
                write: Write::Registers(RegisterBlock::new(start.get(), registers)?),
                changes: run.to_vec(),
            });
        }
    }
    Ok(())
}

/// The changes that more than one request makes, so that they are not made at once.
pub fn in_pieces(planned: &[PlannedWrite], changes: usize) -> Vec<usize> {
    let requests = |index: &usize| {
        let of = planned.iter().filter(|write| write.changes.contains(index));
        of.count()
    };
    (0..changes).filter(|index| requests(index) > 1).collect()
}
