//! Turns errors into messages and exit codes, with the hints of [`hints`](super::hints): the one place
//! for that.

use std::collections::BTreeSet;
use std::error::Error;
use std::fmt;
use std::io::{self, Write};
use std::path::Path;

use super::hints::{failure_hint, hint, write_hint};
use super::trouble::{self, Place};
use super::{CommandError, ExitCode};
use crate::append::{AppendError, Removed};
use crate::cli::Usage;
use crate::client::Failure;
use crate::codec::ExceptionCode;
use crate::output::escape;
use crate::readings::Trouble;
use crate::transport::listen::ListenError;
use crate::words::counted;

/// Prints what there is to say to a command line that nothing comes of: help on stdout, errors on
/// stderr.
pub(super) fn usage(message: &Usage) -> ExitCode {
    match message.print() {
        _ if message.is_error() => ExitCode::Usage,
        Ok(()) => ExitCode::Done,
        Err(cause) => Report::new(false).error(&CommandError::Output(cause)),
    }
}

/// Prints messages, and each hint once.
pub(super) struct Report {
    quiet: bool,
    hinted: BTreeSet<String>,
    lost_output: Option<io::Error>,
}

impl Report {
    /// Prints no hints when `quiet`.
    pub(super) const fn new(quiet: bool) -> Self {
        Self {
            quiet,
            hinted: BTreeSet::new(),
            lost_output: None,
        }
    }

    /// Whether only readings and errors are wanted.
    pub(super) const fn is_quiet(&self) -> bool {
        self.quiet
    }

    /// Prints an error with its causes and its hint, and returns what to end with.
    pub(super) fn error(&mut self, error: &CommandError) -> ExitCode {
        // Somebody who closed the pipe has read enough: nothing to tell.
        let is_closed_pipe = matches!(error, CommandError::Output(cause)
            if cause.kind() == io::ErrorKind::BrokenPipe);
        if !is_closed_pipe {
            say(format_args!("error: {error}"));
            causes(error);
            self.hint(hint(error));
            if let CommandError::Unwritten { lines, .. } = error {
                for line in lines.lines() {
                    say(format_args!("not written: {line}"));
                }
            }
        }
        exit_code(error)
    }

    /// Prints what went wrong while points of a unit were read.
    pub(super) fn trouble(&mut self, place: &Place<'_>, trouble: &Trouble) {
        say(format_args!("error: {}", trouble::text(place, trouble)));
        match trouble {
            Trouble::Unread {
                failure: Failure::Silence { .. },
                is_alive: true,
                ..
            } => self.hint(Some(
                "the meter answers other reads: it may not have these registers, or need a longer \
                 --timeout"
                    .to_owned(),
            )),
            Trouble::Unread { failure, .. } => {
                causes(failure);
                self.hint(failure_hint(failure).map(str::to_owned));
            }
            // Who names points need not be told of addresses.
            Trouble::Refused { code, points }
                if *code == ExceptionCode::ILLEGAL_DATA_ADDRESS && place.are_named(points) =>
            {
                self.hint(Some(
                    "this meter, or its firmware, has no such registers".to_owned(),
                ));
            }
            Trouble::Refused { code, .. } => {
                self.hint(failure_hint(&Failure::Exception(*code)).map(str::to_owned));
            }
            Trouble::NoSetting { .. } | Trouble::NoScale { .. } => self.hint(Some(
                "check the setup on the meter itself, and that it is the meter of --meter"
                    .to_owned(),
            )),
            Trouble::Impossible { .. } => self.hint(Some(
                "the type, byte order or scale is not this register's, or the meter's value is \
                 broken"
                    .to_owned(),
            )),
        }
    }

    /// Prints why a unit cannot be asked any more.
    pub(super) fn failure(&mut self, place: &str, failure: &Failure) {
        say(format_args!("error: {place}: {failure}"));
        causes(failure);
        self.hint(failure_hint(failure).map(str::to_owned));
    }

    /// The same of a status: no other function reads it.
    pub(super) fn status_failure(&mut self, place: &str, failure: &Failure) {
        if !matches!(failure, Failure::Exception(ExceptionCode::ILLEGAL_FUNCTION)) {
            return self.failure(place, failure);
        }
        say(format_args!("error: {place}: {failure}"));
        self.advise("the meter does not have function 07");
    }

    /// Prints what was done on stdout: it is what was asked for. Where that cannot be written, the work
    /// goes on: see [`Self::lost_output`].
    pub(super) fn success(&mut self, text: &str) {
        if !self.quiet
            && let Err(cause) = writeln!(io::stdout(), "{}", escape(text))
        {
            self.lost_output.get_or_insert(cause);
        }
    }

    /// Why something that was done could not be printed.
    pub(super) fn lost_output(&mut self) -> Option<CommandError> {
        self.lost_output.take().map(CommandError::Output)
    }

    /// Prints that a meter has refused to be written to.
    pub(super) fn refused(&mut self, place: &str, code: ExceptionCode) {
        say(format_args!("error: {place}: the meter refused: {code}"));
        self.hint(write_hint(code).map(str::to_owned));
    }

