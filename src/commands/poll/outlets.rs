//! Where the rows of a poll go: to stdout at once, and into files when a line is idle.

use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};
use std::io::ErrorKind;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use jiff::Timestamp;

use super::files::{Files, Series};
use super::printer::Printer;
use super::run::Course;
use crate::append::{AppendOptions, Appender, OnMisfit, Start, Syncing};
use crate::commands::report::{self, Report};
use crate::commands::{CommandError, ExitCode};
use crate::output::csv::{Names, WIDE_COLUMNS};
use crate::output::influx::INFLUX_NAMES;
use crate::output::{Influx, JsonLines, LineFormat, LongCsv, WideCsv};
use crate::polling::site::{
    ColumnUnits, FailedRows, OnSchemaChange, PathTemplate, RowForm, RowSync,
};
use crate::polling::{Cycle, Job, Site, SiteOutput};
use crate::transport::Clock;

/// How long a file is waited for that another program has locked: meanwhile nobody else is written
/// for.
const FILE_WAIT: Duration = Duration::from_secs(1);

/// The same where everything is read once: nobody is kept waiting by that.
const FILE_WAIT_ONCE: Duration = Duration::from_secs(10);

/// Whether rows without a file are printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum OnStdout {
    /// They are.
    Rows,
    /// A live table is there in their place.
    Table,
}

/// Where rows go.
pub(super) struct Outlets<'a> {
    site: &'a Site,
    clock: Arc<dyn Clock>,
    on_stdout: OnStdout,
    /// How long a locked file is waited for.
    wait: Duration,
    /// When the run is to be over; at once where it has no end of its own.
    end: Option<Duration>,
    /// From the first row on.
    printer: Option<Printer>,
    /// The outputs whose header was printed.
    begun: BTreeSet<usize>,
    /// What to end with, where something went wrong that did not end it.
    worst: Option<ExitCode>,
    files: Files,
}

impl<'a> Outlets<'a> {
    /// Looks at the files that the first rows will go to; makes none.
    pub(super) fn open(
        site: &'a Site,
        clock: Arc<dyn Clock>,
        on_stdout: OnStdout,
        course: Course,
    ) -> Result<Self, CommandError> {
        let outlets = Self {
            site,
            on_stdout,
            wait: match course {
                Course::Endless => FILE_WAIT,
                Course::Once { within } => within.map_or(FILE_WAIT_ONCE, |w| w.min(FILE_WAIT_ONCE)),
            },
            end: match course {
                Course::Endless => Some(Duration::ZERO),
                Course::Once { within } => within.map(|within| clock.now().saturating_add(within)),
            },
            printer: None,
            begun: BTreeSet::new(),
            worst: None,
            files: Files::new(Arc::clone(&clock), course),
            clock,
        };
        let now = outlets.clock.utc_now();
        for job in &site.jobs {
            if let Some(output) = site.outputs.get(job.output)
                && let Some(path) = path(job, output, now)
            {
                let (start, options) = beginning(job, output, outlets.wait)?;
                let clock = Arc::clone(&outlets.clock);
                Appender::new(path, start, options, clock).check()?;
            }
        }
        Ok(outlets)
    }

    /// Takes a row.
    pub(super) fn row(&mut self, cycle: &Cycle) -> Result<(), CommandError> {
        let site = self.site;
        let Some((job, output)) = parts(site, cycle) else {
            return Ok(());
        };
        let is_empty = cycle.row.readings.iter().all(Result::is_err);
        if is_empty && output.failed == FailedRows::Skipped {
            return Ok(());
        }
        if let Some(path) = path(job, output, cycle.row.time) {
            let lines = format(output.form).lines(&job.points, &cycle.row);
            let lines = lines.map_err(CommandError::Output)?;
            let wait = self.wait;
            let begin = || beginning(job, output, wait);
            return self.files.row(series(job, output), path, lines, begin);
        }
        if self.on_stdout == OnStdout::Table {
            return Ok(());
        }
        let format = format(output.form);
        let is_first = !self.begun.contains(&job.output);
        let mut bytes = if is_first {
            format
                .start(&job.points)
                .map_err(CommandError::Output)?
                .head()
        } else {
            Vec::new()
        };
        let lines = format.lines(&job.points, &cycle.row);
        bytes.extend(lines.map_err(CommandError::Output)?);
        let printer = self
            .printer
            .get_or_insert_with(|| Printer::start(site.jobs.len()));
        if printer.row(bytes) {
            self.begun.insert(job.output);
        }
        Ok(())
    }

    /// Looks after stdout.
    ///
    /// # Errors
    /// Where it takes nothing any more, and rows go nowhere else.
    pub(super) fn look(&mut self, report: &mut Report) -> Result<(), CommandError> {
        let Some(Err(error)) = self.printer.as_mut().map(Printer::look) else {
            return Ok(());
        };
        if self.site.outputs.iter().all(|output| output.path.is_none()) {
            return Err(error);
        }
        match &error {
            CommandError::Output(cause) if cause.kind() == ErrorKind::BrokenPipe => {
                report::warning("stdout was closed: no more rows go there");
                self.worst = Some(ExitCode::Output);
            }
            error => self.worst = Some(report.error(error)),
        }
        Ok(())
    }

