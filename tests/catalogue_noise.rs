//! The catalogue of faults (`tests/catalogue.md`): answers in pieces, noise around them, echoes and
//! second copies.

mod support {
    pub(crate) mod catalogue;
    pub(crate) mod clock;
    pub(crate) mod script;
}

use support::catalogue::{ADAPTER, ANSWER, Case, REQUEST, SILENCE, T, THINKS, ms};

/// An answer with three registers.
const BYTES: usize = 11;

/// Row 12.
#[test]
fn an_answer_that_breaks_off_anywhere_is_told_with_its_counts() {
    for cut in 1..BYTES {
        let rule = format!("cut={cut},on=1");
        let mut case = Case::new([rule.as_str()]).retries(0);
        let found = format!("the answer broke off after {cut} of 11 bytes");
        assert_eq!(case.fails(1), found);
    }
}

/// Row 12: with retries it is asked for again.
#[test]
fn an_answer_that_breaks_off_once_is_asked_for_again() {
    for cut in 1..BYTES {
        let rule = format!("cut={cut},on=1");
        let mut case = Case::new([rule.as_str()]);
        case.reads(1);
        assert_eq!((case.attempts(), case.counters().truncated), (2, 1));
    }
}

/// Row 13.
#[test]
fn the_rest_of_an_answer_that_comes_after_the_time_out_is_thrown_away() {
    for rest in ["1.1", "1.5", "1.9"] {
        for cut in 1..BYTES {
            let rule = format!("cut={cut},rest={rest},on=1");
            let mut case = Case::new([rule.as_str()]).retries(0);
            case.fails(1);
            case.reads(2);
            assert_eq!(case.attempts(), 2);
        }
    }
}

/// Row 14.
#[test]
fn an_answer_in_two_pieces_is_the_answer() {
    for gap in [1, 16, 60] {
        for first in 1..BYTES {
            let rule = format!("split={first},gap={gap}ms,on=1");
            let mut case = Case::new([rule.as_str()]);
            case.reads(1);
            assert_eq!(case.attempts(), 1);
            assert_eq!(case.now(), SILENCE + REQUEST + THINKS + ms(gap));
        }
    }
}

/// Row 15.
#[test]
fn an_answer_byte_by_byte_is_the_answer() {
    let mut case = Case::new(["drip=20ms,on=1"]);
    case.reads(1);
    assert_eq!(case.attempts(), 1);
    assert_eq!(case.now(), SILENCE + REQUEST + THINKS + ms(200));
}

/// Row 16.
#[test]
fn an_answer_that_never_ends_fails_when_its_time_is_up() {
    for pace in [1, 20, 99] {
        let rule = format!("endless,every={pace}ms,lasts=1500ms,on=1");
        let mut case = Case::new([rule.as_str()]).retries(0);
        case.fails(1);
        let deadline = SILENCE + REQUEST + T + ANSWER + ADAPTER;
        assert!(case.now() <= deadline, "{:?}", case.now());
    }
}

/// Rows 17 to 19, and 22.
#[test]
fn bytes_before_the_answer_are_skipped_and_counted() {
    for (noise, count) in [("00", 1), ("000000", 3), ("FF", 1), ("11", 1), ("1103", 2)] {
        let rule = format!("before={noise},on=1");
        let mut case = Case::new([rule.as_str()]);
        case.reads(1);
        assert_eq!((case.attempts(), case.counters().stray), (1, count));
    }
}

/// Row 20.
#[test]
fn up_to_32_random_bytes_before_the_answer_are_skipped_and_counted() {
    for seed in 0..300 {
        let rule = format!("before,seed={seed},on=1");
        let mut case = Case::new([rule.as_str()]);
        case.reads(1);
        assert_eq!(case.attempts(), 1);
        assert!((1..=32).contains(&case.counters().stray));
    }
}

