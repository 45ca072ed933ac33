//! What is told of a poll, and what is counted.

mod support {
    pub(crate) mod clock;
    pub(crate) mod polled;
}

use std::time::Duration;

use meterpoll::polling::{Cycle, News, Tally, Watch};

use support::polled::{job, noon, polled, seconds, switched};

/// An hour of a meter that is off from minute 10 to minute 30.
fn hour() -> Vec<Cycle> {
    let clock = noon();
    let jobs = [job("em24", 1, &["frequency"], seconds(60))];
    let off = vec![(1, seconds(590)..seconds(1790))];
    let mut open = || Ok(switched(&clock, off.clone()));
    polled(&jobs, &*clock, &mut open, seconds(3600))
}

#[test]
fn a_fault_is_told_once_and_so_is_its_end() {
    let mut watch = Watch::default();
    let told: Vec<(usize, News)> = hour()
        .iter()
        .enumerate()
        .flat_map(|(minute, cycle)| {
            let news = watch.heed(cycle).into_iter();
            news.map(move |news| (minute, news))
        })
        .collect();
    let back = News::Back {
        since: "2026-01-15T12:10:00Z".parse().unwrap(),
        rows: 20,
    };
    assert_eq!(told, [(10, News::Missing), (30, back)]);
}

#[test]
fn rows_are_counted_by_what_they_lack() {
    let mut tally = Tally::default();
    for cycle in hour() {
        tally.add(&cycle);
    }
    let counts = tally.of(0);
    assert_eq!((counts.rows, counts.complete, counts.missed), (60, 40, 0));
    assert_eq!(counts.lacking, [("timeout".to_owned(), 20)].into());
    assert_eq!(counts.answer_time, Some(Duration::ZERO));
    // Three attempts three times, and then one.
    assert!(counts.took.1 > seconds(3));
    assert!(counts.mean().unwrap() < seconds(1));
    assert_eq!(tally.of(7).rows, 0);
    assert_eq!(tally.of(7).mean(), None);
}

#[test]
fn slots_that_are_missed_are_told_when_that_begins_and_when_it_has_ended() {
    let mut cycles = hour();
    for (minute, missed) in [(2, 3), (4, 1), (20, 2)] {
        cycles[minute].slot.missed = missed;
    }
    for cycle in &mut cycles {
        cycle.troubles.clear();
    }
    let mut watch = Watch::default();
    let told: Vec<(usize, News)> = cycles
        .iter()
        .enumerate()
        .flat_map(|(minute, cycle)| {
            let news = watch.heed(cycle).into_iter();
            news.map(move |news| (minute, news))
        })
        .collect();
    assert_eq!(
        told,
        [
            (2, News::Missed { slots: 3 }),
            (14, News::InTime { slots: 4 }),
            (20, News::Missed { slots: 2 }),
            (30, News::InTime { slots: 2 }),
        ]
    );
}
