//! `read-registers`: points of meters, once.

use std::collections::BTreeSet;
use std::io::{self, IsTerminal, Write};

use super::asking::{Asking, units};
use super::open_line::LinePlan;
use super::report::{self, Report};
use super::show_plan::ShownPlan;
use super::signals::Stop;
use super::{CommandError, ExitCode, print};
use crate::cli::{FormatChoice, FunctionChoice, Layout, NumberingChoice, ReadRegisters};
use crate::client::Client;
use crate::codec::{FunctionCode, ReadFunction, Unit};
use crate::output::csv::{CsvStyle, WIDE_COLUMNS};
use crate::output::{Heading, Json, JsonLines, LongCsv, Sink, Table, WideCsv};
use crate::profile::selector::{Numbering, Reading, select};
use crate::profile::{Limits, Point, Profile, find};
use crate::readings::{Fault, Row};

/// Reads and prints what was asked for, unit by unit.
pub(super) fn run(
    arguments: &ReadRegisters,
    report: &mut Report,
) -> Result<ExitCode, CommandError> {
    effects(arguments)?;
    let profile = arguments.meter.as_deref().map(find::find).transpose()?;
    let line = LinePlan::new(&arguments.line, profile.as_ref());
    let limits = profile
        .as_ref()
        .map_or_else(Limits::default, |profile| profile.limits.clone());
    let units = units(&arguments.unit, &limits)?;
    let points = points(arguments, profile.as_ref())?;
    let function = function(arguments, &limits);
    let mut asking = Asking::new(&line, profile.as_ref(), &points, function);
    // Who names a function gets that one.
    asking.patience.ways.interchangeable_reads &= arguments.function.is_none();
    if arguments.dry_run || arguments.plan {
        return show(arguments, &line, &units, &asking);
    }

    let mut client = line.open()?;
    // From here on a row is in hand; before, a signal ends the program where it is.
    let stop = Stop::listen();
    let result = read(arguments, &units, &asking, &stop, &mut client, report);
    // Whatever became of it, no late answer is left to whoever opens the port next; a port that is
    // lost has none.
    let _ = client.finish();
    result.map(|code| stop.requested().unwrap_or(code))
}

/// Prints what would be sent, and sends nothing.
fn show(
    arguments: &ReadRegisters,
    line: &LinePlan<'_>,
    units: &[Unit],
    asking: &Asking<'_>,
) -> Result<ExitCode, CommandError> {
    let besides: Vec<Point> = asking.setup.besides(asking.points).cloned().collect();
    let all = [asking.points, &besides].concat();
    let shown = ShownPlan {
        units,
        points: &all,
        besides: &besides,
        plan: &asking.plan(&all),
        settings: line.settings,
        pause: asking.patience.pause,
        cost: asking.cost,
    };
    let text = if arguments.plan {
        shown.to_string()
    } else {
        shown.frames()
    };
    print(text.as_bytes())
}

/// Reads every unit once.
fn read(
    arguments: &ReadRegisters,
    units: &[Unit],
    asking: &Asking<'_>,
    stop: &Stop,
    client: &mut Client,
    report: &mut Report,
) -> Result<ExitCode, CommandError> {
    let heading = match units.len() {
        _ if !report.is_quiet() => Heading::Full {
            line: asking.line.clone(),
        },
        0 | 1 => Heading::None,
        _ => Heading::Unit,
    };
    let mut sink = sink(arguments, heading);
    let mut delivered = 0;
    let mut faults = Vec::new();
    // A lost port is looked for by the next unit; where it does not come back, each of the others
    // would look for it in vain as long.
    let mut is_away = false;
    let mut untried = 0;
    for unit in units.iter().copied() {
        let row = if is_away {
            untried += 1;
            let count = asking.points.len();
            Row::missing(client.utc_now(), asking.meter, unit, count, Fault::Port)
        } else {
            let taken = asking.ask(unit, client, report);
            is_away = taken.is_port_away();
            taken.row
        };
        sink.row(asking.points, &row)
            .map_err(CommandError::Output)?;
        faults.extend(row.faults());
        delivered += row.readings.len() - row.faults().count();
        if stop.requested().is_some() {
            break;
        }
    }
    sink.finish().map_err(CommandError::Output)?;
    if untried > 0 {
        report::untried_units(untried);
    }
    Ok(ExitCode::of(delivered, &faults))
}

