//! The loop-back test: a word goes out with function 08 and has to come back, again and again.
//!
//! * [`word`] is what goes out at each try.
//! * [`echo`](super::echo) finds out first whether the line echoes: the answer to function 08 is its request byte
//!   for byte, so that an echo alone would pass for a meter.
//! * [`tally`] is what the tries come to, [`verdict`] what that says of the line; both are pure.

pub mod tally;
pub mod verdict;

use std::fmt;
use std::time::Duration;

use jiff::Timestamp;

use crate::client::{Client, Failure, Patience};
use crate::codec::Unit;
use crate::profile::LoopbackData;

pub use super::echo::LineEcho;
pub use tally::{Noticed, Summary, Tally, Times};
pub use verdict::Verdict;

/// One word sent out, and what became of it.
#[derive(Debug)]
pub struct Try {
    /// Which one, from 1.
    pub number: u64,
    /// When it began.
    pub time: Timestamp,
    /// What was sent.
    pub word: u16,
    /// How long the meter took to begin its answer, or why there is none.
    pub result: Result<AnswerTime, Failure>,
}

/// How long a meter took to begin its answer, in whole tenths of a millisecond: what is printed is
/// what is counted. Prints as milliseconds, `12.3`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct AnswerTime {
    tenths: u64,
}

impl AnswerTime {
    /// So many tenths of a millisecond.
    pub const fn from_tenths(tenths: u64) -> Self {
        Self { tenths }
    }

    /// Tenths of a millisecond.
    pub const fn tenths(self) -> u64 {
        self.tenths
    }
}

impl From<Duration> for AnswerTime {
    /// To the nearest tenth; half of one goes up.
    fn from(time: Duration) -> Self {
        let tenths = (time.as_micros() + 50) / 100;
        Self {
            tenths: u64::try_from(tenths).unwrap_or(u64::MAX),
        }
    }
}

impl fmt::Display for AnswerTime {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}.{}", self.tenths / 10, self.tenths % 10)
    }
}

/// Sends the word of this try once and waits for it. What is still owed for earlier tries is waited
/// for before that, so it is never taken for this one's.
pub fn attempt(
    client: &mut Client,
    unit: Unit,
    number: u64,
    data: LoopbackData,
    patience: Patience,
) -> Try {
    let word = word(data, number);
    Try {
        number,
        time: client.utc_now(),
        word,
        result: client.loop_back(unit, word, patience).map(AnswerTime::from),
    }
}

/// How many tries it takes until the words begin anew.
pub const WORDS: u64 = 36;

/// What goes out at a try, counted from 1: nothing, everything, every other bit, each bit alone,
/// and all but each bit. No two of [`WORDS`] in a row are the same, so that an answer to another try
/// is told from the right one; a meter that sends back 0 alone always gets 0.
pub const fn word(data: LoopbackData, number: u64) -> u16 {
    if matches!(data, LoopbackData::Zero) {
        return 0;
    }
    let index = number.wrapping_sub(1) % WORDS;
    match index {
        0 => 0x0000,
        1 => 0xFFFF,
        2 => 0x5555,
        3 => 0xAAAA,
        4..20 => 1 << (index - 4),
        _ => !(1 << (index - 20)),
    }
}
