//! A pseudo terminal whose other end clients open like a serial port.
//!
//! Both ends are held: so the line does not hang up while no client has it open, and one that comes
//! back finds it as it was. What is written while none reads stays there for the next, some
//! thousand bytes of it; a client throws stale bytes away when it opens a port.
//!
//! A client that was killed takes its lock on a serial port with it, since the port is closed then. A
//! pty that is held open is not: so on Linux it is unlocked when the last client has gone.

#[cfg(target_os = "linux")]
mod visitors;

use std::fs::File;
use std::io::{self, Read, Write};
use std::os::fd::{AsFd, OwnedFd};
use std::os::unix::fs::FileTypeExt;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::{Mode, OFlags, fcntl_setfl, open};
use rustix::io::{Errno, ioctl_fionread};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
#[cfg(target_os = "linux")]
use rustix::termios::ioctl_tiocnxcl;
use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};

use super::outside::{CHUNK, heard_on_line};
use super::{Afterwards, ClientId, Existing, Heard, OpenError, Outside, PtyError, TransportError};

/// After this long what was written has come to the other end, and if it is not there, it was read.
const ON_ITS_WAY: Duration = Duration::from_millis(100);

/// How often it is looked whether a client has read everything.
const LOOK_AGAIN: Duration = Duration::from_millis(1);

/// A pty, raw as a serial line is.
pub struct Pty {
    ends: Option<Ends>,
    /// The path of the clients' end.
    path: String,
    /// A name of its own that leads there; it goes with the pty.
    link: Option<PathBuf>,
}

struct Ends {
    ours: File,
    theirs: OwnedFd,
    #[cfg(target_os = "linux")]
    visitors: Option<visitors::Visitors>,
}

impl Pty {
    /// Makes a pty.
    ///
    /// # Errors
    /// [`PtyError::None`].
    pub fn new() -> Result<Self, PtyError> {
        let (ends, path) = Ends::new().map_err(PtyError::None)?;
        Ok(Self {
            ends: Some(ends),
            path,
            link: None,
        })
    }

    /// Makes a pty that clients find under a name, a symbolic link to it that is removed when this
    /// is dropped.
    ///
    /// # Errors
    /// [`PtyError`]; nothing of that name may exist. A link to a pty that was there before is of a
    /// program that still runs, or of one that was killed: by now somebody's terminal may be there.
    pub fn named(name: &Path) -> Result<Self, PtyError> {
        let mut pty = Self::new()?;
        let path = || name.display().to_string();
        std::os::unix::fs::symlink(&pty.path, name).map_err(|source| match source.kind() {
            io::ErrorKind::AlreadyExists => PtyError::Exists {
                path: path(),
                what: kind_of_file(name),
            },
            _ => PtyError::Name {
                path: path(),
                source,
            },
        })?;
        pty.link = Some(name.to_owned());
        Ok(pty)
    }

    /// What a client opens: the name, else the path of the pty itself, `/dev/pts/5`.
    pub fn path(&self) -> String {
        match &self.link {
            Some(link) => link.display().to_string(),
            None => self.path.clone(),
        }
    }

    fn lost(&self, source: impl Into<io::Error>) -> TransportError {
        TransportError::Lost {
            port: self.path(),
            source: source.into(),
        }
    }

    fn ends(&mut self) -> Result<&mut Ends, TransportError> {
        let lost = self.lost(io::ErrorKind::NotConnected);
        self.ends.as_mut().ok_or(lost)
    }

    /// Makes another pty under the same name, and hangs up on whoever has the one before.
    fn renew(&mut self, link: &Path) -> io::Result<()> {
        let (ends, path) = Ends::new()?;
        // In one step, so that a client never finds nothing there.
        let aside = aside(link);
        std::os::unix::fs::symlink(&path, &aside)?;
        std::fs::rename(&aside, link).inspect_err(|_| drop(std::fs::remove_file(&aside)))?;
        self.path = path;
        self.ends = Some(ends);
        Ok(())
    }
}

impl Drop for Pty {
    /// Removes the name, unless somebody has put another thing there.
    fn drop(&mut self) {
        if let Some(link) = &self.link
            && std::fs::read_link(link).is_ok_and(|target| target == Path::new(&self.path))
        {
            let _ = std::fs::remove_file(link);
        }
    }
}

impl Outside for Pty {
    fn hear(&mut self, wait: Duration) -> Result<Heard, TransportError> {
        let mut chunk = [0; CHUNK];
        match self.ends()?.receive(&mut chunk, wait) {
            Ok(count) => Ok(heard_on_line(&chunk, count)),
            Err(error) => Err(self.lost(error)),
        }
    }

    fn say(&mut self, _: ClientId, bytes: &[u8]) -> Result<(), TransportError> {
        match self.ends()?.ours.write(bytes) {
            Ok(_) => Ok(()),
            // Nobody reads, and there is no more room: a wire does not wait either.
            Err(error) if error.kind() == io::ErrorKind::WouldBlock => Ok(()),
            Err(error) => Err(self.lost(error)),
        }
    }

    /// Without a name nobody would know the pty that comes after this one.
    fn hang_up(&mut self, _: ClientId) -> Result<Afterwards, OpenError> {
        let Some(link) = self.link.clone() else {
            self.ends = None;
            return Ok(Afterwards::Closed);
        };
        let renewed = self.renew(&link);
        renewed.map_err(|source| OpenError::Other {
            port: self.path(),
            source,
        })?;
        Ok(Afterwards::Open)
    }

