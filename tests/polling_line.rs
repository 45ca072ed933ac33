//! One line polled for hours, on a fake clock: who is read when, and what a dead meter costs.

mod support {
    pub(crate) mod clock;
    pub(crate) mod polled;
}

use std::cell::RefCell;
use std::sync::Arc;
use std::sync::atomic::{AtomicI64, Ordering};
use std::time::Duration;

use jiff::{SignedDuration, Timestamp};
use meterpoll::polling::{Event, LineLoop};
use meterpoll::readings::Fault;
use meterpoll::sim::SimulatedLine;
use meterpoll::transport::Clock;

use support::clock::FakeClock;
use support::polled::{T, client, job, noon, of, polled, seconds, switched, told};

const ALWAYS: std::ops::Range<Duration> = Duration::ZERO..Duration::MAX;

#[test]
fn two_thousand_cycles_begin_on_the_second() {
    let clock = noon();
    let jobs = [job("em24", 1, &["frequency"], seconds(1))];
    let cycles = polled(
        &jobs,
        &*clock,
        &mut || Ok(switched(&clock, vec![])),
        seconds(2000),
    );
    assert_eq!(cycles.len(), 2000);
    let start: Timestamp = "2026-01-15T12:00:00Z".parse().unwrap();
    for (cycle, number) in cycles.iter().zip(0..) {
        assert_eq!(cycle.row.time, start + seconds(number));
        assert_eq!(cycle.slot.time, cycle.row.time);
        assert_eq!((cycle.slot.late, cycle.slot.missed), (Duration::ZERO, 0));
        assert_eq!(cycle.row.worst(), None);
    }
}

#[test]
fn each_set_of_points_has_its_own_interval() {
    let clock = noon();
    let jobs = [
        job("em24", 1, &["@energy"], seconds(60)),
        job("em24", 1, &["frequency"], seconds(7)),
        job("pqm", 17, &["frequency"], seconds(60)),
    ];
    let cycles = polled(
        &jobs,
        &*clock,
        &mut || Ok(switched(&clock, vec![])),
        seconds(600),
    );
    assert_eq!(of(&cycles, 0).len(), 10);
    assert_eq!(of(&cycles, 2).len(), 10);
    let times = of(&cycles, 1);
    let times: Vec<i64> = times.iter().map(|c| c.slot.time.as_second()).collect();
    assert!(times.iter().all(|time| time % 7 == 0));
    assert!(times.windows(2).all(|pair| pair[1] - pair[0] == 7));
    assert!(cycles.iter().all(|cycle| cycle.row.worst().is_none()));
    // Of those due together the first of the site goes first, and the other right behind it.
    assert_eq!([cycles[0].job, cycles[1].job], [0, 2]);
    assert!(cycles[1].slot.late < seconds(1));
}

#[test]
fn a_dead_meter_is_tried_in_one_cycle_then_probed_once_in_each_and_costs_the_others_nothing() {
    let clock = noon();
    let jobs = [
        job("em24", 1, &["frequency"], seconds(10)),
        job("pqm", 17, &["frequency"], seconds(10)),
        job("em21", 3, &["frequency"], seconds(10)),
    ];
    let off = vec![(1, ALWAYS)];
    let cycles = polled(
        &jobs,
        &*clock,
        &mut || Ok(switched(&clock, off.clone())),
        seconds(1000),
    );
    let dead = told(&cycles, 0);
    assert_eq!(dead.len(), 100);
    assert!(
        dead[..1]
            .iter()
            .all(|row| *row == (Some(Fault::Timeout), "asked"))
    );
    assert!(
        dead[1..]
            .iter()
            .all(|row| *row == (Some(Fault::Timeout), "once"))
    );
    for job in [1, 2] {
        let rows = of(&cycles, job);
        assert_eq!(rows.len(), 100);
        assert!(rows.iter().all(|cycle| cycle.row.worst().is_none()));
        // In the first slot nobody knows yet; from then on it goes last.
        assert!(rows[1..].iter().all(|cycle| cycle.slot.late < T / 2));
    }
}

