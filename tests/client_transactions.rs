//! One request at a time on a scripted line: answers, silences, retries, and what is made of
//! everything else that comes back.

#[path = "support/clock.rs"]
mod clock;
#[path = "support/script.rs"]
mod script;

use std::time::Duration;

use meterpoll::client::{Echo, Failure, Patience};
use meterpoll::codec::{Request, Response, rtu};
use meterpoll::transport::{LineSettings, TransportError};

use self::script::{Bench, dripped, read, reply, true_reply, true_response, unit};

/// The time-out in these tests.
const T: Duration = Duration::from_secs(1);

/// At 9600 8N1: t3.5, a request of 8 characters, two periods of an adapter.
const SILENCE: Duration = Duration::from_nanos(3_645_833);
const REQUEST: Duration = Duration::from_nanos(8_333_333);
const ADAPTER: Duration = Duration::from_millis(32);

const fn ms(milliseconds: u64) -> Duration {
    Duration::from_millis(milliseconds)
}

fn patience(retries: u32) -> Patience {
    Patience {
        timeout: T,
        longest_answer: T,
        retries,
        ..Patience::default()
    }
}

/// The frame of a read of unit 17.
fn asked(start: u16, count: u16) -> Vec<u8> {
    let frame = rtu::encode_request(unit(17), &read(start, count));
    frame.as_bytes().to_vec()
}

/// The true answer to it.
fn answered(start: u16, count: u16) -> Vec<u8> {
    true_reply(&asked(start, count))
}

impl Bench {
    /// Reads three registers of unit 17.
    fn read(&mut self, retries: u32) -> Result<Response, Failure> {
        self.client
            .request(unit(17), &read(0x6B, 3), patience(retries))
    }

    fn loopback(&mut self) -> Result<Response, Failure> {
        let request = Request::ReturnQueryData(0xA537);
        self.client.request(unit(17), &request, patience(0))
    }

    /// Reading them goes right.
    fn assert_reads(&mut self, retries: u32) {
        let response = self.read(retries).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(response, true_response(unit(17), 0x6B, 3));
    }

    /// Reading them fails.
    fn failure(&mut self, retries: u32) -> Failure {
        self.read(retries).expect_err("nothing answered")
    }
}

/// A line on which a read of three registers meets these bytes, 10 ms after the request.
fn meeting(bytes: Vec<u8>) -> Bench {
    let bench = Bench::new();
    bench.line.answer(vec![(ms(10), bytes)]);
    bench
}

#[test]
fn an_answer_in_time_is_returned_when_it_is_whole() {
    let mut bench = Bench::new();
    bench
        .line
        .answer(dripped(ms(40), &answered(0x6B, 3), ms(1)));
    bench.assert_reads(2);
    let sent = bench.line.sent();
    assert_eq!(sent.len(), 1);
    assert_eq!(
        sent[0].frame,
        [0x11, 0x03, 0x00, 0x6B, 0x00, 0x03, 0x76, 0x87]
    );
    assert_eq!(sent[0].at, SILENCE);
    assert_eq!(bench.now(), SILENCE + REQUEST + ms(50));
}

#[test]
fn silence_fails_after_the_time_out_of_every_attempt() {
    for retries in 0..=3 {
        let mut bench = Bench::new();
        assert_eq!(bench.failure(retries).to_string(), "no answer within 1s");
        let attempts = retries + 1;
        assert_eq!(bench.now(), SILENCE + (REQUEST + T) * attempts);
        let expected: Vec<Duration> = (0..attempts)
            .map(|attempt| SILENCE + (REQUEST + T) * attempt)
            .collect();
        assert_eq!(bench.sent_at(), expected);
        assert!(
            bench
                .line
                .sent()
                .iter()
                .all(|sent| sent.frame == asked(0x6B, 3))
        );
    }
}

#[test]
fn after_one_silence_the_same_frame_goes_out_again() {
    let mut bench = Bench::new();
    bench.line.answer(Vec::new());
    bench.line.answer(vec![(ms(40), answered(0x6B, 3))]);
    bench.assert_reads(2);
    let frames: Vec<Vec<u8>> = bench
        .line
        .sent()
        .into_iter()
        .map(|sent| sent.frame)
        .collect();
    assert_eq!(frames, [asked(0x6B, 3), asked(0x6B, 3)]);
}

#[test]
fn an_answer_that_begins_in_time_may_end_after_it() {
    // 255 characters take 2125 ms at 1200 baud.
    let settings = LineSettings {
        baud: 1200,
        ..LineSettings::default()
    };
    let mut bench = Bench::with(settings, Echo::Auto);
    let character = Duration::from_nanos(8_333_333);
    let answer = answered(0x1000, 125);
    bench.line.answer(dripped(ms(999), &answer, character));
    let response = bench
        .client
        .request(unit(17), &read(0x1000, 125), patience(0));
    assert_eq!(response.ok(), Some(true_response(unit(17), 0x1000, 125)));
    assert_eq!(bench.frames(), 1);
}

#[test]
fn an_answer_that_begins_after_the_time_out_is_too_late() {
    for delay in [1000, 1001, 1300] {
        let mut bench = Bench::new();
        let late = dripped(
            ms(delay) + Duration::from_nanos(1),
            &answered(0x6B, 3),
            ms(1),
        );
        bench.line.answer(late);
        assert!(matches!(bench.failure(0), Failure::Silence { .. }));
        assert_eq!(bench.now(), SILENCE + REQUEST + T);
    }
}

