//! What can go wrong with a port.

use std::io;

use thiserror::Error;

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
    #[error("port {port} is in use by another program")]
    Busy {
        /// The port as it was named.
        port: String,
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
        what: &'static str,
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
