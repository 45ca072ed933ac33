//! `read-registers`: points of meters, once.

use std::collections::BTreeSet;
use std::io::{self, IsTerminal, Write};

use super::open_line::LinePlan;
use super::{CommandError, ExitCode, print, report};
use crate::cli::{FormatChoice, FunctionChoice, Layout, NumberingChoice, ReadRegisters};
use crate::codec::{FunctionCode, ReadFunction, Unit, rtu};
use crate::output::csv::CsvStyle;
use crate::output::{Json, JsonLines, LongCsv, Sink, Table, WideCsv};
use crate::profile::plan::Cost;
use crate::profile::selector::{Numbering, select};
use crate::profile::{Limits, Plan, Point, Profile, find};
use crate::readings;

/// Reads and prints what was asked for, unit by unit.
pub(super) fn run(arguments: &ReadRegisters, quiet: bool) -> Result<ExitCode, CommandError> {
    let profile = arguments.meter.as_deref().map(find::find).transpose()?;
    let line = LinePlan::new(&arguments.line, profile.as_ref());
    let limits = profile
        .as_ref()
        .map_or_else(Limits::default, |profile| profile.limits.clone());
    let units = units(arguments, &limits)?;
    let points = points(arguments, profile.as_ref())?;
    let function = function(arguments, profile.as_ref())?;
    let cost = Cost::new(line.settings, &limits);
    let plan = Plan::new(&points, function, &limits, cost);
    if arguments.dry_run {
        return print(frames(&units, &plan).as_bytes());
    }

    let mut client = line.open()?;
    let patience = line.patience(&limits);
    let meter = profile.as_ref().map_or("", |profile| profile.name.as_str());
    let name = line.name();
    let mut sink = sink(arguments, &name, quiet);
    let mut delivered = 0;
    let mut faults = Vec::new();
    for unit in units {
        let (row, failures) = readings::take(&mut client, unit, meter, &points, &plan, patience);
        let place = report::Place {
            line: &name,
            unit,
            attempts: patience.retries + 1,
        };
        for failure in &failures {
            report::failed(&place, failure, quiet);
        }
        sink.row(&points, &row).map_err(CommandError::Output)?;
        faults.extend(row.faults());
        delivered += row.readings.len() - row.faults().count();
    }
    sink.finish().map_err(CommandError::Output)?;
    Ok(ExitCode::of(delivered, &faults))
}

fn units(arguments: &ReadRegisters, limits: &Limits) -> Result<Vec<Unit>, CommandError> {
    let numbers = arguments.unit.0.iter();
    numbers
        .map(|number| Unit::new(*number, limits.units).map_err(CommandError::Unit))
        .collect()
}

fn points(
    arguments: &ReadRegisters,
    profile: Option<&Profile>,
) -> Result<Vec<Point>, CommandError> {
    let numbering = match arguments.numbering {
        NumberingChoice::Protocol => Numbering::Protocol,
        NumberingChoice::Modicon => Numbering::Modicon,
    };
    let points = select(&arguments.what, numbering, profile)?;
    let is_wide_csv = arguments.format == FormatChoice::Csv && arguments.layout == Layout::Wide;
    if is_wide_csv {
        let mut names = BTreeSet::new();
        if let Some(point) = points.iter().find(|point| !names.insert(&point.name)) {
            let name = point.name.clone();
            return Err(CommandError::ColumnClash { name });
        }
    }
    Ok(points)
}

/// The function typed, as far as the meter answers it; else the meter's own.
fn function(
    arguments: &ReadRegisters,
    profile: Option<&Profile>,
) -> Result<ReadFunction, CommandError> {
    let typed = arguments.function.map(|function| match function {
        FunctionChoice::HoldingRegisters => ReadFunction::HoldingRegisters,
        FunctionChoice::InputRegisters => ReadFunction::InputRegisters,
    });
    let Some(profile) = profile else {
        return Ok(typed.unwrap_or_default());
    };
    let Some(function) = typed else {
        return Ok(profile.limits.read_function());
    };
    let code = FunctionCode::from(function);
    if !profile.limits.functions.contains(&code) {
        return Err(CommandError::Function {
            meter: profile.name.clone(),
            code: code.get(),
        });
    }
    Ok(function)
}

/// The requests as they would go out, one a line.
fn frames(units: &[Unit], plan: &Plan) -> String {
    let requests = units.iter().flat_map(|unit| {
        plan.reads
            .iter()
            .map(|read| rtu::encode_request(*unit, &read.request()))
    });
    requests
        .flat_map(|frame| [frame.to_string(), "\n".to_owned()])
        .collect()
}

fn sink(arguments: &ReadRegisters, line: &str, quiet: bool) -> Box<dyn Sink> {
    let out = io::stdout();
    let style = CsvStyle {
        units: arguments.units,
        terminal: out.is_terminal(),
    };
    let out: Box<dyn Write> = Box::new(out.lock());
    match (arguments.format, arguments.layout) {
        (FormatChoice::Table, _) => Box::new(Table::new(out, (!quiet).then(|| line.to_owned()))),
        (FormatChoice::Csv, Layout::Wide) => Box::new(WideCsv::new(out, style)),
        (FormatChoice::Csv, Layout::Long) => Box::new(LongCsv::new(out, style)),
        (FormatChoice::Json, _) => Box::new(Json::new(out)),
        (FormatChoice::Jsonl, _) => Box::new(JsonLines::new(out)),
    }
}
