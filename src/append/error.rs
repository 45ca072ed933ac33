//! Why rows were not appended.

use std::error::Error;
use std::fmt;
use std::io;
use std::path::PathBuf;
use std::time::Duration;

use thiserror::Error;

use super::start::Misfit;

/// Why rows were not appended, and to which file.
#[derive(Debug)]
pub struct AppendError {
    /// The file.
    pub file: PathBuf,
    /// What the matter is.
    pub problem: Problem,
}

impl fmt::Display for AppendError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.file.display(), self.problem)
    }
}

// By hand, for the message tells the problem, and so the cause is what is behind that.
impl Error for AppendError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        self.problem.source()
    }
}

/// What the matter is with a file.
#[derive(Debug, Error)]
pub enum Problem {
    /// It holds something else.
    #[error("{0}")]
    Misfit(Misfit),
    /// It is a folder.
    #[error("it is a folder, not a file")]
    Folder,
    /// It is a pipe, a terminal, a device: what was written cannot be looked at there, nor cut.
    #[error("it is no file that rows can be appended to, but a pipe or a device")]
    Device,
    /// It cannot be opened.
    #[error("it cannot be opened for appending")]
    Open(#[source] io::Error),
    /// It is not there, and its folder does not let it be made.
    #[error("the folder {} cannot have it", .folder.display())]
    NoPlace {
        /// The folder it would be in, or the one that folder would be in.
        folder: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// Another program has had it locked all the time.
    #[error("another program has had it locked for {}", seconds(.waited))]
    Locked {
        /// How long that was waited for.
        waited: Duration,
    },
    /// Its file system has no locks.
    #[error("it cannot be locked")]
    Lock(#[source] io::Error),
    /// It was another file whenever its lock was there.
    #[error("it is moved away again and again")]
    Restless,
    /// Every numbered name holds something else.
    #[error("all of its numbered names hold other columns")]
    NoNumber,
    /// It cannot be looked at.
    #[error("it cannot be read")]
    Read(#[source] io::Error),
    /// The tail that is not whole cannot be removed.
    #[error("a last line that is not whole cannot be removed")]
    Cut(#[source] io::Error),
    /// The system did not take the rows.
    #[error("the rows cannot be written{kept}")]
    Write {
        /// What is there now.
        kept: Kept,
        /// What the system said.
        source: io::Error,
    },
    /// The system took part of them.
    #[error("only {written} of {length} bytes could be written{kept}")]
    Short {
        /// So many were taken.
        written: usize,
        /// So many were to be.
        length: usize,
        /// What is there now.
        kept: Kept,
    },
    /// Rows that could not be removed after an earlier try are not there any more as they were
    /// left, so they may have been written or not. They are not looked for again.
    #[error("it has changed since rows were left there that could not be brought to the disk")]
    Changed,
    /// The disk did not take them.
    #[error("the rows cannot be brought to the disk{kept}")]
    Sync {
        /// What is there now.
        kept: Kept,
        /// What the system said.
        source: io::Error,
    },
}

/// What a file holds after rows could not be written. Prints as the end of a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kept {
    /// What it held before.
    Before,
    /// That, and perhaps some of the rows: they could not be removed. The next to append removes a
    /// line that is not whole.
    Unknown {
        /// Where they begin, in bytes from the beginning of the file.
        from: u64,
    },
}

impl Problem {
    /// Where rows begin that may be in the file although they could not be written.
    pub const fn left_from(&self) -> Option<u64> {
        match self {
            Self::Write { kept, .. } | Self::Short { kept, .. } | Self::Sync { kept, .. } => {
                match kept {
                    Kept::Before => None,
                    Kept::Unknown { from } => Some(*from),
                }
            }
            _ => None,
        }
    }
}

impl fmt::Display for Kept {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Before => Ok(()),
            Self::Unknown { .. } => f.write_str(", and what was written of them cannot be removed"),
        }
    }
}

/// `10 s`, `0.5 s`.
fn seconds(time: &Duration) -> String {
    format!("{} s", time.as_secs_f64())
}
