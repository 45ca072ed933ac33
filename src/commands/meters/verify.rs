//! `meters verify`: whether what a profile says of its meter holds on a live one.

use std::collections::BTreeMap;

use crate::cli::VerifyMeter;
use crate::commands::asking::{Asking, units};
use crate::commands::open_line::LinePlan;
use crate::commands::report::Report;
use crate::commands::signals::Stop;
use crate::commands::{CommandError, ExitCode, print};
use crate::output::verification::Verified;
use crate::profile::find;
use crate::profile::identity::Outcome;
use crate::readings::verify::{points, verify};
use crate::readings::{Fault, Taken};

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
    let mut code = Ok(ExitCode::Done);
    for (index, unit) in units.into_iter().enumerate() {
        let Taken { row, scales, .. } = asking.ask(unit, &mut client, report);
        let steps = points.iter().map(|point| point.step(&scales));
        let readings = row.readings.iter().cloned().zip(steps);
        let named = points.iter().map(|point| point.name.clone());
        let readings: BTreeMap<String, _> = named.zip(readings).collect();
        let verification = verify(&profile, &readings);
        let verified = Verified {
            verification: &verification,
            row: &row,
            points: &points,
            line: (!report.is_quiet()).then_some(&*asking.line),
        };
        let between = if index > 0 { "\n" } else { "" };
        let faults: Vec<Fault> = row.faults().collect();
        let end = end(
            row.readings.len() - faults.len(),
            &faults,
            &verification.tests,
        );
        code = print(format!("{between}{}", verified.text()).as_bytes())
            .and(code)
            .map(|worst| worse(worst, end));
        if code.is_err() || stop.requested().is_some() || faults.contains(&Fault::Port) {
            break;
        }
    }
    let _ = client.finish();
    code.map(|code| stop.requested().unwrap_or(code))
}

/// What one unit comes to: done when something holds, nothing fails and no reading was lost.
fn end<T>(delivered: usize, faults: &[Fault], tests: &[(T, Outcome)]) -> ExitCode {
    if delivered == 0 {
        return ExitCode::of(delivered, faults);
    }
    let holds = tests
        .iter()
        .any(|(_, outcome)| matches!(outcome, Outcome::Holds { .. }));
    let fails = tests
        .iter()
        .any(|(_, outcome)| matches!(outcome, Outcome::Fails { .. }));
    let is_lost = |fault: &Fault| !matches!(fault, Fault::Absent | Fault::Overflow);
    if holds && !fails && !faults.iter().any(is_lost) {
        ExitCode::Done
    } else {
        ExitCode::SomeMissing
    }
}

/// What two units come to.
const fn worse(one: ExitCode, other: ExitCode) -> ExitCode {
    match (one, other) {
        (ExitCode::Done, other) => other,
        (one, _) => one,
    }
}
