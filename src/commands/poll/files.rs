//! The files that rows go to, and the rows that are not there yet. What a file does not take is kept,
//! and tried again with the next rows.

use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, VecDeque};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use log::info;

use super::printer::lost;
use super::run::Course;
use crate::append::{AppendError, AppendOptions, Appender, Problem, Removed, Start};
use crate::commands::report::{self, Report};
use crate::commands::{CommandError, ExitCode};
use crate::transport::Clock;

/// What does not take rows is left alone so long before it is tried again.
const TRY_AGAIN: Duration = Duration::from_secs(2);

/// So many bytes of rows are kept for files that do not take them, all together.
const MOST_KEPT: usize = 4 * 1024 * 1024;

/// What a row takes beside its bytes, about.
const EACH: usize = 64;

/// Files that follow one another: those of an output and, where each meter has its own, of a meter.
pub(super) type Series = (usize, String);

/// Files, and rows that are not there yet.
pub(super) struct Files {
    clock: Arc<dyn Clock>,
    /// By output and path.
    open: BTreeMap<(usize, PathBuf), OpenFile>,
    /// What does not take rows, or did not take all.
    troubles: BTreeMap<Series, InTrouble>,
    /// The number of the next row.
    next: u64,
    /// What all rows take, and how much that may be.
    size: usize,
    most: usize,
}

/// A file that rows go to, and those that are not there yet.
struct OpenFile {
    series: Series,
    appender: Appender,
    rows: VecDeque<KeptRow>,
    left: Option<Left>,
}

/// What stands in a file although it could not be written.
struct Left {
    file: PathBuf,
    from: u64,
    bytes: Vec<u8>,
    /// The number behind that of the last of its rows.
    end: u64,
}

/// Whether it is known of all rows that they are in their file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Known {
    /// It is.
    Yes,
    /// Others changed the file, and what is not known was told.
    No,
}

/// A row that is in no file yet.
struct KeptRow {
    /// Those that came before it have lower ones.
    number: u64,
    bytes: Vec<u8>,
}

/// What is known of files that do not take rows.
struct InTrouble {
    /// The last of them.
    path: PathBuf,
    /// How many rows were given up since.
    lost: usize,
    /// When it is tried again.
    again: Duration,
}

impl Files {
    /// None yet. All rows of a single run are kept, for it has an end.
    pub(super) fn new(clock: Arc<dyn Clock>, course: Course) -> Self {
        Self {
            clock,
            open: BTreeMap::new(),
            troubles: BTreeMap::new(),
            next: 0,
            size: 0,
            most: match course {
                Course::Endless => MOST_KEPT,
                Course::Once { .. } => usize::MAX,
            },
        }
    }

    /// Takes the bytes of a row, to be written later.
    pub(super) fn row(
        &mut self,
        series: Series,
        path: PathBuf,
        bytes: Vec<u8>,
        begin: impl FnOnce() -> Result<(Start, AppendOptions), CommandError>,
    ) -> Result<(), CommandError> {
        let file = match self.open.entry((series.0, path)) {
            Entry::Occupied(file) => file.into_mut(),
            Entry::Vacant(place) => {
                let (start, options) = begin()?;
                let path = place.key().1.clone();
                place.insert(OpenFile {
                    series,
                    appender: Appender::new(path, start, options, Arc::clone(&self.clock)),
                    rows: VecDeque::new(),
                    left: None,
                })
            }
        };
        let number = self.next;
        self.next += 1;
        let row = KeptRow { number, bytes };
        self.size += row.size();
        file.rows.push_back(row);
        while self.size > self.most && self.give_up() {}
        Ok(())
    }

    /// Gives up the oldest row of all; returns whether there was one.
    fn give_up(&mut self) -> bool {
        let rows = self
            .open
            .iter_mut()
            .filter(|(_, file)| !file.rows.is_empty());
        let oldest = rows.min_by_key(|(_, file)| file.rows.front().map(|row| row.number));
        let Some(((_, path), file)) = oldest else {
            return false;
        };
        let Some(row) = file.rows.pop_front() else {
            return false;
        };
        self.size -= row.size();
        let trouble = self.troubles.entry(file.series.clone());
        let trouble = trouble.or_insert_with(|| InTrouble {
            path: path.clone(),
            lost: 0,
            again: Duration::ZERO,
        });
        trouble.lost += 1;
        if file.rows.is_empty() {
            let key = (file.series.0, path.clone());
            self.open.remove(&key);
        }
        true
    }

    /// Whether there is anything to write.
    pub(super) fn has_rows(&self) -> bool {
        !self.open.is_empty()
    }

