//! What becomes of reads that meet silence: a unit that is not there costs no more than its
//! attempts, one that does not answer big reads is read in parts, and an answer that was lost costs
//! no value.

mod support {
    pub(crate) mod clock;
    pub(crate) mod fussy;
    pub(crate) mod script;
}

use std::time::Duration;

use meterpoll::client::{Failure, Patience};
use meterpoll::profile::Limits;
use meterpoll::readings::Trouble;
use meterpoll::transport::LineSettings;

use support::fussy::{Fussy, Run, points, statuses};
use support::script::true_reply;

/// A time-out, and what an adapter is given on top of an answer's transfer.
const T: Duration = Duration::from_secs(1);
const ADAPTER: Duration = Duration::from_millis(32);

/// Characters at 9600 8N1.
fn transfer(characters: usize) -> Duration {
    LineSettings::default().transfer_time(characters)
}

/// The reads that were told to have met silence, and how many were not tried after each.
fn unread(troubles: &[Trouble]) -> Vec<(u16, u16, usize)> {
    let unread = troubles.iter().map(|trouble| match trouble {
        Trouble::Unread {
            read,
            failure: Failure::Silence { .. },
            untried,
            ..
        } => (read.range.start().get(), read.range.count(), *untried),
        other => panic!("{other:?}"),
    });
    unread.collect()
}

/// Every point is missing for want of an answer.
fn all_silent(count: u16) -> String {
    let lines = (0..count).map(|address| format!("0x{address:04X} timeout\n"));
    lines.collect::<Vec<_>>().concat()
}

#[test]
fn a_unit_that_is_not_there_sees_as_many_requests_as_there_are_attempts() {
    for (retries, expected) in [
        (0, vec![(0, 20)]),
        (1, vec![(0, 20), (0, 1)]),
        (2, vec![(0, 20), (0, 1), (0, 1)]),
    ] {
        let mut run = Run::on(|_| Vec::new(), &Limits::default());
        run.patience.retries = retries;
        let points = points((0..20).chain([0x100, 0x200]));
        let (row, troubles) = run.read(&points);
        let missing = all_silent(20) + "0x0100 timeout\n0x0200 timeout\n";
        assert_eq!(statuses(&points, &row), missing);
        assert_eq!(unread(&troubles), [(0, 20, 2)]);
        assert_eq!(run.requests(), expected);
    }
}

#[test]
fn what_a_unit_that_is_not_there_costs_is_its_time_outs_and_one_late_answer_waited_for() {
    let mut run = Run::on(|_| Vec::new(), &Limits::default());
    run.read(&points(0..20));
    let sent = run.bench.sent_at();
    // The answer to the first request, of 45 characters, may come as late again.
    let late = T + transfer(8) + T + transfer(45) + ADAPTER;
    let again = sent[0] + late;
    let once_more = again + T + transfer(8);
    assert_eq!(sent[1..], [again, once_more]);
    assert_eq!(run.bench.now(), once_more + T + transfer(8));
}

#[test]
fn a_single_point_that_meets_silence_is_repeated() {
    let mut run = Run::on(|_| Vec::new(), &Limits::default());
    let (_, troubles) = run.read(&points([7, 9]));
    assert_eq!(unread(&troubles), [(7, 1, 1)]);
    assert_eq!(run.requests(), [(7, 1), (7, 1), (7, 1)]);
}

#[test]
fn a_meter_that_is_silent_on_more_than_11_registers_gives_all_of_24() {
    let mut run = Run::new(Fussy::new(None).limit(11));
    run.read_all(&points(0..24));
    let parts = [(0, 24), (0, 1), (1, 11), (12, 12), (12, 6), (18, 6)];
    assert_eq!(run.requests(), parts);
    // An answer may have been lost: only silence at the same place again is a rule for good.
    run.read_all(&points(0..24));
    assert_eq!(run.requests(), parts);
    run.read_all(&points(0..24));
    assert_eq!(run.requests(), [(0, 11), (11, 11), (22, 2)]);
}

#[test]
fn what_silence_taught_holds_for_reads_that_were_planned_before() {
    let mut run = Run::new(Fussy::new(None).limit(11));
    run.read_all(&points((0..24).chain(0x100..0x118)));
    let requests = run.requests();
    assert_eq!(requests[6..], [(0x100, 11), (0x10B, 11), (0x116, 2)]);
}

#[test]
fn a_meter_that_is_silent_on_holes_gives_what_is_around_them() {
    let limits = Limits {
        read_holes: true,
        ..Limits::default()
    };
    let mut run = Run::with(Fussy::new(None).without(8..9), &limits);
    // However many registers it gave before, it has not shown that it gives this hole.
    run.read_all(&points((0..8).chain(9..11).chain([0x100, 0x102])));
    assert_eq!(
        run.requests(),
        [(0, 11), (0, 1), (1, 7), (9, 2), (0x100, 1), (0x102, 1)]
    );
}

