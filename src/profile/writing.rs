//! What may be written to a meter, and what that does.

use jiff::civil::Time;
use rust_decimal::Decimal;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::point::{OnlyWith, Point};
use super::scaling::times;
use crate::codec::value::Raw;
use crate::codec::{FunctionCode, RegisterAddress};

/// What is to be known before a point is written.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Writing {
    /// What writing it does that nobody wants by accident, in a few words.
    pub hazard: Option<String>,
    /// It does something when it is written, and does not keep what was written.
    pub momentary: bool,
    /// It changes how the meter is reached.
    pub moves: Option<Moves>,
    /// The raw number is a multiple of this; 0 or 1 says nothing.
    pub step: u16,
    /// The only raw numbers it takes, where these are no range.
    pub allowed: Vec<i64>,
    /// Raw numbers that it takes besides those within [`Point::limits`].
    pub also: Vec<i64>,
    /// The one function it can be written with.
    pub function: Option<WriteFunction>,
    /// Whether it is written on all meters at once.
    pub broadcast: Broadcasting,
    /// It can be written only while another point holds one of these.
    pub only_with: Option<OnlyWith>,
    /// The point that shows what was written, where this one cannot be read.
    pub shown_by: Option<String>,
}

/// Nothing is to be known.
static PLAIN: Writing = Writing {
    hazard: None,
    momentary: false,
    moves: None,
    step: 0,
    allowed: Vec::new(),
    also: Vec::new(),
    function: None,
    broadcast: Broadcasting::Unmarked,
    only_with: None,
    shown_by: None,
};

/// The functions that write registers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum WriteFunction {
    /// 6 (06h) Write Single Register.
    SingleRegister,
    /// 16 (10h) Write Multiple Registers.
    MultipleRegisters,
}

impl From<WriteFunction> for FunctionCode {
    fn from(function: WriteFunction) -> Self {
        match function {
            WriteFunction::SingleRegister => Self::WriteSingleRegister,
            WriteFunction::MultipleRegisters => Self::WriteMultipleRegisters,
        }
    }
}

/// What of it changes when a point changes how the meter is reached.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Moves {
    /// Its address, of which no two on a line may be alike.
    Address,
    /// The setting of its port.
    Port,
}

/// What a profile says of broadcasting a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Broadcasting {
    /// Nothing.
    #[default]
    Unmarked,
    /// The manual says that it can be.
    Allowed,
    /// It can be written in no other way.
    Only,
}

/// Something a meter does when it is told to.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Operation {
    /// Its name: lower case, digits and `_`.
    pub name: String,
    /// What it does, in a few words.
    pub about: String,
    /// How the meter is told.
    pub action: Action,
    /// What it does that nobody wants by accident.
    pub hazard: Option<String>,
    /// Whether the manual says that it can be told to all meters at once.
    pub broadcast: Broadcasting,
    /// It is carried out only while a point holds one of these.
    pub only_with: Option<OnlyWith>,
    /// What was read of it in the maker's manual, not worked out or taken from a driver.
    pub verified: bool,
    /// Page of the manual.
    pub page: String,
}

impl Operation {
    /// What goes with it, as a point.
    pub fn data(&self) -> Option<&Point> {
        match &self.action {
            Action::Number { data, .. } => data.as_deref(),
            Action::Register { .. } => None,
        }
    }
}

/// How a meter is told to do something.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub enum Action {
    /// By its number: with function 05, or in the command registers with function 16.
    Number {
        /// The number.
        number: u16,
        /// What goes with it into the registers behind the number, as a point that lies there; with
        /// function 05 nothing can.
        data: Option<Box<Point>>,
    },
    /// By a value in a register.
    Register {
        /// The register.
        address: RegisterAddress,
        /// The value.
        value: u16,
    },
}

/// The registers that take operations by their number: a code, the number behind it, then what goes
/// with it, all in one write of function 16.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct CommandRegisters {
    /// The first of them.
    pub address: RegisterAddress,
    /// What it is to hold.
    pub code: u16,
}

/// The points that set a meter's clock, time and date next to each other in this order.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ClockPoints {
    /// The name of the one that takes the time of day.
    pub time: String,
    /// The name of the one that takes the date.
    pub date: String,
}

/// Points of which no two may hold the same.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Distinct {
    /// Their names.
    pub points: Vec<String>,
    /// Raw numbers that several may hold.
    pub except: Vec<u16>,
    /// Why, in a few words.
    pub about: String,
}

