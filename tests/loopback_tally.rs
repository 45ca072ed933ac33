//! What the tries of a loop-back test come to: times, percentiles, jitter, the verdict in words.

use std::io;
use std::time::Duration;

use meterpoll::client::Failure;
use meterpoll::codec::ExceptionCode;
use meterpoll::output::loopback::lines;
use meterpoll::profile::LoopbackData;
use meterpoll::readings::loopback::{
    AnswerTime, LineEcho, Noticed, Summary, Tally, Times, Verdict, WORDS, word,
};
use meterpoll::transport::TransportError;
use proptest::prelude::*;

type Outcome = Result<AnswerTime, Failure>;

fn tenths(tenths: u64) -> AnswerTime {
    AnswerTime::from_tenths(tenths)
}

fn silence() -> Failure {
    Failure::Silence {
        timeout: Duration::from_secs(1),
        others: 0,
        stray: 0,
    }
}

fn lost_port() -> Failure {
    Failure::Port(TransportError::Lost {
        port: "tty".to_owned(),
        source: io::Error::from(io::ErrorKind::BrokenPipe),
    })
}

/// The summary of tries on a line without echo; the first of them was with `noticed`.
fn summary(tries: impl IntoIterator<Item = Outcome>, noticed: Noticed) -> Summary {
    let mut tally = Tally::default();
    let mut beside = noticed;
    for result in tries {
        tally.add(&result, std::mem::take(&mut beside));
    }
    tally.summary(LineEcho::Absent)
}

fn times(times: &[u64]) -> Option<Times> {
    let tries = times.iter().map(|time| Ok(tenths(*time)));
    summary(tries, Noticed::default()).times
}

/// So many bytes of noise.
fn noise(noise: u64) -> Noticed {
    Noticed {
        noise,
        ..Noticed::default()
    }
}

/// So many answers, and then these failures.
fn tries(answers: usize, failures: Vec<Failure>) -> Summary {
    let answers = (0..answers).map(|_| Ok(tenths(123)));
    let failures = failures.into_iter().map(Err);
    summary(answers.chain(failures), Noticed::default())
}

fn several(count: usize, failure: fn() -> Failure) -> Vec<Failure> {
    (0..count).map(|_| failure()).collect()
}

#[test]
fn an_answer_time_is_whole_tenths_of_a_millisecond_rounded_half_up() {
    for (microseconds, shown) in [
        (0, "0.0"),
        (49, "0.0"),
        (50, "0.1"),
        (12_349, "12.3"),
        (12_350, "12.4"),
        (1_000_000, "1000.0"),
    ] {
        let time = AnswerTime::from(Duration::from_micros(microseconds));
        assert_eq!(time.to_string(), shown, "{microseconds}");
    }
}

#[test]
fn percentiles_are_times_that_were_measured_by_nearest_rank() {
    // Ranks of five: 3 is the first that is at least 2.5, 5 the first that is at least 4.75.
    let five = times(&[50, 20, 15, 40, 35]).expect("five answers");
    assert_eq!(five.min, tenths(15));
    assert_eq!(five.median, tenths(35));
    assert_eq!(five.p95, tenths(50));
    assert_eq!(five.max, tenths(50));
    // Of twenty, the 10th and the 19th.
    let all: Vec<u64> = (1..=20).collect();
    let twenty = times(&all).expect("twenty answers");
    assert_eq!((twenty.median, twenty.p95), (tenths(10), tenths(19)));
    let one = times(&[7]).expect("an answer");
    assert_eq!([one.min, one.median, one.p95, one.max], [tenths(7); 4]);
    assert_eq!(times(&[]), None);
}

#[test]
fn jitter_is_the_mean_step_from_one_answer_time_to_the_next() {
    let jitter = |all: &[u64]| times(all).and_then(|times| times.jitter);
    assert_eq!(jitter(&[100]), None);
    assert_eq!(jitter(&[100, 100, 100]), Some(tenths(0)));
    assert_eq!(jitter(&[100, 130]), Some(tenths(30)));
    // Steps of 30, 20 and 10, whichever way they go.
    assert_eq!(jitter(&[100, 130, 110, 120]), Some(tenths(20)));
    // 5 in 2 steps rounds up, 4 in 3 steps down.
    assert_eq!(jitter(&[10, 15, 15]), Some(tenths(3)));
    assert_eq!(jitter(&[10, 14, 14, 14]), Some(tenths(1)));
}