#[test]
fn an_answer_that_never_ends_is_given_its_transfer_time_and_no_more() {
    let mut bench = Bench::new();
    bench
        .line
        .answer(dripped(ms(900), &answered(0x1000, 125), ms(20)));
    let failure = bench
        .client
        .request(unit(17), &read(0x1000, 125), patience(0));
    // 255 characters at 9600 baud.
    let transfer = Duration::from_micros(265_625);
    assert_eq!(bench.now(), SILENCE + REQUEST + T + transfer + ADAPTER);
    // From 900 ms to 1297.6 ms a byte every 20 ms.
    assert_eq!(
        failure.expect_err("it is not whole").to_string(),
        "the answer broke off after 20 of 255 bytes"
    );
}

#[test]
fn the_echo_of_the_request_is_dropped() {
    for echo in [Echo::Auto, Echo::On] {
        let mut bench = Bench::with(LineSettings::default(), echo);
        bench
            .line
            .meter(|frame| vec![(ms(0), frame.to_vec()), (ms(40), true_reply(frame))]);
        bench.assert_reads(0);
        // An adapter may deliver both at once.
        bench
            .line
            .meter(|frame| vec![(ms(40), [frame, &true_reply(frame)].concat())]);
        bench.assert_reads(0);
    }
}

#[test]
fn an_echo_alone_is_told_as_such() {
    let mut bench = Bench::new();
    bench.line.meter(|frame| vec![(ms(0), frame.to_vec())]);
    assert!(matches!(bench.failure(1), Failure::OnlyEcho));
    assert_eq!(bench.frames(), 2);
    assert_eq!(bench.now(), SILENCE + (REQUEST + T) * 2);
}

#[test]
fn a_loopback_on_a_line_that_does_not_echo_takes_one_copy() {
    let mut bench = Bench::new();
    bench.line.meter(|frame| vec![(ms(10), frame.to_vec())]);
    assert_eq!(bench.loopback().ok(), Some(Response::QueryData(0xA537)));
}

#[test]
fn a_loopback_on_a_line_said_to_echo_takes_two_copies() {
    let mut bench = Bench::with(LineSettings::default(), Echo::On);
    bench.line.meter(|frame| vec![(ms(0), frame.to_vec())]);
    assert!(matches!(bench.loopback(), Err(Failure::OnlyEcho)));
    bench
        .line
        .meter(|frame| vec![(ms(0), frame.to_vec()), (ms(10), frame.to_vec())]);
    assert_eq!(bench.loopback().ok(), Some(Response::QueryData(0xA537)));
}

#[test]
fn a_line_that_has_echoed_once_is_known_to_echo() {
    // Whether echo and answer come one after the other or both at once.
    for echo_after in [ms(0), ms(40)] {
        let mut bench = Bench::new();
        bench.line.answer(vec![
            (echo_after, asked(0x6B, 3)),
            (ms(40), answered(0x6B, 3)),
        ]);
        bench.assert_reads(0);
        bench.line.meter(|frame| vec![(ms(0), frame.to_vec())]);
        assert!(matches!(bench.loopback(), Err(Failure::OnlyEcho)));
    }
}

#[test]
fn frames_of_other_units_are_dropped_while_the_time_runs_on() {
    let mut bench = Bench::new();
    let foreign = reply(unit(18), true_response(unit(18), 0x6B, 3));
    bench
        .line
        .answer(vec![(ms(10), foreign.clone()), (ms(20), answered(0x6B, 3))]);
    bench.assert_reads(0);
    // One at 0.9 T does not give the answer more time.
    bench
        .line
        .answer(vec![(ms(900), foreign), (ms(1001), answered(0x6B, 3))]);
    let start = bench.now();
    assert_eq!(
        bench.failure(0).to_string(),
        "no answer within 1s, only 1 frame of other units"
    );
    assert_eq!(bench.now(), start + SILENCE + REQUEST + T);
}

#[test]
fn another_unit_that_talks_for_ever_does_not_hold_a_request_up() {
    let mut bench = Bench::new();
    let foreign = reply(unit(18), true_response(unit(18), 0x6B, 3));
    bench
        .line
        .inject_endlessly(ms(100), ms(200), move || foreign.clone());
    match bench.failure(2) {
        Failure::Silence {
            timeout,
            others,
            stray,
        } => assert_eq!((timeout, others, stray), (T, 5, 0)),
        other => panic!("{other}"),
    }
    // The second and third attempt wait for silence where they would cut a frame off.
    let sent = bench.sent_at();
    assert_eq!(sent[0], SILENCE);
    assert_eq!(sent[1], sent[0] + REQUEST + T);
    assert_eq!(bench.now(), sent[2] + REQUEST + T);
}

#[test]
fn an_answer_to_something_else_is_named_when_the_time_is_up() {
    let mut bench = meeting(answered(0x6B, 2));
    assert_eq!(
        bench.failure(0).to_string(),
        "the unit answered something else: 2 registers, and 3 asked for"
    );
    assert_eq!(bench.now(), SILENCE + REQUEST + T);
}

#[test]
fn a_line_that_is_lost_fails_at_once_and_is_not_asked_again() {
    for lost_at in [ms(0), ms(4), ms(500), ms(1009)] {
        let mut bench = Bench::new();
        bench.line.hang_up(lost_at);
        match bench.failure(2) {
            Failure::Port(TransportError::Lost { port, .. }) => assert_eq!(port, "scripted"),
            other => panic!("{other}"),
        }
        assert_eq!(bench.now(), lost_at);
        assert_eq!(bench.frames(), usize::from(lost_at > SILENCE));
    }
}
