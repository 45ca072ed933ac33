//! Whether a client has a pty open, as far as the system tells.

use std::mem::MaybeUninit;
use std::os::fd::{AsFd, BorrowedFd, OwnedFd};

use rustix::fs::inotify::{CreateFlags, ReadFlags, Reader, WatchFlags, add_watch, init};

/// Room for a few events; more are read in turn.
const ROOM: usize = 512;

/// Counts how often a path is opened and closed.
pub(super) struct Visitors {
    events: OwnedFd,
    here: u64,
}

impl Visitors {
    /// Watches a path that nobody has open yet but this program. `None` where the system does not
    /// let it.
    pub(super) fn of(path: &str) -> Option<Self> {
        let events = init(CreateFlags::CLOEXEC | CreateFlags::NONBLOCK).ok()?;
        add_watch(&events, path, WatchFlags::OPEN | WatchFlags::CLOSE).ok()?;
        Some(Self { events, here: 0 })
    }

    /// Takes note of who came and went; whether the last one went.
    pub(super) fn have_left(&mut self) -> bool {
        let closed = ReadFlags::CLOSE_WRITE | ReadFlags::CLOSE_NOWRITE;
        let before = self.here;
        let mut has_closed = false;
        let mut room = [const { MaybeUninit::uninit() }; ROOM];
        let mut reader = Reader::new(&self.events, &mut room);
        // It ends when there are no more events.
        while let Ok(event) = reader.next() {
            if event.events().contains(ReadFlags::OPEN) {
                self.here += 1;
            } else if event.events().intersects(closed) {
                self.here = self.here.saturating_sub(1);
                has_closed = true;
            }
        }
        (before > 0 || has_closed) && self.here == 0
    }
}

impl AsFd for Visitors {
    fn as_fd(&self) -> BorrowedFd<'_> {
        self.events.as_fd()
    }
}
