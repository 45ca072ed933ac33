//! Why a command cannot do its work.

use std::io;

use thiserror::Error;

use crate::append::AppendError;
use crate::codec::{AddressError, Unit};
use crate::polling::SiteError;
use crate::polling::site::PathError;
use crate::profile::assignment::AssignError;
use crate::profile::find::FindError;
use crate::profile::selector::SelectError;
use crate::profile::write_plan::WritePlanError;
use crate::sim::values::ValuesError;
use crate::transport::faulty::FaultScriptError;
use crate::transport::listen::ListenError;
use crate::transport::ports::ListError;
use crate::transport::{OpenError, PtyError, TransportError};
use crate::writing::before::NotNow;

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
    /// What was typed is nothing that can be written.
    #[error(transparent)]
    Assign(#[from] AssignError),
    /// The meter does not take it like that.
    #[error(transparent)]
    WritePlan(#[from] WritePlanError),
    /// The meter does not take it as it is now.
    #[error("{place}: {problem}; nothing was sent there")]
    NotNow {
        /// The unit.
        place: String,
        /// What forbids it.
        problem: NotNow,
    },
    /// What changes how the meter is reached, before something else that is written.
    #[error("{name} changes how the meter is reached, and {after} is to be written after it")]
    MovesFirst {
        /// The point.
        name: String,
        /// What comes behind it.
        after: String,
    },
    /// One address for several meters.
    #[error("{name} would give several meters one address")]
    OneAddress {
        /// The point.
        name: String,
    },
    /// A request that follows from the setup of a meter.
    #[error("{name} is scaled by what the meter is set up for, which nothing tells unread")]
    NeedsMeter {
        /// The point.
        name: String,
    },
    /// Something hazardous, and nobody to ask.
    #[error("{name} {hazard}, and there is no terminal to ask at; nothing was sent")]
    NeedsYes {
        /// The point or operation.
        name: String,
        /// What it does.
        hazard: String,
    },
    /// Somebody was asked and did not say yes.
    #[error("{place}: not confirmed, so nothing was sent there")]
    Declined {
        /// Who it was to be done to.
        place: String,
    },
    /// A meter of whose operations nothing is known.
    #[error("the profile of {meter} has no operations")]
    NoOperations {
        /// The meter.
        meter: String,
    },
    /// An operation that the meter does not have.
    #[error("{meter} has no operation '{name}'{}", did_you_mean(.near))]
    NoOperation {
        /// The meter.
        meter: String,
        /// What was named.
        name: String,
        /// Names that look like it.
        near: Vec<String>,
    },
    /// A value for an operation that takes none.
    #[error("{name} takes no value")]
    TakesNothing {
        /// The operation.
        name: String,
    },
    /// No value for an operation that takes one.
    #[error("{name} takes a value, {what}: {form}")]
    Lacks {
        /// The operation.
        name: String,
        /// What the value is.
        what: String,
        /// What can be given.
        form: String,
    },
    /// Function 05 carries a number and nothing with it.
    #[error("{name} takes a value, and function 05 carries none")]
    CarriesNothing {
        /// The operation.
        name: String,
    },
    /// The meter is not told in this way.
    #[error("{meter} takes no operations with function {code:02}")]
    Carrier {
        /// The meter.
        meter: String,
        /// The function code.
        code: u8,
    },
    /// A read that was to be broadcast.
    #[error("'{name}' has no value, and a broadcast reads nothing: nobody answers it")]
    BroadcastRead {
        /// What was typed.
        name: String,
    },
    /// A broadcast to meters of which nothing is known.
    #[error("without a meter nothing tells what may be broadcast")]
    BroadcastUnknown,
    /// A meter that obeys no broadcast.
    #[error("{meter} obeys no broadcast")]
    NoBroadcast {
        /// The meter.
        meter: String,
    },
    /// A function that the meter does not obey on address 0.
    #[error("{meter} does not obey function {code:02} in a broadcast")]
    BroadcastFunction {
        /// The meter.
        meter: String,
        /// The function code.
        code: u8,
    },
    /// What the manual does not say can be broadcast.
    #[error("the manual of {meter} does not say that {name} can be broadcast")]
    NotBroadcast {
        /// The meter.
        meter: String,
        /// The point or operation.
        name: String,
    },
    /// A point for one unit that is written to all at once alone.
    #[error("{name} is written to all meters at once, and to none by itself")]
    BroadcastOnly {
        /// The point.
        name: String,
    },
    /// A meter without a clock that can be set.
    #[error("{meter} has no clock that can be set by a broadcast")]
    NoClock {
        /// The meter.
        meter: String,
    },
    /// This computer does not tell where it is.
    #[error("this computer's time zone is not known: {problem}")]
    NoTimeZone {
        /// What is wrong.
        problem: String,
    },
    /// Something that is no time.
    #[error("'{found}' is no time to set a clock to")]
    NoMoment {
        /// What was given.
        found: String,
    },
    /// An option that has no effect on what was asked for.
    #[error("{option} is for {what}")]
    NoEffect {
        /// The option.
        option: &'static str,
        /// What it has an effect on: a format, one unit, a serial port.
        what: &'static str,
    },
    /// The site file is wrong.
    #[error(transparent)]
    Site(#[from] SiteError),
    /// Nothing says how often something is read.
    #[error("nothing says how often {what} is read")]
    NoInterval {
        /// The meter.
        what: String,
    },
    /// A path that names no file.
    #[error("--output {path}: {problem}")]
    Path {
        /// What was typed.
        path: String,
        /// What is wrong with it.
        problem: PathError,
    },
    /// Rows with different columns in one file of wide CSV.
    #[error("{first} and {second} have different columns, and both would go to {place}")]
    Columns {
        /// What has some.
        first: String,
        /// What has others.
        second: String,
        /// The file, or stdout.
        place: String,
    },
    /// What is polled would get in its own way.
    #[error("{}{problem}", .file.as_ref().map(|file| format!("{file}: ")).unwrap_or_default())]
    Clash {
        /// The site file, where it is one.
        file: Option<String>,
        /// What does.
        problem: String,
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
    Values(Box<ValuesError>),
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

fn did_you_mean(near: &[String]) -> String {
    match near {
        [] => String::new(),
        near => format!("; did you mean {}?", near.join(", ")),
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

impl From<ValuesError> for CommandError {
    fn from(error: ValuesError) -> Self {
        Self::Values(Box::new(error))
    }
}
