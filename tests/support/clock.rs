//! A clock that only moves when it is told to.

#![allow(dead_code, reason = "each test file uses its share")]

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use jiff::Timestamp;
use meterpoll::transport::Clock;

/// Starts at 0 and, but for one that [`Self::costs`] time, moves by `sleep` and `advance` alone, so that a test of waiting takes no time
/// and always ends the same. Shared in an `Arc`, all its holders see the same time.
#[derive(Debug)]
pub(crate) struct FakeClock {
    nanoseconds: AtomicU64,
    look: AtomicU64,
    start: Timestamp,
}

impl FakeClock {
    /// A clock whose day begins at 2026-01-15 12:00 UTC.
    pub(crate) fn new() -> Self {
        Self::starting("2026-01-15T12:00:00Z")
    }

    /// A clock whose day begins at this RFC 3339 time.
    pub(crate) fn starting(at: &str) -> Self {
        Self {
            nanoseconds: AtomicU64::new(0),
            look: AtomicU64::new(0),
            start: at.parse().unwrap(),
        }
    }

    /// Moves the time on.
    pub(crate) fn advance(&self, time: Duration) {
        self.nanoseconds.fetch_add(count(time), Ordering::SeqCst);
    }

    /// From now on so much time passes at each look at the clock, as on a machine that is slow.
    pub(crate) fn costs(&self, time: Duration) {
        self.look.store(count(time), Ordering::SeqCst);
    }
}

impl Clock for FakeClock {
    fn now(&self) -> Duration {
        let cost = self.look.load(Ordering::SeqCst);
        Duration::from_nanos(self.nanoseconds.fetch_add(cost, Ordering::SeqCst))
    }

    fn sleep(&self, time: Duration) {
        self.advance(time);
    }

    fn utc_now(&self) -> Timestamp {
        self.start + self.now()
    }
}

fn count(time: Duration) -> u64 {
    u64::try_from(time.as_nanos()).unwrap()
}
