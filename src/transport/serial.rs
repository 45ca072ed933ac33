//! The serial port, through the crate `serialport`.
//!
//! What its error kinds mislead about, on Linux: "not there" and "busy" are both `NoDevice` or
//! `NotFound`, so the path is looked at first; a port that hung up gives `BrokenPipe`, `Unknown` or
//! an empty read, so any failure but a time-out or a signal counts as loss. On Windows "not there"
//! and "busy" are both `NoDevice` and nothing tells them apart, so there the system's own words
//! have to do.

use std::io::{self, Read, Write};
use std::path::Path;
use std::time::Duration;

use serialport::{ClearBuffer, DataBits, ErrorKind, FlowControl, SerialPort};

use super::{LineSettings, OpenError, Parity, StopBits, Transport, TransportError};

/// How long a write may wait for room in the driver's buffer. A frame is 256 bytes at the most,
/// so only a dead adapter takes this long.
const WRITE_WAIT: Duration = Duration::from_secs(2);

/// An open serial port, held exclusively.
pub struct Serial {
    name: String,
    port: Box<dyn SerialPort>,
}

impl Serial {
    /// Opens `name` and sets it up. A second open by anybody fails while this one lives.
    ///
    /// # Errors
    /// [`OpenError`] tells not there, busy, not permitted and not a serial port apart.
    pub fn open(name: &str, settings: LineSettings) -> Result<Self, OpenError> {
        if let Some(error) = obstacle(name) {
            return Err(error);
        }
        let port = serialport::new(name, settings.baud)
            .data_bits(DataBits::Eight)
            .flow_control(FlowControl::None)
            .parity(match settings.parity {
                Parity::None => serialport::Parity::None,
                Parity::Even => serialport::Parity::Even,
                Parity::Odd => serialport::Parity::Odd,
            })
            .stop_bits(match settings.stop_bits {
                StopBits::One => serialport::StopBits::One,
                StopBits::Two => serialport::StopBits::Two,
            })
            .open()
            .map_err(|error| open_error(name, settings, error))?;
        Ok(Self {
            name: name.to_owned(),
            port,
        })
    }

    fn lost(&self, source: impl Into<io::Error>) -> TransportError {
        TransportError::Lost {
            port: self.name.clone(),
            source: source.into(),
        }
    }
}

impl Transport for Serial {
    fn send(&mut self, frame: &[u8]) -> Result<(), TransportError> {
        self.port
            .set_timeout(WRITE_WAIT)
            .map_err(|error| self.lost(error))?;
        // One system call: the driver takes a frame whole, and a meter resets its receiver at a
        // gap inside a request.
        self.port.write_all(frame).map_err(|error| self.lost(error))
    }

    fn receive(&mut self, into: &mut [u8], wait: Duration) -> Result<usize, TransportError> {
        self.port
            .set_timeout(wait)
            .map_err(|error| self.lost(error))?;
        match self.port.read(into) {
            Ok(0) => Err(self.lost(io::Error::from(io::ErrorKind::UnexpectedEof))),
            Ok(count) => Ok(count),
            Err(error) => match error.kind() {
                io::ErrorKind::TimedOut | io::ErrorKind::Interrupted => Ok(0),
                _ => Err(self.lost(error)),
            },
        }
    }

    fn discard_input(&mut self) -> Result<(), TransportError> {
        self.port
            .clear(ClearBuffer::Input)
            .map_err(|error| self.lost(error))
    }
}

/// What the path itself shows, before anything is opened.
fn obstacle(name: &str) -> Option<OpenError> {
    let port = || name.to_owned();
    let found = match std::fs::metadata(Path::new(name)) {
        Ok(found) => found,
        // Windows names its ports outside the file system.
        Err(_) if cfg!(windows) => return None,
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            return Some(OpenError::NotThere { port: port() });
        }
        Err(source) => {
            return Some(OpenError::Other {
                port: port(),
                source,
            });
        }
    };
    let what = kind_of_file(&found)?;
    Some(OpenError::NotSerial { port: port(), what })
}

#[cfg(unix)]
fn kind_of_file(found: &std::fs::Metadata) -> Option<&'static str> {
    use std::os::unix::fs::FileTypeExt;
    let kind = found.file_type();
    if kind.is_char_device() {
        None
    } else if kind.is_dir() {
        Some("a directory")
    } else if kind.is_file() {
        Some("a file")
    } else {
        Some("no character device")
    }
}

#[cfg(not(unix))]
fn kind_of_file(found: &std::fs::Metadata) -> Option<&'static str> {
    found.is_dir().then_some("a directory")
}

fn open_error(name: &str, settings: LineSettings, error: serialport::Error) -> OpenError {
    let port = name.to_owned();
    match error.kind() {
        // Windows says so for a port that is not there as well as for one in use.
        ErrorKind::NoDevice if cfg!(windows) => OpenError::Other {
            port,
            source: error.into(),
        },
        // The path was there a moment ago, so this is the lock.
        ErrorKind::NoDevice => OpenError::Busy { port },
        ErrorKind::Io(io::ErrorKind::PermissionDenied) => not_permitted(port),
        ErrorKind::Io(io::ErrorKind::NotFound) => OpenError::NotThere { port },
        ErrorKind::InvalidInput => OpenError::Settings {
            port,
            settings: settings.to_string(),
            source: error.into(),
        },
        // A character device that is no terminal, `/dev/null` say, has no line settings.
        ErrorKind::Unknown if error.description == NOT_A_TTY => OpenError::NotSerial {
            port,
            what: "a device without line settings",
        },
        _ => OpenError::Other {
            port,
            source: error.into(),
        },
    }
}

/// How `serialport` words `ENOTTY`, which has no kind of its own there.
const NOT_A_TTY: &str = "Not a typewriter";

#[cfg(unix)]
fn not_permitted(port: String) -> OpenError {
    use std::os::unix::fs::MetadataExt;

    /// Mode bits that let a group read and write.
    const GROUP_MAY: u32 = 0o060;

    let found = std::fs::metadata(&port).ok();
    let name = |gid| {
        let group = uzers::get_group_by_gid(gid)?;
        Some(group.name().to_string_lossy().into_owned())
    };
    let owner = found.as_ref().and_then(|found| name(found.gid()));
    // Nobody should be told to join root's group, nor one that would not help.
    let helps =
        found.is_some_and(|found| found.gid() != 0 && found.mode() & GROUP_MAY == GROUP_MAY);
    let user = uzers::get_effective_username().map_or_else(
        || format!("uid {}", uzers::get_effective_uid()),
        |name| name.to_string_lossy().into_owned(),
    );
    let mut groups: Vec<String> = uzers::group_access_list()
        .unwrap_or_default()
        .iter()
        .map(|group| group.name().to_string_lossy().into_owned())
        .collect();
    groups.sort_unstable();
    groups.dedup();
    let member = if groups.is_empty() {
        "no group".to_owned()
    } else {
        groups.join(", ")
    };
    let whose = owner.as_ref().map_or_else(
        || "an unknown group".to_owned(),
        |group| format!("group {group}"),
    );
    OpenError::NotPermitted {
        port,
        who: format!("it belongs to {whose}, and user {user} is in {member}"),
        group: owner.filter(|_| helps),
    }
}

#[cfg(not(unix))]
fn not_permitted(port: String) -> OpenError {
    OpenError::NotPermitted {
        port,
        who: "the system denies access".to_owned(),
        group: None,
    }
}
