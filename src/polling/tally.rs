//! A poll in figures.

use std::collections::BTreeMap;
use std::time::Duration;

use super::line::{Cycle, Effort};

/// What has been counted of each set of points.
#[derive(Debug, Clone, Default)]
pub struct Tally(BTreeMap<usize, Counts>);

/// What has been counted of one.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Counts {
    /// Rows.
    pub rows: u64,
    /// Rows with every value.
    pub complete: u64,
    /// Rows that lack something, by their status.
    pub lacking: BTreeMap<String, u64>,
    /// Slots that were not begun.
    pub missed: u64,
    /// The longest that a slot was begun late.
    pub latest: Duration,
    /// How long the rows for which the meter was asked have taken in all, and the longest.
    pub took: (Duration, Duration),
    /// For how many rows it was asked.
    pub asked: u32,
    /// How long the meter takes to begin an answer, by the median of its last.
    pub answer_time: Option<Duration>,
}

impl Counts {
    /// How long a row has taken on average; `None` when the meter was never asked.
    pub fn mean(&self) -> Option<Duration> {
        self.took.0.checked_div(self.asked)
    }
}

impl Tally {
    /// One more row.
    pub fn add(&mut self, cycle: &Cycle) {
        let counts = self.0.entry(cycle.job).or_default();
        counts.rows += 1;
        match cycle.row.worst() {
            None => counts.complete += 1,
            Some(fault) => *counts.lacking.entry(fault.to_string()).or_default() += 1,
        }
        counts.missed = counts.missed.saturating_add(cycle.slot.missed);
        counts.latest = counts.latest.max(cycle.slot.late);
        if let Effort::Asked(_) = cycle.effort {
            counts.asked = counts.asked.saturating_add(1);
            let (all, longest) = counts.took;
            counts.took = (all.saturating_add(cycle.took), longest.max(cycle.took));
        }
        counts.answer_time = cycle.answer_time.or(counts.answer_time);
    }

    /// What has been counted of a set of points so far.
    pub fn of(&self, job: usize) -> Counts {
        self.0.get(&job).cloned().unwrap_or_default()
    }
}
