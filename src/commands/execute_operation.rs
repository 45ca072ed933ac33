//! `execute-operation`: what a meter does when it is told to.

mod list;
pub(super) mod telling;

use self::telling::Telling;
use log::info;

use super::asking::{Asking, units};
use super::careful::Consent;
use super::fates::{self, Deed};
use super::open_line::LinePlan;
use super::report::{self, Report};
use super::tour::Tour;
use super::{CommandError, ExitCode, print, print_frames};
use crate::cli::ExecuteOperation;
use crate::client::Client;
use crate::codec::{Request, Unit, rtu};
use crate::profile::writing::Broadcasting;
use crate::profile::{Profile, Setup, find};
use crate::readings::Fault;
use crate::transport::{Clock, SystemClock};
use crate::writing::before::allowed;
use crate::writing::{Receipt, before, check};

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
    if telling.operation.broadcast == Broadcasting::Only {
        let name = telling.operation.name.clone();
        return Err(CommandError::BroadcastOnly { name });
    }
    let units = units(unit, &profile.limits)?;
    let line = LinePlan::new(&arguments.line, Some(&profile));
    if arguments.care.dry_run {
        let request = Request::Write(telling.write(SystemClock::new().utc_now())?);
        return print_frames(
            units
                .iter()
                .map(|unit| rtu::encode_request(*unit, &request)),
        );
    }
    let hazards = telling.hazard().into_iter().collect();
    let consent = Consent::of(hazards, arguments.care)?;
    let mut asking = Asking::new(&line, Some(&profile), &[], profile.limits.read_function());
    let with = telling.operation.only_with.as_ref();
    let with = with.and_then(|with| profile.point(&with.point));
    asking.setup = Setup::default().with(with.cloned());
    let mut client = line.open()?;
    let task = Task {
        profile: &profile,
        telling: &telling,
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

/// Telling under way.
struct Task<'a> {
    profile: &'a Profile,
    telling: &'a Telling<'a>,
    asking: &'a Asking<'a>,
}

impl Task<'_> {
    fn unit(
        &self,
        unit: Unit,
        tour: &mut Tour<'_>,
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
            tour.add(ExitCode::of(0, &[Fault::from(failure)]));
            return Ok(());
        }
        let scales = before.map(|before| before.scales).unwrap_or_default();
        let with = operation.only_with.as_ref();
        let allowed = allowed(&operation.name, "carried out", with, &scales, self.profile);
        allowed.map_err(|problem| CommandError::NotNow {
            place: place.clone(),
            problem,
        })?;
        if tour.is_stopped() {
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
        tour.begin(&place, client)?;
        let write = self.telling.write(client.utc_now())?;
        // What could be made once can be made always.
        let make = |now| self.telling.write(now).unwrap_or_else(|_| write.clone());
        let request = Request::Write(write.clone());
        info!(
            "unit {unit}: writing {}",
            rtu::encode_request(unit, &request)
        );
        let result = client.write_made(unit, &make, self.asking.patience);
        let fate = check::unread(Receipt::of(result));
        let deed = Deed {
            place: &place,
            name: &operation.name,
            value: None,
            done: "done",
            find_out: None,
        };
        tour.add(fates::tell(&deed, &fate, report));
        Ok(())
    }
}
