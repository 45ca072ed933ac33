//! Arguments of `meters` and its commands.

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum, ValueHint};

use super::line::LineArguments;
use super::values::Units;

/// Arguments of `meters`.
#[derive(Debug, Args)]
pub struct Meters {
    /// What to do with them; list them when left out
    #[command(subcommand)]
    pub command: Option<MetersCommand>,
}

/// The commands of `meters`.
#[derive(Debug, Subcommand)]
pub enum MetersCommand {
    /// List the meters inside the program and your own
    List,
    /// Show a meter: its line, limits and groups, and its points
    Show(ShowMeter),
    /// Print the profile of a meter as the TOML file that it is
    Export(ExportMeter),
    /// Check profile files: whether they load, and what they may lack all the same
    Check(CheckMeters),
    /// Read a live meter and test what its profile says must hold: sums, powers, frequency
    ///
    /// Ends with 0 when something could be tested and all of it holds; with 1 when something fails,
    /// is missing, or nothing flows that could be tested; with the code of the cause when nothing
    /// could be read at all.
    Verify(Box<VerifyMeter>),
}

const SHOW_EXAMPLES: &str = "\
Examples:
  meterpoll meters show pqm
  meterpoll meters show pqm @energy 'voltage_*'
  meterpoll meters show pqm current_a
  meterpoll meters show ./mine.toml -f csv";

/// Arguments of `meters show`.
#[derive(Debug, Args)]
#[command(after_help = SHOW_EXAMPLES)]
pub struct ShowMeter {
    /// A name that `meters list` shows, or a profile file
    #[arg(value_name = "METER")]
    pub meter: String,
    /// The points to show: names (`current_a`), globs (`current_*`), groups (`@energy`) [default: the
    /// meter as a whole and all its points]
    #[arg(value_name = "WHAT")]
    pub what: Vec<String>,
    /// How they are shown
    #[arg(short, long, value_name = "FORMAT", default_value = "table")]
    pub format: ShowFormat,
}

/// `--format` of `meters show`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ShowFormat {
    /// For people; a single point with all there is to say about it
    Table,
    /// Comma-separated values with a header, a row a point
    Csv,
    /// One object, with the points in an array
    Json,
}

const EXPORT_EXAMPLES: &str = "\
Examples:
  meterpoll meters export pqm > mine.toml
  meterpoll read-registers -p /dev/ttyUSB0 -a 17 --meter mine.toml";

/// Arguments of `meters export`.
#[derive(Debug, Args)]
#[command(after_help = EXPORT_EXAMPLES)]
pub struct ExportMeter {
    /// A name that `meters list` shows, or a profile file
    #[arg(value_name = "METER")]
    pub meter: String,
}

const CHECK_EXAMPLES: &str = "\
Examples:
  meterpoll meters check mine.toml
  meterpoll meters check ~/.config/meterpoll/meters/*.toml";

/// Arguments of `meters check`.
#[derive(Debug, Args)]
#[command(after_help = CHECK_EXAMPLES)]
pub struct CheckMeters {
    /// Profile files; what is wrong with one goes to stderr, advice to stdout
    #[arg(value_name = "FILE", required = true, value_hint = ValueHint::FilePath)]
    pub files: Vec<PathBuf>,
}

const VERIFY_EXAMPLES: &str = "\
Examples:
  meterpoll meters verify pqm -p sim: -a 17
  meterpoll meters verify ./mine.toml -p /dev/ttyUSB0 -a 1";

/// Arguments of `meters verify`.
#[derive(Debug, Args)]
#[command(after_help = VERIFY_EXAMPLES)]
pub struct VerifyMeter {
    /// A name that `meters list` shows, or a profile file
    #[arg(value_name = "METER")]
    pub meter: String,
    /// The units to read: 17, or 1,2,5-9
    #[arg(short = 'a', long, aliases = ["unit-id", "slave"], value_name = "UNITS")]
    pub unit: Units,
    /// The line.
    #[command(flatten)]
    pub line: LineArguments,
}
