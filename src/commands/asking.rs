//! Reading units of one meter: what is asked, how, and what is said when it goes wrong.

use super::CommandError;
use super::open_line::LinePlan;
use super::report::Report;
use super::trouble::Place;
use crate::cli::{NumberingChoice, Units};
use crate::client::{Client, Patience};
use crate::codec::{FunctionCode, ReadFunction, Unit};
use crate::profile::plan::{Cost, Rules};
use crate::profile::selector::Numbering;
use crate::profile::{Limits, Plan, Point, Profile, Setup};
use crate::readings::{Inquiry, Memory, Taken, take};

/// The units that were typed, if a meter of these limits can have them.
pub(super) fn units(typed: &Units, limits: &Limits) -> Result<Vec<Unit>, CommandError> {
    let numbers = typed.0.iter();
    numbers
        .map(|number| Unit::new(*number, limits.units).map_err(CommandError::Unit))
        .collect()
}

/// Whether a meter answers a function.
///
/// # Errors
/// [`CommandError::Function`] when it does not.
pub(super) fn answered(profile: &Profile, function: FunctionCode) -> Result<(), CommandError> {
    if profile.limits.functions.contains(&function) {
        return Ok(());
    }
    Err(CommandError::Function {
        meter: profile.name.clone(),
        code: function.get(),
    })
}

/// How register numbers are written.
pub(super) const fn numbering(typed: NumberingChoice) -> Numbering {
    match typed {
        NumberingChoice::Protocol => Numbering::Protocol,
        NumberingChoice::Modicon => Numbering::Modicon,
    }
}

/// What every unit is asked.
pub(super) struct Asking<'a> {
    /// The meter's name; empty for an unknown one.
    pub(super) meter: &'a str,
    /// What is read.
    pub(super) points: &'a [Point],
    /// What they depend on.
    pub(super) setup: Setup,
    function: ReadFunction,
    rules: Rules,
    /// What reads cost on this line.
    pub(super) cost: Cost,
    /// How patient to be.
    pub(super) patience: Patience,
    /// The line, `/dev/ttyUSB0 at 9600 8N1`.
    pub(super) line: String,
}

impl<'a> Asking<'a> {
    /// Asks for `points`, with `function` those that have none of their own.
    pub(super) fn new(
        line: &LinePlan<'_>,
        profile: Option<&'a Profile>,
        points: &'a [Point],
        function: ReadFunction,
    ) -> Self {
        let unknown = Limits::default();
        let limits = profile.map_or(&unknown, |profile| &profile.limits);
        let patience = line.patience(limits);
        Self {
            meter: profile.map_or("", |profile| &profile.name),
            points,
            setup: Setup::of(points, profile),
            function,
            rules: profile.map_or_else(|| Rules::new(limits), Rules::of),
            cost: Cost::new(line.settings, patience.pause, limits.typical_answer),
            patience,
            line: line.name(),
        }
    }

    /// The cheapest plan for points of this meter.
    pub(super) fn plan(&self, points: &[Point]) -> Plan {
        Plan::new(points, self.function, &self.rules, self.cost)
    }

    /// What is asked of one unit.
    pub(super) fn inquiry(&self, unit: Unit) -> Inquiry<'a, '_> {
        Inquiry {
            unit,
            meter: self.meter,
            points: self.points,
            setup: &self.setup,
            function: self.function,
            cost: self.cost,
            patience: self.patience,
        }
    }

    /// A memory in which nothing has been learned of a unit yet.
    pub(super) fn memory(&self) -> Memory {
        Memory::new(self.rules.clone())
    }

    /// Reads one unit and tells what went wrong.
    pub(super) fn ask(&self, unit: Unit, client: &mut Client, report: &mut Report) -> Taken<'a> {
        let taken = take(client, &self.inquiry(unit), &mut self.memory());
        let place = self.place(unit, &taken.points);
        for trouble in &taken.troubles {
            report.trouble(&place, trouble);
        }
        taken
    }

    /// Where, what and how often something was tried.
    pub(super) fn place<'b>(&'b self, unit: Unit, points: &'b [Point]) -> Place<'b> {
        Place {
            meter: "",
            line: &self.line,
            unit,
            points,
            attempts: self.patience.retries + 1,
        }
    }
}
