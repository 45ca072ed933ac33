//! Answers that come after their time-out: never the answer to anything else.

#[path = "support/clock.rs"]
mod clock;
#[path = "support/script.rs"]
mod script;

use std::time::Duration;

use meterpoll::client::{Failure, Patience};
use meterpoll::codec::{Request, Response};
use proptest::prelude::*;
use proptest::test_runner::{RngAlgorithm, TestRng, TestRunner};

use self::script::{Bench, Chunk, dripped, read, true_reply, true_response, unit};

/// The time-out in these tests.
const T: Duration = Duration::from_secs(1);

/// At 9600 8N1: a request of 8 characters, an answer with one register.
const REQUEST: Duration = Duration::from_nanos(8_333_333);
const ANSWER: Duration = Duration::from_nanos(7_291_666);
/// Two periods of an adapter that holds bytes back.
const ADAPTER: Duration = Duration::from_millis(32);

const fn ms(milliseconds: u64) -> Duration {
    Duration::from_millis(milliseconds)
}

impl Bench {
    fn ask(&mut self, number: u16, request: &Request, retries: u32) -> Result<Response, Failure> {
        let patience = Patience {
            timeout: T,
            longest_answer: T,
            retries,
            ..Patience::default()
        };
        self.client.request(unit(number), request, patience)
    }

    /// Reads one register of unit 17: its value is the true one, or there is none. Says which.
    fn reads(&mut self, address: u16, retries: u32) -> bool {
        match self.ask(17, &read(address, 1), retries) {
            Ok(response) => {
                assert_eq!(response, true_response(unit(17), address, 1));
                true
            }
            Err(_) => false,
        }
    }

    /// A meter that answers everything truly, so much after the request.
    fn answer_after(&self, delay: Duration) {
        self.line
            .meter(move |frame| vec![(delay, true_reply(frame))]);
    }
}

#[test]
fn a_late_answer_is_not_the_answer_to_the_next_register() {
    for delay in [1001, 1100, 1900, 2000].map(ms) {
        let mut bench = Bench::new();
        bench.line.answer(vec![(delay, true_reply(&frame(1)))]);
        bench.answer_after(ms(40));
        assert!(!bench.reads(1, 0));
        assert!(bench.reads(2, 0));
        assert!(bench.reads(1, 0));
    }
}

/// The frame that asks unit 17 for one register.
fn frame(address: u16) -> Vec<u8> {
    let mut bench = Bench::new();
    assert!(!bench.reads(address, 0));
    bench.line.sent().remove(0).frame
}

#[test]
fn a_late_answer_that_comes_in_drips_is_not_the_answer_to_the_next_register() {
    let mut bench = Bench::new();
    bench
        .line
        .answer(dripped(ms(1950), &true_reply(&frame(1)), ms(1)));
    bench.answer_after(ms(40));
    assert!(!bench.reads(1, 0));
    assert!(bench.reads(2, 0));
}

#[test]
fn the_answer_to_the_retry_is_drained_when_the_first_one_came_late() {
    let mut bench = Bench::new();
    bench.answer_after(ms(1100));
    assert!(bench.reads(1, 1));
    let retried = bench.sent_at()[1];
    bench.answer_after(ms(40));
    assert!(bench.reads(2, 0));
    // The next request goes out when that answer has come and the line was silent for t3.5.
    let silence = Duration::from_nanos(3_645_833);
    assert_eq!(bench.sent_at()[2], retried + REQUEST + ms(1100) + silence);
}

#[test]
fn the_same_request_again_goes_out_at_once_and_takes_the_late_answer() {
    let mut bench = Bench::new();
    bench.line.answer(vec![(ms(1100), true_reply(&frame(1)))]);
    bench.line.answer(Vec::new());
    assert!(!bench.reads(1, 0));
    let failed = bench.now();
    assert!(bench.reads(1, 0));
    assert_eq!(bench.sent_at()[1], failed);
    assert_eq!(bench.now(), failed + ms(100));
}

#[test]
fn a_different_request_waits_for_what_never_comes_no_longer_than_twice_the_time_out() {
    for retries in 0..=2 {
        let mut bench = Bench::new();
        assert!(!bench.reads(1, retries));
        bench.answer_after(ms(40));
        assert!(bench.reads(2, 0));
        let sent = bench.sent_at();
        let (last, next) = (sent[sent.len() - 2], sent[sent.len() - 1]);
        assert_eq!(next, last + REQUEST + 2 * T + ANSWER + ADAPTER);
    }
}

#[test]
fn time_that_passes_elsewhere_counts_towards_the_wait() {
    let mut bench = Bench::new();
    assert!(!bench.reads(1, 0));
    bench.clock.advance(ms(5000));
    bench.answer_after(ms(40));
    let start = bench.now();
    assert!(bench.reads(2, 0));
    assert_eq!(bench.sent_at()[1], start);
}

#[test]
fn a_late_exception_is_not_the_answer_to_the_next_register() {
    let mut bench = Bench::new();
    let refusal = [0x11, 0x83, 0x02, 0xC1, 0x34].to_vec();
    bench.line.answer(vec![(ms(1500), refusal)]);
    bench.answer_after(ms(40));
    assert!(!bench.reads(1, 0));
    assert!(bench.reads(2, 0));
}

#[test]
fn a_late_answer_of_another_unit_is_dropped() {
    let mut bench = Bench::new();
    bench.answer_after(ms(1100));
    assert!(bench.ask(18, &read(1, 1), 0).is_err());
    bench.answer_after(ms(40));
    assert!(bench.reads(1, 0));
}

