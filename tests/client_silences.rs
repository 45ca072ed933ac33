//! Silence between frames: kept before every request, and what is made of a line that has none.

#[path = "support/clock.rs"]
mod clock;
#[path = "support/script.rs"]
mod script;

use std::sync::Arc;
use std::time::Duration;

use meterpoll::client::{Echo, Failure, Patience};
use meterpoll::codec::Response;
use meterpoll::codec::rtu::encode_request;
use meterpoll::transport::{LineSettings, Parity};
use proptest::prelude::Rng;
use proptest::test_runner::{RngAlgorithm, TestRng};

use self::clock::FakeClock;
use self::script::{Bench, ScriptedLine, read, true_reply, true_response, unit};

/// The time-out in these tests.
const T: Duration = Duration::from_secs(1);

/// At 9600 8N1: t3.5, a request of 8 characters.
const SILENCE: Duration = Duration::from_nanos(3_645_833);
const REQUEST: Duration = Duration::from_nanos(8_333_333);

const fn ms(milliseconds: u64) -> Duration {
    Duration::from_millis(milliseconds)
}

impl Bench {
    fn read_after(&mut self, pause: Duration, retries: u32) -> Result<Response, Failure> {
        let patience = Patience {
            timeout: T,
            longest_answer: T,
            retries,
            pause,
            ..Patience::default()
        };
        self.client.request(unit(17), &read(0x6B, 3), patience)
    }

    fn assert_reads(&mut self, pause: Duration) {
        let response = self.read_after(pause, 0);
        let response = response.unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(response, true_response(unit(17), 0x6B, 3));
    }

    fn answer_truly(&self, delay: Duration) {
        self.line
            .meter(move |frame| vec![(delay, true_reply(frame))]);
    }
}

/// A line on which something was going on before the client came.
fn before(script: impl FnOnce(&ScriptedLine)) -> Bench {
    let clock = Arc::new(FakeClock::new());
    let settings = LineSettings::default();
    let line = ScriptedLine::new(Arc::clone(&clock), settings);
    script(&line);
    clock.advance(ms(100));
    Bench::on(clock, line, settings, Echo::Auto)
}

/// The same bytes every time.
fn noise(seed: u8) -> impl FnMut() -> Vec<u8> + Send {
    let mut rng = rng(seed);
    move || {
        (0..64)
            .map(|_| below(&mut rng, 256))
            .map(|byte| byte.to_le_bytes()[0])
            .collect()
    }
}

fn rng(seed: u8) -> TestRng {
    TestRng::from_seed(RngAlgorithm::ChaCha, &[seed; 32])
}

/// A number below `limit`, near enough to even.
fn below(rng: &mut TestRng, limit: u32) -> u32 {
    rng.next_u32() % limit
}

/// Baud; t3.5 of 8N1 and 8E1 in microseconds, cut to whole ones.
const TABLE: [(u32, u64, u64); 8] = [
    (1200, 29_166, 32_083),
    (2400, 14_583, 16_041),
    (4800, 7_291, 8_020),
    (9600, 3_645, 4_010),
    (19_200, 1_822, 2_005),
    (38_400, 1_750, 1_750),
    (57_600, 1_750, 1_750),
    (115_200, 1_750, 1_750),
];

