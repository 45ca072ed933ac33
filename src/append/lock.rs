//! The lock of a file, which keeps two programs from writing at once.

use std::fs::{File, TryLockError};
use std::time::Duration;

use super::error::Problem;
use crate::transport::Clock;

/// How often a lock that another program holds is tried again. It is held for a few milliseconds.
const TRY_AGAIN: Duration = Duration::from_millis(5);

/// Takes the lock, waiting for it at most so long. Closing the file gives it back.
pub(super) fn lock(file: &File, wait: Duration, clock: &dyn Clock) -> Result<(), Problem> {
    let give_up = clock.now() + wait;
    loop {
        match file.try_lock() {
            Ok(()) => return Ok(()),
            Err(TryLockError::Error(error)) => return Err(Problem::Lock(error)),
            Err(TryLockError::WouldBlock) if clock.now() < give_up => clock.sleep(TRY_AGAIN),
            Err(TryLockError::WouldBlock) => return Err(Problem::Locked { waited: wait }),
        }
    }
}