    /// Writes what is not in its file yet. What goes wrong is told when it begins and when it is
    /// over, once for all files that follow one another.
    pub(super) fn flush(&mut self, report: &mut Report) {
        let now = self.clock.now();
        let (mut written, mut failed) = (BTreeMap::new(), BTreeMap::new());
        for ((_, path), file) in &mut self.open {
            let trouble = self.troubles.get(&file.series);
            // One that is locked has cost enough time.
            let was_locked = failed.get(&file.series) == Some(&true);
            if was_locked || trouble.is_some_and(|trouble| now < trouble.again) {
                continue;
            }
            let before = file.size();
            let appended = file.append();
            self.size -= before - file.size();
            match appended {
                Ok(_) => {
                    written.insert(file.series.clone(), path.clone());
                }
                Err(error) => {
                    let is_locked = matches!(error.problem, Problem::Locked { .. });
                    let is_first = failed.insert(file.series.clone(), is_locked).is_none();
                    if is_first && trouble.is_none() {
                        report.error(&CommandError::Append(error));
                    }
                    written
                        .entry(file.series.clone())
                        .or_insert_with(|| path.clone());
                }
            }
        }
        self.open.retain(|_, file| !file.rows.is_empty());
        let again = self.clock.now().saturating_add(TRY_AGAIN);
        for (series, path) in written {
            if failed.contains_key(&series) {
                let lost = self.troubles.get(&series).map_or(0, |trouble| trouble.lost);
                let trouble = InTrouble { path, lost, again };
                self.troubles.insert(series, trouble);
            } else if let Some(trouble) = self.troubles.remove(&series) {
                let path = path.display();
                match trouble.lost {
                    0 => report.remark(&format!("{path}: written again")),
                    rows => report::warning(&format!("{path}: written again; {}", lost(rows))),
                }
            }
        }
    }

    /// Writes what is left. Every file that does not take it is told, with the rows that are lost by
    /// that. Returns what to end with where there are such.
    pub(super) fn finish(&mut self, report: &mut Report) -> Option<ExitCode> {
        let mut worst = None;
        for file in self.open.values_mut() {
            match file.append() {
                Ok(Known::Yes) => {}
                Ok(Known::No) => worst = Some(ExitCode::Output),
                Err(error) => {
                    let lines = String::from_utf8_lossy(&file.bytes()).into_owned();
                    worst = Some(report.error(&CommandError::Unwritten { error, lines }));
                }
            }
        }
        self.open.clear();
        for trouble in self.troubles.values().filter(|trouble| trouble.lost > 0) {
            report::problem(&trouble.path.display().to_string(), &lost(trouble.lost));
            worst = Some(ExitCode::Output);
        }
        worst
    }
}

impl OpenFile {
    /// Appends all rows; returns whether it is known that all are there.
    fn append(&mut self) -> Result<Known, AppendError> {
        let known = self.undo()?;
        let mut tell = |file: &Path, removed: &Removed| report::removed(file, removed);
        let bytes = self.bytes();
        let file = match self.appender.append(&bytes, &mut tell) {
            Ok(file) => file,
            Err(error) => {
                self.left = error.problem.left_from().map(|from| Left {
                    file: error.file.clone(),
                    from,
                    bytes,
                    end: self.rows.back().map_or(0, |row| row.number + 1),
                });
                return Err(error);
            }
        };
        let file = std::path::absolute(&file).unwrap_or(file);
        info!("wrote {} bytes to {}", bytes.len(), file.display());
        self.rows.clear();
        Ok(known)
    }

    /// Removes what an earlier try has left, so that no row stands there twice. Where that cannot be
    /// known, its rows are told and dropped.
    fn undo(&mut self) -> Result<Known, AppendError> {
        let Some(left) = &self.left else {
            return Ok(Known::Yes);
        };
        let undone = self.appender.undo(&left.file, &left.bytes, left.from);
        match undone {
            Ok(()) => {
                self.left = None;
                Ok(Known::Yes)
            }
            Err(error) if matches!(error.problem, Problem::Changed) => {
                report::doubtful(&error, &String::from_utf8_lossy(&left.bytes));
                let end = left.end;
                self.left = None;
                let count = self.rows.partition_point(|row| row.number < end);
                self.rows.drain(..count);
                Ok(Known::No)
            }
            Err(error) => Err(error),
        }
    }

    fn size(&self) -> usize {
        self.rows.iter().map(KeptRow::size).sum()
    }

    fn bytes(&self) -> Vec<u8> {
        let rows: Vec<&[u8]> = self.rows.iter().map(|row| &*row.bytes).collect();
        rows.concat()
    }
}

impl KeptRow {
    const fn size(&self) -> usize {
        self.bytes.len() + EACH
    }
}
