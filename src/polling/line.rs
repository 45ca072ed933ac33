//! The loop of one line: whatever is due is read, one meter at a time, and handed on.
//!
//! Each meter gets one row a slot, whatever happens. What is due first goes first, and of those due
//! together a meter that was silent lately goes last. After a silent row such a meter is probed with
//! one attempt a slot, until it answers; other sets of its points are not asked for in a
//! slot in which it was silent. A port that is away is looked for once a slot.

use std::collections::BTreeMap;
use std::time::Duration;

use thiserror::Error;

use super::job::Job;
use super::schedule::{Clocks, Moment, Schedule, Slot};
use crate::client::{Client, Patience};
use crate::codec::Unit;
use crate::readings::{Fault, Memory, Row, Trouble, take};
use crate::transport::{Clock, OpenError, TransportError};

/// A wait is cut into pieces of this length, so that it can be ended.
const PIECE: Duration = Duration::from_millis(100);

/// Slots no further apart are due together: a wall clock that is set on moves those of one meter
/// before those of another by microseconds.
const TOGETHER: Duration = Duration::from_millis(1);

/// Why a line has no port.
#[derive(Debug, Error)]
pub enum PortError {
    /// It cannot be opened.
    #[error(transparent)]
    Open(#[from] OpenError),
    /// It was lost as soon as it was open.
    #[error(transparent)]
    Lost(#[from] TransportError),
}

/// One row, and how it came about.
#[derive(Debug)]
pub struct Cycle {
    /// What was read, as an index into [`Site::jobs`](super::Site::jobs).
    pub job: usize,
    /// When it was due.
    pub slot: Slot,
    /// The readings.
    pub row: Row,
    /// What went wrong.
    pub troubles: Vec<Trouble>,
    /// How the meter was asked.
    pub effort: Effort,
    /// How long that took.
    pub took: Duration,
    /// How long the unit takes to begin an answer: the median of its last; `None` before the first.
    pub answer_time: Option<Duration>,
}

/// How a meter was asked for a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Effort {
    /// With so many attempts at each read.
    Asked(u32),
    /// It was not, and the row says what is the matter with it.
    Spared(Spared),
}

/// Why a meter was not asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Spared {
    /// It was silent in this slot already.
    Silent,
    /// The port is away, as was found in this slot.
    PortAway,
    /// The time of the whole run is over.
    Deadline,
}

/// What happens on a line.
#[derive(Debug)]
pub enum Event {
    /// A row.
    Cycle(Box<Cycle>),
    /// The port is open.
    Open,
    /// The port could not be opened. Each slot it is tried again.
    NoPort(PortError),
    /// Everything that was due has been read.
    Idle,
}

/// Opens the port of a line.
pub type Open<'a> = dyn FnMut() -> Result<Client, PortError> + 'a;

/// One line and what is read on it.
pub struct LineLoop<'a> {
    jobs: Vec<(usize, &'a Job)>,
    clock: &'a dyn Clock,
    open: &'a mut Open<'a>,
    client: Option<Client>,
    /// What was learned of each meter.
    memories: BTreeMap<usize, Memory>,
    /// When the last row of a unit was silent: that of those whose was.
    silences: BTreeMap<Unit, Duration>,
    /// When the port was last found to be away.
    away_at: Option<Duration>,
}

