//! When meters are read, on clocks that do as they are told.

use std::time::Duration;

use jiff::{SignedDuration, Timestamp};
use meterpoll::polling::{Every, EveryError, Moment, Schedule, Slot};
use proptest::prelude::*;

const DAY: u64 = 86_400;

fn at(time: &str) -> Timestamp {
    time.parse().unwrap()
}

fn seconds(seconds: u64) -> Duration {
    Duration::from_secs(seconds)
}

fn every(interval: Duration) -> Every {
    Every::new(interval).unwrap()
}

/// Two clocks, of which one can be set.
struct Clocks {
    now: Duration,
    utc: Timestamp,
}

impl Clocks {
    fn at(utc: &str) -> Self {
        Self {
            // The monotonic clock has nothing to do with the other.
            now: Duration::from_millis(123_456),
            utc: at(utc),
        }
    }

    fn moment(&self) -> Moment {
        Moment {
            now: self.now,
            utc: self.utc,
        }
    }

    fn pass(&mut self, time: Duration) {
        self.now += time;
        self.utc += time;
    }

    /// Somebody sets the wall clock.
    fn step(&mut self, by: SignedDuration) {
        self.utc += by;
    }

    /// Waits for the next slot and takes it.
    fn next(&mut self, schedule: &mut Schedule) -> Slot {
        let wait = schedule.next().saturating_sub(self.now);
        self.pass(wait);
        schedule.take(self.moment()).expect("a slot that is due")
    }
}

/// The wall times of so many slots.
fn times(interval: Duration, start: &str, count: usize) -> Vec<String> {
    let mut clocks = Clocks::at(start);
    let mut schedule = Schedule::new(every(interval), clocks.moment());
    (0..count)
        .map(|_| clocks.next(&mut schedule).time.to_string())
        .collect()
}

#[test]
fn a_quarter_of_an_hour_falls_on_the_quarters_of_the_hour() {
    assert_eq!(
        times(seconds(900), "2026-01-15T12:07:31.5Z", 5),
        [
            "2026-01-15T12:15:00Z",
            "2026-01-15T12:30:00Z",
            "2026-01-15T12:45:00Z",
            "2026-01-15T13:00:00Z",
            "2026-01-15T13:15:00Z",
        ]
    );
}

#[test]
fn a_run_that_starts_on_a_round_time_begins_at_once() {
    assert_eq!(
        times(seconds(60), "2026-01-15T12:07:00Z", 2),
        ["2026-01-15T12:07:00Z", "2026-01-15T12:08:00Z"]
    );
}

#[test]
fn an_interval_that_does_not_divide_a_day_counts_from_1970() {
    let times = times(seconds(420), "2026-01-15T23:50:00Z", 3);
    assert_eq!(
        times,
        [
            "2026-01-15T23:55:00Z",
            "2026-01-16T00:02:00Z",
            "2026-01-16T00:09:00Z"
        ]
    );
    for time in times {
        assert_eq!(at(&time).as_second() % 420, 0, "{time}");
    }
}

#[test]
fn the_hours_when_summer_time_begins_and_ends_have_as_many_slots_as_others() {
    for start in ["2026-03-29T00:00:00Z", "2026-10-25T00:00:00Z"] {
        let times = times(seconds(900), start, 16);
        let found: Vec<i64> = times.iter().map(|time| at(time).as_second()).collect();
        let expected: Vec<i64> = (0..16).map(|n| at(start).as_second() + n * 900).collect();
        assert_eq!(found, expected);
    }
}

#[test]
fn nothing_drifts_in_a_day_of_slow_reads() {
    let mut clocks = Clocks::at("2026-01-15T00:00:00Z");
    let mut schedule = Schedule::new(every(seconds(1)), clocks.moment());
    let start = clocks.now;
    for cycle in 0..DAY {
        let slot = clocks.next(&mut schedule);
        assert_eq!(slot.due, start + seconds(cycle));
        assert_eq!((slot.late, slot.missed), (Duration::ZERO, 0));
        // What reading takes, more each time.
        clocks.pass(Duration::from_millis(cycle % 999));
    }
}

#[test]
fn a_slot_is_late_until_the_next_one_is_due_and_then_missed() {
    let mut clocks = Clocks::at("2026-01-15T12:00:00Z");
    let mut schedule = Schedule::new(every(seconds(60)), clocks.moment());
    clocks.next(&mut schedule);

    clocks.pass(seconds(110));
    let slot = schedule.take(clocks.moment()).unwrap();
    assert_eq!(slot.time, at("2026-01-15T12:01:00Z"));
    assert_eq!((slot.late, slot.missed), (seconds(50), 0));

    // Until 12:05:10: those of 12:02, 12:03 and 12:04 are over.
    clocks.pass(seconds(200));
    let slot = schedule.take(clocks.moment()).unwrap();
    assert_eq!(slot.time, at("2026-01-15T12:05:00Z"));
    assert_eq!((slot.late, slot.missed), (seconds(10), 3));

    assert_eq!(schedule.take(clocks.moment()), None);
    let slot = clocks.next(&mut schedule);
    assert_eq!(slot.time, at("2026-01-15T12:06:00Z"));
    assert_eq!((slot.late, slot.missed), (Duration::ZERO, 0));
}