#[test]
fn on_a_line_with_no_time_left_a_dead_meter_costs_one_time_out_and_its_quarantine_a_cycle() {
    let clock = noon();
    let jobs = [
        job("em24", 1, &["frequency"], seconds(1)),
        job("pqm", 17, &["frequency"], seconds(1)),
    ];
    let off = vec![(1, ALWAYS)];
    let cycles = polled(
        &jobs,
        &*clock,
        &mut || Ok(switched(&clock, off.clone())),
        seconds(200),
    );
    let rows = of(&cycles, 1);
    let gaps: Vec<Duration> = rows
        .windows(2)
        .skip(3)
        .map(|pair| {
            pair[1]
                .row
                .time
                .duration_since(pair[0].row.time)
                .unsigned_abs()
        })
        .collect();
    assert!(gaps.iter().all(|gap| *gap <= 2 * T + T / 2), "{gaps:?}");
    // What was missed is counted, and there is a row or a count for each slot.
    for job in [0, 1] {
        let rows = of(&cycles, job);
        let missed: u64 = rows.iter().map(|cycle| cycle.slot.missed).sum();
        let start: Timestamp = "2026-01-15T12:00:00Z".parse().unwrap();
        let slots = rows.last().unwrap().slot.time.duration_since(start);
        assert_eq!(
            rows.len() as u64 + missed,
            slots.unsigned_abs().as_secs() + 1
        );
    }
}

#[test]
fn a_dead_meter_that_comes_back_is_read_with_all_attempts_again() {
    let clock = noon();
    let jobs = [job("em24", 1, &["frequency", "@energy"], seconds(10))];
    let off = vec![(1, seconds(15)..seconds(65))];
    let cycles = polled(
        &jobs,
        &*clock,
        &mut || Ok(switched(&clock, off.clone())),
        seconds(100),
    );
    let timeout = Some(Fault::Timeout);
    assert_eq!(
        told(&cycles, 0),
        [
            (None, "asked"),
            (None, "asked"),
            (timeout, "asked"),
            (timeout, "once"),
            (timeout, "once"),
            (timeout, "once"),
            (timeout, "once"),
            (None, "once"),
            (None, "asked"),
            (None, "asked"),
        ]
    );
}

#[test]
fn a_meter_that_is_silent_in_a_slot_is_not_asked_for_its_other_points_in_that_slot() {
    let clock = noon();
    let jobs = [
        job("em24", 1, &["frequency"], seconds(10)),
        job("em24", 1, &["@energy"], seconds(10)),
    ];
    let off = vec![(1, ALWAYS)];
    let cycles = polled(
        &jobs,
        &*clock,
        &mut || Ok(switched(&clock, off.clone())),
        seconds(50),
    );
    assert_eq!(
        told(&cycles, 0),
        [
            (Some(Fault::Timeout), "asked"),
            (Some(Fault::Timeout), "once"),
            (Some(Fault::Timeout), "once"),
            (Some(Fault::Timeout), "once"),
            (Some(Fault::Timeout), "once"),
        ]
    );
    assert_eq!(
        told(&cycles, 1),
        [(Some(Fault::Timeout), "spared: silent"); 5]
    );
}

/// A clock whose wall time can be set.
struct SetClock {
    clock: Arc<FakeClock>,
    by: AtomicI64,
}

impl Clock for SetClock {
    fn now(&self) -> Duration {
        self.clock.now()
    }

    fn sleep(&self, time: Duration) {
        self.clock.sleep(time);
    }

    fn utc_now(&self) -> Timestamp {
        self.clock.utc_now() + SignedDuration::from_secs(self.by.load(Ordering::SeqCst))
    }
}

#[test]
fn a_clock_set_back_an_hour_and_forward_a_day_leaves_the_pace_and_is_seen_in_the_rows() {
    let clock = Arc::new(SetClock {
        clock: noon(),
        by: AtomicI64::new(0),
    });
    let jobs = [job("em24", 1, &["frequency"], seconds(60))];
    let rows = RefCell::new(Vec::new());
    let mut deliver = |event| {
        let Event::Cycle(cycle) = event else { return };
        let mut rows = rows.borrow_mut();
        rows.push((
            cycle.slot.due,
            cycle.row.time.to_string(),
            cycle.slot.missed,
        ));
        match rows.len() {
            2 => clock.by.store(-3600, Ordering::SeqCst),
            4 => clock.by.store(86_400, Ordering::SeqCst),
            _ => {}
        }
    };
    let mut open = || Ok(client(SimulatedLine::new(1, clock.clone()), &clock));
    let stop = || clock.now() >= seconds(360);
    LineLoop::new(jobs.iter().enumerate(), &*clock, &mut open).endless(&stop, &mut deliver);
    let expected = [
        (0, "2026-01-15T12:00:00Z"),
        (60, "2026-01-15T12:01:00Z"),
        (120, "2026-01-15T11:02:00Z"),
        (180, "2026-01-15T11:03:00Z"),
        (240, "2026-01-16T12:04:00Z"),
        (300, "2026-01-16T12:05:00Z"),
    ];
    let expected = expected.map(|(due, time)| (seconds(due), time.to_owned(), 0));
    assert_eq!(*rows.borrow(), expected);
}

