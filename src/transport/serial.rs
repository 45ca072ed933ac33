//! The serial port, through the crate `serialport`.
//!
//! What its error kinds mislead about, on Linux: "not there" and "busy" are both `NoDevice` or
//! `NotFound`, so the path is looked at first; a port that hung up gives `BrokenPipe`, `Unknown` or
//! an empty read, so any failure but a time-out or a signal counts as loss. On Windows "not there"
//! and "busy" are both `NoDevice` and nothing tells them apart, so there the system's own words
//! have to do.
//!
//! A port is held by two locks, for each binds only some: `TIOCEXCL` everybody but root, `flock`
//! those who ask for it. `serialport` takes the first before it asks for the second, and where the
//! second fails it takes back the first, *whoever's* it was. So as root the lock is looked at
//! before that library is let near the port, and as a holder both are taken anew at each request,
//! since other programs on that library are not as careful.

use std::io::{self, Read, Write};
use std::path::Path;
use std::time::Duration;

use log::debug;
use serialport::{ClearBuffer, DataBits, ErrorKind, FlowControl, SerialPort};

use super::holder::Holders;
use super::{LineSettings, OpenError, Parity, StopBits, Transport, TransportError, lock};

#[cfg(unix)]
type Port = serialport::TTYPort;
#[cfg(windows)]
type Port = serialport::COMPort;

/// How long a write may wait for room in the driver's buffer. A frame is 256 bytes at the most,
/// so only a dead adapter takes this long.
const WRITE_WAIT: Duration = Duration::from_secs(2);

/// A serial port, held exclusively while it is open. Once it fails it is closed at once: an adapter
/// that is plugged in again gets another name for as long as the dead one is held.
pub struct Serial {
    name: String,
    settings: LineSettings,
    port: Option<Port>,
}

impl Serial {
    /// Opens `name` and sets it up. A second open by anybody fails while this one lives.
    ///
    /// # Errors
    /// [`OpenError`] tells not there, busy, not permitted and not a serial port apart.
    pub fn open(name: &str, settings: LineSettings) -> Result<Self, OpenError> {
        Ok(Self {
            name: name.to_owned(),
            settings,
            port: Some(open(name, settings)?),
        })
    }

    /// Does something with the open port; when that fails, the port is lost and closed.
    fn with_port<T>(
        &mut self,
        work: impl FnOnce(&mut Port) -> io::Result<T>,
    ) -> Result<T, TransportError> {
        let result = match &mut self.port {
            Some(port) => work(port),
            None => Err(io::Error::other("it is closed")),
        };
        result.map_err(|source| {
            self.close();
            TransportError::Lost {
                port: self.name.clone(),
                source,
            }
        })
    }

    fn close(&mut self) {
        let Some(port) = self.port.take() else {
            return;
        };
        // The system waits with closing until all is sent: on a dead adapter, half a minute.
        if let Err(error) = port.clear(ClearBuffer::Output) {
            debug!("port {}: while closing: {error}", self.name);
        }
    }
}

impl Transport for Serial {
    fn send(&mut self, frame: &[u8]) -> Result<(), TransportError> {
        self.with_port(|port| {
            hold(port);
            port.set_timeout(WRITE_WAIT)?;
            // One system call: the driver takes a frame whole, and a meter resets its receiver at
            // a gap inside a request.
            port.write_all(frame)
        })
    }

    fn receive(&mut self, into: &mut [u8], wait: Duration) -> Result<usize, TransportError> {
        self.with_port(|port| {
            port.set_timeout(wait)?;
            match port.read(into) {
                Ok(0) => Err(io::ErrorKind::UnexpectedEof.into()),
                Ok(count) => Ok(count),
                Err(error) => match error.kind() {
                    io::ErrorKind::TimedOut | io::ErrorKind::Interrupted => Ok(0),
                    _ => Err(error),
                },
            }
        })
    }

    fn discard_input(&mut self) -> Result<(), TransportError> {
        self.with_port(|port| Ok(port.clear(ClearBuffer::Input)?))
    }

    fn reopen(&mut self) -> Result<(), OpenError> {
        self.close();
        self.port = Some(open(&self.name, self.settings)?);
        Ok(())
    }
}

/// Takes both locks anew. What fails here fails at the next use of the port as well.
#[cfg(unix)]
fn hold(port: &mut Port) {
    let _ = port.set_exclusive(true);
}

/// The system shares no port.
#[cfg(not(unix))]
fn hold(_: &mut Port) {}

fn open(name: &str, settings: LineSettings) -> Result<Port, OpenError> {
    if let Some(error) = obstacle(name) {
        return Err(error);
    }
    let look = lock::look(name).map_err(|lock::Held| busy(name.to_owned()))?;
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
        .open_native()
        .map_err(|error| open_error(name, settings, error))?;
    // Not before: the last one to close a port lets DTR drop, which some adapters live on.
    drop(look);
    Ok(port)
}

const fn busy(port: String) -> OpenError {
    OpenError::Busy {
        port,
        holders: Holders::Unknown,
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
        ErrorKind::NoDevice => busy(port),
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