#[test]
fn t3_5_is_kept_before_each_of_ten_thousand_requests() {
    let mut rng = rng(35);
    for (baud, plain, even) in TABLE {
        for (parity, silence) in [(Parity::None, plain), (Parity::Even, even)] {
            let settings = LineSettings {
                baud,
                parity,
                ..LineSettings::default()
            };
            let mut bench = Bench::with(settings, Echo::Auto);
            let mut faults = TestRng::from_seed(RngAlgorithm::ChaCha, &[7; 32]);
            bench.line.meter(move |frame| {
                let answer = true_reply(frame);
                let delay = Duration::from_micros(u64::from(below(&mut faults, 1_300_000)));
                match below(&mut faults, 8) {
                    0 => Vec::new(),
                    1 => vec![(delay, answer[..4].to_vec())],
                    2 => vec![(delay, answer), (delay + ms(1), vec![0x00, 0x00])],
                    3 => vec![(ms(0), frame.to_vec()), (delay, answer)],
                    _ => vec![(delay, answer)],
                }
            });
            while bench.frames() < 625 {
                let count = u16::try_from(1 + below(&mut rng, 125)).expect("a small number");
                let request = read(0x1000, count);
                let patience = Patience {
                    timeout: T,
                    longest_answer: T,
                    retries: below(&mut rng, 3),
                    ..Patience::default()
                };
                // What comes of it is told by other tests.
                drop(bench.client.request(unit(17), &request, patience));
                bench
                    .clock
                    .advance(Duration::from_micros(u64::from(below(&mut rng, 5000))));
            }
            for sent in bench.line.sent() {
                assert!(
                    sent.silence >= Duration::from_micros(silence),
                    "{settings}: {:?} after {:?} of silence",
                    sent.at,
                    sent.silence
                );
            }
        }
    }
}

#[test]
fn no_more_than_t3_5_is_spent_between_an_answer_and_the_next_request() {
    let mut bench = Bench::new();
    bench.answer_truly(ms(40));
    for _ in 0..10 {
        bench.assert_reads(Duration::ZERO);
    }
    let cycle = REQUEST + ms(40) + SILENCE;
    let expected: Vec<Duration> = (0..10).map(|index| SILENCE + cycle * index).collect();
    assert_eq!(bench.sent_at(), expected);
}

#[test]
fn a_line_that_has_been_silent_is_not_waited_for() {
    let mut bench = Bench::new();
    bench.answer_truly(ms(40));
    bench.assert_reads(Duration::ZERO);
    bench.clock.advance(ms(4));
    let start = bench.now();
    bench.assert_reads(Duration::ZERO);
    assert_eq!(bench.sent_at()[1], start);
}

#[test]
fn the_pause_is_kept_between_requests_but_not_before_the_first() {
    let mut bench = Bench::new();
    bench.answer_truly(ms(40));
    for _ in 0..3 {
        bench.assert_reads(ms(100));
    }
    let cycle = REQUEST + ms(40) + ms(100);
    assert_eq!(
        bench.sent_at(),
        [SILENCE, SILENCE + cycle, SILENCE + cycle * 2]
    );
}

#[test]
fn a_pause_shorter_than_t3_5_does_not_shorten_it() {
    let mut bench = Bench::new();
    bench.answer_truly(ms(40));
    bench.assert_reads(ms(1));
    bench.assert_reads(ms(1));
    assert_eq!(bench.sent_at()[1], SILENCE + REQUEST + ms(40) + SILENCE);
}

#[test]
fn the_pause_has_passed_by_the_time_a_silent_meter_is_asked_again() {
    let mut bench = Bench::new();
    assert!(bench.read_after(ms(100), 1).is_err());
    assert_eq!(bench.sent_at(), [SILENCE, SILENCE + REQUEST + T]);
}

#[test]
fn what_came_before_the_port_was_opened_is_thrown_away() {
    let stale = true_response(unit(17), 0x70, 3);
    let stale = script::reply(unit(17), stale);
    let mut bench = before(|line| line.inject(ms(50), &stale));
    bench.answer_truly(ms(40));
    bench.assert_reads(Duration::ZERO);
    assert_eq!(bench.sent_at(), [ms(100) + SILENCE]);
}

#[test]
fn the_line_is_seen_silent_before_the_first_request() {
    let stale = script::reply(unit(17), true_response(unit(17), 0x70, 3));
    let mut bench = before(|line| {
        line.inject(ms(101), &stale[..5]);
        line.inject(ms(104), &stale[5..]);
    });
    bench.answer_truly(ms(40));
    bench.assert_reads(Duration::ZERO);
    assert_eq!(bench.sent_at(), [ms(104) + SILENCE]);
}

