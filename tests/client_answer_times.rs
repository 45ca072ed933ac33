//! How long a unit takes to answer, as measured; and requests it may not answer at all.

#[path = "support/clock.rs"]
mod clock;
#[path = "support/script.rs"]
mod script;

use std::time::Duration;

use meterpoll::client::{Echo, Failure, Patience};
use meterpoll::codec::{ExceptionCode, FunctionCode, Reply, Response, rtu};
use meterpoll::transport::LineSettings;

use self::script::{Bench, Chunk, dripped, read, true_reply, unit};

/// At 9600 8N1: t3.5 and one character.
const SILENCE: Duration = Duration::from_nanos(3_645_833);
const CHARACTER: Duration = Duration::from_nanos(1_041_666);

const fn ms(milliseconds: u64) -> Duration {
    Duration::from_millis(milliseconds)
}

impl Bench {
    /// Reads ten registers, 25 bytes, with what comes back after the request.
    fn reads(&mut self, chunks: impl Fn(Vec<u8>) -> Vec<Chunk> + Send + 'static) {
        self.line.meter(move |frame| chunks(true_reply(frame)));
        let response = self
            .client
            .request(unit(17), &read(0x10, 10), Patience::default());
        response.unwrap_or_else(|error| panic!("{error}"));
    }

    /// What is known of unit 17, to the microsecond.
    fn known(&self) -> Option<u128> {
        self.client
            .answer_time(unit(17))
            .map(|time| time.as_micros())
    }
}

#[test]
fn nothing_is_known_of_a_unit_that_has_not_answered() {
    let mut bench = Bench::new();
    assert_eq!(bench.known(), None);
    bench.reads(|answer| vec![(SILENCE + ms(40), answer)]);
    assert_eq!(bench.client.answer_time(unit(18)), None);
}

#[test]
fn the_time_counts_from_the_silence_after_the_request_to_where_the_answer_begins() {
    let mut bench = Bench::new();
    // The first byte is there a character after it began, the others follow.
    bench.reads(|answer| dripped(SILENCE + ms(40) + CHARACTER, &answer, CHARACTER));
    assert_eq!(bench.known(), Some(40_000));
}

#[test]
fn bytes_that_are_delivered_at_once_were_on_the_wire_one_by_one() {
    let mut bench = Bench::new();
    let end = SILENCE + ms(40) + LineSettings::default().transfer_time(25);
    bench.reads(move |answer| vec![(end, answer)]);
    assert_eq!(bench.known(), Some(40_000));
    // Noise behind the answer is no part of it.
    let mut bench = Bench::new();
    bench.reads(move |answer| vec![(end, [answer, vec![0; 9]].concat())]);
    assert_eq!(bench.known(), Some(40_000));
}

#[test]
fn a_meter_faster_than_the_wire_takes_no_time() {
    let mut bench = Bench::new();
    bench.reads(|answer| vec![(Duration::ZERO, answer)]);
    assert_eq!(bench.known(), Some(0));
}

#[test]
fn echo_and_noise_before_the_answer_are_not_its_beginning() {
    let mut bench = Bench::with(LineSettings::default(), Echo::Auto);
    bench.reads(|answer| {
        let frame = rtu::encode_request(unit(17), &read(0x10, 10));
        let mut chunks = vec![(Duration::ZERO, frame.as_bytes().to_vec())];
        chunks.push((ms(1), vec![0x00]));
        chunks.extend(dripped(SILENCE + ms(20) + CHARACTER, &answer, CHARACTER));
        chunks
    });
    assert_eq!(bench.known(), Some(20_000));
}

#[test]
fn the_median_of_the_last_31_answers_counts() {
    let mut bench = Bench::new();
    let after = |delay: u64| {
        move |answer: Vec<u8>| dripped(SILENCE + ms(delay) + CHARACTER, &answer, CHARACTER)
    };
    for delay in [500, 20, 10, 30, 25] {
        bench.reads(after(delay));
    }
    assert_eq!(bench.known(), Some(25_000));
    for _ in 0..15 {
        bench.reads(after(60));
    }
    assert_eq!(bench.known(), Some(60_000));
    for _ in 0..16 {
        bench.reads(after(10));
    }
    assert_eq!(bench.known(), Some(10_000));
}

#[test]
fn refusals_and_answers_that_may_be_late_are_not_measured() {
    let mut bench = Bench::new();
    bench.line.answer(Vec::new());
    bench.reads(|answer| vec![(ms(40), answer)]);
    assert_eq!(bench.frames(), 2);
    assert_eq!(bench.known(), None);
    let refusal = Reply::Exception {
        function: FunctionCode::ReadHoldingRegisters,
        code: ExceptionCode::ILLEGAL_DATA_ADDRESS,
    };
    let refusal = rtu::encode_reply(unit(17), &refusal).as_bytes().to_vec();
    bench.line.answer(vec![(ms(1), refusal)]);
    let refused = bench
        .client
        .request(unit(17), &read(0x20, 10), Patience::default());
    assert!(matches!(refused, Err(Failure::Exception(_))));
    assert_eq!(bench.known(), None);
}

/// What comes of a trial, and how many requests it took.
fn trial(bench: &mut Bench) -> (Result<Response, Failure>, usize) {
    let result = bench
        .client
        .try_request(unit(17), &read(0x10, 10), Patience::default());
    let frames = bench.frames();
    (result, frames)
}

#[test]
fn a_trial_that_meets_silence_is_not_repeated() {
    let mut bench = Bench::new();
    let (result, frames) = trial(&mut bench);
    assert!(matches!(result, Err(Failure::Silence { .. })));
    assert_eq!(frames, 1);
}

#[test]
fn a_trial_that_meets_damage_is_repeated_like_any_other_request() {
    let mut bench = Bench::new();
    let broken = |frame: Vec<u8>| vec![(ms(10), frame[..10].to_vec())];
    let answer = true_reply(rtu::encode_request(unit(17), &read(0x10, 10)).as_bytes());
    bench.line.answer(broken(answer));
    let (result, frames) = trial(&mut bench);
    assert!(matches!(result, Err(Failure::Silence { .. })));
    assert_eq!(frames, 3);
}