#[test]
fn a_lost_try_makes_no_step() {
    let results = [Ok(tenths(100)), Err(silence()), Ok(tenths(104))];
    let times = summary(results, Noticed::default()).times;
    assert_eq!(times.and_then(|times| times.jitter), Some(tenths(4)));
}

proptest! {
    #[test]
    fn each_percentile_is_the_least_time_that_so_many_did_not_exceed(
        all in prop::collection::vec(0_u64..60, 1..200),
    ) {
        let found = times(&all).expect("answers");
        for (percent, found) in [(50, found.median), (95, found.p95)] {
            let within = |most: u64| all.iter().filter(|time| **time <= most).count() * 100;
            let found = found.tenths();
            prop_assert!(all.contains(&found));
            prop_assert!(within(found) >= percent * all.len());
            let below = all.iter().copied().filter(|time| *time < found).max();
            prop_assert!(below.is_none_or(|below| within(below) < percent * all.len()));
        }
        prop_assert_eq!(found.min.tenths(), *all.iter().min().expect("answers"));
        prop_assert_eq!(found.max.tenths(), *all.iter().max().expect("answers"));
    }
}

#[test]
fn every_bit_is_sent_as_0_and_as_1_and_no_word_comes_twice_before_all_have_come() {
    let mut words: Vec<u16> = (1..=WORDS)
        .map(|number| word(LoopbackData::Any, number))
        .collect();
    assert_eq!(words[..6], [0x0000, 0xFFFF, 0x5555, 0xAAAA, 0x0001, 0x0002]);
    assert_eq!(words[19..22], [0x8000, 0xFFFE, 0xFFFD]);
    assert_eq!(words[35], 0x7FFF);
    assert_eq!(word(LoopbackData::Any, WORDS + 1), 0x0000);
    words.sort_unstable();
    words.dedup();
    assert_eq!(words.len(), 36);
    for number in 0..=100 {
        assert_eq!(word(LoopbackData::Zero, number), 0);
    }
    let _ = word(LoopbackData::Any, u64::MAX);
}

#[test]
fn a_line_is_good_when_every_word_came_back_and_nothing_else() {
    let good = tries(20, Vec::new());
    assert_eq!(good.verdict(), Verdict::Good);
    assert_eq!(
        good.to_string(),
        "the line is good: 20 of 20 answered, no damage, no noise"
    );
}

#[test]
fn a_line_that_loses_up_to_five_of_a_hundred_is_doubtful_and_more_is_bad() {
    let verdict = |answers, lost| tries(answers, several(lost, silence)).verdict();
    assert_eq!(verdict(19, 1), Verdict::Doubtful);
    assert_eq!(verdict(18, 1), Verdict::Bad);
    assert_eq!(verdict(18, 2), Verdict::Bad);
    assert_eq!(verdict(95, 5), Verdict::Doubtful);
    assert_eq!(verdict(94, 6), Verdict::Bad);
    assert_eq!(verdict(0, 1), Verdict::Bad);
    assert_eq!(verdict(0, 0), Verdict::Untried);
    assert_eq!(
        tries(19, several(1, silence)).to_string(),
        "the line is doubtful: 19 of 20 answered"
    );
    assert_eq!(
        tries(0, several(20, silence)).to_string(),
        "the line is bad: none of 20 answered"
    );
    assert_eq!(tries(0, Vec::new()).to_string(), "nothing was tried");
}

#[test]
fn anything_else_on_the_line_makes_it_doubtful() {
    for (noticed, words) in [
        (noise(2), "2 noise bytes"),
        (
            Noticed {
                late: 3,
                ..noise(0)
            },
            "3 late answers",
        ),
        (
            Noticed {
                others: 1,
                ..noise(0)
            },
            "1 frame of other units",
        ),
        (
            Noticed {
                late: 1,
                others: 2,
                ..noise(1)
            },
            "1 noise byte, 1 late answer, 2 frames of other units",
        ),
    ] {
        let found = summary((0..20).map(|_| Ok(tenths(1))), noticed);
        assert_eq!(found.verdict(), Verdict::Doubtful, "{words}");
        assert_eq!(
            found.to_string(),
            format!("the line is doubtful: 20 of 20 answered, {words}")
        );
    }
}

