//! How a meter is to be treated.

use std::time::Duration;

/// How patient the client is with one meter, and what it knows of the meter's ways.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Patience {
    /// How long an answer may take to begin; its transfer time comes on top.
    pub timeout: Duration,
    /// How long the meter may take at the worst: as long, past the time-out, nothing else is asked
    /// of a unit that has not answered.
    pub longest_answer: Duration,
    /// How many times a request is repeated when the line fails.
    pub retries: u32,
    /// Least time between the end of anything on the line and the next request; t3.5 is kept
    /// anyway.
    pub pause: Duration,
    /// How a late answer can be told from the right one.
    pub ways: Ways,
}

impl Default for Patience {
    /// One second, two retries, no pause, and nothing known of the meter.
    fn default() -> Self {
        Self {
            timeout: Duration::from_secs(1),
            longest_answer: Duration::from_secs(1),
            retries: 2,
            pause: Duration::ZERO,
            ways: Ways::default(),
        }
    }
}

impl Patience {
    /// How long an answer may take to begin at the most.
    pub(super) fn at_the_most(self) -> Duration {
        self.timeout.max(self.longest_answer)
    }

    /// How long an answer is remembered, for a second copy of it may come: longer than late answers
    /// are waited for.
    pub(super) fn of_copies(self) -> Duration {
        self.at_the_most().saturating_mul(4)
    }

    /// How long a request may take in all while the meter says that it is busy: as long as all
    /// attempts at a silent one take, and a second at least, for a meter that says so is alive.
    pub(super) fn in_all(self) -> Duration {
        let attempts = self.timeout.saturating_mul(self.retries.saturating_add(1));
        attempts.max(Duration::from_secs(1))
    }
}

/// What a meter's ways are good for in telling a late answer from the right one. Nothing, for a
/// meter of which nothing is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Ways {
    /// Functions 03 and 04 read the same registers.
    pub interchangeable_reads: bool,
    /// What function 08 sends back, on a meter that has it.
    pub loopback: Option<QueryData>,
}

impl Ways {
    /// Whether they are good for anything.
    pub(super) const fn tell_late_answers(self) -> bool {
        self.interchangeable_reads || self.loopback.is_some()
    }
}

/// The data that a meter's function 08 takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum QueryData {
    /// Nothing but 0000.
    Zero,
    /// Any word.
    Any,
}