impl<'a> LineLoop<'a> {
    /// A loop that has not begun. `jobs` are those of the line, with their indices in the site;
    /// `open` is called when there is something to read, and in each slot until there is a port.
    pub fn new(
        jobs: impl IntoIterator<Item = (usize, &'a Job)>,
        clock: &'a dyn Clock,
        open: &'a mut Open<'a>,
    ) -> Self {
        Self {
            jobs: jobs.into_iter().collect(),
            clock,
            open,
            client: None,
            memories: BTreeMap::new(),
            silences: BTreeMap::new(),
            away_at: None,
        }
    }

    /// Reads everything once, in its order. What is not begun `within` that time is missing, and
    /// what is begun is hurried. Ends early when `stop` says so, but no row is cut short.
    pub fn once(
        mut self,
        within: Option<Duration>,
        stop: &dyn Fn() -> bool,
        deliver: &mut dyn FnMut(Event),
    ) {
        let Moment { now, utc } = Moment::of(self.clock);
        let slot = Slot {
            due: now,
            time: utc,
            late: Duration::ZERO,
            missed: 0,
        };
        let deadline = within.map(|within| now.saturating_add(within));
        for (index, job) in std::mem::take(&mut self.jobs) {
            if stop() {
                break;
            }
            let cycle = self.read(index, job, slot, deadline, deliver);
            deliver(Event::Cycle(Box::new(cycle)));
        }
        self.finish();
    }

    /// Reads every set of points in each of its slots, until `stop` says so; the row in hand is
    /// finished first. Sets without an interval are left out.
    pub fn endless(mut self, stop: &dyn Fn() -> bool, deliver: &mut dyn FnMut(Event)) {
        // At once, and not at the first slot: whoever has started it wants to know.
        self.open(deliver);
        let mut clocks = Clocks::default();
        let start = clocks.look(self.clock);
        let jobs = std::mem::take(&mut self.jobs).into_iter();
        let mut jobs: Vec<(usize, &Job, Schedule)> = jobs
            .filter_map(|(index, job)| Some((index, job, Schedule::new(job.every?, start))))
            .collect();
        let mut is_idle = true;
        while !stop() {
            let now = self.clock.now();
            let earliest = jobs.iter().map(|(_, _, schedule)| schedule.next()).min();
            let together = earliest.unwrap_or_default().saturating_add(TOGETHER);
            let first = jobs.iter_mut().min_by_key(|(index, job, schedule)| {
                let is_silent = self.silences.contains_key(&job.subject.unit);
                // What is not due yet is not kept waiting by anybody.
                (schedule.next().max(together), is_silent, *index)
            });
            let Some((index, job, schedule)) = first else {
                break;
            };
            if let Some(wait) = schedule.next().checked_sub(now).filter(|w| !w.is_zero()) {
                if !is_idle {
                    deliver(Event::Idle);
                    is_idle = true;
                }
                self.clock.sleep(wait.min(PIECE));
            } else if let Some(slot) = schedule.take(clocks.look(self.clock)) {
                let cycle = self.read(*index, job, slot, None, deliver);
                deliver(Event::Cycle(Box::new(cycle)));
                is_idle = false;
            }
        }
        self.finish();
    }

    /// Opens the port if it was never open; once it was, the client looks for it.
    fn open(&mut self, deliver: &mut dyn FnMut(Event)) {
        if self.client.is_some() {
            return;
        }
        match (self.open)() {
            Ok(client) => {
                self.client = Some(client);
                deliver(Event::Open);
            }
            Err(error) => {
                self.away_at = Some(self.clock.now());
                deliver(Event::NoPort(error));
            }
        }
    }

    /// No late answer is left to whoever opens the port next; a port that is lost has none.
    fn finish(self) {
        if let Some(client) = self.client {
            let _ = client.finish();
        }
    }

    /// One row of a set of points.
    fn read(
        &mut self,
        index: usize,
        job: &Job,
        slot: Slot,
        deadline: Option<Duration>,
        deliver: &mut dyn FnMut(Event),
    ) -> Cycle {
        let start = self.clock.now();
        let left = deadline.map(|deadline| deadline.saturating_sub(start));
        if let Some(reason) = self.reason_to_spare(job, slot, left) {
            return self.spared(index, job, slot, reason);
        }
        self.open(deliver);
        // Opening may have taken its time.
        let left = deadline.map(|deadline| deadline.saturating_sub(self.clock.now()));
        if let Some(reason) = self.reason_to_spare(job, slot, left) {
            return self.spared(index, job, slot, reason);
        }
        let patience = self.patience(job, left);
        let Some(client) = self.client.as_mut() else {
            return self.spared(index, job, slot, Spared::PortAway);
        };
        let memory = self.memories.entry(job.meter);
        let memory = memory.or_insert_with(|| job.memory());
        let taken = take(client, &job.inquiry(patience), memory);
        let answer_time = client.answer_time(job.subject.unit);
        let is_away = taken.is_port_away();
        let (row, troubles) = (taken.row, taken.troubles);
        let end = self.clock.now();
        self.away_at = is_away.then_some(end);
        self.note(job.subject.unit, &row, &troubles, end);
        Cycle {
            job: index,
            slot,
            row,
            troubles,
            effort: Effort::Asked(patience.retries.saturating_add(1)),
            took: end.saturating_sub(start),
            answer_time,
        }
    }

    /// Why a meter need not be asked in this slot, if it need not.
    fn reason_to_spare(&self, job: &Job, slot: Slot, left: Option<Duration>) -> Option<Spared> {
        let silence = self.silences.get(&job.subject.unit);
        if left.is_some_and(|left| left.is_zero()) {
            Some(Spared::Deadline)
        } else if self.away_at.is_some_and(|at| at >= slot.due) {
            Some(Spared::PortAway)
        } else if silence.is_some_and(|at| *at >= slot.due) {
            Some(Spared::Silent)
        } else {
            None
        }
    }

    /// A row of a meter that is not asked.
    fn spared(&self, index: usize, job: &Job, slot: Slot, reason: Spared) -> Cycle {
        let fault = match reason {
            Spared::PortAway => Fault::Port,
            Spared::Silent | Spared::Deadline => Fault::Timeout,
        };
        let subject = &job.subject;
        let now = self.clock.utc_now();
        let count = job.points.len();
        let client = self.client.as_ref();
        Cycle {
            job: index,
            slot,
            row: Row::missing(now, &subject.name, subject.unit, count, fault),
            troubles: Vec::new(),
            effort: Effort::Spared(reason),
            took: Duration::ZERO,
            answer_time: client.and_then(|client| client.answer_time(subject.unit)),
        }
    }

    /// As patient as the job is; with one attempt at what was in vain lately, and in no more time
    /// than there is.
    fn patience(&self, job: &Job, left: Option<Duration>) -> Patience {
        let mut patience = job.patience;
        let silence = self.silences.get(&job.subject.unit);
        if silence.is_some() || self.away_at.is_some() {
            patience.retries = 0;
        }
        if let Some(left) = left {
            patience.timeout = patience.timeout.min(left);
            let attempts = left.as_nanos() / patience.timeout.as_nanos().max(1);
            let retries = u32::try_from(attempts.saturating_sub(1)).unwrap_or(u32::MAX);
            patience.retries = patience.retries.min(retries);
        }
        patience
    }

    /// Notes whether a unit has answered. A port that is lost says nothing about it.
    fn note(&mut self, unit: Unit, row: &Row, troubles: &[Trouble], at: Duration) {
        let is_lost = row.faults().any(|fault| fault == Fault::Port);
        let is_silent = troubles
            .iter()
            .any(|trouble| matches!(trouble, Trouble::Unread { is_alive, .. } if !is_alive));
        let has_value = row.readings.iter().any(Result::is_ok);
        if is_lost && !has_value {
            return;
        }
        if is_silent && !has_value {
            self.silences.insert(unit, at);
        } else {
            self.silences.remove(&unit);
        }
    }
}
