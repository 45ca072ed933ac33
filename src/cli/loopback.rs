//! Arguments of `loopback`.

use std::time::Duration;

use clap::builder::ValueParser;
use clap::{Arg, Args, ValueEnum, value_parser};

use super::line::LineArguments;
use super::values::{Units, duration};

const EXAMPLES: &str = "\
Examples:
  meterpoll loopback -p sim: -a 17 --meter pqm
  meterpoll loopback -p /dev/ttyUSB0 -b 19200 -P even -a 1
  meterpoll loopback -p /dev/ttyUSB0 -a 17 --meter pqm --count 1000 -f json
  meterpoll loopback -p /dev/ttyUSB0 -a 17 --meter pqm --forever --interval 1s -f csv";

/// Arguments of `loopback`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES, mut_arg("retries", without_retries))]
pub struct Loopback {
    /// The units to test, one after the other: 17, or 1,2,5-9; --unit-id and --slave mean the same
    #[arg(short = 'a', long, aliases = ["unit-id", "slave"], value_name = "UNITS")]
    pub unit: Units,
    /// The meter: a name that `meters list` shows, or a profile file; it tells what the meter sends
    /// back [default: anything]
    #[arg(long, value_name = "METER")]
    pub meter: Option<String>,
    /// How many words each unit gets, one try each; at most 1000000
    #[arg(long, value_name = "COUNT", default_value_t = 20, value_parser = value_parser!(u64).range(1..=1_000_000))]
    pub count: u64,
    /// Go on until stopped; SIGINT, SIGTERM and SIGHUP let the summary be printed
    #[arg(long, conflicts_with = "count")]
    pub forever: bool,
    /// Least time from the start of one try to the start of the next, such as 100ms; with 0s as fast
    /// as line and meter allow
    #[arg(long, value_name = "TIME", value_parser = duration, default_value = "0s")]
    pub interval: Duration,
    /// How tries are printed
    #[arg(short, long, value_name = "FORMAT", default_value = "table")]
    pub format: LoopbackFormat,
    /// Print the requests in hex and send nothing
    #[arg(long, conflicts_with = "forever")]
    pub dry_run: bool,
    /// The line.
    #[command(flatten)]
    pub line: LineArguments,
}

/// `--format` of `loopback`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum LoopbackFormat {
    /// For people: a line a try and a summary
    Table,
    /// Comma-separated values with a header, a row a try; the summary goes to stderr
    Csv,
    /// One object with the settings, the tries and the summary
    Json,
}

/// Every try counts by itself, so nothing is repeated.
fn without_retries(retries: Arg) -> Arg {
    let parser = ValueParser::from(|text: &str| match text {
        "0" => Ok(0_u32),
        _ => Err("each try is made once; --count says how many there are"),
    });
    retries.hide(true).default_value("0").value_parser(parser)
}
