//! `write-setpoint`: points of a meter, once, and what became of it.

use super::asking::{Asking, units};
use super::careful::Consent;
use super::fates::{self, Deed};
use super::open_line::LinePlan;
use super::report::{self, Report};
use super::setpoints::{Job, Ready, insisted, moving, piecemeal, typed};
use super::tour::Tour;
use super::{CommandError, ExitCode, print, print_frames};
use crate::cli::{NumberingChoice, WriteSetpoint};
use crate::client::Client;
use crate::codec::{Frame, Request, Unit, rtu};
use crate::output::changes::{Line, table};
use crate::profile::EncodeError;
use crate::profile::assignment::AssignError;
use crate::profile::write_plan::{Change, PlannedWrite, WriteRules};
use crate::profile::{Limits, Scales, find};
use crate::readings::Fault;
use crate::writing::before::NotNow;
use crate::writing::{Before, Fate, Receipt, before, carry_out, check};

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
    let job = Job::new(assignments, profile, rules)?.one_by_one(units.len())?;
    if arguments.care.dry_run {
        let (_, planned) = job.ready_unread()?;
        return print_frames(frames(&units, &planned));
    }
    let consent = Consent::of(job.hazards(), arguments.care)?;

    let readable = job.readable();
    let mut asking = Asking::new(&line, profile, &readable, limits.read_function());
    asking.setup = job.setup();
    let mut client = line.open()?;
    let task = Task {
        arguments,
        line: &line,
        job: &job,
        asking: &asking,
    };
    let tour = Tour::new(&units, &consent);
    let code = tour.all(&mut client, report, |unit, tour, client, report| {
        task.unit(unit, tour, client, report)
    });
    // Whatever became of it, no late answer is left to whoever opens the port next; a port that is
    // lost has none.
    let _ = client.finish();
    Ok(code)
}

/// The requests as they would go out.
fn frames(units: &[Unit], planned: &[PlannedWrite]) -> Vec<Frame> {
    let requests = planned
        .iter()
        .map(|planned| Request::Write(planned.write.clone()));
    let requests: Vec<Request> = requests.collect();
    let of_unit = |unit: &Unit| {
        let unit = *unit;
        requests
            .iter()
            .map(move |request| rtu::encode_request(unit, request))
    };
    units.iter().flat_map(of_unit).collect()
}

/// Writing under way.
struct Task<'a> {
    arguments: &'a WriteSetpoint,
    line: &'a LinePlan<'a>,
    job: &'a Job<'a>,
    asking: &'a Asking<'a>,
}

