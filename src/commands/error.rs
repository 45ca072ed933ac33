//! Why a command cannot do its work.

use std::io;

use thiserror::Error;

use crate::codec::AddressError;
use crate::profile::find::FindError;
use crate::profile::selector::SelectError;
use crate::transport::ports::ListError;
use crate::transport::{OpenError, TransportError};

/// Why a command cannot do its work at all.
#[derive(Debug, Error)]
pub enum CommandError {
    /// A unit that no meter, or not this one, can have.
    #[error("{0}")]
    Unit(AddressError),
    /// The selection is wrong.
    #[error(transparent)]
    Select(#[from] SelectError),
    /// Two columns of a wide table would have one name.
    #[error("'{name}' would be two columns of one name in wide CSV")]
    ColumnClash {
        /// The name.
        name: String,
    },
    /// An option that has no effect on the format asked for.
    #[error("{option} is for {format}")]
    NoEffect {
        /// The option.
        option: &'static str,
        /// What it is for.
        format: &'static str,
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
    /// The ports cannot be listed.
    #[error(transparent)]
    Ports(#[from] ListError),
    /// Stdout does not take what is written.
    #[error("the output cannot be written")]
    Output(#[source] io::Error),
}
