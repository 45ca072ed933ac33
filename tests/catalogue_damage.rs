//! The catalogue of faults (`tests/catalogue.md`): damaged answers, and valid frames that are not
//! the answer.

mod support {
    pub(crate) mod catalogue;
    pub(crate) mod clock;
    pub(crate) mod question;
    pub(crate) mod script;
}

use meterpoll::client::Echo;
use proptest::prelude::Rng;
use proptest::test_runner::{RngAlgorithm, TestRng};

use support::catalogue::{ADAPTER, ANSWER, Case, REQUEST, SILENCE, T, THINKS, ms};
use support::question::{Question, read, registers, reply_frame};

/// Bits of an answer with three registers.
const BITS: usize = 88;

/// Row 30.
#[test]
fn a_damaged_answer_is_asked_for_again_100_ms_later() {
    for rule in ["crc,on=1", "crc-swapped,on=1"] {
        let mut case = Case::new([rule]);
        case.reads(1);
        let sent: Vec<_> = case.sent().iter().map(|sent| sent.at).collect();
        assert_eq!(sent, [SILENCE, SILENCE + REQUEST + THINKS + ms(100)]);
        assert_eq!(case.counters().damaged, 1);
    }
}

/// Rows 31 and 34.
#[test]
fn an_answer_that_is_always_damaged_is_told_as_damaged() {
    for rule in ["crc,on=1-3", "crc-swapped,on=1-3"] {
        let mut case = Case::new([rule]);
        let found = "the answer was damaged: 11 bytes without a valid CRC";
        assert_eq!(case.fails(1), found);
        assert_eq!(case.attempts(), 3);
    }
}

/// Row 32.
#[test]
fn no_bit_that_is_flipped_makes_a_wrong_value() {
    for bit in 0..BITS {
        let rule = format!("flip={bit},on=1");
        let mut case = Case::new([rule.as_str()]).retries(0);
        case.fails(1);
        case.reads(2);
        let mut case = Case::new([rule.as_str()]).retries(1);
        case.reads(1);
        assert_eq!(case.attempts(), 2);
    }
}

/// Row 33: through the client.
#[test]
fn no_burst_of_up_to_16_bits_makes_a_wrong_value() {
    let mut case = Case::new(["burst,on=1-2000"]).retries(0);
    for address in 0..2000 {
        case.fails(address);
    }
    assert_eq!(case.attempts(), 2000);
}

/// Row 33: the mass of them, where it is decided what is believed.
#[test]
fn of_a_hundred_thousand_bursts_none_is_believed() {
    let mut rng = TestRng::from_seed(RngAlgorithm::ChaCha, &[33; 32]);
    let mut below = |limit: usize| usize::try_from(rng.next_u32()).unwrap() % limit;
    let values: Vec<u16> = (0x1200..0x1200 + 125).collect();
    let counts = [1, 3, 11, 125];
    let shapes: Vec<_> = counts
        .iter()
        .map(|count| {
            let question = Question::new(read(0x6B, *count));
            let answer = registers(&values[..usize::from(*count)]);
            let frame = reply_frame(0x11, &answer);
            (question.with(Echo::Auto, Some(false)), frame)
        })
        .collect();
    for index in 0..100_000 {
        // A long frame costs twenty times as much: one in fifty is.
        let shape = if index % 50 == 0 { 3 } else { index % 3 };
        let (question, frame) = &shapes[shape];
        let length = 1 + below(16);
        let start = below(frame.len() * 8 - length + 1);
        let mut damaged = frame.clone();
        for bit in start..start + length {
            let is_end = bit == start || bit + 1 == start + length;
            if is_end || below(2) == 1 {
                damaged[bit / 8] ^= 1 << (bit % 8);
            }
        }
        assert_eq!(question.answer(&damaged), None, "{damaged:02X?}");
    }
}

