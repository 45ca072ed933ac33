//! What the tries of a loop-back test come to, in numbers.

use std::collections::BTreeMap;

use super::{AnswerTime, LineEcho};
use crate::client::{Counters, Failure};

/// Counts tries as they end. Its size follows from how much answer times differ, not from how many
/// tries there are, so that a test can go on for days.
#[derive(Debug, Clone, Default)]
pub struct Tally {
    tries: u64,
    answered: u64,
    failed: Failed,
    noticed: Noticed,
    /// How many answers took so long.
    times: BTreeMap<AnswerTime, u64>,
    last: Option<AnswerTime>,
    /// How far each answer time is from the one before, added up in tenths of a millisecond.
    steps: u64,
}

/// Tries that were not answered, by why.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Failed {
    /// The meter refused.
    pub refused: u64,
    /// Nothing came.
    pub silent: u64,
    /// Nothing but our own echo came.
    pub only_echo: u64,
    /// The answer was damaged: the CRC was wrong, or the bytes were no frame.
    pub damaged: u64,
    /// The answer broke off.
    pub truncated: u64,
    /// The unit answered something else.
    pub mismatched: u64,
    /// The line was never silent, or the port was lost.
    pub unsent: u64,
}

impl Failed {
    /// All that the line, and not the meter, is to blame for.
    pub const fn lost(&self) -> u64 {
        let Self {
            refused: _,
            silent,
            only_echo,
            damaged,
            truncated,
            mismatched,
            unsent,
        } = *self;
        silent + only_echo + damaged + truncated + mismatched + unsent
    }
}

/// What was noticed on the line beside the answers.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Noticed {
    /// Bytes that belong to no frame.
    pub noise: u64,
    /// Answers that came after their time, before the last try went out.
    pub late: u64,
    /// Frames of other units.
    pub others: u64,
}

impl Noticed {
    /// What was counted between two moments.
    pub const fn between(before: &Counters, after: &Counters) -> Self {
        Self {
            noise: after.stray - before.stray,
            late: after.late - before.late,
            others: after.others - before.others,
        }
    }
}

/// What all tries come to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Summary {
    /// How many there were.
    pub tries: u64,
    /// How many were answered as they should be.
    pub answered: u64,
    /// The others.
    pub failed: Failed,
    /// How long answers took; `None` without any.
    pub times: Option<Times>,
    /// What was noticed beside them.
    pub noticed: Noticed,
    /// Whether the line echoes.
    pub echo: LineEcho,
}

/// How long answers took to begin. Percentiles are by nearest rank: the least time that so many of a
/// hundred answers did not exceed, so each of them was measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Times {
    /// The shortest.
    pub min: AnswerTime,
    /// The 50th percentile.
    pub median: AnswerTime,
    /// The 95th.
    pub p95: AnswerTime,
    /// The longest.
    pub max: AnswerTime,
    /// The mean difference between an answer time and that of the answer before it, whichever is
    /// longer; `None` with one answer. This is what the jitter of RFC 3550 (6.4.1) estimates,
    /// without its smoothing.
    pub jitter: Option<AnswerTime>,
}

impl Tally {
    /// One more try, and what was noticed beside it.
    pub fn add(&mut self, result: &Result<AnswerTime, Failure>, beside: Noticed) {
        self.tries += 1;
        self.noticed.late += beside.late;
        self.noticed.others += beside.others;
        self.noticed.noise += beside.noise;
        let time = match result {
            Ok(time) => *time,
            Err(failure) => return self.fail(failure),
        };
        self.answered += 1;
        *self.times.entry(time).or_default() += 1;
        if let Some(last) = self.last.replace(time) {
            let step = last.tenths().abs_diff(time.tenths());
            self.steps = self.steps.saturating_add(step);
        }
    }

    /// How many tries there were so far.
    pub const fn tries(&self) -> u64 {
        self.tries
    }

    fn fail(&mut self, failure: &Failure) {
        let failed = &mut self.failed;
        *match failure {
            Failure::Exception(_) => &mut failed.refused,
            Failure::Silence { .. } | Failure::Stopped => &mut failed.silent,
            Failure::OnlyEcho => &mut failed.only_echo,
            Failure::Damaged { .. } => &mut failed.damaged,
            Failure::Truncated { .. } => &mut failed.truncated,
            Failure::Mismatch { .. } => &mut failed.mismatched,
            Failure::Ambiguous | Failure::NeverQuiet { .. } | Failure::Port(_) => {
                &mut failed.unsent
            }
        } += 1;
    }

    /// What it all comes to, on a line that echoes or does not.
    pub fn summary(&self, echo: LineEcho) -> Summary {
        Summary {
            tries: self.tries,
            answered: self.answered,
            failed: self.failed,
            times: self.times(),
            noticed: self.noticed,
            echo,
        }
    }

    fn times(&self) -> Option<Times> {
        let (min, _) = self.times.first_key_value()?;
        let (max, _) = self.times.last_key_value()?;
        let jitter = self.answered.checked_sub(1).filter(|steps| *steps > 0);
        Some(Times {
            min: *min,
            median: self.percentile(50)?,
            p95: self.percentile(95)?,
            max: *max,
            // To the nearest tenth, as the times themselves.
            jitter: jitter.map(|steps| {
                let doubled = u128::from(self.steps) * 2 + u128::from(steps);
                let mean = doubled / (u128::from(steps) * 2);
                AnswerTime::from_tenths(u64::try_from(mean).unwrap_or(u64::MAX))
            }),
        })
    }

    /// The time that `percent` of a hundred answers did not exceed.
    fn percentile(&self, percent: u64) -> Option<AnswerTime> {
        let rank = (u128::from(self.answered) * u128::from(percent)).div_ceil(100);
        let mut counted = 0;
        let mut times = self.times.iter();
        let found = times.find(|(_, count)| {
            counted += u128::from(**count);
            counted >= rank
        });
        found.map(|(time, _)| *time)
    }
}