#[test]
fn bytes_behind_an_answer_are_thrown_away_and_waited_out() {
    for trail in [&[0x00][..], &[0x00; 3], &[0xA7, 0x11, 0x03]] {
        let mut bench = Bench::new();
        let trail = trail.to_vec();
        bench
            .line
            .meter(move |frame| vec![(ms(40), true_reply(frame)), (ms(42), trail.clone())]);
        for _ in 0..3 {
            bench.assert_reads(Duration::ZERO);
        }
        assert_eq!(bench.sent_at()[1], SILENCE + REQUEST + ms(42) + SILENCE);
    }
}

#[test]
fn every_request_goes_out_in_one_write() {
    let mut bench = Bench::new();
    bench.answer_truly(ms(40));
    for count in 1..=125 {
        let response = bench
            .client
            .request(unit(17), &read(0, count), Patience::default());
        assert_eq!(response.ok(), Some(true_response(unit(17), 0, count)));
    }
    let sent = bench.line.sent();
    assert_eq!(sent.len(), 125);
    assert!(sent.iter().all(|sent| sent.frame.len() == 8));
}

#[test]
fn nothing_is_sent_on_a_line_that_is_never_silent() {
    let mut bench = Bench::new();
    bench.line.inject_endlessly(ms(0), ms(1), noise(1));
    match bench
        .read_after(Duration::ZERO, 2)
        .expect_err("nothing can be asked")
    {
        Failure::NeverQuiet { discarded } => assert_eq!(discarded, 64 * 1005),
        other => panic!("{other}"),
    }
    assert_eq!(bench.frames(), 0);
    // t3.5 and the time-out, to the next byte.
    assert_eq!(bench.now(), ms(1004));
}

#[test]
fn noise_that_starts_with_the_request_and_never_ends_fails_when_the_time_is_up() {
    let mut bench = Bench::new();
    // 64 000 bytes a second: more than the line carries, in every second of the wait.
    bench.line.inject_endlessly(ms(10), ms(1), noise(2));
    match bench
        .read_after(Duration::ZERO, 0)
        .expect_err("it is all noise")
    {
        // No more than two frames of it are kept.
        Failure::Damaged { received } => assert!(received <= 512, "{received} bytes"),
        other => panic!("{other}"),
    }
    assert_eq!(bench.frames(), 1);
    // An answer of 11 characters that began at the last moment would have had this long.
    let transfer = Duration::from_nanos(11_458_333) + ms(32);
    assert!(bench.now() >= SILENCE + REQUEST + T);
    assert!(bench.now() <= SILENCE + REQUEST + T + transfer);
}

#[test]
fn noise_that_is_let_go_is_counted_once() {
    let mut bench = Bench::new();
    // Many echoes, so that there is more than is kept with three bytes of noise before them.
    bench.line.answer(vec![(
        ms(10),
        [&[0x00; 3], &asked().repeat(10)[..]].concat(),
    )]);
    let failure = bench.read_after(Duration::ZERO, 0);
    assert!(matches!(failure, Err(Failure::OnlyEcho)), "{failure:?}");
    assert_eq!(bench.client.counters(unit(17)).stray, 3);
}

/// The frame of the read in these tests.
fn asked() -> Vec<u8> {
    encode_request(unit(17), &read(0x6B, 3)).as_bytes().to_vec()
}

#[test]
fn an_answer_in_the_middle_of_noise_is_found() {
    let mut bench = Bench::new();
    bench.line.inject_endlessly(ms(10), ms(1), noise(3));
    bench.answer_truly(Duration::from_micros(500_500));
    bench.assert_reads(Duration::ZERO);
}

#[test]
fn an_answer_before_more_noise_than_is_kept_is_found() {
    let mut bench = Bench::new();
    bench.line.meter(|frame| {
        let mut bytes = vec![0x00; 300];
        bytes.extend(true_reply(frame));
        bytes.extend([0x00; 600]);
        vec![(ms(10), bytes)]
    });
    bench.assert_reads(Duration::ZERO);
}

#[test]
fn the_time_of_day_comes_from_the_clock_of_the_line() {
    let bench = Bench::new();
    bench.clock.advance(ms(1500));
    assert_eq!(bench.client.utc_now().to_string(), "2026-01-15T12:00:01.5Z");
}
