//! What a person types to write: `NAME=VALUE`, `0x1028=500`.

use rust_decimal::Decimal;
use rust_decimal::prelude::ToPrimitive;
use thiserror::Error;

use super::encoding::EncodeError;
use super::model::Profile;
use super::point::{Access, Point};
use super::selector::{Purpose, Reading, SelectError, one};
use super::setup::Scales;
use super::write_plan::Change;
use super::writing::{Distinct, NotTaken, Writing};
use crate::codec::ReadFunction;

/// A point and the value it is to hold.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Assignment {
    /// The point, or registers by address as one.
    pub point: Point,
    /// The value as it was typed.
    pub value: String,
    /// The point of the meter that lies in registers that were named by their address.
    known: Option<Box<Point>>,
}

/// Why what was typed is nothing that can be written.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum AssignError {
    /// Nothing was typed.
    #[error("nothing to write: name points and values, NAME=VALUE")]
    Nothing,
    /// No value.
    #[error("'{typed}' is no NAME=VALUE")]
    NoValue {
        /// What was typed.
        typed: String,
    },
    /// No point.
    #[error(transparent)]
    Select(#[from] SelectError),
    /// Several points, or registers of which each has a value of its own.
    #[error("'{selector}' is more than one point, and each has a value of its own")]
    Several {
        /// What was typed before the `=`.
        selector: String,
    },
    /// Registers by address that are not those of one point.
    #[error("'{selector}': in these registers lie {points}, not as a whole or not alone")]
    NotOne {
        /// What was typed before the `=`.
        selector: String,
        /// The points.
        points: String,
    },
    /// Two values for the same registers.
    #[error("{}", twice(.first, .second))]
    Twice {
        /// The point that comes first.
        first: String,
        /// The other one; it may be the same.
        second: String,
    },
    /// Not a value of the point.
    #[error("{name}: {problem}")]
    Value {
        /// The point.
        name: String,
        /// What is wrong.
        problem: Box<EncodeError>,
    },
    /// Not a value that the meter takes.
    #[error("{name}: {problem}")]
    NotTaken {
        /// The point.
        name: String,
        /// What it takes.
        problem: Box<NotTaken>,
    },
    /// Two points that may not hold the same get the same value.
    #[error("{first} and {second} would hold the same: {about}")]
    Alike {
        /// One of them.
        first: String,
        /// The other one.
        second: String,
        /// Why they may not.
        about: String,
    },
}

fn twice(first: &str, second: &str) -> String {
    if first == second {
        format!("{first} is given two values")
    } else {
        format!("{first} and {second} are values for the same registers")
    }
}

/// What was typed, checked as far as that can be done without a meter.
///
/// # Errors
/// [`AssignError`] for the first thing that is wrong.
pub fn assignments(typed: &[String], reading: Reading<'_>) -> Result<Vec<Assignment>, AssignError> {
    if typed.is_empty() {
        return Err(AssignError::Nothing);
    }
    typed
        .iter()
        .map(|typed| assignment(typed, reading))
        .collect()
}

/// Whether each register is given one value.
///
/// # Errors
/// [`AssignError::Twice`] names two points that share one.
pub fn apart(assignments: &[Assignment]) -> Result<(), AssignError> {
    let mut rest = assignments;
    while let [first, others @ ..] = rest {
        let range = first.point.range;
        if let Some(other) = others
            .iter()
            .find(|other| other.point.range.overlaps(range))
        {
            return Err(AssignError::Twice {
                first: first.point.name.clone(),
                second: other.point.name.clone(),
            });
        }
        rest = others;
    }
    Ok(())
}

fn assignment(typed: &str, reading: Reading<'_>) -> Result<Assignment, AssignError> {
    // Values of text may hold the mark themselves.
    let Some((selector, value)) = typed.split_once('=') else {
        return Err(AssignError::NoValue {
            typed: typed.to_owned(),
        });
    };
    let reading = Reading {
        purpose: Purpose::Write,
        ..reading
    };
    let points = one(selector, reading)?;
    let several = || AssignError::Several {
        selector: selector.to_owned(),
    };
    let [point] = <[Point; 1]>::try_from(points).map_err(|_| several())?;
    let is_raw = selector.starts_with(|first: char| first.is_ascii_digit());
    // Which one it is, is not for a group to say; registers by address have a factor behind a `*`.
    if !is_raw && (selector.starts_with('@') || selector.contains(['*', '?'])) {
        return Err(several());
    }
    if point.function == Some(ReadFunction::InputRegisters) {
        let name = selector.to_owned();
        return Err(SelectError::ReadOnly { name }.into());
    }
    let known = match reading.profile {
        Some(profile) if is_raw => known(selector, &point, profile)?,
        _ => None,
    };
    let point = if is_raw {
        Point {
            access: known
                .as_ref()
                .map_or(Access::ReadWrite, |known| known.access),
            writing: known.as_ref().and_then(|known| known.writing.clone()),
            ..point
        }
    } else {
        point
    };
    Ok(Assignment {
        point,
        value: value.to_owned(),
        known: known.map(Box::new),
    })
}

