//! Arguments of `read-registers`.

use clap::{Args, ValueEnum};

use super::line::LineArguments;
use super::output::OutputArguments;
use super::values::Units;

const EXAMPLES: &str = "\
Examples:
  meterpoll read-registers -p sim: -a 17 --meter pqm
  meterpoll read-registers -p /dev/ttyUSB0 -a 17 --meter pqm 'current_*'
  meterpoll read-registers -p /dev/ttyUSB0 -a 1-5 --meter pqm @energy -f csv
  meterpoll read-registers -p /dev/ttyUSB0 -a 1-5 --meter pqm @energy -o energy.csv
  meterpoll read-registers -p /dev/ttyUSB0 -b 19200 -P even -a 1 0x0000+10
  meterpoll read-registers -p /dev/ttyUSB0 -a 1 '0x11F:u32/CDAB*0.1=kWh'
  meterpoll read-registers -b 19200 -a 17 --meter pqm @power --plan";

/// Arguments of `read-registers`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct ReadRegisters {
    /// Points (`current_a`), globs (`current_*`), groups (`@energy`), or registers by address
    /// (`0x006B`, `107`, `0x6B+3`, `0x11F:u32/CDAB*0.1=kWh`) [default: the meter's @default group]
    #[arg(
        value_name = "WHAT",
        long_help = "\
What to read; the meter's @default group when left out.

With --meter: point names (current_a), globs (current_*), groups (@energy).

Always: registers by protocol address, from 0:
  0x006B              one register
  107                 the same in decimal
  0x6B+3              three registers
  0x11F:u32           a type: u16 i16 u32 i32 u64 i64 f32 f64 hex
                      bits mod10000 ascii/N (N characters), and
                      letter time date as the PQM stores them
  0x11F:u32/CDAB      an order of bytes: ABCD CDAB BADC DCBA
  0x11F:u32*0.1=kWh   a factor and a unit"
    )]
    pub what: Vec<String>,
    /// The units to read: 17, or 1,2,5-9; --unit-id and --slave mean the same
    #[arg(short = 'a', long, aliases = ["unit-id", "slave"], value_name = "UNITS")]
    pub unit: Units,
    /// The meter: a name that `meters list` shows, or a profile file
    #[arg(long, value_name = "METER")]
    pub meter: Option<String>,
    /// The function raw registers are read with; a meter's points as well where it takes both for
    /// one [default: what the meter wants, else 3]
    #[arg(long, value_name = "CODE")]
    pub function: Option<FunctionChoice>,
    /// How register numbers are written
    #[arg(long, value_name = "FORM", default_value = "protocol")]
    pub numbering: NumberingChoice,
    /// How readings are printed [default: table; with --output csv]
    #[arg(short, long, value_name = "FORMAT")]
    pub format: Option<FormatChoice>,
    /// Shape of CSV [default: wide]
    #[arg(long, value_name = "SHAPE")]
    pub layout: Option<Layout>,
    /// Put units into the header of wide CSV
    #[arg(long)]
    pub units: bool,
    /// Where the rows go.
    #[command(flatten)]
    pub output: OutputArguments,
    /// Print the requests in hex and send nothing
    #[arg(long)]
    pub dry_run: bool,
    /// Print the requests with the registers, points and time of each, and send nothing
    #[arg(long, conflicts_with = "dry_run")]
    pub plan: bool,
    /// The line.
    #[command(flatten)]
    pub line: LineArguments,
}

/// `--function`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum FunctionChoice {
    /// Read Holding Registers
    #[value(name = "3", aliases = ["03", "0x03"])]
    HoldingRegisters,
    /// Read Input Registers
    #[value(name = "4", aliases = ["04", "0x04"])]
    InputRegisters,
}

/// `--numbering`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum NumberingChoice {
    /// Addresses as on the wire, from 0
    Protocol,
    /// 30001 or 300001 for input registers, 40001 or 400001 for holding registers
    Modicon,
}

/// `--format`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum FormatChoice {
    /// For people
    Table,
    /// Comma-separated values with a header
    Csv,
    /// One array of objects, one a reading
    Json,
    /// One object a line, one a reading
    Jsonl,
    /// Influx line protocol, a line a row
    Influx,
}

/// `--layout`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Layout {
    /// A row a meter, a column a point
    Wide,
    /// A row a reading
    Long,
}
