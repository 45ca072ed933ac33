//! One file a subcommand: arguments in, readings out or something written. The only place that sees both the command
//! line and the rest.

mod asking;
mod broadcast;
mod careful;
mod completions;
mod error;
mod execute_operation;
mod exit_code;
mod fates;
mod hints;
mod local_time;
mod logging;
mod loopback;
mod meters;
mod open_line;
mod outlet;
mod poll;
mod ports;
mod read_registers;
mod read_status;
mod report;
mod setpoints;
mod show_plan;
mod signals;
mod simulate;
mod tour;
mod trouble;
mod write_setpoint;

use std::ffi::OsString;
use std::io::{self, Write};

use crate::cli::{self, Command};
use crate::codec::Frame;

use report::Report;

pub use error::{CommandError, HiddenKinds};
pub use exit_code::ExitCode;

/// Runs the program with these arguments, the first being its own name, and returns what it ends
/// with. Readings go to stdout, everything else to stderr.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let arguments = match cli::parse(arguments) {
        Ok(arguments) => arguments,
        Err(usage) => return report::usage(&usage),
    };
    logging::start(arguments.verbosity);
    let mut report = Report::new(arguments.verbosity.quiet);
    let result = match arguments.command {
        Command::ReadRegisters(arguments) => read_registers::run(&arguments, &mut report),
        Command::WriteSetpoint(arguments) => write_setpoint::run(&arguments, &mut report),
        Command::Broadcast(arguments) => broadcast::run(&arguments, &mut report),
        Command::ExecuteOperation(arguments) => execute_operation::run(&arguments, &mut report),
        Command::ReadStatus(arguments) => read_status::run(&arguments, &mut report),
        Command::Loopback(arguments) => loopback::run(&arguments, &mut report),
        Command::Poll(arguments) => poll::run(&arguments, &mut report),
        Command::Meters(arguments) => meters::run(&arguments, &mut report),
        Command::Ports => ports::list(&report),
        Command::Simulate(arguments) => simulate::run(&arguments, &report),
        Command::Completions(arguments) => completions::print_script(&arguments),
    };
    let code = result.unwrap_or_else(|error| report.error(&error));
    match report.lost_output() {
        Some(error) if code == ExitCode::Done => report.error(&error),
        _ => code,
    }
}

/// Writes frames to stdout in hex, one a line.
fn print_frames(frames: impl IntoIterator<Item = Frame>) -> Result<ExitCode, CommandError> {
    let lines = frames.into_iter().map(|frame| frame.to_string() + "\n");
    print(lines.collect::<String>().as_bytes())
}

/// Writes text to stdout in one go.
fn print(text: &[u8]) -> Result<ExitCode, CommandError> {
    let mut out = io::stdout().lock();
    out.write_all(text)
        .and_then(|()| out.flush())
        .map_err(CommandError::Output)?;
    Ok(ExitCode::Done)
}
