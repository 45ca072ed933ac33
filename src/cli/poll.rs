//! Arguments of `poll`.

use std::path::PathBuf;
use std::time::Duration;

use clap::{Arg, Args, ValueEnum};

use super::line::LineArguments;
use super::output::OutputArguments;
use super::read_registers::Layout;
use super::values::{Units, interval, timeout};

const EXAMPLES: &str = "\
Examples:
  meterpoll poll -p sim: -a 17 --meter pqm --every 5s @power
  meterpoll poll -p /dev/ttyUSB0 -a 1-5 --meter em24 --every 1m -o em24.csv
  meterpoll poll -p /dev/ttyUSB0 -a 1-5 --meter em24 --every 1m -o 'log/%Y-%m-%d.csv'
  meterpoll poll -p /dev/ttyUSB0 -a 1 --meter em24 --once --deadline 50s -o em24.csv
  meterpoll poll --config site.toml --check
  meterpoll poll --config site.toml

From cron, once a minute:
  * * * * * meterpoll poll --config /etc/site.toml --once --deadline 50s";

/// What `--config` says in their place.
const OF_THE_SITE: [&str; 19] = [
    "what",
    "unit",
    "meter",
    "every",
    "skip_failed",
    "format",
    "layout",
    "units",
    "output",
    "on_schema_change",
    "no_sync",
    "baud",
    "parity",
    "stop_bits",
    "timeout",
    "retries",
    "pause",
    "settle",
    "echo",
];

/// Arguments of `poll`.
#[expect(
    clippy::struct_excessive_bools,
    reason = "each is a flag that can be typed"
)]
#[derive(Debug, Args)]
#[command(
    after_help = EXAMPLES,
    mut_arg("output", |output| with_fields(output)),
    mut_arg("wait", |wait| wait.conflicts_with("config"))
)]
pub struct Poll {
    /// Points (`current_a`), globs (`current_*`), groups (`@energy`), or registers by address, as
    /// for read-registers [default: the meter's @default group]
    #[arg(value_name = "WHAT")]
    pub what: Vec<String>,
    /// A site file: lines, meters, intervals and outputs; a port that is given besides is not used
    #[arg(long, value_name = "FILE", conflicts_with_all = OF_THE_SITE)]
    pub config: Option<PathBuf>,
    /// The units to read: 17, or 1,2,5-9; --unit-id and --slave mean the same
    #[arg(
        short = 'a',
        long,
        aliases = ["unit-id", "slave"],
        value_name = "UNITS",
        required_unless_present = "config"
    )]
    pub unit: Option<Units>,
    /// The meter: a name that `meters list` shows, or a profile file
    #[arg(long, value_name = "METER")]
    pub meter: Option<String>,
    /// How often, from 10ms to 24h: on round times in UTC, so that 15m is at :00, :15, :30 and :45;
    /// what does not divide a day counts from 1970-01-01
    #[arg(long, value_name = "TIME", value_parser = interval)]
    pub every: Option<Duration>,
    /// Read everything once and end, as from cron
    #[arg(long)]
    pub once: bool,
    /// Check everything, print what would be read when and how long that takes, and open nothing
    #[arg(long)]
    pub check: bool,
    /// How long --once may take in all; what it does not come to is missing [default: the longest
    /// interval, where there is one]
    #[arg(long, value_name = "TIME", value_parser = timeout, requires = "once")]
    pub deadline: Option<Duration>,
    /// Write no row where nothing could be read
    #[arg(long)]
    pub skip_failed: bool,
    /// How rows are written [default: csv; on a terminal, a table of the last values in place of
    /// rows]
    #[arg(short, long, value_name = "FORMAT")]
    pub format: Option<RowFormat>,
    /// Shape of CSV [default: wide]
    #[arg(long, value_name = "SHAPE")]
    pub layout: Option<Layout>,
    /// Put units into the header of wide CSV
    #[arg(long)]
    pub units: bool,
    /// The file.
    #[command(flatten)]
    pub output: OutputArguments,
    /// The line.
    #[command(flatten)]
    pub line: LineArguments,
}

/// `--format` of `poll`: rows that can go on for ever.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum RowFormat {
    /// Comma-separated values with a header
    Csv,
    /// One object a line, one a reading
    Jsonl,
    /// Influx line protocol
    Influx,
}

/// The path of a poll's file changes with the time.
fn with_fields(output: Arg) -> Arg {
    let help = "Append the rows to this file and print none; {meter} and the fields of strftime, \
                such as %Y-%m-%d, are filled in, in UTC";
    output.help(help).long_help(format!(
        "{help}\n\nIts folders are made. The rows of a slot go in together, under a lock, so that \
         others can append to it and rename it; a new file begins with its header. A last line \
         that was never finished, as after a power cut, is removed, and stderr says what it was. A \
         file with other columns, or that holds something else, is not touched. While a file \
         cannot be written, rows are kept, 4 MiB of them at the most, and written later."
    ))
}
