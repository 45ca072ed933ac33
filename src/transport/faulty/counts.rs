//! What has happened so far.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use super::kind::FaultKind;

/// How much has gone through a [`super::Faulty`].
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct FaultCounts {
    /// Requests that were sent, those that a lost port kept from the meter included.
    pub requests: u64,
    /// Requests that the meter behind began to answer, whatever became of the answer.
    pub answers: u64,
    faults: BTreeMap<FaultKind, u64>,
}

impl FaultCounts {
    /// Requests that a fault of this kind was chosen for. A fault that `any` picked counts under
    /// its own kind.
    pub fn of(&self, kind: FaultKind) -> u64 {
        self.faults.get(&kind).copied().unwrap_or_default()
    }

    /// The kinds that were chosen so far, each with how many requests it was chosen for.
    pub fn faults(&self) -> impl Iterator<Item = (FaultKind, u64)> {
        self.faults.iter().map(|(kind, count)| (*kind, *count))
    }

    /// Requests that a fault was chosen for.
    pub fn all_faults(&self) -> u64 {
        self.faults.values().sum()
    }
}

/// The counts of a [`super::Faulty`], to be looked at while a line owns that.
#[derive(Debug, Clone, Default)]
pub struct FaultTally(Arc<Mutex<FaultCounts>>);

impl FaultTally {
    /// The counts as they are now.
    pub fn counts(&self) -> FaultCounts {
        self.with(|counts| counts.clone())
    }

    /// Counts a request and returns its number, from 1.
    pub(super) fn request(&self) -> u64 {
        self.with(|counts| {
            counts.requests += 1;
            counts.requests
        })
    }

    pub(super) fn answer(&self) {
        self.with(|counts| counts.answers += 1);
    }

    pub(super) fn fault(&self, kind: FaultKind) {
        self.with(|counts| *counts.faults.entry(kind).or_default() += 1);
    }

    /// Counts are right at every moment, so a holder that panicked does no harm.
    fn with<T>(&self, job: impl FnOnce(&mut FaultCounts) -> T) -> T {
        job(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}
