//! `read-status`: the eight status bits of function 07, by name.

use std::io::{self, Write};

use super::asking::{answered, units};
use super::open_line::LinePlan;
use super::report::{self, Report};
use super::signals::Stop;
use super::{CommandError, ExitCode, print_frames};
use crate::cli::{ReadStatus, StatusFormat};
use crate::client::Client;
use crate::codec::{FunctionCode, Request, Response, Unit, rtu};
use crate::output::status::{Form, StatusRow, Statuses, bits};
use crate::profile::{Limits, find};
use crate::readings::Fault;

/// Reads and prints the status of every unit.
pub(super) fn run(arguments: &ReadStatus, report: &mut Report) -> Result<ExitCode, CommandError> {
    let profile = arguments.meter.as_deref().map(find::find).transpose()?;
    let profile = profile.as_ref();
    let limits = profile.map_or_else(Limits::default, |profile| profile.limits.clone());
    if let Some(profile) = profile {
        answered(profile, FunctionCode::ReadExceptionStatus)?;
    }
    let units = units(&arguments.unit, &limits)?;
    let line = LinePlan::new(&arguments.line, profile);
    if arguments.dry_run {
        let request = Request::ReadExceptionStatus;
        return print_frames(
            units
                .iter()
                .map(|unit| rtu::encode_request(*unit, &request)),
        );
    }
    let form = match arguments.format {
        StatusFormat::Table if report.is_quiet() => Form::Lines,
        StatusFormat::Table => Form::Table,
        StatusFormat::Csv => Form::Csv,
        StatusFormat::Json => Form::Json,
    };
    let mut sink = Statuses::new(io::stdout().lock(), bits(profile), form);
    let mut client = line.open()?;
    // From here on a row is in hand; before, a signal ends the program where it is.
    let stop = Stop::listen();
    let status = Status {
        meter: profile.map_or("", |profile| &profile.name),
        line: &line,
        limits: &limits,
    };
    let result = status.all(&units, &mut client, &mut sink, &stop, report);
    // Whatever became of it, no late answer is left to whoever opens the port next; a port that is
    // lost has none.
    let _ = client.finish();
    result.map(|code| stop.requested().unwrap_or(code))
}

/// What every unit is asked.
struct Status<'a> {
    meter: &'a str,
    line: &'a LinePlan<'a>,
    limits: &'a Limits,
}

impl Status<'_> {
    fn all(
        &self,
        units: &[Unit],
        client: &mut Client,
        sink: &mut Statuses<impl Write>,
        stop: &Stop,
        report: &mut Report,
    ) -> Result<ExitCode, CommandError> {
        let patience = self.line.patience(self.limits);
        let mut delivered = 0;
        let mut faults = Vec::new();
        for (index, unit) in units.iter().copied().enumerate() {
            let time = client.utc_now();
            let answer = client.request(unit, &Request::ReadExceptionStatus, patience);
            let bits = match answer {
                Ok(Response::ExceptionStatus(bits)) => {
                    delivered += 1;
                    Ok(bits)
                }
                // No other response answers this.
                Ok(_) => Err(Fault::Mismatch),
                Err(failure) => {
                    let place = format!("unit {unit} on {}, status", self.line.name());
                    report.status_failure(&place, &failure);
                    Err(Fault::from(&failure))
                }
            };
            faults.extend(bits.err());
            let meter = self.meter;
            let row = StatusRow {
                time,
                meter,
                unit,
                bits,
            };
            sink.row(&row).map_err(CommandError::Output)?;
            // Each of the others would look for a port that is lost as long.
            if stop.requested().is_some() || client.is_lost() {
                report::untried_units(units.len() - index - 1);
                break;
            }
        }
        sink.finish().map_err(CommandError::Output)?;
        Ok(ExitCode::of(delivered, &faults))
    }
}
