//! What has happened, counted.

use std::collections::BTreeMap;
use std::fmt;

use meterpoll::client::Counters;
use meterpoll::readings::Fault;
use meterpoll::transport::faulty::{FaultCounts, FaultKind};

use crate::check::Outcome;

/// The counts of one line, or of all.
#[derive(Debug, Default)]
pub(crate) struct Tally {
    pub(crate) transactions: u64,
    pub(crate) faults: BTreeMap<FaultKind, u64>,
    pub(crate) stalls: u64,
    pub(crate) withheld: u64,
    /// What the client was asked: a read, or a row of readings.
    pub(crate) questions: u64,
    /// How often a line was opened.
    pub(crate) sessions: u64,
    pub(crate) right: u64,
    pub(crate) missing: BTreeMap<String, u64>,
    pub(crate) wrong: u64,
    pub(crate) excused: u64,
    pub(crate) recoveries: Recoveries,
    pub(crate) client: Counters,
    /// Lines that came to an end of their own, or whose port was lost.
    pub(crate) broken: u64,
}

/// How lines read once their faults were over.
#[derive(Debug, Default)]
pub(crate) struct Recoveries {
    /// The first read was right.
    pub(crate) first: u64,
    /// A later one was.
    pub(crate) later: u64,
    /// None was.
    pub(crate) never: u64,
    /// The meter was late itself time after time.
    pub(crate) untold: u64,
}

impl Tally {
    pub(crate) fn add(&mut self, other: &Self) {
        self.transactions += other.transactions;
        for (kind, count) in &other.faults {
            *self.faults.entry(*kind).or_default() += count;
        }
        self.stalls += other.stalls;
        self.withheld += other.withheld;
        self.questions += other.questions;
        self.sessions += other.sessions;
        self.right += other.right;
        for (cause, count) in &other.missing {
            *self.missing.entry(cause.clone()).or_default() += count;
        }
        self.wrong += other.wrong;
        self.excused += other.excused;
        self.recoveries.first += other.recoveries.first;
        self.recoveries.later += other.recoveries.later;
        self.recoveries.never += other.recoveries.never;
        self.recoveries.untold += other.recoveries.untold;
        self.add_client(other.client);
        self.broken += other.broken;
    }

    /// What one client has counted of one unit.
    pub(crate) fn add_client(&mut self, of: Counters) {
        let all = &mut self.client;
        all.requests += of.requests;
        all.answers += of.answers;
        all.retries += of.retries;
        all.silences += of.silences;
        all.late += of.late;
        all.copies += of.copies;
        all.damaged += of.damaged;
        all.truncated += of.truncated;
        all.mismatched += of.mismatched;
        all.busy += of.busy;
        all.stray += of.stray;
        all.echoes += of.echoes;
        all.others += of.others;
    }

    /// What went through the fault rules.
    pub(crate) fn add_faults(&mut self, counts: &FaultCounts) {
        self.transactions += counts.requests;
        for (kind, count) in counts.faults() {
            *self.faults.entry(kind).or_default() += count;
        }
    }

    /// What became of a value; a wrong one is counted by whoever judges it.
    pub(crate) fn add_outcome(&mut self, outcome: &Outcome) {
        match outcome {
            Outcome::Right => self.right += 1,
            Outcome::Wrong { .. } => {}
            Outcome::Missing(fault) => {
                let cause = match fault {
                    Fault::Exception(_) => "exception".to_owned(),
                    fault => fault.to_string(),
                };
                *self.missing.entry(cause).or_default() += 1;
                self.broken += u64::from(*fault == Fault::Port);
            }
        }
    }

    pub(crate) const fn is_well(&self) -> bool {
        self.wrong == 0 && self.recoveries.never == 0 && self.broken == 0
    }
}

impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let list = |items: Vec<String>| items.join(", ");
        let faults = self.faults.iter();
        let faults = list(faults.map(|(kind, n)| format!("{kind} {n}")).collect());
        let missing = self.missing.iter();
        let missing = list(missing.map(|(cause, n)| format!("{cause} {n}")).collect());
        let all_faults: u64 = self.faults.values().sum();
        let all_missing: u64 = self.missing.values().sum();
        writeln!(f, "transactions   {}", self.transactions)?;
        writeln!(f, "faults         {all_faults}: {faults}")?;
        writeln!(f, "stalls         {}", self.stalls)?;
        writeln!(f, "withheld       {}", self.withheld)?;
        writeln!(
            f,
            "questions      {} in {} sessions",
            self.questions, self.sessions
        )?;
        writeln!(f, "right          {}", self.right)?;
        writeln!(f, "missing        {all_missing}: {missing}")?;
        writeln!(f, "wrong          {}", self.wrong)?;
        writeln!(
            f,
            "excused        {} (came provably later than promised)",
            self.excused
        )?;
        let Recoveries {
            first,
            later,
            never,
            untold,
        } = self.recoveries;
        writeln!(
            f,
            "after faults   right at once {first}, at a further read {later}, never {never}, \
             the meter too late to tell {untold}"
        )?;
        if self.broken > 0 {
            writeln!(f, "broken         {}", self.broken)?;
        }
        write!(f, "client         {}", self.client)
    }
}
