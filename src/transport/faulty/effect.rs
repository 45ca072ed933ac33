//! What a fault does, with its values.

use std::time::Duration;

use super::kind::FaultKind;

/// What a rule does to a request. `None` is a value left to chance.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Effect {
    Late {
        time_outs: Option<f64>,
        timeout: Duration,
    },
    Delay(Duration),
    Silence,
    Cut {
        keep: Option<usize>,
        /// When the rest comes, after the end of the request; `None` is never.
        rest: Option<Duration>,
    },
    Split {
        first: Option<usize>,
        gap: Duration,
    },
    Drip(Duration),
    Endless(Pace),
    Before {
        noise: Option<Vec<u8>>,
        gap: Duration,
    },
    After {
        noise: Option<Vec<u8>>,
        gap: Duration,
    },
    Echo {
        /// How many bytes; `None` is all of them.
        bytes: Option<usize>,
        gap: Duration,
    },
    EchoOnly,
    Twice(Duration),
    Crc,
    CrcSwapped,
    Flip(Option<usize>),
    Burst(Option<usize>),
    WrongUnit(Option<u8>),
    Stranger {
        unit: Option<u8>,
        gap: Duration,
    },
    StrangerOnly {
        unit: Option<u8>,
        pace: Pace,
    },
    WrongFunction(Option<u8>),
    WrongCount(Option<CountChange>),
    Oversize,
    Exception(Option<u8>),
    ExceptionFor(Option<u8>),
    Garbage(Pace),
    HangUp(Moment),
    Any(Vec<Choice>),
}

/// One of what `any` picks from.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Choice {
    pub(super) kind: FaultKind,
    pub(super) effect: Effect,
}

/// How something without end goes on: until the next request at the latest.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Pace {
    /// From one byte, or frame, to the next; above zero.
    pub(super) every: Duration,
    /// For how long; `None` is until the next request.
    pub(super) lasts: Option<Duration>,
}

/// How the data of an answer is changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum CountChange {
    /// One register more.
    More,
    /// One register fewer.
    Fewer,
    /// One byte more.
    Odd,
    /// No data.
    None,
    /// 255 bytes.
    Most,
}

impl CountChange {
    pub(super) const ALL: [Self; 5] = [Self::More, Self::Fewer, Self::Odd, Self::None, Self::Most];
}

/// When the port is lost.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Moment {
    /// As the request is sent: it does not reach the meter.
    Before,
    /// After part of the answer.
    During,
    /// After the answer.
    After,
}
