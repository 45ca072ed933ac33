//! What a read costs on this line.

use std::time::Duration;

use crate::transport::LineSettings;

/// Characters of a read request and of an answer without its registers.
const FIXED_CHARACTERS: usize = 8 + 5;

/// What reads cost on a line, all in nanoseconds: the planner adds up very many of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cost {
    /// Request, answer and silences, without the registers and the meter's own time.
    exchange: u64,
    /// The meter's own time.
    answer: u64,
    /// Each register.
    register: u64,
}

impl Cost {
    /// The cost on a line with these settings, where `pause` is kept between requests and the
    /// meter takes `answer` before it begins to answer.
    ///
    /// T(N) = (8 + 5 + 2N) c + 2 t3.5 + d: the first silence ends the request for the meter, the
    /// second one, or the pause where that is longer, comes before the next request.
    pub fn new(settings: LineSettings, pause: Duration, answer: Duration) -> Self {
        let silence = settings.silence();
        let exchange = settings.transfer_time(FIXED_CHARACTERS) + silence + silence.max(pause);
        Self {
            exchange: nanoseconds(exchange),
            answer: nanoseconds(answer),
            register: nanoseconds(settings.transfer_time(2)),
        }
    }

    /// The same line and a meter that takes `answer` before it begins to answer.
    #[must_use]
    pub fn with_answer(self, answer: Duration) -> Self {
        let answer = nanoseconds(answer);
        Self { answer, ..self }
    }

    /// The meter's own time that is reckoned with.
    pub const fn answer(self) -> Duration {
        Duration::from_nanos(self.answer)
    }

    /// How long it takes to read this many registers in one request.
    pub const fn of(self, registers: u16) -> Duration {
        Duration::from_nanos(self.nanoseconds(registers as u64))
    }

    /// The same as a number, which more than 584 years never leave.
    pub(super) const fn nanoseconds(self, registers: u64) -> u64 {
        self.exchange
            .saturating_add(self.answer)
            .saturating_add(self.register.saturating_mul(registers))
    }
}

fn nanoseconds(time: Duration) -> u64 {
    u64::try_from(time.as_nanos()).unwrap_or(u64::MAX)
}
