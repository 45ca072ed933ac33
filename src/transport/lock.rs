//! Whether a port is held, seen without disturbing who holds it.

/// Somebody holds the lock of the port.
pub(super) struct Held;

/// A look at a port; nothing of it is locked.
#[cfg(unix)]
pub(super) struct Look(
    #[expect(dead_code, reason = "it keeps the port open")] Option<std::fs::File>,
);

/// Opens the port as nobody's terminal, without waiting for a carrier, and tries its lock; the lock
/// is free again on return. A port that cannot be looked at is not held, for all that is known:
/// whoever opens it next learns why.
#[cfg(unix)]
pub(super) fn look(name: &str) -> Result<Look, Held> {
    use std::fs::{File, TryLockError};

    use rustix::fs::{Mode, OFlags, open};

    let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::NONBLOCK | OFlags::CLOEXEC;
    let Ok(port) = open(name, flags, Mode::empty()) else {
        return Ok(Look(None));
    };
    let port = File::from(port);
    match port.try_lock() {
        Err(TryLockError::WouldBlock) => Err(Held),
        Err(TryLockError::Error(_)) => Ok(Look(None)),
        // Where it cannot be given back, closing gives it back.
        Ok(()) => Ok(Look(port.unlock().is_ok().then_some(port))),
    }
}

/// Where the system lets nobody open a port twice there is nothing to look for.
#[cfg(not(unix))]
pub(super) struct Look;

/// Sees nothing.
#[cfg(not(unix))]
pub(super) fn look(_: &str) -> Result<Look, Held> {
    Ok(Look)
}