/// Refuses options that would do nothing.
fn effects(arguments: &ReadRegisters) -> Result<(), CommandError> {
    let is_csv = arguments.format == FormatChoice::Csv;
    let no_effect = |option, what| Err(CommandError::NoEffect { option, what });
    match arguments.layout {
        Some(_) if arguments.plan => no_effect("--layout", "readings"),
        _ if arguments.plan && arguments.units => no_effect("--units", "readings"),
        _ if arguments.plan && arguments.format != FormatChoice::Table => {
            no_effect("--format", "readings")
        }
        Some(_) if !is_csv => no_effect("--layout", "--format csv"),
        Some(Layout::Long) if arguments.units => no_effect("--units", "wide CSV"),
        _ if arguments.units && !is_csv => no_effect("--units", "--format csv"),
        _ => Ok(()),
    }
}

fn points(
    arguments: &ReadRegisters,
    profile: Option<&Profile>,
) -> Result<Vec<Point>, CommandError> {
    let reading = Reading {
        numbering: match arguments.numbering {
            NumberingChoice::Protocol => Numbering::Protocol,
            NumberingChoice::Modicon => Numbering::Modicon,
        },
        function: typed_function(arguments),
        profile,
        ..Reading::default()
    };
    let points = select(&arguments.what, reading)?;
    if let Some(profile) = profile {
        answered(&points, profile)?;
        let is_heard = profile.limits.interchangeable_reads
            || points.iter().any(|point| point.function.is_some());
        if arguments.function.is_some() && !is_heard {
            return Err(CommandError::NoEffect {
                option: "--function",
                what: "registers by address, or a meter whose functions 03 and 04 are one",
            });
        }
    }
    if arguments.format == FormatChoice::Csv && arguments.layout != Some(Layout::Long) {
        let mut names: BTreeSet<&str> = WIDE_COLUMNS.into();
        if let Some(point) = points.iter().find(|point| !names.insert(&point.name)) {
            let name = point.name.clone();
            return Err(CommandError::ColumnClash { name });
        }
    }
    Ok(points)
}

/// Whether the meter answers the functions that points need.
fn answered(points: &[Point], profile: &Profile) -> Result<(), CommandError> {
    let needed = points.iter().filter_map(|point| point.function);
    for code in needed.map(FunctionCode::from) {
        if !profile.limits.functions.contains(&code) {
            return Err(CommandError::Function {
                meter: profile.name.clone(),
                code: code.get(),
            });
        }
    }
    Ok(())
}

fn typed_function(arguments: &ReadRegisters) -> Option<ReadFunction> {
    arguments.function.map(|function| match function {
        FunctionChoice::HoldingRegisters => ReadFunction::HoldingRegisters,
        FunctionChoice::InputRegisters => ReadFunction::InputRegisters,
    })
}

/// The function for points that have none of their own: the meter's, or the one typed where the
/// meter takes both for one.
fn function(arguments: &ReadRegisters, limits: &Limits) -> ReadFunction {
    typed_function(arguments)
        .filter(|_| limits.interchangeable_reads)
        .unwrap_or_else(|| limits.read_function())
}

fn sink(arguments: &ReadRegisters, heading: Heading) -> Box<dyn Sink> {
    let out = io::stdout();
    let style = CsvStyle {
        units: arguments.units,
        terminal: out.is_terminal(),
    };
    let out: Box<dyn Write> = Box::new(out.lock());
    match (arguments.format, arguments.layout) {
        (FormatChoice::Table, _) => Box::new(Table::new(out, heading)),
        (FormatChoice::Csv, Some(Layout::Long)) => Box::new(LongCsv::new(out, style)),
        (FormatChoice::Csv, _) => Box::new(WideCsv::new(out, style)),
        (FormatChoice::Json, _) => Box::new(Json::new(out)),
        (FormatChoice::Jsonl, _) => Box::new(JsonLines::new(out)),
    }
}
