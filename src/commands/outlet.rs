//! Where rows go: to stdout, one by one, or into a file, all together.

use std::io::{self, Write};
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use log::info;

use super::{CommandError, report};
use crate::append::{AppendOptions, Appender, OnMisfit, Removed, Syncing};
use crate::cli::{FormatChoice, Layout, OutputArguments, ReadRegisters, SchemaChange};
use crate::output::csv::Names;
use crate::output::{
    Heading, Influx, Json, JsonLines, LineFormat, LongCsv, Sink, Stream, Table, WideCsv,
};
use crate::profile::Point;
use crate::readings::Row;
use crate::transport::SystemClock;

/// How long a file is waited for that another program has locked. It takes milliseconds to append
/// rows, and longer only where many wait for a slow disk.
const FILE_WAIT: Duration = Duration::from_secs(10);

/// Takes rows.
pub(super) trait Outlet {
    /// Takes one meter's readings.
    fn row(&mut self, points: &[Point], row: &Row) -> Result<(), CommandError>;

    /// There are no more rows for now.
    fn finish(&mut self) -> Result<(), CommandError>;
}

/// The format that was asked for, or is meant.
pub(super) fn format(arguments: &ReadRegisters) -> FormatChoice {
    arguments.format.unwrap_or(match arguments.output.output {
        Some(_) => FormatChoice::Csv,
        None => FormatChoice::Table,
    })
}

/// Where the rows of these points go as was asked. A file is looked at, and not made yet.
pub(super) fn open(
    arguments: &ReadRegisters,
    points: &[Point],
    heading: Heading,
) -> Result<Box<dyn Outlet>, CommandError> {
    let lines: Box<dyn LineFormat> = match (format(arguments), arguments.layout) {
        (FormatChoice::Table, _) => return Ok(Box::new(Stdout(Table::new(out(), heading)))),
        (FormatChoice::Json, _) => return Ok(Box::new(Stdout(Json::new(out())))),
        (FormatChoice::Csv, Some(Layout::Long)) => Box::new(LongCsv),
        (FormatChoice::Csv, _) if arguments.units => Box::new(WideCsv(Names::WithUnits)),
        (FormatChoice::Csv, _) => Box::new(WideCsv(Names::Bare)),
        (FormatChoice::Jsonl, _) => Box::new(JsonLines),
        (FormatChoice::Influx, _) => Box::new(Influx),
    };
    match &arguments.output.output {
        None => Ok(Box::new(Stdout(Stream::new(out(), lines)))),
        Some(path) => {
            let outlet = FileOutlet::open(path, &arguments.output, lines, points)?;
            Ok(Box::new(outlet))
        }
    }
}

fn out() -> impl Write {
    io::stdout().lock()
}

/// Each row at once.
struct Stdout<S>(S);

impl<S: Sink> Outlet for Stdout<S> {
    fn row(&mut self, points: &[Point], row: &Row) -> Result<(), CommandError> {
        self.0.row(points, row).map_err(CommandError::Output)
    }

    fn finish(&mut self) -> Result<(), CommandError> {
        self.0.finish().map_err(CommandError::Output)
    }
}

/// All rows together.
struct FileOutlet {
    format: Box<dyn LineFormat>,
    appender: Appender,
    lines: Vec<u8>,
}

impl FileOutlet {
    fn open(
        path: &Path,
        arguments: &OutputArguments,
        format: Box<dyn LineFormat>,
        points: &[Point],
    ) -> Result<Self, CommandError> {
        let start = format.start(points).map_err(CommandError::Output)?;
        let options = AppendOptions {
            on_misfit: match arguments.on_schema_change {
                SchemaChange::Refuse => OnMisfit::Refuse,
                SchemaChange::NewFile => OnMisfit::NewFile,
            },
            syncing: if arguments.no_sync {
                Syncing::Never
            } else {
                Syncing::Each
            },
            wait: FILE_WAIT,
        };
        let appender = Appender::new(path, start, options, Arc::new(SystemClock::new()));
        appender.check()?;
        Ok(Self {
            format,
            appender,
            lines: Vec::new(),
        })
    }
}

impl Outlet for FileOutlet {
    fn row(&mut self, points: &[Point], row: &Row) -> Result<(), CommandError> {
        let lines = self.format.lines(points, row);
        self.lines.extend(lines.map_err(CommandError::Output)?);
        Ok(())
    }

    fn finish(&mut self) -> Result<(), CommandError> {
        let lines = std::mem::take(&mut self.lines);
        let mut tell = |file: &Path, removed: &Removed| report::removed(file, removed);
        match self.appender.append(&lines, &mut tell) {
            Ok(file) => {
                let file = std::path::absolute(&file).unwrap_or(file);
                info!("wrote {} bytes to {}", lines.len(), file.display());
                Ok(())
            }
            Err(error) => {
                let lines = String::from_utf8_lossy(&lines).into_owned();
                Err(CommandError::Unwritten { error, lines })
            }
        }
    }
}