#[test]
fn the_rest_of_an_answer_that_broke_off_does_not_hurt() {
    let mut bench = Bench::new();
    let answer = true_reply(&frame(1));
    let rest = vec![
        (ms(10), answer[..4].to_vec()),
        (ms(1500), answer[4..].to_vec()),
    ];
    bench.line.answer(rest);
    bench.answer_after(ms(40));
    assert!(!bench.reads(1, 0));
    assert!(bench.reads(2, 0));
}

#[test]
fn an_answer_later_than_the_wait_is_refused_where_its_length_differs() {
    let mut bench = Bench::new();
    bench.line.answer(vec![(ms(2100), true_reply(&frame(1)))]);
    bench.answer_after(ms(200));
    assert!(!bench.reads(1, 0));
    let response = bench.ask(17, &read(1, 2), 0);
    assert_eq!(response.ok(), Some(true_response(unit(17), 1, 2)));
}

#[test]
fn an_answer_later_than_the_wait_is_a_known_limit_where_its_length_is_the_same() {
    // Nothing in the frame tells: only a longer time-out does.
    let mut bench = Bench::new();
    bench.line.answer(vec![(ms(2100), true_reply(&frame(1)))]);
    bench.answer_after(ms(200));
    assert!(!bench.reads(1, 0));
    let response = bench.ask(17, &read(2, 1), 0);
    assert_eq!(response.ok(), Some(true_response(unit(17), 1, 1)));
}

/// An echo with one bit flipped.
fn damaged_echo(frame: &[u8], bit: usize) -> Vec<u8> {
    let mut echo = frame.to_vec();
    echo[bit / 8] ^= 1 << (bit % 8);
    echo
}

#[test]
fn a_damaged_echo_is_not_taken_for_an_answer_that_was_lost() {
    // The request for register 0x0240 starts like its answer, and that for 0x006B does so with a
    // bit flipped: a damaged echo looks like a damaged answer. The answer itself comes later.
    for (address, bit) in [(0x0240, 56), (0x006B, 17)] {
        let mut bench = Bench::new();
        bench.line.meter(move |frame| {
            vec![
                (ms(0), damaged_echo(frame, bit)),
                (ms(500), true_reply(frame)),
            ]
        });
        let answered = (0..10)
            .filter(|index| bench.reads(address + index, 0))
            .count();
        // Where the request itself looks alike, the damage is no reason to give up early.
        assert_eq!(answered, if address == 0x0240 { 10 } else { 0 });
    }
}

#[test]
fn noise_that_looks_like_a_damaged_exception_does_not_end_the_wait() {
    let mut bench = Bench::new();
    let noise = [0x11, 0x83, 0x02, 0x00, 0x00].to_vec();
    bench
        .line
        .answer(vec![(ms(10), noise), (ms(300), true_reply(&frame(1)))]);
    bench.answer_after(ms(450));
    assert!(bench.reads(1, 0));
    assert!(bench.reads(2, 0));
}

/// What goes wrong with one request: how late the answer is in ms, and a fault.
type Fault = (u64, u8, prop::sample::Index);

fn faulty(answer: Vec<u8>, (delay, kind, place): &Fault) -> Vec<Chunk> {
    let delay = ms(*delay);
    let at = place.index(answer.len());
    match kind {
        0 => Vec::new(),
        1 => vec![(delay, answer[..at].to_vec())],
        2 => {
            let (first, second) = answer.split_at(at);
            vec![(delay, first.to_vec()), (delay + ms(60), second.to_vec())]
        }
        3 => {
            let mut damaged = answer;
            damaged[at] ^= 1 << place.index(8);
            vec![(delay, damaged)]
        }
        4 => vec![(ms(0), answer[..at.min(5)].to_vec()), (delay, answer)],
        5 => dripped(delay, &answer, ms(1)),
        _ => vec![(delay, answer)],
    }
}

#[test]
fn whatever_goes_wrong_no_register_has_the_value_of_another() {
    let fault = (0_u64..1940, 0..9_u8, any::<prop::sample::Index>());
    let read = (0..4_u16, 0..3_u32, 0..300_u64);
    let reads = prop::collection::vec((read, prop::collection::vec(fault, 3)), 1..12);
    // A line echoes always or never; an echo has one bit flipped, or none.
    let strategy = (reads, prop::option::of(0..128_usize));
    let config = ProptestConfig {
        cases: 6000,
        failure_persistence: None,
        ..ProptestConfig::default()
    };
    let rng = TestRng::deterministic_rng(RngAlgorithm::ChaCha);
    TestRunner::new_with_rng(config, rng)
        .run(&strategy, |(reads, echo)| {
            let mut bench = Bench::new();
            for ((index, retries, idle), faults) in reads {
                bench.clock.advance(ms(idle));
                let mut faults = faults.into_iter().cycle();
                bench.line.meter(move |frame| {
                    let fault = faults.next().expect("they go round");
                    let mut chunks = match echo {
                        Some(bit @ 0..64) => vec![(ms(0), damaged_echo(frame, bit))],
                        Some(_) => vec![(ms(0), frame.to_vec())],
                        None => Vec::new(),
                    };
                    chunks.extend(faulty(true_reply(frame), &fault));
                    chunks
                });
                // Registers of which the requests start like their answers, and others.
                bench.reads([0x0240, 0x0241, 0x6B, 0x6C][usize::from(index)], retries);
            }
            bench.clock.advance(ms(5000));
            bench.answer_after(ms(40));
            prop_assert!(bench.reads(0x6D, 0));
            Ok(())
        })
        .unwrap_or_else(|error| panic!("{error}"));
}