impl Task<'_> {
    /// Writes to one unit.
    fn unit(
        &self,
        unit: Unit,
        tour: &mut Tour<'_>,
        client: &mut Client,
        report: &mut Report,
    ) -> Result<(), CommandError> {
        let place = format!("unit {unit} on {}", self.asking.line);
        let mut memory = self.asking.memory();
        let inquiry = self.asking.inquiry(unit);
        let before = match before(client, &inquiry, self.job.profile(), &mut memory) {
            Ok(before) => before,
            Err(failure) => {
                report.failure(&format!("{place}: nothing was written"), &failure);
                tour.add(ExitCode::of(0, &[Fault::from(&failure)]));
                return Ok(());
            }
        };
        let (changes, planned) = match self.ready(&place, &before) {
            Ok(ready) if !before.is_hopeless() => ready,
            ready => {
                let Some(failure) = before.failure().filter(|_| !is_known(&ready)) else {
                    return ready.map(drop);
                };
                report.failure(&format!("{place}: nothing was written"), failure);
                tour.add(ExitCode::of(0, &[Fault::from(failure)]));
                if before.is_hopeless() {
                    tour.end();
                }
                return Ok(());
            }
        };
        if tour.is_stopped() {
            report::problem(&place, "nothing was written: the program was stopped");
            return Ok(());
        }
        self.show(&place, &before, &changes, &planned, report)?;
        tour.begin(&place, client)?;
        let is_over = || tour.is_stopped();
        let patience = self.asking.patience;
        // What is read back is read where the meter is now.
        let (here, moving) = planned.split_at(moving(&planned, &changes));
        let receipts = carry_out(client, unit, here, changes.len(), patience, &is_over);
        let is_confirmed = receipts.iter().all(Receipt::is_no_failure);
        let verified = !self.arguments.no_verify && !is_over();
        let inquiry = verified.then_some((&inquiry, &mut memory));
        let mut fates = check(client, &changes, receipts, inquiry, &before.scales);
        if is_confirmed && !moving.is_empty() {
            let receipts = carry_out(client, unit, moving, changes.len(), patience, &is_over);
            let last = check(client, &changes, receipts, None, &before.scales);
            for (fate, last) in fates.iter_mut().zip(last) {
                if matches!(fate, Fate::NotTried) {
                    *fate = last;
                }
            }
        }
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
            tour.add(fates::tell(&deed, fate, report));
        }
        Ok(())
    }

    /// The changes and requests for a unit that holds this, if it takes them.
    fn ready(&self, place: &str, before: &Before) -> Result<Ready, CommandError> {
        let ready = self.job.ready(&before.scales)?;
        let allowed = self.job.allowed(&ready.0, &before.scales);
        allowed.map_err(|problem| CommandError::NotNow {
            place: place.to_owned(),
            problem,
        })?;
        Ok(ready)
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
        for warning in piecemeal(changes, planned) {
            report::warning(&warning);
        }
        Ok(())
    }

    /// The command that shows what was written; `None` where nothing of it can be read.
    fn find_out(&self, unit: Unit) -> Option<String> {
        let typed = self.job.points().zip(&self.arguments.what);
        let readable = typed.filter(|(point, _)| point.access.readable());
        // As they were typed: registers by address with their type.
        let names = readable.filter_map(|(_, what)| Some(what.split_once('=')?.0));
        let names: Vec<&str> = names.collect();
        if names.is_empty() {
            return None;
        }
        let line = self.line.typed();
        let meter = self.arguments.meter.as_ref();
        let meter = meter.map(|meter| format!(" --meter {}", quoted(meter)));
        let numbering = match self.arguments.numbering {
            NumberingChoice::Modicon => " --numbering modicon",
            NumberingChoice::Protocol => "",
        };
        Some(format!(
            "meterpoll read-registers {line} -a {unit}{}{numbering} {}",
            meter.unwrap_or_default(),
            names
                .iter()
                .map(|name| quoted(name))
                .collect::<Vec<_>>()
                .join(" ")
        ))
    }
}

/// Whether it is refused for a reason that does not lie in what could not be read.
fn is_known(ready: &Result<Ready, CommandError>) -> bool {
    match ready {
        Ok(_)
        | Err(CommandError::NotNow {
            problem: NotNow::Unknown { .. },
            ..
        }) => false,
        Err(CommandError::Assign(AssignError::Value { problem, .. })) => !matches!(
            **problem,
            EncodeError::NoScale { .. } | EncodeError::MeansNothing { .. }
        ),
        Err(_) => true,
    }
}

/// A word as a shell takes it.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "_./:=@,+-".contains(c);
    if word.chars().all(is_plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

/// What a point will read as.
fn figure(change: &Change, scales: &Scales) -> String {
    let value = change.point.interpret(&change.registers, scales);
    value.map_or_else(|_| "?".to_owned(), |value| value.to_string())
}

/// The same with its unit, where it is a number.
fn shown(change: &Change, scales: &Scales) -> String {
    let value = change.point.interpret(&change.registers, scales);
    let is_number = value.is_ok_and(|value| value.is_number());
    let figure = figure(change, scales);
    match &change.point.unit {
        Some(unit) if is_number => format!("{figure} {unit}"),
        _ => figure,
    }
}
