//! What is worth telling of a poll that may run for years: that something went wrong, once, and that
//! it is over.

use std::collections::{BTreeMap, BTreeSet};

use jiff::Timestamp;

use super::line::{Cycle, Effort};
use crate::readings::Fault;

/// After so many slots in a row that were begun, a line is in time again.
const IN_TIME: u64 = 10;

/// One thing to tell of a set of points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum News {
    /// Its readings are missing, for a reason that was not told since they were all there: see the
    /// cycle's troubles.
    Missing,
    /// They are all there again.
    Back {
        /// The slot of the first row that lacked some.
        since: Timestamp,
        /// How many rows did.
        rows: u64,
    },
    /// Slots were not begun, for the line was busy with others.
    Missed {
        /// How many.
        slots: u64,
    },
    /// Every slot is begun again.
    InTime {
        /// How many were not, in all.
        slots: u64,
    },
}

/// What has been told of each set of points.
#[derive(Debug, Default)]
pub struct Watch(BTreeMap<usize, Told>);

#[derive(Debug, Default)]
struct Told {
    /// The reasons that were told.
    faults: BTreeSet<Fault>,
    /// When the first row lacked something, and how many have since.
    lacking: Option<(Timestamp, u64)>,
    /// Slots that were not begun, since that was told.
    missed: u64,
    /// Slots in a row that were begun.
    begun: u64,
}

impl Watch {
    /// What there is to tell now that there is one more row.
    pub fn heed(&mut self, cycle: &Cycle) -> Vec<News> {
        let told = self.0.entry(cycle.job).or_default();
        let mut news = Vec::new();
        told.slots(cycle.slot.missed, &mut news);
        let is_well = cycle.troubles.is_empty() && matches!(cycle.effort, Effort::Asked(_));
        if is_well {
            let lacking = told.lacking.take();
            if !std::mem::take(&mut told.faults).is_empty()
                && let Some((since, rows)) = lacking
            {
                news.push(News::Back { since, rows });
            }
            return news;
        }
        let lacking = told.lacking.get_or_insert((cycle.slot.time, 0));
        lacking.1 += 1;
        // A meter that was not asked is told of where that was found out.
        if let Some(worst) = cycle.row.worst()
            && !cycle.troubles.is_empty()
            && told.faults.insert(worst)
        {
            news.push(News::Missing);
        }
        news
    }
}

impl Told {
    fn slots(&mut self, missed: u64, news: &mut Vec<News>) {
        if missed > 0 {
            if self.missed == 0 {
                news.push(News::Missed { slots: missed });
            }
            self.missed += missed;
            self.begun = 0;
        } else if self.missed > 0 {
            self.begun += 1;
            if self.begun >= IN_TIME {
                news.push(News::InTime { slots: self.missed });
                self.missed = 0;
            }
        }
    }
}
