//! `read-registers`: points of meters, once.

use std::collections::BTreeSet;

use super::asking::{Asking, answered, numbering, units};
use super::open_line::LinePlan;
use super::outlet::{self, Outlet};
use super::report::{self, Report};
use super::show_plan::ShownPlan;
use super::signals::Stop;
use super::{CommandError, ExitCode, print};
use crate::cli::{FormatChoice, FunctionChoice, Layout, ReadRegisters};
use crate::client::Client;
use crate::codec::{ReadFunction, Unit};
use crate::output::Heading;
use crate::output::csv::WIDE_COLUMNS;
use crate::output::influx::INFLUX_NAMES;
use crate::profile::selector::{Reading, select};
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

    let heading = match units.len() {
        _ if !report.is_quiet() => Heading::Full {
            line: asking.line.clone(),
        },
        0 | 1 => Heading::None,
        _ => Heading::Unit,
    };
    // Before anything is sent: where the rows cannot go, none are taken.
    let mut outlet = outlet::open(arguments, &points, heading)?;
    let mut client = line.open()?;
    // From here on a row is in hand; before, a signal ends the program where it is.
    let stop = Stop::listen();
    let result = read(&mut *outlet, &units, &asking, &stop, &mut client, report);
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
    outlet: &mut dyn Outlet,
    units: &[Unit],
    asking: &Asking<'_>,
    stop: &Stop,
    client: &mut Client,
    report: &mut Report,
) -> Result<ExitCode, CommandError> {
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
        outlet.row(asking.points, &row)?;
        faults.extend(row.faults());
        delivered += row.readings.len() - row.faults().count();
        if stop.requested().is_some() {
            break;
        }
    }
    outlet.finish()?;
    if untried > 0 {
        report::untried_units(untried);
    }
    Ok(ExitCode::of(delivered, &faults))
}

/// Refuses options that would do nothing.
fn effects(arguments: &ReadRegisters) -> Result<(), CommandError> {
    let format = outlet::format(arguments);
    let is_csv = format == FormatChoice::Csv;
    let is_lines = !matches!(format, FormatChoice::Table | FormatChoice::Json);
    let no_effect = |option, what| Err(CommandError::NoEffect { option, what });
    match arguments.layout {
        Some(_) if arguments.plan => no_effect("--layout", "readings"),
        _ if arguments.plan && arguments.units => no_effect("--units", "readings"),
        _ if arguments.plan && arguments.output.output.is_some() => {
            no_effect("--output", "readings")
        }
        _ if arguments.plan && format != FormatChoice::Table => no_effect("--format", "readings"),
        _ if arguments.output.output.is_some() && !is_lines => {
            no_effect("--output", "--format csv, jsonl or influx")
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
        numbering: numbering(arguments.numbering),
        function: typed_function(arguments),
        profile,
        ..Reading::default()
    };
    let points = select(&arguments.what, reading)?;
    if let Some(profile) = profile {
        for function in points.iter().filter_map(|point| point.function) {
            answered(profile, function.into())?;
        }
        let is_heard = profile.limits.interchangeable_reads
            || points.iter().any(|point| point.function.is_some());
        if arguments.function.is_some() && !is_heard {
            return Err(CommandError::NoEffect {
                option: "--function",
                what: "registers by address, or a meter whose functions 03 and 04 are one",
            });
        }
    }
    let (format, taken): (_, &[&str]) = match (outlet::format(arguments), arguments.layout) {
        (FormatChoice::Csv, None | Some(Layout::Wide)) => ("wide CSV", &WIDE_COLUMNS),
        (FormatChoice::Influx, _) => ("Influx line protocol", &INFLUX_NAMES),
        _ => return Ok(points),
    };
    let mut names: BTreeSet<&str> = taken.iter().copied().collect();
    if let Some(point) = points.iter().find(|point| !names.insert(&point.name)) {
        let name = point.name.clone();
        return Err(CommandError::ColumnClash { name, format });
    }
    Ok(points)
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