    fn finish(&mut self, limit: Duration) {
        let Some(ends) = &self.ends else {
            return;
        };
        let start = Instant::now();
        let mut has_come = false;
        while start.elapsed() < limit {
            // What was written takes a moment to come to the other end.
            match ioctl_fionread(&ends.theirs) {
                Ok(0) if has_come || start.elapsed() >= ON_ITS_WAY => return,
                Ok(0) => {}
                Ok(_) => has_come = true,
                Err(_) => return,
            }
            std::thread::sleep(LOOK_AGAIN);
        }
    }
}

impl Ends {
    /// A raw pty and the path of the clients' end; no child process inherits either end.
    fn new() -> io::Result<(Self, String)> {
        let ours = open_ours()?;
        grantpt(&ours)?;
        unlockpt(&ours)?;
        let path = ptsname(&ours, Vec::new())?;
        let path = path.into_string().map_err(io::Error::other)?;
        let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC;
        let theirs = open(path.as_str(), flags, Mode::empty())?;
        let mut attributes = tcgetattr(&theirs)?;
        attributes.make_raw();
        tcsetattr(&theirs, OptionalActions::Now, &attributes)?;
        fcntl_setfl(&ours, OFlags::RDWR | OFlags::NONBLOCK)?;
        let ends = Self {
            ours: File::from(ours),
            theirs,
            #[cfg(target_os = "linux")]
            visitors: visitors::Visitors::of(&path),
        };
        Ok((ends, path))
    }

    /// Takes away the lock of a client that has gone without.
    #[cfg(target_os = "linux")]
    fn unlock(&mut self) {
        if let Some(visitors) = &mut self.visitors
            && visitors.have_left()
        {
            let _ = ioctl_tiocnxcl(&self.theirs);
        }
    }

    /// Nothing tells when the last client has gone.
    #[cfg(not(target_os = "linux"))]
    fn unlock(&mut self) {}

    /// What there is to wait for.
    #[cfg(target_os = "linux")]
    fn waiting(&self) -> Vec<PollFd<'_>> {
        let ours = PollFd::from_borrowed_fd(self.ours.as_fd(), PollFlags::IN);
        let visitors = self.visitors.iter();
        let visitors = visitors.map(|events| PollFd::new(events, PollFlags::IN));
        std::iter::once(ours).chain(visitors).collect()
    }

    /// What there is to wait for.
    #[cfg(not(target_os = "linux"))]
    fn waiting(&self) -> Vec<PollFd<'_>> {
        vec![PollFd::from_borrowed_fd(self.ours.as_fd(), PollFlags::IN)]
    }

    /// 0 when nothing came in time, or a signal did.
    fn receive(&mut self, into: &mut [u8], wait: Duration) -> io::Result<usize> {
        // Far more than anybody waits.
        let wait = Timespec::try_from(wait).unwrap_or(Timespec {
            tv_sec: 3600,
            tv_nsec: 0,
        });
        match poll(&mut self.waiting(), Some(&wait)) {
            Ok(0) | Err(Errno::INTR) => return Ok(0),
            Ok(_) => self.unlock(),
            Err(error) => return Err(error.into()),
        }
        match self.ours.read(into) {
            Ok(0) => Err(io::ErrorKind::UnexpectedEof.into()),
            Ok(count) => Ok(count),
            Err(error) => match error.kind() {
                io::ErrorKind::WouldBlock | io::ErrorKind::Interrupted => Ok(0),
                _ => Err(error),
            },
        }
    }
}

#[cfg(any(target_os = "linux", target_os = "freebsd", target_os = "netbsd"))]
fn open_ours() -> io::Result<OwnedFd> {
    let flags = OpenptFlags::RDWR | OpenptFlags::NOCTTY;
    Ok(openpt(flags | OpenptFlags::CLOEXEC)?)
}

/// Other systems know no such flag for ptys: a child that is made between these two inherits it.
#[cfg(not(any(target_os = "linux", target_os = "freebsd", target_os = "netbsd")))]
fn open_ours() -> io::Result<OwnedFd> {
    let ours = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY)?;
    rustix::io::fcntl_setfd(&ours, rustix::io::FdFlags::CLOEXEC)?;
    Ok(ours)
}

/// A name beside this one that nobody else takes.
fn aside(link: &Path) -> PathBuf {
    let mut name = link.file_name().unwrap_or_default().to_owned();
    name.push(format!(".{}", std::process::id()));
    link.with_file_name(name)
}

/// Whether this is a link, from outside of `/dev`, to the clients' end of a pty.
pub fn is_link_to_pty(path: &Path) -> bool {
    let is_link = path
        .symlink_metadata()
        .is_ok_and(|found| found.is_symlink());
    let target = || path.canonicalize().unwrap_or_default();
    is_link && !path.starts_with("/dev") && is_pty(&target())
}

#[cfg(not(target_os = "macos"))]
fn is_pty(path: &Path) -> bool {
    path.starts_with("/dev/pts")
}

/// `/dev/ttys003`; serial ports have a dot in their names.
#[cfg(target_os = "macos")]
fn is_pty(path: &Path) -> bool {
    let number = path
        .to_str()
        .and_then(|path| path.strip_prefix("/dev/ttys"));
    number.is_some_and(|number| number.bytes().all(|byte| byte.is_ascii_digit()))
}

/// Whether there is a device of this name, such as a serial port.
pub fn is_device(path: &Path) -> bool {
    path.metadata()
        .is_ok_and(|found| found.file_type().is_char_device())
}

fn kind_of_file(path: &Path) -> Existing {
    match path.symlink_metadata().map(|found| found.file_type()) {
        _ if is_link_to_pty(path) => Existing::LinkToPty,
        Ok(kind) if kind.is_dir() => Existing::Directory,
        Ok(kind) if kind.is_symlink() && !path.exists() => Existing::LostLink,
        Ok(kind) if kind.is_file() => Existing::File,
        _ => Existing::Other,
    }
}
