//! `execute-operation`: what a meter does when it is told to.

mod list;
pub(super) mod telling;

use self::telling::Telling;
use super::asking::{Asking, units};
use super::careful::{Consent, Hazard};
use super::fates::{self, Deed, Outcome};
use super::open_line::LinePlan;
use super::report::{self, Report};
use super::signals::Stop;
use super::{CommandError, ExitCode, print};
use crate::cli::ExecuteOperation;
use crate::client::Client;
use crate::codec::{Request, Unit, rtu};
use crate::profile::write_plan::PlannedWrite;
use crate::profile::{Profile, Setup, find};
use crate::readings::Fault;
use crate::transport::{Clock, SystemClock};
use crate::writing::before::allowed;
use crate::writing::{before, carry_out, check};

/// Tells every unit to do it, one after the other.
pub(super) fn run(
    arguments: &ExecuteOperation,
    report: &mut Report,
) -> Result<ExitCode, CommandError> {
    let profile = find::find(&arguments.meter)?;
    let (Some(name), Some(unit)) = (&arguments.operation, &arguments.unit) else {
        return list::list(&profile);
    };
    let telling = Telling::new(
        &profile,
        name,
        arguments.value.as_deref(),
        arguments.function,
    )?;
    let units = units(unit, &profile.limits)?;
    let line = LinePlan::new(&arguments.line, Some(&profile));
    if arguments.care.dry_run {
        let request = Request::Write(telling.write(SystemClock::new().utc_now())?);
        let frames = units
            .iter()
            .map(|unit| rtu::encode_request(*unit, &request));
        let lines: String = frames.map(|frame| frame.to_string() + "\n").collect();
        return print(lines.as_bytes());
    }
    let hazard = telling.operation.hazard.clone().map(|what| Hazard {
        name: telling.operation.name.clone(),
        what,
    });
    let consent = Consent::of(hazard.into_iter().collect(), arguments.care)?;
    let mut asking = Asking::new(&line, Some(&profile), &[], profile.limits.read_function());
    let with = telling.operation.only_with.as_ref();
    let with = with.and_then(|with| profile.point(&with.point));
    asking.setup = Setup::default().with(with.cloned());
    let mut client = line.open()?;
    let mut task = Task {
        profile: &profile,
        telling: &telling,
        asking: &asking,
        consent: &consent,
        stop: None,
        outcome: Outcome::default(),
    };
    task.all(&units, &mut client, report);
    // Whatever became of it, no late answer is left to whoever opens the port next; a port that is
    // lost has none.
    let _ = client.finish();
    let stopped = task.stop.as_ref().and_then(Stop::requested);
    Ok(task.outcome.code(stopped))
}

/// Telling under way.
struct Task<'a> {
    profile: &'a Profile,
    telling: &'a Telling<'a>,
    asking: &'a Asking<'a>,
    consent: &'a Consent,
    /// Listens from the first request on.
    stop: Option<Stop>,
    outcome: Outcome,
}

impl Task<'_> {
    fn all(&mut self, units: &[Unit], client: &mut Client, report: &mut Report) {
        for (index, unit) in units.iter().copied().enumerate() {
            let result = self.unit(unit, client, report);
            let is_over = result.is_err() || client.is_lost() || self.is_stopped();
            if let Err(error) = result {
                // What became of the units before counts as well.
                self.outcome.add(report.error(&error));
            }
            if is_over {
                report::untried_units(units.len() - index - 1);
                break;
            }
        }
    }

    fn is_stopped(&self) -> bool {
        let stop = self.stop.as_ref();
        stop.is_some_and(|stop| stop.requested().is_some())
    }

    fn unit(
        &mut self,
        unit: Unit,
        client: &mut Client,
        report: &mut Report,
    ) -> Result<(), CommandError> {
        let place = format!("unit {unit} on {}", self.asking.line);
        let operation = self.telling.operation;
        let mut memory = self.asking.memory();
        let inquiry = self.asking.inquiry(unit);
        let before = before(client, &inquiry, Some(self.profile), &mut memory);
        let unread = match &before {
            Err(failure) => Some(failure),
            Ok(before) => before.failure(),
        };
        if let Some(failure) = unread {
            report.failure(
                &format!("{place}: {} was not sent", operation.name),
                failure,
            );
            self.outcome.add(ExitCode::of(0, &[Fault::from(failure)]));
            return Ok(());
        }
        let scales = before.map(|before| before.scales).unwrap_or_default();
        let with = operation.only_with.as_ref();
        allowed(&operation.name, "carried out", with, &scales, self.profile)?;
        if self.is_stopped() {
            let text = format!("{} was not sent: the program was stopped", operation.name);
            report::problem(&place, &text);
            return Ok(());
        }
        if !report.is_quiet() {
            let shown = format!(
                "# {} {place}\n{}: {}\n",
                self.asking.meter, operation.name, operation.about
            );
            print(shown.as_bytes())?;
        }
        self.consent.obtain(&place, self.stop.as_ref())?;

        let stop = self.stop.get_or_insert_with(Stop::listen_while_writing);
        client.stop_when(stop.flag());
        let planned = [PlannedWrite {
            write: self.telling.write(client.utc_now())?,
            changes: vec![0],
        }];
        let is_over = || stop.requested().is_some();
        let patience = self.asking.patience;
        let replies = carry_out(client, unit, &planned, 1, patience, &is_over);
        let deed = Deed {
            place: &place,
            name: &operation.name,
            value: None,
            done: "done",
            find_out: None,
        };
        for reply in replies {
            let fate = check::unread(reply);
            self.outcome.add(fates::tell(&deed, &fate, report));
        }
        Ok(())
    }
}
