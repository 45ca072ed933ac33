//! When a meter is read: at a fixed rate, on round times of the wall clock.
//!
//! The slots of an interval are its multiples since 1970-01-01 00:00 UTC. One that divides a day,
//! such as 15 minutes, so falls on the same times every day; one that does not, such as 7 minutes,
//! falls on other times each day, but two runs with the same interval agree on them. Slots are in UTC,
//! so that summer time changes nothing.
//!
//! The pace is the monotonic clock's. The wall clock says only where the round times are: after each
//! slot the next one is moved to the nearest of them, by half an interval at the most. So nothing
//! drifts, and when somebody sets the wall clock, by an hour or a year, no slot comes twice and
//! none come in a bunch: the next one comes after half an interval at the earliest and one and a
//! half at the latest.
//!
//! A slot is begun before the next one is due, or not at all. What could not be begun is missed and
//! counted.

use std::fmt;
use std::time::Duration;

use jiff::Timestamp;
use thiserror::Error;

use crate::transport::Clock;

/// From one slot to the next, from 10 ms to 24 h. Prints as `15m`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Every(Duration);

/// An interval out of its bounds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[error("an interval is from 10ms to 24h")]
pub struct EveryError;

impl Every {
    /// The shortest: less than the shortest read at 115200 baud takes twice.
    const SHORTEST: Duration = Duration::from_millis(10);
    /// The longest.
    const LONGEST: Duration = Duration::from_secs(24 * 60 * 60);

    /// Checks an interval.
    ///
    /// # Errors
    /// [`EveryError`] below 10 ms and above 24 h.
    pub fn new(interval: Duration) -> Result<Self, EveryError> {
        if (Self::SHORTEST..=Self::LONGEST).contains(&interval) {
            return Ok(Self(interval));
        }
        Err(EveryError)
    }

    /// The interval.
    pub const fn get(self) -> Duration {
        self.0
    }
}

impl fmt::Display for Every {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        humantime::format_duration(self.0).fmt(f)
    }
}

/// One moment on both clocks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Moment {
    /// On the monotonic clock.
    pub now: Duration,
    /// On the wall clock.
    pub utc: Timestamp,
}

impl Moment {
    /// This one.
    pub fn of(clock: &dyn Clock) -> Self {
        Self {
            now: clock.now(),
            utc: clock.utc_now(),
        }
    }

    /// What the wall clock says at another time of the monotonic clock, in nanoseconds since 1970.
    fn wall(self, at: Duration) -> i128 {
        self.utc.as_nanosecond() + signed(at) - signed(self.now)
    }
}

/// Reads both clocks. Two looks at them never agree to the nanosecond, and slots that are due together
/// are to stay so: as long as they agree to the millisecond, they count as one.
#[derive(Debug, Clone, Default)]
pub struct Clocks {
    /// How far the wall clock is ahead of the monotonic one, in nanoseconds.
    ahead: Option<i128>,
}

impl Clocks {
    /// Less than this is no change.
    const NOTHING: i128 = 1_000_000;

    /// This moment.
    pub fn look(&mut self, clock: &dyn Clock) -> Moment {
        // In this order: where the program is held up in between, slots are late and never early.
        let utc = clock.utc_now().as_nanosecond();
        let now = clock.now();
        let found = utc - signed(now);
        let ahead = match self.ahead {
            Some(known) if (known - Self::NOTHING..=known).contains(&found) => known,
            _ => found,
        };
        self.ahead = Some(ahead);
        Moment {
            now,
            utc: timestamp(signed(now) + ahead),
        }
    }
}

/// A slot that is due.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Slot {
    /// When it was due, on the monotonic clock.
    pub due: Duration,
    /// When that is on the wall clock as it goes now.
    pub time: Timestamp,
    /// How long ago that was.
    pub late: Duration,
    /// How many slots before it were not begun.
    pub missed: u64,
}

/// The slots of one interval.
#[derive(Debug, Clone)]
pub struct Schedule {
    every: Every,
    next: Duration,
}

impl Schedule {
    /// From now on; the first slot is now when this is a round time, and else the next one that is.
    pub fn new(every: Every, start: Moment) -> Self {
        let interval = nanoseconds(every);
        let wait = (-start.utc.as_nanosecond()).rem_euclid(interval);
        Self {
            every,
            next: start.now.saturating_add(unsigned(wait)),
        }
    }

    /// When the next slot is due, on the monotonic clock.
    pub const fn next(&self) -> Duration {
        self.next
    }

    /// The slot that is due, if one is, and none of those before it; the next one is further on
    /// then.
    pub fn take(&mut self, moment: Moment) -> Option<Slot> {
        let late = moment.now.checked_sub(self.next)?;
        let interval = nanoseconds(self.every);
        // The last that is due: one further back has had its time.
        let missed = signed(late) / interval;
        let due = self.next + unsigned(missed * interval);
        let slot = Slot {
            due,
            time: timestamp(moment.wall(due)),
            late: moment.now.saturating_sub(due),
            missed: u64::try_from(missed).unwrap_or(u64::MAX),
        };
        self.next = self.after(due, moment);
        Some(slot)
    }

    /// The slot after one: an interval on, and from there to the nearest round time.
    fn after(&self, due: Duration, moment: Moment) -> Duration {
        let interval = nanoseconds(self.every);
        let next = due.saturating_add(self.every.get());
        // How far behind a round time it is; more than half an interval is before the next one.
        let behind = moment.wall(next).rem_euclid(interval);
        let shift = if behind * 2 > interval {
            interval - behind
        } else {
            -behind
        };
        let mut aligned = signed(next) + shift;
        if aligned <= signed(moment.now) {
            aligned += interval;
        }
        unsigned(aligned)
    }
}

const fn nanoseconds(every: Every) -> i128 {
    signed(every.0)
}

/// Clocks run for centuries at the most, which are far from any limit.
#[expect(
    clippy::cast_possible_wrap,
    reason = "a Duration has fewer than 2^94 nanoseconds"
)]
const fn signed(time: Duration) -> i128 {
    time.as_nanos() as i128
}

fn unsigned(nanoseconds: i128) -> Duration {
    let nanoseconds = u64::try_from(nanoseconds.max(0)).unwrap_or(u64::MAX);
    Duration::from_nanos(nanoseconds)
}

/// The last moment there is, for what is beyond it.
fn timestamp(nanoseconds: i128) -> Timestamp {
    Timestamp::from_nanosecond(nanoseconds).unwrap_or(Timestamp::MAX)
}
