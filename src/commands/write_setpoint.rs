//! `write-setpoint`: points of a meter, once, and what became of it.

use super::asking::{Asking, units};
use super::careful::Consent;
use super::fates::{self, Deed, Outcome};
use super::open_line::LinePlan;
use super::report::{self, Report};
use super::setpoints::{Job, insisted, typed};
use super::signals::Stop;
use super::{CommandError, ExitCode, print};
use crate::cli::WriteSetpoint;
use crate::client::Client;
use crate::codec::{Request, Unit, rtu};
use crate::output::changes::{Line, table};
use crate::profile::write_plan::{Change, PlannedWrite, WriteRules, in_pieces};
use crate::profile::{Limits, Scales, find};
use crate::readings::Fault;
use crate::writing::{Before, before, carry_out, check};

/// Writes what was asked for, unit by unit.
pub(super) fn run(
    arguments: &WriteSetpoint,
    report: &mut Report,
) -> Result<ExitCode, CommandError> {
    let profile = arguments.meter.as_deref().map(find::find).transpose()?;
    let profile = profile.as_ref();
    let line = LinePlan::new(&arguments.line, profile);
    let limits = profile.map_or_else(Limits::default, |profile| profile.limits.clone());
    let units = units(&arguments.unit, &limits)?;
    let assignments = typed(&arguments.what, arguments.numbering, profile)?;
    let rules = WriteRules::new(profile).insisting(insisted(arguments.function));
    let job = Job::new(assignments, profile, rules)?.one_by_one()?;
    if arguments.care.dry_run {
        let (_, planned) = job.ready_unread()?;
        return print(frames(&units, &planned).as_bytes());
    }
    let consent = Consent::of(job.hazards(), arguments.care)?;

    let readable = job.readable();
    let mut asking = Asking::new(&line, profile, &readable, limits.read_function());
    asking.setup = job.setup();
    let mut client = line.open()?;
    let mut task = Task {
        arguments,
        job: &job,
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

/// The requests as they would go out, one a line.
fn frames(units: &[Unit], planned: &[PlannedWrite]) -> String {
    let of_unit = |unit: &Unit| {
        let unit = *unit;
        planned.iter().map(move |planned| {
            let request = Request::Write(planned.write.clone());
            rtu::encode_request(unit, &request).to_string() + "\n"
        })
    };
    units.iter().flat_map(of_unit).collect()
}

/// Writing under way.
struct Task<'a> {
    arguments: &'a WriteSetpoint,
    job: &'a Job<'a>,
    asking: &'a Asking<'a>,
    consent: &'a Consent,
    /// Listens from the first write on.
    stop: Option<Stop>,
    outcome: Outcome,
}

impl Task<'_> {
    fn all(&mut self, units: &[Unit], client: &mut Client, report: &mut Report) {
        for (index, unit) in units.iter().copied().enumerate() {
            let is_over = self.unit(unit, client, report).unwrap_or_else(|error| {
                // What became of the units before counts as well.
                self.outcome.add(report.error(&error));
                true
            });
            let rest = units.len() - index - 1;
            if is_over || self.is_stopped() {
                report::untried_units(rest);
                break;
            }
        }
    }

    fn is_stopped(&self) -> bool {
        let stop = self.stop.as_ref();
        stop.is_some_and(|stop| stop.requested().is_some())
    }

    /// Writes to one unit, and returns whether the port is lost, or the line of no use.
    fn unit(
        &mut self,
        unit: Unit,
        client: &mut Client,
        report: &mut Report,
    ) -> Result<bool, CommandError> {
        let place = format!("unit {unit} on {}", self.asking.line);
        let mut memory = self.asking.memory();
        let inquiry = self.asking.inquiry(unit);
        let before = match before(client, &inquiry, self.job.profile(), &mut memory) {
            Ok(before) => before,
            Err(failure) => {
                report.failure(&format!("{place}: nothing was written"), &failure);
                self.outcome.add(ExitCode::of(0, &[Fault::from(&failure)]));
                return Ok(true);
            }
        };
        let ready = self.job.ready(&before.scales).and_then(|ready| {
            self.job.allowed(&ready.0, &before.scales)?;
            Ok(ready)
        });
        let (changes, planned) = match (ready, before.failure()) {
            (Ok(ready), _) if !before.is_hopeless() => ready,
            // What would have told was not read.
            (_, Some(failure)) => {
                report.failure(&format!("{place}: nothing was written"), failure);
                self.outcome.add(ExitCode::of(0, &[Fault::from(failure)]));
                return Ok(before.is_hopeless());
            }
            (ready, None) => ready?,
        };
        if self.is_stopped() {
            report::problem(&place, "nothing was written: the program was stopped");
            return Ok(false);
        }
        self.show(&place, &before, &changes, &planned, report)?;
        self.consent.obtain(&place, self.stop.as_ref())?;

        let stop = self.stop.get_or_insert_with(Stop::listen_while_writing);
        client.stop_when(stop.flag());
        let is_over = || stop.requested().is_some();
        let patience = self.asking.patience;
        let replies = carry_out(client, unit, &planned, changes.len(), patience, &is_over);
        let verified = !self.arguments.no_verify && !is_over();
        let inquiry = verified.then_some((&inquiry, &mut memory));
        let fates = check(client, &changes, replies, inquiry, &before.scales);
        let find_out = self.find_out(unit);
        for (change, fate) in changes.iter().zip(&fates) {
            let name = &change.point.name;
            let deed = Deed {
                place: &place,
                name,
                value: Some(&shown(change, &before.scales)),
                done: "written",
                find_out: find_out.as_deref(),
            };
            self.outcome.add(fates::tell(&deed, fate, report));
        }
        Ok(client.is_lost())
    }

    /// Shows what will be written.
    fn show(
        &self,
        place: &str,
        before: &Before,
        changes: &[Change],
        planned: &[PlannedWrite],
        report: &Report,
    ) -> Result<(), CommandError> {
        let mut old = before.old.iter();
        let lines: Vec<Line<'_>> = changes
            .iter()
            .map(|change| Line {
                point: &change.point,
                old: change.point.access.readable().then(|| old.next()).flatten(),
                new: figure(change, &before.scales),
            })
            .collect();
        if !report.is_quiet() {
            let meter = self.asking.meter;
            let meter = if meter.is_empty() {
                String::new()
            } else {
                format!("{meter} ")
            };
            print(format!("# {meter}{place}\n{}", table(&lines)).as_bytes())?;
        }
        if let Some(failure) = before.failure() {
            report::warning(&format!(
                "{place}: what it holds now could not be read ({failure}); it is written all the same"
            ));
        }
        for index in in_pieces(planned, changes.len()) {
            if let Some(change) = changes.get(index) {
                report::warning(&format!(
                    "{} goes in {} requests, low word first, for the meter writes one register at a \
                     time: in between it holds half of it",
                    change.point.name,
                    change.registers.len()
                ));
            }
        }
        Ok(())
    }

    /// The command that shows what was written; `None` where nothing of it can be read.
    fn find_out(&self, unit: Unit) -> Option<String> {
        let points = self.asking.points.iter();
        let names: Vec<&str> = points.map(|point| point.name.as_str()).collect();
        if names.is_empty() {
            return None;
        }
        let port = self.arguments.line.port.as_deref().unwrap_or_default();
        let meter = self.arguments.meter.as_ref();
        let meter = meter
            .map(|meter| format!(" --meter {meter}"))
            .unwrap_or_default();
        Some(format!(
            "meterpoll read-registers -p {port} -a {unit}{meter} {}",
            names.join(" ")
        ))
    }
}

/// What a point will read as.
fn figure(change: &Change, scales: &Scales) -> String {
    let value = change.point.interpret(&change.registers, scales);
    value.map_or_else(|_| "?".to_owned(), |value| value.to_string())
}

/// The same with its unit.
fn shown(change: &Change, scales: &Scales) -> String {
    let figure = figure(change, scales);
    match &change.point.unit {
        Some(unit) => format!("{figure} {unit}"),
        None => figure,
    }
}