/// A clock of which no two looks agree to the microsecond, as on any real machine.
struct RestlessClock {
    clock: Arc<FakeClock>,
    looks: AtomicI64,
}

impl Clock for RestlessClock {
    fn now(&self) -> Duration {
        self.clock.now()
    }

    fn sleep(&self, time: Duration) {
        self.clock.sleep(time);
    }

    fn utc_now(&self) -> Timestamp {
        let looks = self.looks.fetch_add(7919, Ordering::SeqCst);
        self.clock.utc_now() - SignedDuration::from_nanos(looks % 50_000)
    }
}

#[test]
fn meters_that_are_due_together_stay_so_and_a_silent_one_goes_last() {
    let clock = Arc::new(RestlessClock {
        clock: noon(),
        looks: AtomicI64::new(0),
    });
    let jobs = [
        job("em24", 1, &["frequency"], seconds(10)),
        job("pqm", 17, &["frequency"], seconds(10)),
    ];
    let mut open = || Ok(switched(&clock, vec![(1, ALWAYS)]));
    let cycles = polled(&jobs, &*clock, &mut open, seconds(1000));
    let rows = of(&cycles, 1);
    assert!(rows.len() >= 99);
    assert!(rows[2..].iter().all(|cycle| cycle.slot.late < T / 2));
}

/// A wall clock that is set on by microseconds all the time.
struct HurriedClock(Arc<FakeClock>);

impl Clock for HurriedClock {
    fn now(&self) -> Duration {
        self.0.now()
    }

    fn sleep(&self, time: Duration) {
        self.0.sleep(time);
    }

    fn utc_now(&self) -> Timestamp {
        self.0.utc_now() + self.0.now() / 50_000
    }
}

#[test]
fn meters_that_are_due_together_are_read_in_their_order_by_a_clock_that_is_set_on_as_well() {
    let clock = Arc::new(HurriedClock(noon()));
    let jobs = [
        job("em24", 1, &["frequency"], seconds(10)),
        job("pm290", 2, &["frequency"], seconds(10)),
        job("pqm", 17, &["frequency"], seconds(10)),
    ];
    let mut open = || Ok(switched(&clock, vec![]));
    let cycles = polled(&jobs, &*clock, &mut open, seconds(1000));
    let order: Vec<usize> = cycles.iter().map(|cycle| cycle.job).collect();
    let expected: Vec<usize> = (0..order.len()).map(|index| index % 3).collect();
    assert_eq!(order, expected);
}

/// The rows of one run over everything.
fn once(within: Option<Duration>, off: &[u8]) -> (Vec<(Option<Fault>, &'static str)>, Duration) {
    let clock = noon();
    let off: Vec<_> = off.iter().map(|unit| (*unit, ALWAYS)).collect();
    let jobs = [
        job("em24", 1, &["frequency"], seconds(60)),
        job("pm290", 2, &["frequency"], seconds(60)),
        job("pqm", 17, &["frequency"], seconds(60)),
    ];
    let cycles = RefCell::new(Vec::new());
    let mut deliver = |event| {
        if let Event::Cycle(cycle) = event {
            cycles.borrow_mut().push(*cycle);
        }
    };
    let mut open = || Ok(switched(&clock, off.clone()));
    LineLoop::new(jobs.iter().enumerate(), &*clock, &mut open).once(
        within,
        &|| false,
        &mut deliver,
    );
    let cycles = cycles.into_inner();
    let rows = (0..3).flat_map(|job| told(&cycles, job)).collect();
    (rows, clock.now())
}

#[test]
fn a_single_run_reads_everything_once() {
    let (rows, took) = once(None, &[]);
    assert_eq!(rows, [(None, "asked"); 3]);
    assert!(took < seconds(1), "{took:?}");
}

#[test]
fn a_single_run_keeps_its_deadline_and_says_what_it_did_not_come_to() {
    let timeout = Some(Fault::Timeout);
    let (rows, took) = once(Some(seconds(4)), &[1, 2, 17]);
    assert_eq!(rows[0], (timeout, "asked"));
    assert_eq!(rows[2], (timeout, "spared: deadline"));
    // The last late answers are waited for.
    assert!(took < Duration::from_millis(6500), "{took:?}");
}

#[test]
fn a_run_that_is_stopped_finishes_the_row_in_hand() {
    let clock = noon();
    let jobs = [
        job("em24", 1, &["@energy"], seconds(60)),
        job("pqm", 17, &["frequency"], seconds(60)),
    ];
    let cycles = polled(
        &jobs,
        &*clock,
        &mut || Ok(switched(&clock, vec![])),
        Duration::from_millis(1),
    );
    assert_eq!(told(&cycles, 0), [(None, "asked")]);
    assert_eq!(cycles.len(), 1);
}