/// Why a point does not take what it could hold.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum NotTaken {
    /// Beyond its limits.
    #[error("{found} is not {}{}", span(.lowest, .highest), besides(.also))]
    Range {
        /// What was given.
        found: Decimal,
        /// The lowest value.
        lowest: Decimal,
        /// The highest value.
        highest: Decimal,
        /// Values that are taken besides, as they are shown.
        also: Vec<String>,
    },
    /// Between two of its steps.
    #[error("{found} is no multiple of {step}: the nearest are {below} and {above}")]
    Step {
        /// What was given.
        found: Decimal,
        /// The distance of two values.
        step: Decimal,
        /// The next value below.
        below: Decimal,
        /// The next value above.
        above: Decimal,
    },
    /// A time of day that is no whole number of its steps.
    #[error("{found} is no multiple of {step} ms")]
    TimeStep {
        /// What was given.
        found: Time,
        /// The distance of two times.
        step: u16,
    },
    /// A text with what no display shows.
    #[error("there are characters in it that do not print")]
    Unprintable,
    /// None of the few it takes.
    #[error("{found} is none of {}", .allowed.join(", "))]
    Allowed {
        /// What was given.
        found: Decimal,
        /// What is taken, as it is shown.
        allowed: Vec<String>,
    },
}

fn span(lowest: &Decimal, highest: &Decimal) -> String {
    if lowest == highest {
        lowest.to_string()
    } else {
        format!("within {lowest} to {highest}")
    }
}

fn besides(also: &[String]) -> String {
    match also {
        [] => String::new(),
        also => format!(", nor {}", also.join(", ")),
    }
}

impl Point {
    /// What is to be known before it is written.
    pub fn writing(&self) -> &Writing {
        self.writing.as_deref().unwrap_or(&PLAIN)
    }

    /// Whether the meter takes these registers, which hold a value of this point.
    ///
    /// # Errors
    /// [`NotTaken`] tells what it takes, in the terms of the point where its scale is always the
    /// same, else in raw numbers.
    pub fn takes(&self, registers: &[u16]) -> Result<(), NotTaken> {
        let raw = match self.raw_value(registers) {
            Ok(Raw::Integer(raw)) => raw,
            Ok(Raw::Word(word)) => word.into(),
            Ok(Raw::Time(found)) => return self.takes_time(found),
            Ok(Raw::Text(found)) if found.contains(|c: char| c.is_control()) => {
                return Err(NotTaken::Unprintable);
            }
            // Other texts and dates have no limits but those of their type.
            _ => return Ok(()),
        };
        self.takes_raw(raw)
    }

    /// Whether the meter takes a time of day: its step is one of milliseconds.
    fn takes_time(&self, found: Time) -> Result<(), NotTaken> {
        let step = self.writing().step.max(1);
        let milliseconds = i64::from(found.second()) * 1000 + i64::from(found.millisecond());
        if milliseconds % i64::from(step) == 0 {
            return Ok(());
        }
        Err(NotTaken::TimeStep { found, step })
    }

    /// Whether the meter takes a raw number.
    pub(super) fn takes_raw(&self, raw: i128) -> Result<(), NotTaken> {
        let writing = self.writing();
        let is = |number: &i64| i128::from(*number) == raw;
        if writing.also.iter().any(is) {
            return Ok(());
        }
        if !writing.allowed.is_empty() {
            if writing.allowed.iter().any(is) {
                return Ok(());
            }
            return Err(NotTaken::Allowed {
                found: self.figure(raw),
                allowed: self.all_shown(writing.allowed.iter().chain(&writing.also)),
            });
        }
        if let Some((lowest, highest)) = self.limits
            && !(lowest..=highest).contains(&raw)
        {
            return Err(NotTaken::Range {
                found: self.figure(raw),
                lowest: self.figure(lowest),
                highest: self.figure(highest),
                also: self.all_shown(writing.also.iter()),
            });
        }
        let step = i128::from(writing.step.max(1));
        if raw % step != 0 {
            let below = raw - raw.rem_euclid(step);
            return Err(NotTaken::Step {
                found: self.figure(raw),
                step: self.figure(step),
                below: self.figure(below),
                above: self.figure(below + step),
            });
        }
        Ok(())
    }

    /// A raw number as the point shows it without its labels.
    pub(super) fn figure(&self, raw: i128) -> Decimal {
        let scale = self.constant_scale().unwrap_or(Decimal::ONE);
        times(raw, 0, scale).unwrap_or_default()
    }

    /// Raw numbers as the point shows them, with their labels.
    pub(super) fn all_shown<'a>(&self, raws: impl Iterator<Item = &'a i64>) -> Vec<String> {
        let shown = raws.map(|raw| {
            let figure = self.figure(i128::from(*raw));
            match u16::try_from(*raw).ok().and_then(|code| self.label(code)) {
                Some(label) => format!("{figure} ({label})"),
                None => figure.to_string(),
            }
        });
        shown.collect()
    }
}
