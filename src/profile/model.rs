//! A meter, checked and ready to work with.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::time::Duration;

use serde::{Deserialize, Serialize};

use super::identity::Identity;
use super::point::Point;
use super::scaling::Factor;
use super::setup::needed;
use super::writing::{ClockPoints, CommandRegisters, Distinct, Operation};
use crate::codec::{FunctionCode, ReadFunction, RegisterBlock, RegisterRange, UnitRange};
use crate::transport::LineSettings;

/// One meter: what it is, how it is spoken to, and its points.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Profile {
    /// Short name, as typed after `--meter`.
    pub name: String,
    /// Maker and model.
    pub title: String,
    /// The manual that the pages are pages of.
    pub manual: String,
    /// The line setting the meter leaves the factory with.
    pub line: LineSettings,
    /// What may be asked of it, and how fast.
    pub limits: Limits,
    /// How to tell that a unit is one of these.
    pub identification: Option<Identification>,
    /// Named sets of points.
    pub groups: Vec<Group>,
    /// Numbers that scales depend on and that follow from setup registers.
    pub factors: Vec<Factor>,
    /// All points, by address.
    pub points: Vec<Point>,
    /// What must hold between the values of points, whatever the load.
    pub identities: Vec<Identity>,
    /// What it does when it is told to, by number where it has numbers.
    pub operations: Vec<Operation>,
    /// The registers that take operations by their number.
    pub command_registers: Option<CommandRegisters>,
    /// The points that set its clock.
    pub clock: Option<ClockPoints>,
    /// Names of the bits that function 07 answers, by their masks.
    pub status_bits: BTreeMap<u8, String>,
    /// Points of which no two may hold the same.
    pub distinct: Vec<Distinct>,
}

/// What may be asked of a meter, and how fast.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Limits {
    /// The unit numbers it can have.
    pub units: UnitRange,
    /// The functions it answers.
    pub functions: Vec<FunctionCode>,
    /// Whether functions 03 and 04 read the same registers.
    pub interchangeable_reads: bool,
    /// The functions it obeys on address 0.
    pub broadcast_functions: Vec<FunctionCode>,
    /// Whether it is known to obey them for what is marked alone.
    pub broadcasts_marked_only: bool,
    /// What function 08, Return Query Data, sends back, on a meter that has it.
    pub loopback_data: LoopbackData,
    /// The most registers in one read, 1 to 125.
    pub read_registers: u16,
    /// The most registers in one write, 1 to 123.
    pub write_registers: u16,
    /// Whether a read may cover registers that no point names.
    pub read_holes: bool,
    /// A read must not cross a multiple of this many registers.
    pub table_registers: Option<u16>,
    /// How long it usually takes to answer, for planning.
    pub typical_answer: Duration,
    /// How long it may take before its answer begins.
    pub longest_answer: Duration,
    /// The pause it wants before each request, where t3.5 is not enough.
    pub pause: Duration,
}

/// What a meter sends back when it is asked to return data (function 08, sub-function 0). The
/// standard lets it be anything (AP 6.8.1).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum LoopbackData {
    /// Any word.
    #[default]
    Any,
    /// 0 alone; any other word is refused.
    Zero,
}

impl LoopbackData {
    /// Whether the meter sends this word back.
    pub const fn takes(self, word: u16) -> bool {
        match self {
            Self::Any => true,
            Self::Zero => word == 0,
        }
    }
}

impl fmt::Display for LoopbackData {
    /// As in a profile's file: `any`, `zero`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Any => "any",
            Self::Zero => "zero",
        })
    }
}

impl Default for Limits {
    /// What the standard allows a meter of which nothing is known.
    fn default() -> Self {
        Self {
            units: UnitRange::Standard,
            functions: vec![
                FunctionCode::ReadHoldingRegisters,
                FunctionCode::ReadInputRegisters,
            ],
            interchangeable_reads: false,
            broadcast_functions: Vec::new(),
            broadcasts_marked_only: false,
            loopback_data: LoopbackData::Any,
            read_registers: RegisterRange::MOST,
            write_registers: RegisterBlock::MOST,
            read_holes: false,
            table_registers: None,
            typical_answer: Duration::ZERO,
            longest_answer: Self::LONGEST_ANSWER,
            pause: Duration::ZERO,
        }
    }
}

impl Limits {
    /// The usual time-out at 9600 baud: "1 s to several seconds" (SL 2.4.1).
    pub const LONGEST_ANSWER: Duration = Duration::from_secs(1);

    /// The function to read with: 03 where the meter has it, else 04.
    pub fn read_function(&self) -> ReadFunction {
        if self.functions.contains(&FunctionCode::ReadHoldingRegisters) {
            ReadFunction::HoldingRegisters
        } else {
            ReadFunction::InputRegisters
        }
    }
}

/// How to tell that a unit is this meter: a point that holds one of a few codes.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identification {
    /// The name of the point.
    pub point: String,
    /// The raw codes it can hold.
    pub codes: Vec<u16>,
}

/// A named set of points.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Group {
    /// Its name, typed as `@name`.
    pub name: String,
    /// Indices into [`Profile::points`], in the order they are shown.
    pub members: Vec<usize>,
}

impl Profile {
    /// The group that is read when none is named.
    pub const DEFAULT_GROUP: &str = "default";

    /// A point by its name.
    pub fn point(&self, name: &str) -> Option<&Point> {
        self.points.iter().find(|point| point.name == name)
    }

    /// An operation by its name.
    pub fn operation(&self, name: &str) -> Option<&Operation> {
        self.operations
            .iter()
            .find(|operation| operation.name == name)
    }

    /// The names of the points that must be read to make sense of this one.
    pub fn setup_of<'a>(&'a self, point: &'a Point) -> BTreeSet<&'a str> {
        needed(point, &self.factors)
    }

    /// The points of a group, in its order.
    pub fn group(&self, name: &str) -> Option<impl Iterator<Item = &Point>> {
        let group = self.groups.iter().find(|group| group.name == name)?;
        Some(
            group
                .members
                .iter()
                .filter_map(|index| self.points.get(*index)),
        )
    }
}