/// Row 35.
#[test]
fn a_frame_of_another_unit_is_passed_over() {
    let mut case = Case::new(["stranger,gap=990ms,on=1"]).retries(0);
    case.reads(1);
    assert_eq!((case.attempts(), case.counters().others), (1, 1));
    assert_eq!(case.now(), SILENCE + REQUEST + ms(990));
}

/// Row 35: the time runs on meanwhile.
#[test]
fn a_frame_of_another_unit_does_not_give_the_answer_more_time() {
    let mut case = Case::new(["stranger,gap=1001ms,on=1"]).retries(0);
    let found = "no answer within 1s, only 1 frame of other units";
    assert_eq!(case.fails(1), found);
    assert_eq!(case.now(), SILENCE + REQUEST + T);
}

/// Row 36.
#[test]
fn another_unit_that_talks_for_ever_does_not_hold_a_request_up() {
    let mut case = Case::new(["stranger-only,every=200ms,lasts=3s,on=1"]).retries(0);
    let found = "no answer within 1s, only 5 frames of other units";
    assert_eq!(case.fails(1), found);
    assert_eq!(case.now(), SILENCE + REQUEST + T);
}

/// Row 36: the answer itself bears another number.
#[test]
fn an_answer_under_another_number_is_none() {
    let mut case = Case::new(["wrong-unit,on=1-3"]);
    let found = "no answer within 1s, only 1 frame of other units";
    assert_eq!(case.fails(1), found);
    assert_eq!(case.now(), SILENCE + (REQUEST + T) * 3);
}

/// Rows 37, 38 and 45.
#[test]
fn a_valid_frame_that_answers_something_else_is_told_as_such() {
    for (rule, found) in [
        (
            "wrong-function",
            "an answer to function 04 (Read Input Registers)",
        ),
        ("wrong-count=+1", "4 registers, and 3 asked for"),
        ("wrong-count=-1", "2 registers, and 3 asked for"),
        ("wrong-count=odd", "a malformed frame: byte count is 0x0007"),
        (
            "wrong-count=0",
            "a malformed frame: 0 registers: a read carries 1 to 125",
        ),
        (
            "exception-for=4",
            "exception 02 (ILLEGAL DATA ADDRESS) to function 04 (Read Input Registers)",
        ),
        (
            "exception-for=16",
            "exception 02 (ILLEGAL DATA ADDRESS) to function 16 (Write Multiple Registers)",
        ),
    ] {
        let rule = format!("{rule},on=1");
        let mut case = Case::new([rule.as_str()]).retries(0);
        let found = format!("the unit answered something else: {found}");
        assert_eq!(case.fails(1), found, "{rule}");
        assert_eq!(case.now(), SILENCE + REQUEST + T);
        let mut case = Case::new([rule.as_str()]).retries(1);
        case.reads(1);
        assert_eq!((case.attempts(), case.counters().mismatched), (2, 1));
    }
}

/// Rows 38 and 39: no frame has more than 256 bytes, so these are none.
#[test]
fn what_is_longer_than_a_frame_can_be_is_told_as_damaged() {
    for (rule, bytes) in [("wrong-count=255,on=1", 260), ("oversize,on=1", 257)] {
        let mut case = Case::new([rule]).retries(0);
        let found = format!("the answer was damaged: {bytes} bytes without a valid CRC");
        assert_eq!(case.fails(1), found);
        case.reads(2);
        let mut case = Case::new([rule]).retries(1);
        case.reads(1);
        assert_eq!((case.attempts(), case.counters().damaged), (2, 1));
    }
}

/// Row 46.
#[test]
fn a_damaged_exception_is_told_as_damaged() {
    let mut case = Case::layered([["exception=2,on=1"], ["crc,on=1"]]).retries(0);
    let found = "the answer was damaged: 5 bytes without a valid CRC";
    assert_eq!(case.fails(1), found);
    assert!(case.now() <= SILENCE + REQUEST + T + ANSWER + ADAPTER);
}