#[test]
fn a_register_that_silences_the_meter_costs_one_cell() {
    let mut run = Run::new(Fussy::new(None).without(7..8));
    let points = points(0..20);
    let (row, troubles) = run.read(&points);
    assert_eq!(statuses(&points, &row), "0x0007 timeout\n");
    assert_eq!(unread(&troubles), [(7, 1, 0)]);
    assert_eq!(
        run.requests(),
        [
            (0, 20),
            (0, 1),
            (1, 9),
            (10, 10),
            (1, 4),
            (5, 5),
            (5, 2),
            (7, 3),
            (7, 1),
            (7, 1),
            (7, 1),
            // One more silence would end it, so the smallest part comes first.
            (8, 1),
            (9, 1)
        ]
    );
    run.read(&points);
    run.requests();
    run.read(&points);
    assert_eq!(run.requests(), [(0, 7), (7, 1), (7, 1), (7, 1), (8, 12)]);
}

/// A meter that answers but for some requests, counted from 1.
fn losing(lost: &'static [usize]) -> Run {
    let mut count = 0;
    let meter = move |frame: &[u8]| {
        count += 1;
        let answer = (Duration::from_millis(40), true_reply(frame));
        if lost.contains(&count) {
            Vec::new()
        } else {
            vec![answer]
        }
    };
    Run::on(meter, &Limits::default())
}

#[test]
fn a_lost_answer_to_the_first_big_read_costs_no_value_and_teaches_nothing() {
    let mut run = losing(&[1]);
    run.read_all(&points(0..20));
    assert_eq!(run.requests(), [(0, 20), (0, 1), (1, 9), (10, 10)]);
    run.read_all(&points(0..20));
    assert_eq!(run.requests(), [(0, 20)]);
    // From now on it is known to be answered, so a lost answer is asked for again.
    let mut run = losing(&[2]);
    run.read_all(&points(0..20));
    run.read_all(&points(0..20));
    assert_eq!(run.requests(), [(0, 20), (0, 20), (0, 20)]);
}

#[test]
fn a_late_answer_to_the_first_big_read_is_thrown_away() {
    let mut count = 0;
    let meter = move |frame: &[u8]| {
        count += 1;
        let delay = if count == 1 { 1700 } else { 40 };
        vec![(Duration::from_millis(delay), true_reply(frame))]
    };
    let mut run = Run::on(meter, &Limits::default());
    run.read_all(&points(0..20));
    assert_eq!(run.requests(), [(0, 20), (0, 1), (1, 9), (10, 10)]);
}

#[test]
fn two_lost_answers_far_apart_are_no_rule() {
    let mut run = losing(&[1, 6]);
    run.read_all(&points(0..20));
    run.read_all(&points(0..20));
    run.requests();
    // 30 registers at once are new, and their first answer is lost.
    run.read_all(&points(0..30));
    assert_eq!(run.requests(), [(0, 30), (0, 1), (1, 14), (15, 15)]);
    run.read_all(&points(0..30));
    assert_eq!(run.requests(), [(0, 30)]);
}

#[test]
fn a_unit_that_falls_silent_is_given_up_after_three_reads() {
    let mut count = 0;
    let meter = move |frame: &[u8]| {
        count += 1;
        if count > 1 {
            return Vec::new();
        }
        vec![(Duration::from_millis(40), true_reply(frame))]
    };
    let mut run = Run::on(meter, &Limits::default());
    run.patience = Patience {
        retries: 1,
        ..Patience::default()
    };
    let points = points([0, 2, 4, 6, 8, 10]);
    let (row, troubles) = run.read(&points);
    let missing =
        "0x0002 timeout\n0x0004 timeout\n0x0006 timeout\n0x0008 timeout\n0x000A timeout\n";
    assert_eq!(statuses(&points, &row), missing);
    assert_eq!(unread(&troubles), [(2, 1, 0), (4, 1, 0), (6, 1, 2)]);
    assert_eq!(
        run.requests(),
        [(0, 1), (2, 1), (2, 1), (4, 1), (4, 1), (6, 1), (6, 1)]
    );
}

#[test]
fn a_unit_that_falls_silent_on_big_reads_is_asked_for_single_points_before_it_is_given_up() {
    let mut count = 0;
    let meter = move |frame: &[u8]| {
        count += 1;
        if count > 1 {
            return Vec::new();
        }
        vec![(Duration::from_millis(40), true_reply(frame))]
    };
    let mut run = Run::on(meter, &Limits::default());
    let points = points((0..10).chain(0x100..0x114).chain(0x200..0x214));
    let (row, troubles) = run.read(&points);
    assert_eq!(row.faults().count(), 40);
    // What is left on both sides of it, and the second big read.
    assert_eq!(unread(&troubles), [(0x10A, 1, 3)]);
    assert_eq!(
        run.requests(),
        [
            (0, 10),
            (0x100, 20),
            (0x100, 10),
            (0x10A, 1),
            (0x10A, 1),
            (0x10A, 1)
        ]
    );
}

#[test]
fn a_damaged_answer_between_silences_shows_that_the_unit_is_there() {
    let mut count = 0;
    let meter = move |frame: &[u8]| {
        count += 1;
        let mut answer = true_reply(frame);
        match count {
            1 | 7 => {}
            4 => answer.truncate(5),
            _ => return Vec::new(),
        }
        vec![(Duration::from_millis(40), answer)]
    };
    let mut run = Run::on(meter, &Limits::default());
    run.patience.retries = 0;
    let points = points([0, 2, 4, 6, 8, 10, 12]);
    let (row, _) = run.read(&points);
    assert_eq!(
        statuses(&points, &row),
        "0x0002 timeout\n0x0004 timeout\n0x0006 truncated\n0x0008 timeout\n0x000A timeout\n"
    );
}