    /// Whether there is anything to write.
    pub(super) fn has_rows(&self) -> bool {
        self.files.has_rows()
    }

    /// Writes what is not in its file yet. What goes wrong is told when it begins and when it is
    /// over.
    pub(super) fn flush(&mut self, report: &mut Report) {
        self.files.flush(report);
    }

    /// Writes what is left. Every file that does not take it is told, with the rows that are lost by
    /// that.
    /// Returns what to end with where there are such.
    pub(super) fn finish(&mut self, report: &mut Report, stop: &AtomicBool) -> Option<ExitCode> {
        let written = self.files.finish(report).or(self.worst);
        let is_stopped = || stop.load(Ordering::Relaxed);
        let printed = self
            .printer
            .as_mut()
            .and_then(|printer| printer.finish(self.end, &is_stopped, &*self.clock, report));
        printed.or(written)
    }
}

/// What was read, and where its row goes.
fn parts<'a>(site: &'a Site, cycle: &Cycle) -> Option<(&'a Job, &'a SiteOutput)> {
    let job = site.jobs.get(cycle.job)?;
    Some((job, site.outputs.get(job.output)?))
}

/// The file for a row of this time; `None` is stdout.
fn path(job: &Job, output: &SiteOutput, time: Timestamp) -> Option<PathBuf> {
    let path = output.path.as_ref()?;
    Some(path.at(&job.subject.file_name, time))
}

/// Which files follow one another.
fn series(job: &Job, output: &SiteOutput) -> Series {
    let path = output.path.as_ref();
    let has_own = path.is_some_and(PathTemplate::names_the_meter);
    let meter = if has_own { &*job.subject.name } else { "" };
    (job.output, meter.to_owned())
}

/// How a file begins that such rows go to, and how they do.
fn beginning(
    job: &Job,
    output: &SiteOutput,
    wait: Duration,
) -> Result<(Start, AppendOptions), CommandError> {
    let start = format(output.form).start(&job.points);
    Ok((start.map_err(CommandError::Output)?, options(output, wait)))
}

fn options(output: &SiteOutput, wait: Duration) -> AppendOptions {
    AppendOptions {
        on_misfit: match output.on_schema_change {
            OnSchemaChange::Refuse => OnMisfit::Refuse,
            OnSchemaChange::NewFile => OnMisfit::NewFile,
        },
        syncing: match output.syncing {
            RowSync::Each => Syncing::Each,
            RowSync::Never => Syncing::Never,
        },
        wait,
    }
}

fn format(form: RowForm) -> Box<dyn LineFormat> {
    match form {
        RowForm::WideCsv(ColumnUnits::Left) => Box::new(WideCsv(Names::Bare)),
        RowForm::WideCsv(ColumnUnits::Shown) => Box::new(WideCsv(Names::WithUnits)),
        RowForm::LongCsv => Box::new(LongCsv),
        RowForm::JsonLines => Box::new(JsonLines),
        RowForm::Influx => Box::new(Influx),
    }
}

/// Whether all rows that go to one place have the same columns, each of them once.
pub(super) fn columns(site: &Site) -> Result<(), CommandError> {
    let mut heads: BTreeMap<(usize, &str), (Start, &Job)> = BTreeMap::new();
    for job in &site.jobs {
        let Some(output) = site.outputs.get(job.output) else {
            continue;
        };
        distinct(job, output.form)?;
        let start = format(output.form).start(&job.points);
        let start = start.map_err(CommandError::Output)?;
        let has_own = output
            .path
            .as_ref()
            .is_some_and(PathTemplate::names_the_meter);
        let meter = if has_own { &*job.subject.file_name } else { "" };
        match heads.entry((job.output, meter)) {
            Entry::Vacant(place) => drop(place.insert((start, job))),
            Entry::Occupied(first) if first.get().0 != start => {
                let path = output.path.as_ref().map(|path| path.text().to_owned());
                return Err(CommandError::Columns {
                    first: first.get().1.subject.to_string(),
                    second: job.subject.to_string(),
                    place: path.unwrap_or_else(|| "stdout".to_owned()),
                });
            }
            Entry::Occupied(_) => {}
        }
    }
    Ok(())
}

/// Whether each column of a row is there once.
fn distinct(job: &Job, form: RowForm) -> Result<(), CommandError> {
    let (format, taken): (_, &[&str]) = match form {
        RowForm::WideCsv(_) => ("wide CSV", &WIDE_COLUMNS),
        RowForm::Influx => ("Influx line protocol", &INFLUX_NAMES),
        RowForm::LongCsv | RowForm::JsonLines => return Ok(()),
    };
    let mut names: BTreeSet<&str> = taken.iter().copied().collect();
    match job.points.iter().find(|point| !names.insert(&point.name)) {
        Some(point) => Err(CommandError::ColumnClash {
            name: point.name.clone(),
            format,
        }),
        None => Ok(()),
    }
}
