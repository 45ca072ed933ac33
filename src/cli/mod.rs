//! What can be typed: definitions of commands and options, nothing that does work, so that
//! completions, man pages and tests can build it alone. Everybody else calls [`parse`] and reads
//! [`Arguments`].

#[allow(
    rustdoc::broken_intra_doc_links,
    reason = "its doc comments are help texts, where [default: ...] is no link"
)]
mod broadcast;
#[allow(
    rustdoc::broken_intra_doc_links,
    reason = "its doc comments are help texts, where [default: ...] is no link"
)]
mod execute_operation;
mod line;
#[allow(
    rustdoc::broken_intra_doc_links,
    reason = "its doc comments are help texts, where [default: ...] is no link"
)]
mod loopback;
mod meters;
mod output;
#[allow(
    rustdoc::broken_intra_doc_links,
    rustdoc::invalid_html_tags,
    reason = "its doc comments are help texts, where [default: ...] is no link"
)]
mod poll;
#[allow(
    rustdoc::broken_intra_doc_links,
    reason = "its doc comments are help texts, where [default: ...] is no link"
)]
mod read_registers;
mod read_status;
#[allow(
    rustdoc::broken_intra_doc_links,
    rustdoc::invalid_html_tags,
    reason = "its doc comments are help texts, where [default: ...] is no link"
)]
mod simulate;
mod usage;
mod values;
#[allow(
    rustdoc::broken_intra_doc_links,
    reason = "its doc comments are help texts, where [default: ...] is no link"
)]
mod write_setpoint;

use clap::{ArgAction, Args, Parser, Subcommand};
use clap_complete::Shell;

pub use broadcast::BroadcastWrite;
pub use execute_operation::{ExecuteOperation, OperationFunctionChoice};
pub use line::{EchoChoice, LineArguments, ParityChoice, StopBitsChoice};
pub use loopback::{Loopback, LoopbackFormat};
pub use meters::{
    CheckMeters, ExportMeter, Meters, MetersCommand, ShowFormat, ShowMeter, VerifyMeter,
};
pub use output::{OutputArguments, SchemaChange};
pub use poll::{Poll, RowFormat};
pub use read_registers::{FormatChoice, FunctionChoice, Layout, NumberingChoice, ReadRegisters};
pub use read_status::{ReadStatus, StatusFormat};
pub use simulate::Simulate;
pub use usage::{Usage, completion_script, parse};
pub use values::{MeterUnits, Units};
pub use write_setpoint::{Care, WriteFunctionChoice, WriteSetpoint};

/// What the program ends with, code by code.
pub const EXIT_CODES: [(u8, &str); 11] = [
    (0, "everything asked for was done"),
    (
        1,
        "some readings or loop-backs are missing, or something that must hold does not",
    ),
    (
        2,
        "command line or profile wrong, or refused before sending",
    ),
    (3, "port: not there, busy, not permitted, lost"),
    (4, "no valid answer: silence, damaged or mismatched frames"),
    (5, "the meter refused"),
    (
        6,
        "outcome of a write unknown, or the meter holds another value than was written",
    ),
    (7, "output could not be written"),
    (129, "stopped by SIGHUP, after the row in hand was finished"),
    (130, "stopped by SIGINT, after the row in hand was finished"),
    (
        143,
        "stopped by SIGTERM, after the row in hand was finished",
    ),
];

const AFTER_HELP: &str = "\
Exit codes: 0 done, 1 some readings missing, 2 wrong command line, 3 port,
4 no valid answer, 5 refused by the meter, 6 outcome of a write unknown,
7 output not written.

Try it without a meter:
  meterpoll read-registers --port sim: --unit 17 --meter pqm";

/// Reads electricity meters over Modbus RTU, in points and units.
#[derive(Debug, Parser)]
#[command(
    name = "meterpoll",
    version,
    propagate_version = true,
    help_expected = true,
    arg_required_else_help = true,
    after_help = AFTER_HELP
)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
    /// How much to say.
    #[command(flatten)]
    pub verbosity: Verbosity,
}

/// How much to say on stderr.
#[derive(Debug, Clone, Copy, Args)]
pub struct Verbosity {
    /// Print readings and errors only: no headings, footnotes or hints
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    pub quiet: bool,
    /// Say what is being done; twice: show every frame in hex with times
    #[arg(short, long, global = true, action = ArgAction::Count)]
    pub verbose: u8,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Read points of a meter by name, or raw registers by address
    ReadRegisters(Box<ReadRegisters>),
    /// Write points of a meter by name, or raw registers by address, and read them back
    ///
    /// What will be written is shown first, with what the meter holds now. Each request is sent once:
    /// when its answer is lost it may have been carried out or not, which ends with 6 and is never
    /// tried again behind your back. Only a meter that says that it is busy is asked again.
    WriteSetpoint(Box<WriteSetpoint>),
    /// Write to every meter on the line at once, without an answer
    ///
    /// What is sent is reported as sent: nobody answers a broadcast. --verify-units reads meters
    /// afterwards. A broadcast is never repeated by itself.
    Broadcast(Box<BroadcastWrite>),
    /// Have a meter do something: reset, clear energy, set its clock
    ///
    /// It is sent once, as write-setpoint does it. --list shows what a meter can do.
    ExecuteOperation(Box<ExecuteOperation>),
    /// Read the eight status bits of a meter, by name (function 07)
    ReadStatus(Box<ReadStatus>),
    /// Send words to a unit and compare what comes back: is the line good?
    ///
    /// Function 08, sub-function 0 (Return Query Data), as ping does it elsewhere: a line a try, then
    /// how many were answered and how long that took, and in words whether the line is good.
    ///
    /// It is good when every word came back and nothing else was heard; bad when more than 5 of 100
    /// tries were lost, or when nothing but our own echo came back; doubtful in between: with damage,
    /// noise, late answers or frames of other units. The jitter is the mean difference between an
    /// answer time and the one before; p95 is the time that 95 of 100 answers did not exceed.
    ///
    /// One register is read first, which tells whether the line echoes.
    ///
    /// Ends with 0 when every try was answered, and with 1 when some were; when none was, with the
    /// code of the cause: 4, or 5 when all were refused; with 3 when the port was lost.
    Loopback(Box<Loopback>),
    /// Read meters over and over, at a fixed rate, into files; or once, as from cron
    ///
    /// Many meters on many lines, from a site file, or those of one line. Every slot has one row a
    /// meter: a value that could not be read is missing, and the row says why. A meter that is silent
    /// costs the others little, and is read again when it answers; so is a port that was lost. Errors
    /// are told once, and again when they are over.
    ///
    /// SIGINT and SIGTERM end it after the row in hand; so does SIGHUP where there is a terminal.
    ///
    /// With --once it ends with 0 when everything was read, and with 1 when some was; when nothing
    /// was, with the code of the cause.
    Poll(Box<Poll>),
    /// List known meters, show one, print its profile, check a profile, verify it on a live meter
    Meters(Meters),
    /// List serial ports, without opening any
    Ports,
    /// Be a meter, or several, on a pty, a serial port or TCP, with faults on request
    Simulate(Box<Simulate>),
    /// Print a shell's completion script
    Completions(Completions),
}

/// Arguments of `completions`.
#[derive(Debug, Args)]
pub struct Completions {
    /// The shell
    pub shell: Shell,
}
