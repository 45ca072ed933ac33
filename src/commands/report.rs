//! Turns errors into messages, hints and exit codes: the one place for all three.

use std::error::Error;
use std::io;

use super::{CommandError, ExitCode};
use crate::cli::Usage;
use crate::client::Failure;
use crate::codec::{AddressError, ExceptionCode};
use crate::profile::find::FindError;
use crate::profile::selector::SelectError;
use crate::readings::Failed;
use crate::transport::OpenError;

/// Prints what there is to say to a command line that nothing comes of.
pub(super) fn usage(message: &Usage) -> ExitCode {
    match message.print() {
        Ok(()) if message.is_error() => ExitCode::Usage,
        Ok(()) => ExitCode::Done,
        Err(_) => ExitCode::Output,
    }
}

/// Prints an error with its causes and its hint, and returns what to end with.
pub(super) fn error(error: &CommandError, quiet: bool) -> ExitCode {
    // Somebody who closed the pipe has read enough: nothing to tell.
    if let CommandError::Output(cause) = error
        && cause.kind() == io::ErrorKind::BrokenPipe
    {
        return ExitCode::Output;
    }
    say(error, hint(error), quiet);
    exit_code(error)
}

/// Where a read failed, for the message.
pub(super) struct Place<'a> {
    /// `sim: at 9600 8N1`.
    pub(super) line: &'a str,
    /// The unit.
    pub(super) unit: crate::codec::Unit,
    /// How often the read was tried.
    pub(super) attempts: u32,
}

/// Prints why a read brought nothing.
pub(super) fn failed(place: &Place<'_>, failed: &Failed, quiet: bool) {
    let Place {
        line,
        unit,
        attempts,
    } = place;
    let range = failed.read.range;
    let mut text = format!(
        "unit {unit} on {line}, registers {range}: {}",
        failed.failure
    );
    if *attempts > 1 && failed.failure.is_worth_a_retry() {
        text = format!("{text}, {attempts} attempts");
    }
    if failed.untried > 0 {
        text = format!(
            "{text}; {} more reads of this unit were not tried",
            failed.untried
        );
    }
    eprintln!("error: {text}");
    causes(&failed.failure);
    if let (Some(hint), false) = (failure_hint(&failed.failure), quiet) {
        eprintln!("hint: {hint}");
    }
}

/// Something a person may want to know, although the command goes on.
pub(super) fn warning(text: &str) {
    log::warn!("warning: {text}");
}

fn say(error: &dyn Error, hint: Option<String>, quiet: bool) {
    eprintln!("error: {error}");
    causes(error);
    if let (Some(hint), false) = (hint, quiet) {
        eprintln!("hint: {hint}");
    }
}

fn causes(error: &dyn Error) {
    let mut cause = error.source();
    while let Some(error) = cause {
        eprintln!("  because: {error}");
        cause = error.source();
    }
}

const fn exit_code(error: &CommandError) -> ExitCode {
    match error {
        CommandError::Unit(_)
        | CommandError::Select(_)
        | CommandError::ColumnClash { .. }
        | CommandError::Function { .. }
        | CommandError::Find(_)
        | CommandError::Tcp { .. } => ExitCode::Usage,
        CommandError::Open(_) | CommandError::Lost(_) | CommandError::Ports(_) => ExitCode::Port,
        CommandError::Output(_) => ExitCode::Output,
    }
}

fn hint(error: &CommandError) -> Option<String> {
    let text = match error {
        CommandError::Unit(AddressError::UnitZero) => "a read needs one meter: --unit 1 to 247",
        CommandError::Unit(_) => {
            "units go to 247; to 255 only for meters whose profile says so, such as --meter pqm"
        }
        CommandError::Select(error) => return select_hint(error),
        CommandError::ColumnClash { .. } => {
            "ask for it once, or use --layout long or another --format"
        }
        CommandError::Function { .. } => "leave --function out",
        CommandError::Find(FindError::Unknown { .. }) => {
            "`meterpoll meters list` shows them; a profile file is named by its path"
        }
        CommandError::Tcp { .. } => "give a serial port, or sim: for the simulated line",
        CommandError::Open(error) => return open_hint(error),
        _ => return None,
    };
    Some(text.to_owned())
}

fn select_hint(error: &SelectError) -> Option<String> {
    let text = match error {
        SelectError::NoMeter { .. } => "name the meter with --meter, or registers as 0x0000+10",
        SelectError::Malformed { .. } => {
            "registers are written 0x006B, 107, 0x6B+3 or 0x11F:u32/CDAB*0.1=kWh"
        }
        _ => return None,
    };
    Some(text.to_owned())
}

fn open_hint(error: &OpenError) -> Option<String> {
    let text = match error {
        OpenError::NotThere { .. } => {
            "`meterpoll ports` lists the ports; plugging an adapter in shows a new one (a program \
             such as brltty can take it away again)"
        }
        OpenError::NotSerial { .. } => "`meterpoll ports` lists the ports",
        OpenError::Busy { .. } => {
            "another program has it open, a cron job or ModemManager perhaps; --wait 30s waits longer"
        }
        OpenError::NotPermitted {
            group: Some(group), ..
        } => {
            return Some(format!(
                "`sudo usermod -aG {group} $USER` and a new login give access"
            ));
        }
        OpenError::Settings { .. } => "try another --baud",
        _ => return None,
    };
    Some(text.to_owned())
}

fn failure_hint(failure: &Failure) -> Option<&'static str> {
    Some(match failure {
        Failure::Silence { .. } => {
            "check --unit, --baud, --parity and --stop-bits against the meter, then power and \
             wiring (A and B swapped?); a slow meter needs a longer --timeout"
        }
        Failure::OnlyEcho => {
            "the adapter hears itself but no meter: check --unit, --baud and --parity, then the \
             wiring behind the adapter"
        }
        Failure::Damaged { .. } | Failure::Truncated { .. } => {
            "check --baud, --parity and --stop-bits, then cable, termination and bias resistors"
        }
        Failure::Mismatch { .. } => {
            "a late answer or a second master on the line; a longer --timeout helps with the first"
        }
        Failure::NeverQuiet { .. } => {
            "another master may be talking on this line, or its bias resistors are missing"
        }
        Failure::Exception(ExceptionCode::ILLEGAL_FUNCTION) => "try the other --function, 3 or 4",
        Failure::Exception(ExceptionCode::ILLEGAL_DATA_ADDRESS) => {
            "the meter has no such registers, or not as many at once; addresses are as on the \
             wire, from 0 (for 40001 and the like see --numbering modicon)"
        }
        Failure::Exception(_) | Failure::Port(_) => return None,
    })
}
