//! What is polled: lines, what is read on them, and where the rows go. The checked form, which a
//! command line and a site file make alike.

pub mod error;
pub mod format;
pub mod load;
mod outputs;
pub mod path;
mod source;
mod syntax;

use std::time::Duration;

pub use error::SiteError;
pub use path::{PathError, PathTemplate};

use super::job::Job;
use crate::client::Echo;
use crate::transport::LineSettings;

/// Everything that one run polls.
#[derive(Debug, Clone)]
pub struct Site {
    /// The lines; on each one meter is asked at a time.
    pub lines: Vec<SiteLine>,
    /// What is read, in the order in which it is.
    pub jobs: Vec<Job>,
    /// Where rows go; one at least.
    pub outputs: Vec<SiteOutput>,
}

impl Site {
    /// What is read on a line, with the index of each job.
    pub fn jobs_on(&self, line: usize) -> impl Iterator<Item = (usize, &Job)> {
        let jobs = self.jobs.iter().enumerate();
        jobs.filter(move |(_, job)| job.subject.line == line)
    }
}

/// One line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SiteLine {
    /// Its name in messages; the port's where it has no other.
    pub name: String,
    /// The port.
    pub port: String,
    /// Its setting.
    pub settings: LineSettings,
    /// What is known of echoes.
    pub echo: Echo,
    /// How long an adapter needs after its port was opened.
    pub settle: Duration,
    /// How long a port is waited for that another program holds.
    pub wait: Duration,
}

/// Where rows go, and in which form.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SiteOutput {
    /// Its name in messages.
    pub name: String,
    /// The file; stdout when there is none.
    pub path: Option<PathTemplate>,
    /// The form.
    pub form: RowForm,
    /// When rows reach the disk.
    pub syncing: RowSync,
    /// What to do about a file with other columns.
    pub on_schema_change: OnSchemaChange,
    /// What becomes of rows without any value.
    pub failed: FailedRows,
}

/// The form of rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RowForm {
    /// CSV, a row a meter.
    WideCsv(ColumnUnits),
    /// CSV, a row a reading.
    LongCsv,
    /// JSON, an object a line.
    JsonLines,
    /// Influx line protocol.
    Influx,
}

/// Whether the columns of wide CSV show units.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ColumnUnits {
    /// `energy_import`.
    Left,
    /// `energy_import [kWh]`.
    Shown,
}

/// When rows reach the disk.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RowSync {
    /// Before the next ones are read.
    Each,
    /// When the system comes to it.
    Never,
}

/// What to do about a file with other columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OnSchemaChange {
    /// Nothing is written to it.
    Refuse,
    /// The rows go to the next file of numbered names.
    NewFile,
}

/// What becomes of rows without any value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FailedRows {
    /// They are written, with their status.
    Written,
    /// They are left out.
    Skipped,
}