/// Row 21: the request fails when its time is up, and no more bytes are kept than a frame behind a
/// frame of noise has.
#[test]
fn random_bytes_without_end_fail_when_the_time_is_up() {
    for (every, lasts) in [("1ms", "2s"), ("200us", "1100ms"), ("7ms", "1500ms")] {
        let rule = format!("garbage,every={every},lasts={lasts},on=1");
        let mut case = Case::new([rule.as_str()]).retries(0);
        let found = case.fails(1);
        assert!(found.starts_with("the answer was damaged: "), "{found}");
        let kept: usize = found.split(' ').nth(4).unwrap().parse().unwrap();
        assert!(kept <= 512, "{found}");
        let deadline = SILENCE + REQUEST + T + ANSWER + ADAPTER;
        assert!(case.now() <= deadline, "{:?}", case.now());
    }
}

/// Row 21: nothing is asked while it goes on, and everything once it is over.
#[test]
fn random_bytes_that_go_on_keep_the_line_and_no_request_is_sent_into_them() {
    let mut case = Case::new(["garbage,lasts=5s,on=1"]).retries(2);
    case.fails(1);
    let attempts = case.attempts();
    while case.now() < ms(4000) {
        let found = case.fails(2);
        assert!(found.starts_with("the line is never silent: "), "{found}");
        assert_eq!(case.attempts(), attempts);
    }
    case.reads(2);
}

/// Rows 23 and 24.
#[test]
fn bytes_behind_the_answer_do_no_harm() {
    for noise in ["00", "A75C3E", "110306"] {
        for gap in ["0ms", "2ms", "50ms"] {
            let rule = format!("after={noise},gap={gap},on=1-2");
            let mut case = Case::new([rule.as_str()]);
            case.reads(1);
            case.reads(2);
            assert_eq!(case.attempts(), 2);
        }
    }
}

/// Row 25.
#[test]
fn the_echo_of_the_request_is_dropped_and_counted() {
    for gap in ["0ms", "40ms", "900ms"] {
        let rule = format!("echo,gap={gap},on=1-2");
        let mut case = Case::new([rule.as_str()]);
        case.reads(1);
        case.reads(2);
        assert_eq!((case.attempts(), case.counters().echoes), (2, 2));
    }
}

/// Row 26.
#[test]
fn an_echo_alone_is_told_as_such_when_the_time_is_up() {
    let mut case = Case::new(["echo-only,on=1-3"]);
    let found = "nothing but the echo of the own request came back";
    assert_eq!(case.fails(1), found);
    assert_eq!(case.now(), SILENCE + (REQUEST + T) * 3);
}

/// Row 27.
#[test]
fn part_of_an_echo_is_skipped() {
    for bytes in 1..8 {
        let rule = format!("echo={bytes},on=1-2");
        let mut case = Case::new([rule.as_str()]);
        case.reads(1);
        case.reads(2);
        assert_eq!((case.attempts(), case.counters().stray), (2, 2 * bytes));
    }
}

/// Row 29.
#[test]
fn an_answer_that_comes_twice_is_used_once() {
    for gap in [0, 1, 5, 30, 100, 400] {
        let rule = format!("twice,gap={gap}ms,on=1");
        let mut case = Case::new([rule.as_str()]);
        let mut address = 1;
        // Until the second copy has come.
        while case.now() < ms(gap + 100) {
            case.reads(address);
            address += 1;
        }
    }
}

/// Row 29: on a line that doubles everything.
#[test]
fn where_every_answer_comes_twice_every_value_is_right() {
    for gap in [0, 1, 5, 30, 100, 400] {
        let rule = format!("twice,gap={gap}ms,on=1-60");
        let mut case = Case::new([rule.as_str()]);
        let mut address = 0;
        while case.attempts() < 60 {
            case.reads(address);
            address += 1;
        }
        assert!(address >= 40, "{address} reads");
    }
}

/// Row 23: what comes behind looks like the start of the next answer.
#[test]
fn what_is_behind_one_answer_is_not_the_start_of_the_next() {
    for gap in ["0ms", "5ms", "20ms"] {
        let rule = format!("after=1103061122,gap={gap},on=1-2");
        let mut case = Case::new([rule.as_str()]);
        case.reads(1);
        case.reads(2);
    }
}
