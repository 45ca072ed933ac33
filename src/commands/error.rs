//! Why a command cannot do its work.

use std::io;

use thiserror::Error;

use crate::append::AppendError;
use crate::codec::{AddressError, Unit};
use crate::profile::find::FindError;
use crate::profile::selector::SelectError;
use crate::sim::values::ValuesError;
use crate::transport::faulty::FaultScriptError;
use crate::transport::listen::ListenError;
use crate::transport::ports::ListError;
use crate::transport::{OpenError, PtyError, TransportError};

/// Why a command cannot do its work at all.
#[derive(Debug, Error)]
pub enum CommandError {
    /// A unit that no meter, or not this one, can have.
    #[error("{0}")]
    Unit(AddressError),
    /// The selection is wrong.
    #[error(transparent)]
    Select(#[from] SelectError),
    /// Two columns or fields would have one name.
    #[error("'{name}' would be two columns of one name in {format}")]
    ColumnClash {
        /// The name.
        name: String,
        /// The format that has a column a name.
        format: &'static str,
    },
    /// An option that has no effect on what was asked for.
    #[error("{option} is for {what}")]
    NoEffect {
        /// The option.
        option: &'static str,
        /// What it has an effect on: a format, one unit, a serial port.
        what: &'static str,
    },
    /// A meter whose profile says nothing that could be tested.
    #[error("the profile of {meter} has no [[identities]] that could be tested")]
    NoIdentities {
        /// The meter.
        meter: String,
    },
    /// No port was named, and something is to be sent.
    #[error("no port is named")]
    NoPort,
    /// Something that looks like the simulated line and is not.
    #[error("there is no simulated line '{port}'")]
    UnknownSimulation {
        /// What was named.
        port: String,
    },
    /// The meter does not have this function.
    #[error("{meter} does not answer function {code:02}")]
    Function {
        /// The meter.
        meter: String,
        /// The function code.
        code: u8,
    },
    /// There is no such profile, or it is wrong.
    #[error(transparent)]
    Find(#[from] FindError),
    /// A kind of port this version does not open.
    #[error("port {port}: lines over TCP are not in this version")]
    Tcp {
        /// The port as it was named.
        port: String,
    },
    /// The port cannot be opened.
    #[error(transparent)]
    Open(#[from] OpenError),
    /// The port was lost before anything was read.
    #[error(transparent)]
    Lost(#[from] TransportError),
    /// A place where no meter can be simulated.
    #[error("port {port} is no place for a simulated meter")]
    NoPlace {
        /// What was named.
        port: String,
    },
    /// A word that is no path, where a pty of that name would be made.
    #[error("a port is a path, and '{port}' has no / in it")]
    NoPath {
        /// What was named.
        port: String,
    },
    /// Two simulated meters of one unit.
    #[error("unit {unit} is to be {}", twice(.first, .second))]
    UnitTwice {
        /// The unit.
        unit: Unit,
        /// The meter that has it.
        first: String,
        /// The meter that is to have it as well; it may be the same.
        second: String,
    },
    /// There is no pty.
    #[error(transparent)]
    Pty(#[from] PtyError),
    /// Nobody can connect.
    #[error(transparent)]
    Listen(#[from] ListenError),
    /// The values to be simulated are wrong.
    #[error(transparent)]
    Values(#[from] ValuesError),
    /// A fault rule is none.
    #[error("{}{problem}", .file.as_ref().map(|file| format!("{file}: ")).unwrap_or_default())]
    Faults {
        /// The file it is from, if it is from one.
        file: Option<String>,
        /// What is wrong with it.
        problem: Box<FaultScriptError>,
    },
    /// The file of fault rules cannot be read.
    #[error("the fault rules in {file} cannot be read")]
    FaultsUnreadable {
        /// The file.
        file: String,
        /// What the system said.
        source: io::Error,
    },
    /// A fault that cannot be shown to clients of Modbus TCP.
    #[error("{} no whole frame, and Modbus TCP carries no other", .kinds.told(.rule))]
    FaultNotShown {
        /// The rule.
        rule: String,
        /// How much of what it does cannot be shown.
        kinds: HiddenKinds,
    },
    /// A fault that leaves clients no way back.
    #[error(
        "fault rule '{rule}' can end the line for good: a pty without a name is not found again"
    )]
    HangUpForGood {
        /// The rule.
        rule: String,
    },
    /// The ports cannot be listed.
    #[error(transparent)]
    Ports(#[from] ListError),
    /// Rows could not be appended to the file that is for them; none were taken.
    #[error(transparent)]
    Append(#[from] AppendError),
    /// Rows that were taken could not be appended.
    #[error("the readings were taken, and cannot be written")]
    Unwritten {
        /// To which file, and why.
        #[source]
        error: AppendError,
        /// The rows.
        lines: String,
    },
    /// Stdout does not take what is written.
    #[error("the output cannot be written")]
    Output(#[source] io::Error),
}

/// How many of the faults of a rule cannot be shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HiddenKinds {
    /// Its one kind.
    All,
    /// Some of those that it picks from.
    Some,
}

impl HiddenKinds {
    fn told(self, rule: &str) -> String {
        match self {
            Self::All => format!("fault rule '{rule}' leaves"),
            Self::Some => format!("some kinds that fault rule '{rule}' picks from leave"),
        }
    }
}

/// `both pqm and em24`, `pqm twice`.
fn twice(first: &str, second: &str) -> String {
    if first == second {
        format!("{first} twice")
    } else {
        format!("both {first} and {second}")
    }
}
