//! What can go wrong with a port.

use std::fmt;
use std::io;
use std::time::Duration;

use thiserror::Error;

use super::holder::{self, Holders};

/// A port that was open and is no longer usable.
#[derive(Debug, Error)]
pub enum TransportError {
    /// The adapter was pulled, the other side hung up, or the driver gave up.
    #[error("port {port} was lost")]
    Lost {
        /// The port as it was named.
        port: String,
        /// What the system said.
        source: io::Error,
    },
    /// It was lost, and could not be opened again in time.
    #[error("port {port} did not come back within {}", humantime::format_duration(*.within))]
    NotBack {
        /// The port as it was named.
        port: String,
        /// How long it was tried.
        within: Duration,
        /// What came of the last try.
        source: OpenError,
    },
}

impl TransportError {
    /// The port as it was named.
    pub fn port(&self) -> &str {
        match self {
            Self::Lost { port, .. } | Self::NotBack { port, .. } => port,
        }
    }
}

/// Why a port cannot be opened.
#[derive(Debug, Error)]
pub enum OpenError {
    /// There is nothing at that path.
    #[error("port {port} is not there")]
    NotThere {
        /// The port as it was named.
        port: String,
    },
    /// The path names something that is not a serial port.
    #[error("port {port} is {what}, not a serial port")]
    NotSerial {
        /// The port as it was named.
        port: String,
        /// What it is instead.
        what: &'static str,
    },
    /// Another program holds it.
    #[error("port {port} is in use by {holders}")]
    Busy {
        /// The port as it was named.
        port: String,
        /// Who holds it, where that was looked for: see [`Self::with_holders`].
        holders: Holders,
    },
    /// The user may not open it.
    #[error("port {port} is not permitted: {who}")]
    NotPermitted {
        /// The port as it was named.
        port: String,
        /// Who owns it and who asks.
        who: String,
        /// The group whose members may use it, where there is one.
        group: Option<String>,
    },
    /// The port does not do this speed or format.
    #[error("port {port} does not take {settings}")]
    Settings {
        /// The port as it was named.
        port: String,
        /// What was asked of it.
        settings: String,
        /// What the system said.
        source: io::Error,
    },
    /// Anything else.
    #[error("port {port} cannot be opened")]
    Other {
        /// The port as it was named.
        port: String,
        /// What the system said.
        source: io::Error,
    },
}

impl OpenError {
    /// The same, and for a port in use who holds it. Looking for them goes through all processes:
    /// done once an error is to be shown, not at each try.
    #[must_use]
    pub fn with_holders(self) -> Self {
        match self {
            Self::Busy { port, .. } => {
                let holders = holder::of(&port);
                Self::Busy { port, holders }
            }
            other => other,
        }
    }
}

/// Why there is no pty.
#[derive(Debug, Error)]
pub enum PtyError {
    /// The system makes none.
    #[error("no pty can be made")]
    None(#[source] io::Error),
    /// The system knows none.
    #[error("this system has no ptys")]
    Unknown,
    /// There is something of that name.
    #[error("{path} exists already, as {what}")]
    Exists {
        /// The name.
        path: String,
        /// What it is.
        what: Existing,
    },
    /// The name cannot be given.
    #[error("the pty cannot be named {path}")]
    Name {
        /// The name.
        path: String,
        /// What the system said.
        source: io::Error,
    },
}

/// What has a name that a pty was to have. Prints as `a file`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Existing {
    /// A link to a pty, of a program that runs or of one that was killed.
    LinkToPty,
    /// A link that leads nowhere.
    LostLink,
    /// A directory.
    Directory,
    /// A file.
    File,
    /// Anything else.
    Other,
}

impl fmt::Display for Existing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::LinkToPty => "a link to a pty",
            Self::LostLink => "a link that leads nowhere",
            Self::Directory => "a directory",
            Self::File => "a file",
            Self::Other => "something else",
        })
    }
}
