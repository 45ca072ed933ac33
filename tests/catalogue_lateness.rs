//! The catalogue of faults (`tests/catalogue.md`): nothing wrong, silence, and answers that come
//! late.

mod support {
    pub(crate) mod catalogue;
    pub(crate) mod clock;
    pub(crate) mod script;
}

use meterpoll::client::{QueryData, Ways};
use meterpoll::codec::ReadFunction;

use support::catalogue::{ADAPTER, ANSWER, Case, REQUEST, SILENCE, T, UNIT, ms, read, truths};

const FUNCTIONS: Ways = Ways {
    interchangeable_reads: true,
    loopback: None,
};

const LOOPBACK: Ways = Ways {
    interchangeable_reads: false,
    loopback: Some(QueryData::Any),
};

/// Row 1.
#[test]
fn without_a_fault_one_and_most_registers_of_both_functions_are_read() {
    for function in [ReadFunction::HoldingRegisters, ReadFunction::InputRegisters] {
        for count in [1, 125] {
            let mut case = Case::new([]);
            let values = case.ask(UNIT, &read(function, 0x6B, count));
            assert_eq!(values.ok(), Some(truths(UNIT, 0x6B, count)));
            assert_eq!(case.attempts(), 1);
        }
    }
}

/// Row 2.
#[test]
fn silence_costs_the_time_out_of_each_attempt_and_the_wait_for_a_late_answer() {
    for retries in 0..=3 {
        let rule = format!("silence,on=1-{}", retries + 1);
        let mut case = Case::new([rule.as_str()]).retries(retries);
        assert_eq!(case.fails(1), "no answer within 1s");
        let failed = SILENCE + (REQUEST + T) * (retries + 1);
        assert_eq!(case.now(), failed);
        case.reads(2);
        let next = case.sent().pop().expect("a frame").at;
        assert_eq!(next, failed + T + ANSWER + ADAPTER);
    }
}

/// Row 3.
#[test]
fn after_one_silence_the_second_attempt_is_answered() {
    let mut case = Case::new(["silence,on=1"]);
    case.reads(1);
    assert_eq!(case.attempts(), 2);
}

/// Row 4.
#[test]
fn an_answer_at_nine_tenths_of_the_time_out_is_in_time() {
    let mut case = Case::new(["late=0.9,on=1"]).retries(0);
    case.reads(1);
    assert_eq!(case.now(), SILENCE + REQUEST + ms(900));
}

/// Rows 5 and 6.
#[test]
fn an_answer_within_twice_the_time_out_is_not_the_answer_to_something_else() {
    for rule in ["late=1.1,on=1", "late=1.9,on=1"] {
        let mut case = Case::new([rule]).retries(0);
        assert_eq!(case.fails(1), "no answer within 1s");
        case.reads(2);
        assert_eq!((case.attempts(), case.counters().late), (2, 1));
    }
}

/// Row 7.
#[test]
fn an_answer_after_the_wait_is_refused_by_its_byte_count() {
    let mut case = Case::new(["late=3,on=1", "delay=980ms,on=2"]).retries(0);
    assert_eq!(case.fails(1), "no answer within 1s");
    case.try_read(UNIT, 1, 4).expect("an answer");
    assert_eq!(case.attempts(), 2);
}

/// Row 8: what tells such an answer, on a meter that has it.
#[test]
fn an_answer_after_the_wait_is_told_by_its_function_or_by_a_loop_back() {
    // Whether the line echoes has to be known for a loop-back, so a good read goes first.
    for (ways, frames) in [(FUNCTIONS, 3), (LOOPBACK, 4)] {
        let mut case = Case::new(["late=3,on=2", "delay=980ms,on=3"]);
        case = case.retries(0).ways(ways);
        case.reads(0);
        assert_eq!(case.fails(1), "no answer within 1s");
        case.reads(2);
        assert_eq!((case.attempts(), case.counters().late), (frames, 1));
    }
}

/// Row 8: of a meter of which nothing is known, this is the limit: nothing in the frame tells.
#[test]
fn an_answer_after_the_wait_is_a_known_limit_where_nothing_tells_it() {
    let mut case = Case::new(["late=3,on=1", "delay=980ms,on=2"]).retries(0);
    assert_eq!(case.fails(1), "no answer within 1s");
    let values = case.ask(UNIT, &read(ReadFunction::HoldingRegisters, 2, 3));
    assert_eq!(values.ok(), Some(truths(UNIT, 1, 3)));
    // A longer time-out keeps it away; here the answer that is under way is waited for.
    case.clock.advance(ms(1000));
}

/// Row 9.
#[test]
fn of_two_answers_to_the_same_question_the_second_is_drained() {
    for rule in ["late=1.1,on=1", "late=1.1,on=1-2"] {
        let mut case = Case::new([rule]).retries(1);
        case.reads(1);
        assert_eq!((case.attempts(), case.counters().late), (2, 0));
        case.reads(2);
        assert_eq!((case.attempts(), case.counters().late), (3, 1));
    }
}

/// Row 10.
#[test]
fn of_a_hundred_reads_that_are_all_answered_late_none_is_wrong() {
    let mut case = Case::new(["late=1.1,on=1-100"]).retries(0);
    for address in 0..100 {
        assert_eq!(case.fails(address), "no answer within 1s");
    }
    assert_eq!((case.attempts(), case.counters().late), (100, 99));
}

/// Row 10 with retries: the late answer to the first attempt is right.
#[test]
fn of_a_hundred_reads_that_are_all_answered_late_all_are_right_with_a_retry() {
    let mut case = Case::new(["late=1.1,on=1-200"]).retries(1);
    for address in 0..100 {
        case.reads(address);
    }
    assert_eq!(case.attempts(), 200);
}

/// Row 11.
#[test]
fn a_late_answer_of_one_unit_is_not_the_answer_of_another() {
    for late in ["late=1.1,for=18,on=1", "late=3,for=18,on=1"] {
        let mut case = Case::new([late, "delay=980ms,on=2"]).retries(0);
        case.try_read(18, 1, 3).expect_err("no answer");
        case.reads(1);
        assert_eq!(case.attempts(), 2);
    }
}
