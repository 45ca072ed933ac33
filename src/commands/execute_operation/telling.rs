//! How a meter is told to do something: the request.

use std::time::Duration;

use jiff::Timestamp;

use crate::cli::OperationFunctionChoice;
use crate::codec::value::RegisterType;
use crate::codec::{FunctionCode, RegisterAddress, RegisterBlock, Write};
use crate::commands::CommandError;
use crate::commands::careful::Hazard;
use crate::commands::local_time::{Moment, NOW};
use crate::profile::assignment::Assignment;
use crate::profile::selector::alike;
use crate::profile::write_plan::WritePlanError;
use crate::profile::writing::{Action, Operation};
use crate::profile::{Point, Profile, Scales};

/// An operation and how the meter is told.
#[derive(Debug)]
pub(in crate::commands) struct Telling<'a> {
    pub(in crate::commands) operation: &'a Operation,
    profile: &'a Profile,
    value: Option<&'a str>,
    /// The function that carries it.
    pub(in crate::commands) function: FunctionCode,
}

impl<'a> Telling<'a> {
    /// The operation of this name or number, with what goes with it.
    ///
    /// # Errors
    /// [`CommandError`] for an operation that the meter does not have, and for a value or function
    /// that it does not take.
    pub(in crate::commands) fn new(
        profile: &'a Profile,
        name: &str,
        value: Option<&'a str>,
        function: Option<OperationFunctionChoice>,
    ) -> Result<Self, CommandError> {
        let operation = find(profile, name)?;
        let telling = Self {
            operation,
            profile,
            value,
            function: carrier(profile, operation, value, function)?,
        };
        // So that a value is refused before anything is opened.
        telling.write(Timestamp::UNIX_EPOCH)?;
        Ok(telling)
    }

    /// What nobody wants to do by accident.
    pub(in crate::commands) fn hazard(&self) -> Option<Hazard> {
        let what = self.operation.hazard.clone()?;
        let name = self.operation.name.clone();
        Some(Hazard { name, what })
    }

    /// The request, as it is right at `now`.
    ///
    /// # Errors
    /// [`CommandError::Assign`] for a value that does not go with it.
    pub(in crate::commands) fn write(&self, now: Timestamp) -> Result<Write, CommandError> {
        let (number, data) = match &self.operation.action {
            Action::Register { address, value } => {
                return Ok(match self.function {
                    FunctionCode::WriteSingleRegister => Write::Register {
                        address: *address,
                        value: *value,
                    },
                    _ => block(*address, vec![*value])?,
                });
            }
            Action::Number { number, data } => (*number, data.as_deref()),
        };
        let (Some(registers), FunctionCode::WriteMultipleRegisters) =
            (self.profile.command_registers, self.function)
        else {
            return Ok(Write::Coil {
                address: RegisterAddress(number),
                on: true,
            });
        };
        let mut words = vec![registers.code, number];
        if let (Some(data), Some(value)) = (data, self.value) {
            words.extend(encoded(data, value, now)?);
        }
        block(registers.address, words)
    }
}

fn block(address: RegisterAddress, words: Vec<u16>) -> Result<Write, CommandError> {
    let block = RegisterBlock::new(address.get(), words);
    Ok(Write::Registers(block.map_err(WritePlanError::Address)?))
}

/// The registers of what goes with an operation; a clock can be set to the present.
fn encoded(data: &Point, value: &str, now: Timestamp) -> Result<Vec<u16>, CommandError> {
    let present = || Moment::now().map(|moment| moment.civil(now, Duration::ZERO));
    let value = match data.kind {
        RegisterType::Time if value == NOW => format!("{:.3}", present()?.time()),
        RegisterType::Date if value == NOW => present()?.date().to_string(),
        _ => value.to_owned(),
    };
    let assignment = Assignment::new(data.clone(), value);
    Ok(assignment.change(&Scales::default())?.registers)
}

/// The operation of this name, or of this number where the meter has numbers.
fn find<'a>(profile: &'a Profile, name: &str) -> Result<&'a Operation, CommandError> {
    let number = number(name);
    let is_it = |operation: &&Operation| match operation.action {
        Action::Number { number: own, .. } if number.is_some() => number == Some(own),
        _ => operation.name == name,
    };
    if profile.operations.is_empty() {
        return Err(CommandError::NoOperations {
            meter: profile.name.clone(),
        });
    }
    let names = profile.operations.iter();
    let names = names.map(|operation| operation.name.as_str());
    let found = profile.operations.iter().find(is_it);
    found.ok_or_else(|| CommandError::NoOperation {
        meter: profile.name.clone(),
        name: name.to_owned(),
        near: alike(name, names),
    })
}

/// `14`, `0x0E`.
fn number(text: &str) -> Option<u16> {
    let hex = text.strip_prefix("0x").or_else(|| text.strip_prefix("0X"));
    let (digits, radix) = hex.map_or((text, 10), |hex| (hex, 16));
    let number = u16::from_str_radix(digits, radix).ok();
    // The conversion would take a sign.
    number.filter(|_| !digits.starts_with('+'))
}

/// The function that carries an operation.
fn carrier(
    profile: &Profile,
    operation: &Operation,
    value: Option<&str>,
    typed: Option<OperationFunctionChoice>,
) -> Result<FunctionCode, CommandError> {
    let name = || operation.name.clone();
    let data = match &operation.action {
        Action::Number { data, .. } => data.as_deref(),
        Action::Register { .. } => None,
    };
    match (data, value) {
        (None, Some(_)) => return Err(CommandError::TakesNothing { name: name() }),
        (Some(data), None) => {
            return Err(CommandError::Lacks {
                name: name(),
                what: data.about.clone(),
                form: data.expected(),
            });
        }
        _ => {}
    }
    let has = |function| profile.limits.functions.contains(&function);
    if matches!(operation.action, Action::Register { .. }) {
        return match typed {
            Some(_) => Err(CommandError::NoEffect {
                option: "--function",
                what: "operations that have a number",
            }),
            None if has(FunctionCode::WriteSingleRegister) => Ok(FunctionCode::WriteSingleRegister),
            None => Ok(FunctionCode::WriteMultipleRegisters),
        };
    }
    let function = match (typed, data) {
        (Some(OperationFunctionChoice::SingleCoil), Some(_)) => {
            return Err(CommandError::CarriesNothing { name: name() });
        }
        (Some(OperationFunctionChoice::SingleCoil), None) => FunctionCode::WriteSingleCoil,
        (Some(OperationFunctionChoice::MultipleRegisters), _) | (None, Some(_)) => {
            FunctionCode::WriteMultipleRegisters
        }
        (None, None) if has(FunctionCode::WriteSingleCoil) => FunctionCode::WriteSingleCoil,
        (None, None) => FunctionCode::WriteMultipleRegisters,
    };
    let is_there = match function {
        FunctionCode::WriteMultipleRegisters => profile.command_registers.is_some(),
        _ => true,
    };
    if is_there && has(function) {
        return Ok(function);
    }
    Err(CommandError::Carrier {
        meter: profile.name.clone(),
        code: function.get(),
    })
}
