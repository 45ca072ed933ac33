//! Arguments of `read-status`.

use clap::{Args, ValueEnum};

use super::line::LineArguments;
use super::values::Units;

const EXAMPLES: &str = "\
Examples:
  meterpoll read-status -p sim: -a 17 --meter pqm
  meterpoll read-status -p /dev/ttyUSB0 -a 1-9 --meter pqm -f csv";

/// Arguments of `read-status`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct ReadStatus {
    /// The units to read: 17, or 1,2,5-9; --unit-id and --slave mean the same
    #[arg(short = 'a', long, aliases = ["unit-id", "slave"], value_name = "UNITS")]
    pub unit: Units,
    /// The meter: a name that `meters list` shows, or a profile file; it tells what the bits mean
    #[arg(long, value_name = "METER")]
    pub meter: Option<String>,
    /// How the status is printed
    #[arg(short, long, value_name = "FORMAT", default_value = "table")]
    pub format: StatusFormat,
    /// Print the requests in hex and send nothing
    #[arg(long)]
    pub dry_run: bool,
    /// The line.
    #[command(flatten)]
    pub line: LineArguments,
}

/// `--format` of `read-status`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum StatusFormat {
    /// For people: a line a unit
    Table,
    /// Comma-separated values with a header, a row a unit
    Csv,
    /// One array of objects, one a unit
    Json,
}
