//! Arguments of `write-setpoint`.

use clap::{Args, ValueEnum};

use super::line::LineArguments;
use super::read_registers::NumberingChoice;
use super::values::Units;

const EXAMPLES: &str = "\
Examples:
  meterpoll write-setpoint -p sim: -a 17 --meter pqm ct_primary=200
  meterpoll write-setpoint -p /dev/ttyUSB0 -a 1 --meter em24 ct_ratio=40.0
  meterpoll write-setpoint -p /dev/ttyUSB0 -a 2 --meter pm290 pulse_kvarh=suppressed
  meterpoll write-setpoint -p /dev/ttyUSB0 -a 5 0x1028=500 0x1029:i16=-3
  meterpoll write-setpoint -a 17 --function 16 0x1028=0x01F4 0x1029=0x2710 --dry-run";

/// Arguments of `write-setpoint`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct WriteSetpoint {
    /// Points and their new values (`ct_primary=200`), or registers by address (`0x1028=500`)
    #[arg(
        required = true,
        value_name = "WHAT=VALUE",
        long_help = "\
What to write, in this order; neighbours that follow each other go in one request.

With --meter: a point's name and a value as the point reads: a number in its \
unit (ct_primary=200), a label (vt_wiring='3-wire direct'), a text, a date, a \
time. A number that begins with 0x is the register's own (ct_primary=0x00C8).

Always: registers by protocol address, from 0:
  0x1028=500                  one register
  0x1028=0x01F4               the same in hex
  0x1003:u32/CDAB*0.1=40.0    a type, an order of bytes, a factor"
    )]
    pub what: Vec<String>,
    /// The units to write to, one after the other: 17, or 1,2,5-9; --unit-id and --slave mean the same
    #[arg(short = 'a', long, aliases = ["unit-id", "slave"], value_name = "UNITS")]
    pub unit: Units,
    /// The meter: a name that `meters list` shows, or a profile file; it tells what may be written
    #[arg(long, value_name = "METER")]
    pub meter: Option<String>,
    /// The function to write with [default: 6 for one register, 16 for several, as the meter takes
    /// them]
    #[arg(long, value_name = "CODE")]
    pub function: Option<WriteFunctionChoice>,
    /// How register numbers are written
    #[arg(long, value_name = "FORM", default_value = "protocol")]
    pub numbering: NumberingChoice,
    /// How writing is made sure of.
    #[command(flatten)]
    pub care: Care,
    /// Leave out reading back what was written
    #[arg(long)]
    pub no_verify: bool,
    /// The line.
    #[command(flatten)]
    pub line: LineArguments,
}

/// What keeps a write from happening by accident.
#[derive(Debug, Clone, Copy, Args)]
pub struct Care {
    /// Do what is hazardous without asking; needed where nobody can be asked
    #[arg(short, long)]
    pub yes: bool,
    /// Print the requests in hex and send nothing
    #[arg(long)]
    pub dry_run: bool,
}

/// `--function` of commands that write registers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum WriteFunctionChoice {
    /// Write Single Register
    #[value(name = "6", aliases = ["06", "0x06"])]
    SingleRegister,
    /// Write Multiple Registers
    #[value(name = "16", alias = "0x10")]
    MultipleRegisters,
}
