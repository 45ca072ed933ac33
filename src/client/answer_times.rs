//! How long meters take before they begin to answer, as measured on this line.

use std::collections::{BTreeMap, VecDeque};
use std::time::Duration;

use crate::codec::Unit;

/// So many of a unit's last answers count.
const LAST: usize = 31;

/// The times of each unit's last answers.
#[derive(Debug, Default)]
pub(super) struct AnswerTimes(BTreeMap<Unit, VecDeque<Duration>>);

impl AnswerTimes {
    /// One more answer of a unit.
    pub(super) fn note(&mut self, unit: Unit, time: Duration) {
        let times = self.0.entry(unit).or_default();
        if times.len() == LAST {
            times.pop_front();
        }
        times.push_back(time);
    }

    /// The median: an answer that was held up once, or the few that come faster than the rest,
    /// change nothing. `None` before the first answer.
    pub(super) fn median(&self, unit: Unit) -> Option<Duration> {
        let mut times: Vec<Duration> = self.0.get(&unit)?.iter().copied().collect();
        times.sort_unstable();
        times.get(times.len() / 2).copied()
    }
}

/// When the bytes of one exchange came; nothing once some of them were let go, for then the others
/// cannot be counted any more.
#[derive(Debug, Default)]
pub(super) struct Arrivals {
    came: Vec<(usize, Duration)>,
    is_useless: bool,
}

impl Arrivals {
    /// Nothing, and nothing any more: bytes were taken out.
    pub(super) const fn useless() -> Self {
        Self {
            came: Vec::new(),
            is_useless: true,
        }
    }

    /// So many more came at this time; `is_whole` while none was let go.
    pub(super) fn note(&mut self, count: usize, at: Duration, is_whole: bool) {
        self.is_useless |= !is_whole;
        if self.is_useless {
            self.came = Vec::new();
            return;
        }
        let before = self.came.last().map_or(0, |(total, _)| *total);
        self.came.push((before + count, at));
    }

    /// When the byte with this index came, and how many came with it that are not before it, itself
    /// included.
    pub(super) fn of(&self, index: usize) -> Option<(Duration, usize)> {
        let (total, at) = self.came.iter().find(|(total, _)| *total > index)?;
        Some((*at, total - index))
    }
}
