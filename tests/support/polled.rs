//! A line with simulated meters that is polled on a fake clock, meters of which can be switched off.

#![allow(dead_code, reason = "each test file uses its share")]

use std::cell::RefCell;
use std::ops::Range;
use std::sync::Arc;
use std::time::Duration;

use meterpoll::client::{Client, Echo};
use meterpoll::codec::{Unit, UnitRange};
use meterpoll::polling::{
    Cycle, Effort, Event, Every, Job, LineLoop, Manners, PortError, Spared, Subject,
};
use meterpoll::profile::Profile;
use meterpoll::profile::find::find;
use meterpoll::profile::selector::{Reading, select};
use meterpoll::readings::Fault;
use meterpoll::sim::SimulatedLine;
use meterpoll::transport::{
    Clock, Line, LineSettings, OpenError, Timing, Transport, TransportError,
};

use super::clock::FakeClock;

/// The time-out in these tests.
pub(crate) const T: Duration = Duration::from_secs(1);

/// Drops what is sent to units that are off, by the clock.
pub(crate) struct Switched {
    pub(crate) line: SimulatedLine,
    pub(crate) clock: Arc<dyn Clock>,
    /// Which unit, and when.
    pub(crate) off: Vec<(u8, Range<Duration>)>,
}

impl Transport for Switched {
    fn send(&mut self, frame: &[u8]) -> Result<(), TransportError> {
        let now = self.clock.now();
        let is_off = |(unit, when): &(u8, Range<Duration>)| {
            frame.first() == Some(unit) && when.contains(&now)
        };
        if self.off.iter().any(is_off) {
            return Ok(());
        }
        self.line.send(frame)
    }

    fn receive(&mut self, into: &mut [u8], wait: Duration) -> Result<usize, TransportError> {
        self.line.receive(into, wait)
    }

    fn discard_input(&mut self) -> Result<(), TransportError> {
        self.line.discard_input()
    }

    fn reopen(&mut self) -> Result<(), OpenError> {
        self.line.reopen()
    }
}

pub(crate) fn unit(number: u16) -> Unit {
    Unit::new(number, UnitRange::Extended).unwrap()
}

pub(crate) fn seconds(seconds: u64) -> Duration {
    Duration::from_secs(seconds)
}

/// Points of a known meter, read so often.
pub(crate) fn job(meter: &str, number: u16, points: &[&str], every: Duration) -> Job {
    let profile: Profile = find(meter).unwrap();
    let selectors: Vec<String> = points.iter().map(|&point| point.to_owned()).collect();
    let reading = Reading {
        profile: Some(&profile),
        ..Reading::default()
    };
    let points = select(&selectors, reading).unwrap();
    let subject = Subject {
        name: meter.to_owned(),
        file_name: String::new(),
        line: 0,
        unit: unit(number),
        manners: Manners {
            timeout: Some(T),
            retries: 2,
            pause: None,
        },
    };
    Job {
        every: Some(Every::new(every).unwrap()),
        meter: usize::from(number),
        ..Job::new(subject, Some(&profile), points, LineSettings::default())
    }
}

/// A client on a transport at 9600 8N1.
pub(crate) fn client(
    transport: impl Transport + 'static,
    clock: &Arc<impl Clock + 'static>,
) -> Client {
    let timing = Timing::Paced(LineSettings::default());
    let clock: Arc<dyn Clock> = clock.clone();
    Client::new(
        Line::new(Box::new(transport), clock, timing).unwrap(),
        Echo::Auto,
    )
}

/// The simulated line, on which units are off at times.
pub(crate) fn switched(
    clock: &Arc<impl Clock + 'static>,
    off: Vec<(u8, Range<Duration>)>,
) -> Client {
    let line = Switched {
        line: SimulatedLine::new(1, clock.clone()),
        clock: clock.clone(),
        off,
    };
    client(line, clock)
}

/// Polls until the clock shows `until`: every row.
pub(crate) fn polled<C: Clock>(
    jobs: &[Job],
    clock: &C,
    open: &mut dyn FnMut() -> Result<Client, PortError>,
    until: Duration,
) -> Vec<Cycle> {
    let cycles = RefCell::new(Vec::new());
    let mut deliver = |event| {
        if let Event::Cycle(cycle) = event {
            cycles.borrow_mut().push(*cycle);
        }
    };
    let stop = || clock.now() >= until;
    LineLoop::new(jobs.iter().enumerate(), clock, open).endless(&stop, &mut deliver);
    cycles.into_inner()
}

/// The rows of one job.
pub(crate) fn of(cycles: &[Cycle], job: usize) -> Vec<&Cycle> {
    cycles.iter().filter(|cycle| cycle.job == job).collect()
}

/// What its rows are, in a few words each.
pub(crate) fn told(cycles: &[Cycle], job: usize) -> Vec<(Option<Fault>, &'static str)> {
    let told = of(cycles, job).into_iter().map(|cycle| {
        let effort = match cycle.effort {
            Effort::Asked(1) => "once",
            Effort::Asked(_) => "asked",
            Effort::Spared(Spared::Silent) => "spared: silent",
            Effort::Spared(Spared::PortAway) => "spared: port",
            Effort::Spared(Spared::Deadline) => "spared: deadline",
        };
        (cycle.row.worst(), effort)
    });
    told.collect()
}

/// A clock on which all is well.
pub(crate) fn noon() -> Arc<FakeClock> {
    Arc::new(FakeClock::new())
}
