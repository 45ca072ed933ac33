//! Where clients of the simulated meters come from.

use std::path::{Path, PathBuf};
use std::time::Duration;

use crate::cli::Simulate;
use crate::commands::CommandError;
use crate::commands::open_line::{settings, while_busy};
use crate::sim::server::Framing;
use crate::transport::listen::Listener;
use crate::transport::outside::SerialOutside;
#[cfg(unix)]
use crate::transport::pty::{Pty, is_device, is_link_to_pty};
use crate::transport::{Clock, LineSettings, Outside, PtyError};

/// Silence that ends what has no end of its own: far longer than the pauses of a program that was
/// held up while it wrote, and short for whoever waits for an exception.
const GAP: Duration = Duration::from_millis(20);

/// The port of Modbus TCP.
const MODBUS_PORT: u16 = 502;

/// A place where clients can come from.
pub(super) enum Place {
    /// A pty, with a name of its own or without.
    Pty(Option<PathBuf>),
    /// A serial port.
    Serial(String),
    /// A socket that takes RTU frames.
    RtuOverTcp(String),
    /// A socket that takes Modbus TCP.
    Tcp(String),
}

impl Place {
    /// What `--port` means.
    pub(super) fn of(port: Option<&str>) -> Result<Self, CommandError> {
        let Some(port) = port else {
            return Ok(Self::Pty(None));
        };
        if let Some(address) = port.strip_prefix("rtu+tcp://") {
            return Ok(Self::RtuOverTcp(address.to_owned()));
        }
        if let Some(address) = port.strip_prefix("tcp://") {
            return Ok(Self::Tcp(with_port(address)));
        }
        if port.is_empty() || port == "sim" || port.starts_with("sim:") || port.contains("://") {
            let port = port.to_owned();
            return Err(CommandError::NoPlace { port });
        }
        let path = Path::new(port);
        // A slip in the name of a port must not make one.
        let is_there = is_device(path) && !is_link_to_pty(path);
        if cfg!(windows) || path.starts_with("/dev") || is_there {
            return Ok(Self::Serial(port.to_owned()));
        }
        if !port.contains('/') {
            let port = port.to_owned();
            return Err(CommandError::NoPath { port });
        }
        Ok(Self::Pty(Some(path.to_owned())))
    }

    /// Whether a client opens it like a serial port.
    pub(super) const fn is_line(&self) -> bool {
        matches!(self, Self::Pty(_) | Self::Serial(_))
    }

    /// Whether clients find it again after it was lost.
    pub(super) const fn comes_back(&self) -> bool {
        !matches!(self, Self::Pty(None))
    }

    /// How clients frame what they send.
    pub(super) fn framing(&self, settings: LineSettings) -> Framing {
        match self {
            Self::Tcp(_) => Framing::Tcp,
            Self::Serial(_) => Framing::Rtu {
                gap: GAP.max(settings.silence()),
            },
            Self::Pty(_) | Self::RtuOverTcp(_) => Framing::Rtu { gap: GAP },
        }
    }

    /// The setting of a serial port; others have none.
    pub(super) fn settings(
        &self,
        arguments: &Simulate,
        factory: LineSettings,
    ) -> Result<LineSettings, CommandError> {
        let (baud, parity, stop_bits) = (arguments.baud, arguments.parity, arguments.stop_bits);
        let useless = [
            ("--baud", baud.is_some()),
            ("--parity", parity.is_some()),
            ("--stop-bits", stop_bits.is_some()),
        ];
        match useless.iter().find(|(_, is_given)| *is_given) {
            Some((option, _)) if !matches!(self, Self::Serial(_)) => Err(CommandError::NoEffect {
                option,
                what: "a serial port",
            }),
            _ => Ok(settings(baud, parity, stop_bits, factory)),
        }
    }

    /// Opens it, and returns it with what clients know it by.
    pub(super) fn open(
        &self,
        settings: LineSettings,
        wait: Duration,
        clock: &dyn Clock,
    ) -> Result<(Box<dyn Outside>, String), CommandError> {
        match self {
            Self::Pty(name) => Ok(pty(name.as_deref())?),
            Self::Serial(name) => {
                let port = while_busy(clock, name, wait, &|| false, || {
                    SerialOutside::open(name, settings)
                });
                Ok((Box::new(port?), name.clone()))
            }
            Self::RtuOverTcp(address) => listen("rtu+tcp", address),
            Self::Tcp(address) => listen("tcp", address),
        }
    }
}

fn listen(scheme: &str, address: &str) -> Result<(Box<dyn Outside>, String), CommandError> {
    let listener = Listener::open(address)?;
    let name = format!("{scheme}://{}", listener.address());
    Ok((Box::new(listener), name))
}

#[cfg(unix)]
fn pty(name: Option<&Path>) -> Result<(Box<dyn Outside>, String), PtyError> {
    let pty = match name {
        None => Pty::new()?,
        Some(name) => Pty::named(name)?,
    };
    let path = pty.path();
    Ok((Box::new(pty), path))
}

#[cfg(not(unix))]
fn is_device(_: &Path) -> bool {
    false
}

#[cfg(not(unix))]
fn is_link_to_pty(_: &Path) -> bool {
    false
}

#[cfg(not(unix))]
fn pty(_: Option<&Path>) -> Result<(Box<dyn Outside>, String), PtyError> {
    Err(PtyError::Unknown)
}

/// An address with the port of Modbus TCP where it names none.
fn with_port(address: &str) -> String {
    // The colons of `[::1]` are none before a port.
    let behind = address.rsplit(']').next().unwrap_or(address);
    if address.is_empty() || behind.contains(':') {
        address.to_owned()
    } else {
        format!("{address}:{MODBUS_PORT}")
    }
}
