//! Where the rows of a poll go: to stdout at once, and into files when a line is idle. What a file
//! does not take is kept, and tried again with the next rows.

use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use jiff::Timestamp;
use log::info;

use super::printer::Printer;
use super::run::Course;
use crate::append::{AppendError, AppendOptions, Appender, OnMisfit, Removed, Start, Syncing};
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

/// A file that does not take rows is left alone so long before it is tried again.
const TRY_AGAIN: Duration = Duration::from_secs(2);

/// So many bytes of rows are kept for a file that does not take them.
const MOST_KEPT: usize = 4 * 1024 * 1024;

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
    course: Course,
    /// From the first row on.
    printer: Option<Printer>,
    /// The outputs whose header was printed.
    begun: BTreeSet<usize>,
    /// What to end with, where something went wrong that did not end it.
    worst: Option<ExitCode>,
    /// By output and path.
    files: BTreeMap<(usize, PathBuf), OpenFile>,
}

/// A file that rows go to, and those that are not there yet.
struct OpenFile {
    appender: Appender,
    format: Box<dyn LineFormat>,
    lines: Vec<u8>,
    health: Health,
}

/// Whether a file takes rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Health {
    /// It does, for all that is known.
    Good,
    /// It did not the last time.
    Failing {
        /// How many bytes were given up since.
        lost: usize,
        /// When it is tried again.
        again: Duration,
    },
}

impl<'a> Outlets<'a> {
    /// Looks at the files that the first rows will go to; makes none.
    pub(super) fn open(
        site: &'a Site,
        clock: Arc<dyn Clock>,
        on_stdout: OnStdout,
        course: Course,
    ) -> Result<Self, CommandError> {
        let mut outlets = Self {
            site,
            clock,
            on_stdout,
            wait: match course {
                Course::Endless => FILE_WAIT,
                Course::Once { within } => within.map_or(FILE_WAIT_ONCE, |w| w.min(FILE_WAIT_ONCE)),
            },
            course,
            printer: None,
            begun: BTreeSet::new(),
            worst: None,
            files: BTreeMap::new(),
        };
        let now = outlets.clock.utc_now();
        for job in &site.jobs {
            if let Some(output) = site.outputs.get(job.output)
                && let Some(path) = path(job, output, now)
            {
                outlets.file(job, output, path)?.appender.check()?;
            }
        }
        outlets.files.clear();
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
            let file = self.file(job, output, path)?;
            let lines = file.format.lines(&job.points, &cycle.row);
            file.lines.extend(lines.map_err(CommandError::Output)?);
            return Ok(());
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
        self.files.values().any(|file| !file.lines.is_empty())
    }

    /// Writes what is not in its file yet. What goes wrong is told when it begins and when it is
    /// over.
    pub(super) fn flush(&mut self, report: &mut Report) {
        for ((_, path), file) in &mut self.files {
            if let Health::Failing { lost, again } = file.health
                && self.clock.now() < again
            {
                let lost = lost + file.keep_within(MOST_KEPT);
                file.health = Health::Failing { lost, again };
                continue;
            }
            match (file.append(), file.health) {
                (Ok(()), Health::Good) => {}
                (Ok(()), Health::Failing { lost, .. }) => {
                    file.health = Health::Good;
                    let lost = match lost {
                        0 => String::new(),
                        lost => format!("; {lost} bytes of rows are lost"),
                    };
                    report.remark(&format!("{}: written again{lost}", path.display()));
                }
                (Err(error), health) => {
                    let before = match health {
                        Health::Failing { lost, .. } => lost,
                        Health::Good => {
                            report.error(&CommandError::Append(error));
                            0
                        }
                    };
                    let lost = before + file.keep_within(MOST_KEPT);
                    let again = self.clock.now().saturating_add(TRY_AGAIN);
                    file.health = Health::Failing { lost, again };
                }
            }
        }
        // The next rows of a site with times in its paths go to others.
        self.files.retain(|_, file| !file.lines.is_empty());
    }

    /// Writes what is left. Every file that does not take it is told, with the rows that are lost by
    /// that.
    /// Returns what to end with where there are such.
    pub(super) fn finish(&mut self, report: &mut Report, stop: &AtomicBool) -> Option<ExitCode> {
        let mut worst = self.worst;
        for ((_, path), file) in &mut self.files {
            if let Err(error) = file.append() {
                let lines = String::from_utf8_lossy(&file.lines).into_owned();
                worst = Some(report.error(&CommandError::Unwritten { error, lines }));
            }
            if let Health::Failing { lost, .. } = file.health
                && lost > 0
            {
                report::problem(
                    &path.display().to_string(),
                    &format!("{lost} bytes of rows are lost"),
                );
                worst = Some(ExitCode::Output);
            }
        }
        self.files.clear();
        let is_stopped = || stop.load(Ordering::Relaxed);
        let printed = self
            .printer
            .as_mut()
            .and_then(|printer| printer.finish(self.course, &is_stopped, &*self.clock, report));
        printed.or(worst)
    }

    /// The file of this path and output, which is not opened by that.
    fn file(
        &mut self,
        job: &Job,
        output: &SiteOutput,
        path: PathBuf,
    ) -> Result<&mut OpenFile, CommandError> {
        match self.files.entry((job.output, path)) {
            Entry::Occupied(file) => Ok(file.into_mut()),
            Entry::Vacant(place) => {
                let format = format(output.form);
                let start = format.start(&job.points).map_err(CommandError::Output)?;
                let path = place.key().1.clone();
                let clock = Arc::clone(&self.clock);
                let options = options(output, self.wait);
                Ok(place.insert(OpenFile {
                    appender: Appender::new(path, start, options, clock),
                    format,
                    lines: Vec::new(),
                    health: Health::Good,
                }))
            }
        }
    }
}

impl OpenFile {
    fn append(&mut self) -> Result<(), AppendError> {
        if self.lines.is_empty() {
            return Ok(());
        }
        let mut tell = |file: &Path, removed: &Removed| report::removed(file, removed);
        let file = self.appender.append(&self.lines, &mut tell)?;
        let file = std::path::absolute(&file).unwrap_or(file);
        info!("wrote {} bytes to {}", self.lines.len(), file.display());
        self.lines.clear();
        Ok(())
    }

    /// Gives up the oldest rows, whole ones, until no more than so many bytes are left; returns how
    /// many were given up.
    fn keep_within(&mut self, most: usize) -> usize {
        let over = self.lines.len().saturating_sub(most);
        if over == 0 {
            return 0;
        }
        let rest = self.lines.iter().skip(over);
        let to_line_end = rest.take_while(|byte| **byte != b'\n').count() + 1;
        let given_up = (over + to_line_end).min(self.lines.len());
        self.lines.drain(..given_up);
        given_up
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
    Some(path.at(&job.subject.name, time))
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
        let meter = if has_own { &*job.subject.name } else { "" };
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
