//! The catalogue of faults (`tests/catalogue.md`): exceptions, what a meter wants of whoever asks
//! it, and a unit that is not there.

mod support {
    pub(crate) mod catalogue;
    pub(crate) mod clock;
    pub(crate) mod script;
}

use std::sync::Arc;
use std::time::Duration;

use meterpoll::codec::{Unit, UnitRange};
use meterpoll::transport::Clock;

use support::catalogue::{ADAPTER, ANSWER, Case, REQUEST, SILENCE, T, THINKS, answer, ms};
use support::clock::FakeClock;

/// The silences before the frames sent so far, but for the first, in whole milliseconds.
fn silences(case: &Case) -> Vec<u128> {
    let sent = case.sent();
    let silences = sent.iter().skip(1).map(|sent| sent.silence.as_millis());
    silences.collect()
}

/// Rows 40, 41 and 44.
#[test]
fn a_refusal_is_told_with_its_code_and_not_asked_about_again() {
    for (code, name) in [
        ("0x00", "exception 00"),
        ("0x01", "exception 01 (ILLEGAL FUNCTION)"),
        ("0x02", "exception 02 (ILLEGAL DATA ADDRESS)"),
        ("0x03", "exception 03 (ILLEGAL DATA VALUE)"),
        ("0x04", "exception 04 (SERVER DEVICE FAILURE)"),
        ("0x05", "exception 05 (ACKNOWLEDGE)"),
        ("0x0A", "exception 0A (GATEWAY PATH UNAVAILABLE)"),
        ("0x63", "exception 63"),
        ("0xFF", "exception FF"),
    ] {
        let rule = format!("exception={code},on=1");
        let mut case = Case::new([rule.as_str()]);
        assert_eq!(case.fails(1), format!("the meter refused: {name}"));
        assert_eq!(case.attempts(), 1);
    }
}

/// Row 42.
#[test]
fn a_busy_unit_is_asked_again_after_100_and_200_ms() {
    let mut case = Case::new(["exception=6,on=1-2"]).retries(0);
    case.reads(1);
    assert_eq!(silences(&case), [100, 200]);
    assert_eq!((case.counters().busy, case.counters().retries), (2, 0));
}

/// Row 43.
#[test]
fn a_unit_that_stays_busy_is_told_as_such_within_the_time_of_its_attempts() {
    let mut case = Case::new(["exception=6,on=1-4"]).retries(0);
    let found = "the meter refused: exception 06 (SERVER DEVICE BUSY)";
    assert_eq!(case.fails(1), found);
    assert_eq!(silences(&case), [100, 200, 400]);
    assert!(case.now() < T);
}

/// Row 44.
#[test]
fn a_fault_of_memory_is_asked_about_once_more() {
    let mut case = Case::new(["exception=8,on=1"]).retries(0);
    case.reads(1);
    assert_eq!(case.attempts(), 2);
    let mut case = Case::new(["exception=8,on=1-2"]).retries(0);
    let found = "the meter refused: exception 08 (MEMORY PARITY ERROR)";
    assert_eq!(case.fails(1), found);
    assert_eq!(case.attempts(), 2);
}

/// Row 44.
#[test]
fn a_gateway_whose_unit_is_silent_is_asked_as_often_as_a_silent_unit() {
    let mut case = Case::new(["exception=0x0B,on=1-2"]);
    case.reads(1);
    assert_eq!(case.attempts(), 3);
    let mut case = Case::new(["exception=0x0B,on=1-3"]);
    let found = "the meter refused: exception 0B (GATEWAY TARGET DEVICE FAILED TO RESPOND)";
    assert_eq!(case.fails(1), found);
    assert_eq!(case.attempts(), 3);
}

/// Row 55: a read takes a unit, and 0 is none.
#[test]
fn nobody_can_be_read_at_the_number_of_all() {
    for range in [UnitRange::Standard, UnitRange::Extended] {
        assert!(Unit::new(0, range).is_err());
    }
}

/// A meter that hears no request sooner than so long after anything on the line.
fn resting(clock: &Arc<FakeClock>, rest: Duration, pause: Duration) -> Case {
    let now = Arc::clone(clock);
    let mut deaf_until = Duration::ZERO;
    let meter = move |frame: &[u8]| {
        let is_deaf = now.now() < deaf_until;
        deaf_until = now.now() + REQUEST + rest;
        if is_deaf {
            return Vec::new();
        }
        deaf_until += THINKS;
        vec![(THINKS, answer(frame))]
    };
    Case::on(clock, [[]; 0] as [[&str; 0]; 0], meter)
        .pause(pause)
        .retries(0)
}

/// Row 56.
#[test]
fn a_meter_that_needs_a_pause_answers_every_request_behind_one() {
    let clock = Arc::new(FakeClock::new());
    let mut case = resting(&clock, ms(100), ms(100));
    for address in 0..20 {
        case.reads(address);
    }
    assert_eq!(case.attempts(), 20);
    assert!(silences(&case).iter().all(|silence| *silence == 100));
}

/// Row 56: and without one every other is lost.
#[test]
fn a_meter_that_needs_a_pause_and_gets_none_loses_requests_and_no_value_is_wrong() {
    let clock = Arc::new(FakeClock::new());
    let mut case = resting(&clock, ms(100), Duration::ZERO);
    case.reads(0);
    assert_eq!(case.fails(1), "no answer within 1s");
    case.clock.advance(ms(100));
}

/// Row 72: one time-out, and as long again for an answer that may still come and would collide with
/// the next unit's.
#[test]
fn a_unit_that_is_not_there_costs_the_others_its_time_out_and_the_wait_for_a_late_answer() {
    let cycle = |dead: &[u16]| {
        let rules: Vec<String> = dead
            .iter()
            .map(|number| format!("silence,for={number}"))
            .collect();
        let mut case = Case::new(rules.iter().map(String::as_str)).retries(0);
        let mut starts = Vec::new();
        for address in 0..100 {
            starts.push(case.now());
            for number in 1..=5 {
                let read = case.try_read(number, address, 3);
                assert_eq!(read.is_err(), dead.contains(&number));
            }
        }
        let periods: Vec<Duration> = starts
            .windows(2)
            .map(|pair| pair[1].saturating_sub(pair[0]))
            .collect();
        assert_eq!(periods.iter().min(), periods.iter().max());
        periods[0]
    };
    let (alive, dead) = (cycle(&[]), cycle(&[1]));
    // The answer of the dead one is no longer there.
    let answered = THINKS + SILENCE;
    assert_eq!(dead + answered, alive + T + T + ANSWER + ADAPTER);
}

/// Rows 60 to 62.
#[test]
fn a_read_during_which_the_port_is_lost_fails_at_once_and_the_next_is_right() {
    for rule in ["hang-up=before,on=1", "hang-up=during,on=1"] {
        let mut case = Case::new([rule]);
        let found = case.fails(1);
        assert!(found.contains("was lost"), "{found}");
        assert_eq!(case.attempts(), 1);
        assert!(case.now() <= SILENCE + REQUEST + THINKS, "{rule}");
        case.reads(2);
    }
    let mut case = Case::new(["hang-up=after,on=1"]);
    case.reads(1);
    let found = case.fails(2);
    assert!(found.contains("was lost"), "{found}");
}
