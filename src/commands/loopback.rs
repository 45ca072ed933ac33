//! `loopback`: words to a unit and back, and whether the line is good.

mod advice;
mod run;

use std::io::{self, Write};
use std::time::Duration;

use self::run::Run;
use super::asking::{answered, units};
use super::open_line::LinePlan;
use super::report::Report;
use super::signals::Stop;
use super::{CommandError, ExitCode, print};
use crate::cli::{Loopback, LoopbackFormat};
use crate::client::{Echo, Patience};
use crate::codec::{FunctionCode, Request, Unit, rtu};
use crate::output::Heading;
use crate::output::loopback::LoopbackSink;
use crate::output::loopback::csv::Csv;
use crate::output::loopback::json::{Json, Settings};
use crate::output::loopback::table::Table;
use crate::profile::{Limits, LoopbackData, find};
use crate::readings::echo;
use crate::readings::loopback::word;

/// Tests the line to every unit and tells what comes of it.
pub(super) fn run(arguments: &Loopback, report: &mut Report) -> Result<ExitCode, CommandError> {
    let profile = arguments.meter.as_deref().map(find::find).transpose()?;
    let unknown = Limits::default();
    let limits = profile.as_ref().map_or(&unknown, |profile| &profile.limits);
    if let Some(profile) = profile.as_ref() {
        answered(profile, FunctionCode::Diagnostics)?;
    }
    let units = units(&arguments.unit, limits)?;
    if arguments.forever && units.len() > 1 {
        return Err(CommandError::NoEffect {
            option: "--forever",
            what: "one unit",
        });
    }
    let line = LinePlan::new(&arguments.line, profile.as_ref());
    let test = Test {
        meter: profile.as_ref().map_or("", |profile| &profile.name),
        probe: echo::probe(profile.as_ref()),
        data: limits.loopback_data,
        count: (!arguments.forever).then_some(arguments.count),
        interval: arguments.interval,
        patience: line.patience(limits),
        line: line.name(),
        format: arguments.format,
    };
    if arguments.dry_run {
        return print(test.frames(&units).as_bytes());
    }
    let mut sink = sink(&test, &line, units.len(), report.is_quiet());

    let echo = line.echo();
    // Where the line is said not to echo that is found out as well: on one that does, an echo would
    // pass for a meter.
    let mut client = match echo {
        Echo::On => line.open_with(Echo::On)?,
        Echo::Auto | Echo::Off => line.open_with(Echo::Auto)?,
    };
    // From here on a try is in hand; before, a signal ends the program where it is.
    let stop = Stop::listen();
    let mut run = Run::new(&test, echo, &stop);
    let result = run.all(&units, &mut client, sink.as_mut(), report);
    // Whatever became of it, no late answer is left to whoever opens the port next; a port that is
    // lost has none.
    let _ = client.finish();
    result?;
    Ok(stop.requested().unwrap_or_else(|| run.code()))
}

/// What every unit is put to.
struct Test<'a> {
    /// The meter's name; empty for an unknown one.
    meter: &'a str,
    /// The read that shows whether the line echoes.
    probe: Request,
    data: LoopbackData,
    /// How many tries a unit gets; `None` until stopped.
    count: Option<u64>,
    interval: Duration,
    patience: Patience,
    /// The line, `/dev/ttyUSB0 at 9600 8N1`.
    line: String,
    format: LoopbackFormat,
}

impl Test<'_> {
    /// What would be sent when all goes well.
    fn frames(&self, units: &[Unit]) -> String {
        let probe = units.first().map(|unit| (*unit, self.probe.clone()));
        let tries = units.iter().flat_map(|unit| {
            let numbers = 1..=self.count.unwrap_or_default();
            numbers.map(|number| {
                let word = word(self.data, number);
                (*unit, Request::ReturnQueryData(word))
            })
        });
        let requests = probe.into_iter().chain(tries);
        let frames = requests.map(|(unit, request)| rtu::encode_request(unit, &request));
        frames
            .flat_map(|frame| [frame.to_string(), "\n".to_owned()])
            .collect()
    }
}

fn sink(
    test: &Test<'_>,
    line: &LinePlan<'_>,
    units: usize,
    is_quiet: bool,
) -> Box<dyn LoopbackSink> {
    let out: Box<dyn Write> = Box::new(io::stdout().lock());
    match test.format {
        LoopbackFormat::Table => {
            let heading = match units {
                _ if !is_quiet => Heading::Full {
                    line: test.line.clone(),
                },
                0 | 1 => Heading::None,
                _ => Heading::Unit,
            };
            Box::new(Table::new(out, heading))
        }
        LoopbackFormat::Csv => Box::new(Csv::new(out)),
        LoopbackFormat::Json => {
            let settings = Settings {
                port: line.port().to_owned(),
                baud: line.settings.baud,
                parity: line.settings.parity.to_string(),
                stop_bits: line.settings.stop_bits.count(),
                timeout: test.patience.timeout,
                interval: test.interval,
                count: test.count,
            };
            Box::new(Json::new(out, settings))
        }
    }
}
