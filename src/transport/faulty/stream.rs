//! Bytes without end, made when they are due and never ahead.

use std::time::Duration;

use fastrand::Rng;

use super::effect::Pace;
use super::spoil;

/// What goes on until the next request, or for as long as its rule says.
pub(super) struct Stream {
    source: Source,
    every: Duration,
    next_at: Duration,
    until: Option<Duration>,
}

/// What comes.
pub(super) enum Source {
    /// A random byte each time.
    Garbage(Rng),
    /// A byte of these each time, over and over.
    Cycle { bytes: Vec<u8>, at: usize },
    /// An answer of another unit to this request each time.
    Stranger {
        request: Vec<u8>,
        unit: u8,
        chance: Rng,
    },
}

impl Stream {
    /// Begins at `from`.
    pub(super) fn new(source: Source, from: Duration, pace: Pace) -> Self {
        Self {
            source,
            every: pace.every,
            next_at: from,
            until: pace.lasts.map(|lasts| from.saturating_add(lasts)),
        }
    }

    /// Whether it is over some time, without another request.
    pub(super) const fn ends(&self) -> bool {
        self.until.is_some()
    }

    /// When the next bytes are due; `None` when it is over.
    pub(super) fn next_at(&self) -> Option<Duration> {
        let is_over = self.until.is_some_and(|until| self.next_at >= until);
        (!is_over).then_some(self.next_at)
    }

    /// The next bytes and when they were due; `None` when none are by `now`.
    pub(super) fn make(&mut self, now: Duration) -> Option<(Duration, Vec<u8>)> {
        let due = self.next_at().filter(|due| *due <= now)?;
        self.next_at = due.saturating_add(self.every);
        let bytes = match &mut self.source {
            Source::Garbage(chance) => vec![chance.u8(..)],
            Source::Cycle { bytes, at } => {
                let byte = bytes.get(*at).copied();
                *at = if *at + 1 < bytes.len() { *at + 1 } else { 0 };
                byte.into_iter().collect()
            }
            Source::Stranger {
                request,
                unit,
                chance,
            } => spoil::stranger(request, Some(*unit), chance),
        };
        Some((due, bytes))
    }

    /// Lets go of what has been due by `now`, without making it.
    pub(super) fn skip(&mut self, now: Duration) {
        if let Some(since) = now.checked_sub(self.next_at) {
            let missed = since.as_nanos() / self.every.as_nanos().max(1);
            let missed = u32::try_from(missed).unwrap_or(u32::MAX);
            let past = self.every.saturating_mul(missed.saturating_add(1));
            self.next_at = self.next_at.saturating_add(past);
        }
    }
}
