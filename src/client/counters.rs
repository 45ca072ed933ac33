//! What has happened between the client and each unit, counted.

use std::collections::BTreeMap;
use std::fmt;

use super::failure::Failure;
use crate::codec::Unit;
use crate::words::counted;

/// What has been counted of one unit. Noise and frames of others belong to nobody: they count for
/// the unit that was being asked.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counters {
    /// Requests sent, repeated ones included.
    pub requests: u64,
    /// Answers believed, exceptions included.
    pub answers: u64,
    /// Requests repeated because the line failed.
    pub retries: u64,
    /// Attempts that met silence.
    pub silences: u64,
    /// Answers that came when something else was asked, or nobody waited any more.
    pub late: u64,
    /// Answers that came a second time.
    pub copies: u64,
    /// Answers that were damaged: the CRC was wrong, or bytes were no frame.
    pub damaged: u64,
    /// Answers that broke off.
    pub truncated: u64,
    /// Valid frames of the unit that answered something else.
    pub mismatched: u64,
    /// Times the unit said that it is busy.
    pub busy: u64,
    /// Bytes that belong to no frame.
    pub stray: u64,
    /// Own requests that came back.
    pub echoes: u64,
    /// Valid frames of other units.
    pub others: u64,
}

impl Counters {
    /// One more attempt has failed.
    pub(super) fn fail(&mut self, failure: &Failure) {
        match failure {
            Failure::Silence { .. } | Failure::Stopped | Failure::OnlyEcho => self.silences += 1,
            Failure::Truncated { .. } => self.truncated += 1,
            Failure::Damaged { .. } => self.damaged += 1,
            Failure::Mismatch { .. } => self.mismatched += 1,
            Failure::NeverQuiet { discarded } => self.stray += *discarded as u64,
            Failure::Exception(_) | Failure::Ambiguous | Failure::Port(_) => {}
        }
    }
}

/// `12 requests, 11 answers, 1 retry`: what there was of the rest.
impl fmt::Display for Counters {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&counted(self.requests, "request", "requests"))?;
        write!(f, ", {}", counted(self.answers, "answer", "answers"))?;
        for (count, one, many) in [
            (self.retries, "retry", "retries"),
            (self.silences, "silence", "silences"),
            (self.late, "late answer", "late answers"),
            (self.copies, "second copy", "second copies"),
            (self.damaged, "damaged answer", "damaged answers"),
            (self.truncated, "truncated answer", "truncated answers"),
            (
                self.mismatched,
                "answer to something else",
                "answers to something else",
            ),
            (self.busy, "time busy", "times busy"),
            (self.stray, "stray byte", "stray bytes"),
            (self.echoes, "echo", "echoes"),
            (self.others, "frame of other units", "frames of other units"),
        ] {
            if count > 0 {
                write!(f, ", {}", counted(count, one, many))?;
            }
        }
        Ok(())
    }
}

/// The counters of every unit that was asked.
#[derive(Debug, Default)]
pub(super) struct Ledger(BTreeMap<Unit, Counters>);

impl Ledger {
    /// Those of a unit, to be counted up.
    pub(super) fn of(&mut self, unit: Unit) -> &mut Counters {
        self.0.entry(unit).or_default()
    }

    /// Those of a unit; all 0 for one that was never asked.
    pub(super) fn get(&self, unit: Unit) -> Counters {
        self.0.get(&unit).copied().unwrap_or_default()
    }

    /// All of them, by unit.
    pub(super) fn all(&self) -> impl Iterator<Item = (Unit, Counters)> {
        self.0.iter().map(|(unit, counters)| (*unit, *counters))
    }
}