/// What becomes of the slots of `interval` when the clock is set by `step` after the third: the time
/// between them on the monotonic clock, and the wall times.
fn stepped(interval: Duration, step: SignedDuration) -> (Vec<Duration>, Vec<Timestamp>) {
    let mut clocks = Clocks::at("2026-01-15T12:00:00Z");
    let mut schedule = Schedule::new(every(interval), clocks.moment());
    let mut dues = Vec::new();
    let mut times = Vec::new();
    for cycle in 0..8 {
        let slot = clocks.next(&mut schedule);
        assert_eq!((slot.late, slot.missed), (Duration::ZERO, 0));
        dues.push(slot.due);
        times.push(clocks.utc);
        clocks.pass(interval / 10);
        if cycle == 2 {
            clocks.step(step);
        }
    }
    let gaps = dues
        .windows(2)
        .map(|pair| pair[1].saturating_sub(pair[0]))
        .collect();
    (gaps, times)
}

#[test]
fn a_clock_set_back_an_hour_or_forward_a_day_changes_no_pace_and_time_stamps_are_true() {
    for (step, after) in [
        (SignedDuration::from_hours(-1), "2026-01-15T11:03:00Z"),
        (SignedDuration::from_hours(24), "2026-01-16T12:03:00Z"),
    ] {
        let (gaps, times) = stepped(seconds(60), step);
        assert_eq!(gaps, [seconds(60); 7]);
        assert_eq!(times[2], at("2026-01-15T12:02:00Z"));
        assert_eq!(times[3], at(after));
    }
}

#[test]
fn a_clock_set_by_a_part_of_the_interval_moves_slots_to_round_times_again_once() {
    // Slots at :00 :15 :30, set forward 4 minutes: the next but one is at :45 by the new time.
    let (gaps, times) = stepped(seconds(900), SignedDuration::from_mins(4));
    assert_eq!(gaps[2..5], [seconds(900), seconds(660), seconds(900)]);
    assert_eq!(times[3], at("2026-01-15T12:49:00Z"));
    assert_eq!(times[4], at("2026-01-15T13:00:00Z"));
    // Set back 4 minutes.
    let (gaps, times) = stepped(seconds(900), SignedDuration::from_mins(-4));
    assert_eq!(gaps[2..5], [seconds(900), seconds(1140), seconds(900)]);
    assert_eq!(times[3], at("2026-01-15T12:41:00Z"));
    assert_eq!(times[4], at("2026-01-15T13:00:00Z"));
}

#[test]
fn a_wall_clock_that_goes_a_little_wrong_is_followed_not_run_away_from() {
    let mut clocks = Clocks::at("2026-01-15T12:00:00Z");
    let mut schedule = Schedule::new(every(seconds(10)), clocks.moment());
    for _ in 0..1000 {
        let slot = clocks.next(&mut schedule);
        assert_eq!((slot.late, slot.missed), (Duration::ZERO, 0));
        // 500 ppm, the most that time servers correct at once.
        clocks.step(SignedDuration::from_millis(5));
        let from_round = slot.time.as_nanosecond().rem_euclid(10_000_000_000);
        assert!(from_round <= 5_000_000, "{}", slot.time);
    }
}

#[test]
fn an_interval_has_its_bounds() {
    for wrong in [Duration::ZERO, Duration::from_millis(9), seconds(DAY + 1)] {
        assert_eq!(Every::new(wrong), Err(EveryError));
    }
    assert_eq!(every(seconds(900)).to_string(), "15m");
    assert_eq!(EveryError.to_string(), "an interval is from 10ms to 24h");
}

proptest! {
    #[test]
    fn whatever_is_done_to_the_clock_slots_come_one_by_one(
        interval in 10_u64..100_000,
        doings in proptest::collection::vec((0_u64..300_000, -100_000_000_i64..100_000_000), 1..50),
    ) {
        let interval = Duration::from_millis(interval);
        let mut clocks = Clocks::at("2026-01-15T12:00:00Z");
        let mut schedule = Schedule::new(every(interval), clocks.moment());
        let mut last: Option<Duration> = None;
        for (took, step) in doings {
            let slot = clocks.next(&mut schedule);
            prop_assert!(slot.late < interval);
            if let Some(last) = last {
                prop_assert!(slot.due >= last + interval / 2);
            }
            last = Some(slot.due);
            prop_assert!(schedule.next() > clocks.now);
            prop_assert!(schedule.next() <= clocks.now + interval * 3 / 2);
            clocks.pass(Duration::from_millis(took));
            clocks.step(SignedDuration::from_millis(step));
        }
    }
}
