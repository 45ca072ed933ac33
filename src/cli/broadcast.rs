//! Arguments of `broadcast`.

use std::time::Duration;

use clap::Args;

use super::line::LineArguments;
use super::read_registers::NumberingChoice;
use super::values::{Units, duration};
use super::write_setpoint::{Care, WriteFunctionChoice};

const EXAMPLES: &str = "\
Examples:
  meterpoll broadcast -p sim: --meter pqm clock=now
  meterpoll broadcast -p /dev/ttyUSB0 --meter pqm clock=2026-11-22T13:27:10.015 --verify-units 17,18
  meterpoll broadcast -p /dev/ttyUSB0 --meter pqm clear_all_demand
  meterpoll broadcast -p /dev/ttyUSB0 --meter em24 demand_interval=15 --verify-units 1-9";

/// Arguments of `broadcast`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct BroadcastWrite {
    /// Points and their new values (`demand_interval=15`), the clock (`clock=now`), or one operation
    /// (`clear_all_demand`)
    #[arg(
        required = true,
        value_name = "WHAT=VALUE",
        long_help = "\
What to write to every meter on the line, in this order: points and values as \
write-setpoint takes them, or the name of one operation that \
`execute-operation --list` shows.

clock=now sets the clock to this computer's local time, at the moment it is \
sent; clock=2026-11-22T13:27:10.015 to another one. A time with an offset \
(...Z, ...+01:00) is turned into local time."
    )]
    pub what: Vec<String>,
    /// The meter: a name that `meters list` shows, or a profile file; it tells what may be broadcast
    #[arg(long, value_name = "METER")]
    pub meter: Option<String>,
    /// The function to write with [default: 6 for one register, 16 for several, as the meter obeys
    /// them]
    #[arg(long, value_name = "CODE")]
    pub function: Option<WriteFunctionChoice>,
    /// How register numbers are written
    #[arg(long, value_name = "FORM", default_value = "protocol")]
    pub numbering: NumberingChoice,
    /// Send also what the meter's manual does not say can be broadcast
    #[arg(long)]
    pub force: bool,
    /// Send each point in a request of its own: the clock's time and date apart
    #[arg(long)]
    pub one_by_one: bool,
    /// How long the meters get to do it before anything else is sent, or the port is left
    #[arg(long, value_name = "TIME", value_parser = turnaround, default_value = "200ms")]
    pub turnaround: Duration,
    /// Read these units afterwards and tell which of them hold the values: 17, or 1,2,5-9
    #[arg(long, value_name = "UNITS")]
    pub verify_units: Option<Units>,
    /// How writing is made sure of.
    #[command(flatten)]
    pub care: Care,
    /// The line.
    #[command(flatten)]
    pub line: LineArguments,
}

/// The longest turnaround: no meter takes a minute to do something.
const LONGEST_TURNAROUND: Duration = Duration::from_secs(60);

fn turnaround(text: &str) -> Result<Duration, String> {
    match duration(text)? {
        time if time > LONGEST_TURNAROUND => Err("the longest turnaround is 1m".to_owned()),
        time => Ok(time),
    }
}