/// Whether two points that may not hold the same get the same value.
///
/// # Errors
/// [`AssignError::Alike`] names two.
pub fn alike(changes: &[Change], rules: &[Distinct]) -> Result<(), AssignError> {
    for rule in rules {
        let mut given: Vec<(&str, u16)> = Vec::new();
        let under_it = changes
            .iter()
            .filter(|change| rule.points.contains(&change.name));
        for change in under_it {
            let [register] = change.registers.as_slice() else {
                continue;
            };
            if rule.except.contains(register) {
                continue;
            }
            if let Some((first, _)) = given.iter().find(|(_, other)| other == register) {
                return Err(AssignError::Alike {
                    first: (*first).to_owned(),
                    second: change.point.name.clone(),
                    about: rule.about.clone(),
                });
            }
            given.push((&change.point.name, *register));
        }
    }
    Ok(())
}

/// The point of the meter that registers by address are.
fn known(selector: &str, raw: &Point, profile: &Profile) -> Result<Option<Point>, AssignError> {
    // A point that is read alone lies where another one does.
    let there = |point: &&Point| {
        point.range.overlaps(raw.range) && (!point.alone || point.range == raw.range)
    };
    let there: Vec<&Point> = profile.points.iter().filter(there).collect();
    match there.as_slice() {
        [] => Ok(None),
        [point] if point.range == raw.range => {
            if point.access.writable() {
                return Ok(Some((*point).clone()));
            }
            let name = point.name.clone();
            Err(SelectError::ReadOnly { name }.into())
        }
        several => {
            let names: Vec<&str> = several.iter().map(|point| point.name.as_str()).collect();
            Err(AssignError::NotOne {
                selector: selector.to_owned(),
                points: names.join(", "),
            })
        }
    }
}

impl Assignment {
    /// A value for a point of a meter.
    pub const fn new(point: Point, value: String) -> Self {
        Self {
            point,
            value,
            known: None,
        }
    }

    /// The name of the meter's point: registers by address may be one.
    pub fn known_as(&self) -> &str {
        &self.known.as_deref().unwrap_or(&self.point).name
    }

    /// What is to be known before it is written.
    pub fn writing(&self) -> &Writing {
        self.point.writing()
    }

    /// The point with the registers that hold the value, on a meter that is set up like this.
    ///
    /// # Errors
    /// [`AssignError::Value`] and [`AssignError::NotTaken`].
    pub fn change(&self, scales: &Scales) -> Result<Change, AssignError> {
        let name = || self.point.name.clone();
        let rules = self.known.as_deref().unwrap_or(&self.point);
        let registers = self.point.encode(&self.value, scales);
        let registers = registers.map_err(|problem| match rather(rules, &problem) {
            Some(problem) => AssignError::NotTaken {
                name: name(),
                problem: Box::new(problem),
            },
            None => AssignError::Value {
                name: name(),
                problem: Box::new(problem),
            },
        })?;
        match rules.takes(&registers) {
            Ok(()) => Ok(Change {
                point: self.point.clone(),
                name: self.known_as().to_owned(),
                registers,
            }),
            Err(problem) => Err(AssignError::NotTaken {
                name: name(),
                problem: Box::new(problem),
            }),
        }
    }
}

/// What the meter does not take about a figure that the registers cannot hold: the nearest that they
/// can are of no use where it does not take those either. `None` where it does.
fn rather(point: &Point, problem: &EncodeError) -> Option<NotTaken> {
    let scale = point.constant_scale()?;
    let raw = |figure: Decimal| figure.checked_div(scale)?.to_i128();
    let (found, near) = match problem {
        EncodeError::BetweenSteps {
            found,
            below,
            above,
        } => (*found, vec![raw(*below)?, raw(*above)?]),
        EncodeError::OutOfRange { found, lowest, .. } => {
            (Decimal::from_str_exact(found).ok()?, vec![raw(*lowest)?])
        }
        _ => return None,
    };
    let is_beyond = matches!(problem, EncodeError::OutOfRange { .. });
    if let Some((lowest, highest)) = point.limits
        && (is_beyond || near.iter().any(|raw| !(lowest..=highest).contains(raw)))
    {
        let [lowest, highest] = [lowest, highest].map(|raw| point.figure(raw));
        let also = point.all_shown(point.writing().also.iter());
        return Some(NotTaken::Range {
            found,
            lowest,
            highest,
            also,
        });
    }
    let problem = near
        .into_iter()
        .find_map(|raw| point.takes_raw(raw).err())?;
    Some(match problem {
        NotTaken::Step {
            step, below, above, ..
        } => NotTaken::Step {
            found,
            step,
            below,
            above,
        },
        NotTaken::Allowed { allowed, .. } => NotTaken::Allowed { found, allowed },
        problem => problem,
    })
}
