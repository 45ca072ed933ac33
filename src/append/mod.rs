//! Rows appended to files that others read and append to as well: none is lost, torn or mixed with
//! another, and none stands under columns that are not its own.
//!
//! It knows bytes, lines, headers and files, and nothing of readings. Each [`Appender::append`]
//! stands for itself: it opens the file, takes its lock, looks at what is there, writes all rows in
//! one go and lets go again. So others may append in between, and a file that was renamed, deleted,
//! replaced or cut to nothing is found out by itself, and begins with its header.
//!
//! * [`Start`] is how a file of such rows begins; [`Misfit`] is why one is not such a file.
//! * [`commit`] is what happens under the lock, on anything that is a [`Store`]; [`undo`] removes what
//!   one that failed has left.
//! * `system` opens, locks and makes files; `numbered` has the names to go on with.
//!
//! The lock is `flock`: on a file server it holds where the server keeps locks, and where a file
//! cannot be locked nothing is written to it.

mod cells;
mod commit;
mod error;
mod examine;
mod lock;
mod numbered;
mod start;
mod store;
mod system;
mod tail;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use crate::transport::Clock;

pub use commit::{commit, undo};
pub use error::{AppendError, Kept, Problem};
pub use start::{Misfit, Start};
pub use store::Store;
pub use tail::Removed;

/// So often is a file opened that is another one as soon as its lock is there.
const TRIES: usize = 100;

/// Appends rows to a file.
pub struct Appender {
    path: PathBuf,
    start: Start,
    options: AppendOptions,
    clock: Arc<dyn Clock>,
}

/// How rows are appended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AppendOptions {
    /// What to do about a file that begins in another way.
    pub on_misfit: OnMisfit,
    /// Whether rows survive a power cut.
    pub syncing: Syncing,
    /// How long to wait for a file that another program has locked.
    pub wait: Duration,
}

/// What to do about a file that holds something else than such rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OnMisfit {
    /// Nothing is written.
    Refuse,
    /// The rows go to `name.2.csv`, `name.3.csv` and on: the first that fits, is empty or is not
    /// there.
    NewFile,
}

/// Whether rows are on the disk, not on their way to it, when they are said to be written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Syncing {
    /// They are, and so is the name of a new file.
    Each,
    /// They are when the system comes to it: less wear of flash memory.
    Never,
}

impl Appender {
    /// For rows that belong into files beginning so, and so into `path` and no other unless it does
    /// not fit. Nothing is opened yet.
    pub fn new(
        path: impl Into<PathBuf>,
        start: Start,
        options: AppendOptions,
        clock: Arc<dyn Clock>,
    ) -> Self {
        Self {
            path: path.into(),
            start,
            options,
            clock,
        }
    }

    /// Whether rows could be appended now. Changes nothing, and makes nothing.
    ///
    /// # Errors
    /// As [`Self::append`] would, but for what shows only when it is done: a full disk, say.
    pub fn check(&self) -> Result<(), AppendError> {
        self.first_fitting(|file| self.check_at(file)).map(drop)
    }

    /// Appends whole lines, all or none, and returns which file they went to. No lines are no work.
    /// A tail that was never finished is cut off first; `tell` is told.
    ///
    /// # Errors
    /// Says which file it is about. But for [`Kept::Unknown`] it is as it was before, apart from the
    /// tail.
    pub fn append(
        &self,
        lines: &[u8],
        tell: &mut dyn FnMut(&Path, &Removed),
    ) -> Result<PathBuf, AppendError> {
        if lines.is_empty() {
            return Ok(self.path.clone());
        }
        self.first_fitting(|file| self.append_at(file, lines, tell))
    }

    /// Removes what an earlier try to append these lines has left in `file` from `from` on, as
    /// [`Problem::left_from`] says.
    ///
    /// # Errors
    /// [`Problem::Changed`] where that is not there any more as it was left: the lines may have been
    /// written or not. Any other leaves it as it is, to be tried again.
    pub fn undo(&self, file: &Path, lines: &[u8], from: u64) -> Result<(), AppendError> {
        let undone = self.undo_at(file, lines, from);
        undone.map_err(|problem| AppendError {
            file: file.to_owned(),
            problem,
        })
    }

    fn undo_at(&self, path: &Path, lines: &[u8], from: u64) -> Result<(), Problem> {
        for _ in 0..TRIES {
            let mut file = system::open(path)?.ok_or(Problem::Changed)?;
            self.lock(&file)?;
            if system::is_at(&file, path)? {
                return commit::undo(&mut file, &self.start, lines, from);
            }
        }
        Err(Problem::Restless)
    }

    /// Does it to the first file that fits.
    fn first_fitting(
        &self,
        mut act: impl FnMut(&Path) -> Result<(), Problem>,
    ) -> Result<PathBuf, AppendError> {
        for file in numbered::names(&self.path) {
            match act(&file) {
                Ok(()) => return Ok(file),
                Err(Problem::Misfit(_)) if self.options.on_misfit == OnMisfit::NewFile => {}
                Err(problem) => return Err(AppendError { file, problem }),
            }
        }
        Err(AppendError {
            file: self.path.clone(),
            problem: Problem::NoNumber,
        })
    }

    fn check_at(&self, path: &Path) -> Result<(), Problem> {
        for _ in 0..TRIES {
            let Some(mut file) = system::open(path)? else {
                return system::may_make(path);
            };
            self.lock(&file)?;
            if system::is_at(&file, path)? {
                return examine::whole_lines(&mut file, &self.start).map(drop);
            }
        }
        Err(Problem::Restless)
    }

    fn append_at(
        &self,
        path: &Path,
        lines: &[u8],
        tell: &mut dyn FnMut(&Path, &Removed),
    ) -> Result<(), Problem> {
        for _ in 0..TRIES {
            let (mut file, folders) = match system::open(path)? {
                Some(file) => (file, Vec::new()),
                None => system::make(path)?,
            };
            let is_new = !folders.is_empty();
            self.lock(&file)?;
            // Somebody may have moved it away while the lock was waited for.
            if !system::is_at(&file, path)? {
                continue;
            }
            let Self { start, options, .. } = self;
            let mut tell = |removed: &Removed| tell(path, removed);
            let result = commit(&mut file, start, lines, options.syncing, &mut tell);
            match result {
                Err(_) if is_new => system::unmake(&file, path),
                Ok(()) if options.syncing == Syncing::Each => system::sync_folders(&folders),
                _ => {}
            }
            // Closing gives the lock back.
            return result;
        }
        Err(Problem::Restless)
    }

    fn lock(&self, file: &std::fs::File) -> Result<(), Problem> {
        lock::lock(file, self.options.wait, &*self.clock)
    }
}