    /// Prints what to try.
    pub(super) fn advise(&mut self, hint: &str) {
        self.hint(Some(hint.to_owned()));
    }

    /// Prints something a person may want to know although all is well.
    pub(super) fn remark(&self, text: &str) {
        if !self.quiet {
            say(format_args!("{text}"));
        }
    }

    fn hint(&mut self, hint: Option<String>) {
        if let Some(hint) = hint.filter(|_| !self.quiet)
            && self.hinted.insert(hint.clone())
        {
            say(format_args!("hint: {hint}"));
        }
    }
}

/// Prints that units were not asked because the port is gone.
pub(super) fn untried_units(count: usize) {
    if count == 0 {
        return;
    }
    let (units, were) = if count == 1 {
        ("unit", "was")
    } else {
        ("units", "were")
    };
    say(format_args!("error: {count} more {units} {were} not tried"));
}

/// Prints that rows are empty because nobody was asked.
pub(super) fn untried_rows(count: usize, why: &str) {
    let rows = counted(count as u64, "row is", "rows are");
    say(format_args!(
        "error: {why}: {rows} of meters that were not asked"
    ));
}

/// Prints something that is to be known before something is done.
pub(super) fn warning(text: &str) {
    say(format_args!("warning: {text}"));
}

/// Prints something that went wrong.
pub(super) fn problem(place: &str, text: &str) {
    say(format_args!("error: {place}: {text}"));
}

/// Prints that something was sent, and why nothing is known of it.
pub(super) fn unknown(place: &str, failure: &Failure) {
    say(format_args!("error: {place}: {failure}"));
    causes(failure);
}

/// Prints that rows may be in a file or not, for it was changed before they could be removed.
pub(super) fn doubtful(error: &AppendError, lines: &str) {
    say(format_args!("error: {error}"));
    for line in lines.lines() {
        say(format_args!("may be written: {line}"));
    }
}

/// Prints what was cut off a file, even when little is wanted: it may be gone for good.
pub(super) fn removed(file: &Path, removed: &Removed) {
    say(format_args!("{}: {removed}", file.display()));
}

/// Writes a line to stderr, made safe for a terminal: it may quote a file or a meter. Where stderr
/// does not take it, there is nobody to tell, and the readings still go out.
fn say(line: fmt::Arguments<'_>) {
    let _ = writeln!(io::stderr(), "{}", escape(&line.to_string()));
}

fn causes(error: &dyn Error) {
    let mut cause = error.source();
    while let Some(error) = cause {
        say(format_args!("  because: {error}"));
        cause = error.source();
    }
}

const fn exit_code(error: &CommandError) -> ExitCode {
    match error {
        CommandError::Unit(_)
        | CommandError::Select(_)
        | CommandError::Assign(_)
        | CommandError::WritePlan(_)
        | CommandError::NotNow { .. }
        | CommandError::MovesFirst { .. }
        | CommandError::NeedsMeter { .. }
        | CommandError::NeedsYes { .. }
        | CommandError::Declined { .. }
        | CommandError::NoOperations { .. }
        | CommandError::NoOperation { .. }
        | CommandError::TakesNothing { .. }
        | CommandError::Lacks { .. }
        | CommandError::CarriesNothing { .. }
        | CommandError::Carrier { .. }
        | CommandError::BroadcastRead { .. }
        | CommandError::BroadcastUnknown
        | CommandError::NoBroadcast { .. }
        | CommandError::BroadcastFunction { .. }
        | CommandError::NotBroadcast { .. }
        | CommandError::BroadcastOnly { .. }
        | CommandError::NoClock { .. }
        | CommandError::NoMoment { .. }
        | CommandError::NoTimeZone { .. }
        | CommandError::OneAddress { .. }
        | CommandError::ColumnClash { .. }
        | CommandError::Site(_)
        | CommandError::NoInterval { .. }
        | CommandError::Path { .. }
        | CommandError::Columns { .. }
        | CommandError::Function { .. }
        | CommandError::NoEffect { .. }
        | CommandError::NoIdentities { .. }
        | CommandError::Clash { .. }
        | CommandError::NoPort
        | CommandError::UnknownSimulation { .. }
        | CommandError::Find(_)
        | CommandError::Tcp { .. }
        | CommandError::NoPlace { .. }
        | CommandError::UnitTwice { .. }
        | CommandError::Listen(ListenError::Address { .. })
        | CommandError::Values(_)
        | CommandError::Faults { .. }
        | CommandError::FaultsUnreadable { .. }
        | CommandError::NoPath { .. }
        | CommandError::HangUpForGood { .. }
        | CommandError::FaultNotShown { .. } => ExitCode::Usage,
        CommandError::Open(_)
        | CommandError::Lost(_)
        | CommandError::Ports(_)
        | CommandError::Pty(_)
        | CommandError::Listen(_) => ExitCode::Port,
        CommandError::Append(_) | CommandError::Unwritten { .. } | CommandError::Output(_) => {
            ExitCode::Output
        }
    }
}