#[test]
fn what_may_be_an_echo_is_not_called_good() {
    let mut tally = Tally::default();
    tally.add(&Ok(tenths(1)), Noticed::default());
    let found = |echo| tally.summary(echo);
    assert_eq!(found(LineEcho::Present).verdict(), Verdict::Good);
    assert_eq!(found(LineEcho::Unknown).verdict(), Verdict::Doubtful);
    assert_eq!(
        found(LineEcho::Unknown).to_string(),
        "the line is doubtful: 1 of 1 answered, and what came back may be our echo"
    );
}

#[test]
fn only_our_own_echo_is_told_as_such() {
    let echo = || Failure::OnlyEcho;
    let mut found = tries(0, several(3, echo));
    found.echo = LineEcho::Present;
    assert_eq!(found.verdict(), Verdict::OnlyEcho);
    assert_eq!(
        found.to_string(),
        "the line is bad: only our own echo comes back, no meter answers"
    );
    assert_eq!(tries(1, several(3, echo)).verdict(), Verdict::Bad);
}

#[test]
fn a_refusal_takes_a_good_line_and_does_not_count_as_lost() {
    let refused = || Failure::Exception(ExceptionCode::ILLEGAL_DATA_VALUE);
    let found = tries(1, several(19, refused));
    assert_eq!(found.verdict(), Verdict::Refused);
    assert_eq!(found.lost(), 0);
    assert_eq!(
        found.to_string(),
        "the line carries every frame, but the meter refused 19 of 20"
    );
    let noticed = noise(1);
    let found = summary([Err(refused())], noticed);
    assert_eq!(
        found.to_string(),
        "the line is doubtful: none of 1 answered, 1 refusal, 1 noise byte"
    );
}

#[test]
fn each_kind_of_failure_is_counted_where_it_belongs() {
    let found = tries(
        90,
        vec![
            silence(),
            Failure::OnlyEcho,
            Failure::Damaged { received: 8 },
            Failure::Damaged { received: 3 },
            Failure::Truncated {
                received: 3,
                expected: 8,
            },
            Failure::Mismatch {
                found: "an answer".to_owned(),
            },
            Failure::NeverQuiet { discarded: 9 },
            lost_port(),
            Failure::Exception(ExceptionCode::SERVER_DEVICE_BUSY),
            Failure::Exception(ExceptionCode::SERVER_DEVICE_BUSY),
        ],
    );
    assert_eq!((found.tries, found.answered, found.lost()), (100, 90, 8));
    assert_eq!(
        found.to_string(),
        "the line is bad: 90 of 100 answered, 2 refusals, 2 damaged answers, 1 answer broken off, \
         1 wrong answer"
    );
}

#[test]
fn a_summary_is_four_lines_and_three_without_an_answer() {
    let results = [Ok(tenths(123)), Ok(tenths(140)), Err(silence())];
    let noticed = noise(2);
    assert_eq!(
        lines(&summary(results, noticed)),
        [
            "3 tries, 2 answered, 1 lost (33.3 %)",
            "answer times: min 12.3, median 12.3, p95 14.0, max 14.0, jitter 1.7 ms",
            "damaged answers: 0, noise bytes: 2, late answers: 0, frames of others: 0, echo: no",
            "the line is bad: 2 of 3 answered, 2 noise bytes",
        ]
    );
    let refused = Failure::Exception(ExceptionCode::ILLEGAL_FUNCTION);
    assert_eq!(
        lines(&tries(0, vec![refused])),
        [
            "1 try, 0 answered, 1 refused, 0 lost (0.0 %)",
            "damaged answers: 0, noise bytes: 0, late answers: 0, frames of others: 0, echo: no",
            "the line carries every frame, but the meter refused 1 of 1",
        ]
    );
}

#[test]
fn a_percentage_is_0_for_none_and_100_for_all_alone() {
    let first = |answers, lost| lines(&tries(answers, several(lost, silence)))[0].clone();
    assert_eq!(
        first(9_999, 1),
        "10000 tries, 9999 answered, 1 lost (0.1 %)"
    );
    assert_eq!(
        first(1, 9_999),
        "10000 tries, 1 answered, 9999 lost (99.9 %)"
    );
    assert_eq!(first(0, 3), "3 tries, 0 answered, 3 lost (100.0 %)");
    assert_eq!(first(0, 0), "0 tries, 0 answered, 0 lost (0.0 %)");
}
