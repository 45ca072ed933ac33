//! `meters verify`: whether what a profile says of its meter holds on a live one.

use std::collections::BTreeMap;

use crate::cli::VerifyMeter;
use crate::commands::asking::{Asking, units};
use crate::commands::open_line::LinePlan;
use crate::commands::report::{self, Report};
use crate::commands::signals::Stop;
use crate::commands::{CommandError, ExitCode, print};
use crate::output::verification::Verified;
use crate::profile::find;
use crate::profile::identity::Outcome;
use crate::readings::verify::{Verification, points, verify};
use crate::readings::{Fault, Row, Taken};

/// Reads the points that identities are about, and tests these.
pub(super) fn run(arguments: &VerifyMeter, report: &mut Report) -> Result<ExitCode, CommandError> {
    let profile = find::find(&arguments.meter)?;
    let points = points(&profile);
    if points.is_empty() {
        let meter = profile.name;
        return Err(CommandError::NoIdentities { meter });
    }
    let line = LinePlan::new(&arguments.line, Some(&profile));
    let units = units(&arguments.unit, &profile.limits)?;
    let function = profile.limits.read_function();
    let asking = Asking::new(&line, Some(&profile), &points, function);
    let mut client = line.open()?;
    let stop = Stop::listen();
    let mut found = Found::default();
    let mut result = Ok(());
    for (index, unit) in units.iter().copied().enumerate() {
        let taken = asking.ask(unit, &mut client, report);
        let is_away = taken.is_port_away();
        let Taken { row, scales, .. } = taken;
        let steps = points.iter().map(|point| point.step(&scales));
        let named = points.iter().map(|point| point.name.clone());
        let readings: BTreeMap<String, _> =
            named.zip(row.readings.iter().cloned().zip(steps)).collect();
        let verification = verify(&profile, &readings);
        found.add(&row, &verification);
        let verified = Verified {
            verification: &verification,
            row: &row,
            points: &points,
            line: (!report.is_quiet()).then_some(&*asking.line),
        };
        let between = if index > 0 { "\n" } else { "" };
        result = print(format!("{between}{}", verified.text()).as_bytes()).map(drop);
        let rest = units.len() - index - 1;
        if is_away && rest > 0 {
            report::untried_units(rest);
        }
        if result.is_err() || is_away || stop.requested().is_some() {
            break;
        }
    }
    let _ = client.finish();
    result.map(|()| stop.requested().unwrap_or_else(|| found.code()))
}

/// What all units come to.
#[derive(Default)]
struct Found {
    delivered: usize,
    faults: Vec<Fault>,
    holds: bool,
    fails: bool,
}

impl Found {
    fn add(&mut self, row: &Row, verification: &Verification<'_>) {
        let outcomes = || verification.tests.iter().map(|(_, outcome)| outcome);
        self.delivered += row.readings.len() - row.faults().count();
        self.faults.extend(row.faults());
        self.holds |= outcomes().any(|outcome| matches!(outcome, Outcome::Holds { .. }));
        self.fails |= outcomes().any(|outcome| matches!(outcome, Outcome::Fails { .. }));
    }

    /// Done when something holds, nothing fails and no reading was lost.
    fn code(&self) -> ExitCode {
        // What the meter says it does not have is not lost.
        let is_lost = |fault: &Fault| !matches!(fault, Fault::Absent | Fault::Overflow);
        if self.delivered > 0 && !self.faults.iter().any(is_lost) && self.holds && !self.fails {
            return ExitCode::Done;
        }
        match ExitCode::of(self.delivered, &self.faults) {
            ExitCode::Done => ExitCode::SomeMissing,
            code => code,
        }
    }
}
