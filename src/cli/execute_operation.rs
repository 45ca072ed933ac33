//! Arguments of `execute-operation`.

use clap::{Args, ValueEnum};

use super::line::LineArguments;
use super::values::Units;
use super::write_setpoint::Care;

const EXAMPLES: &str = "\
Examples:
  meterpoll execute-operation --meter pqm --list
  meterpoll execute-operation -p sim: -a 17 --meter pqm clear_energy
  meterpoll execute-operation -p /dev/ttyUSB0 -a 17 --meter pqm 14 --yes
  meterpoll execute-operation -p /dev/ttyUSB0 -a 17 --meter pqm set_clock_time now
  meterpoll execute-operation -p /dev/ttyUSB0 -a 1 --meter em24 reset_partial_meters --yes";

/// Arguments of `execute-operation`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct ExecuteOperation {
    /// The operation: a name, or a number where the meter has numbers
    #[arg(required_unless_present = "list", value_name = "OPERATION")]
    pub operation: Option<String>,
    /// What goes with it, where it takes something: a time of day, a date, `now`, a text, a key
    #[arg(value_name = "VALUE", allow_hyphen_values = true)]
    pub value: Option<String>,
    /// List the meter's operations and what is hazardous about them
    #[arg(long, conflicts_with_all = ["operation", "value", "unit"])]
    pub list: bool,
    /// The units to tell, one after the other: 17, or 1,2,5-9; --unit-id and --slave mean the same
    #[arg(
        short = 'a',
        long,
        aliases = ["unit-id", "slave"],
        value_name = "UNITS",
        required_unless_present = "list"
    )]
    pub unit: Option<Units>,
    /// The meter: a name that `meters list` shows, or a profile file
    #[arg(long, value_name = "METER")]
    pub meter: String,
    /// The function to tell it with, for operations that have a number [default: 5, or 16 where
    /// something goes with it]
    #[arg(long, value_name = "CODE")]
    pub function: Option<OperationFunctionChoice>,
    /// How doing it is made sure of.
    #[command(flatten)]
    pub care: Care,
    /// The line.
    #[command(flatten)]
    pub line: LineArguments,
}

/// `--function` of operations.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum OperationFunctionChoice {
    /// Write Single Coil: the number alone
    #[value(name = "5", aliases = ["05", "0x05"])]
    SingleCoil,
    /// Write Multiple Registers: the meter's command registers
    #[value(name = "16", alias = "0x10")]
    MultipleRegisters,
}
