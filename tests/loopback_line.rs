//! The loop-back test on a scripted line: what shows whether it echoes, and what a try takes for
//! its answer.

mod support {
    pub(crate) mod clock;
    pub(crate) mod script;
}

use std::time::Duration;

use meterpoll::client::{Failure, Patience};
use meterpoll::codec::rtu::{decode_request, encode_request};
use meterpoll::codec::{ExceptionCode, Reply, Request, Response, rtu};
use meterpoll::profile::{LoopbackData, builtin, load};
use meterpoll::readings::echo;
use meterpoll::readings::loopback::{LineEcho, Noticed, Tally, Try, attempt};
use meterpoll::transport::LineSettings;
use support::script::{Bench, Chunk, reply, unit};

const LONG: Duration = Duration::from_millis(40);

/// Unit 17's registers from 0, one of them.
fn probe() -> Request {
    echo::probe(None)
}

fn probe_frame() -> Vec<u8> {
    encode_request(unit(17), &probe()).as_bytes().to_vec()
}

fn register() -> Vec<u8> {
    support::script::true_reply(&probe_frame())
}

fn refusal(request: &Request, code: ExceptionCode) -> Vec<u8> {
    let function = request.function();
    let reply = Reply::Exception { function, code };
    rtu::encode_reply(unit(17), &reply).as_bytes().to_vec()
}

/// What is found out when the reads are answered with these bytes, one after the other, and how many
/// reads that took.
fn found(answers: &[&[&[u8]]]) -> (LineEcho, usize) {
    let mut bench = Bench::new();
    for answer in answers {
        bench.line.answer(vec![(LONG, answer.concat())]);
    }
    let echo = echo::find_out(&mut bench.client, unit(17), &probe(), Patience::default());
    (echo.expect("the port is there"), bench.frames())
}

#[test]
fn an_answer_alone_shows_that_the_line_does_not_echo() {
    assert_eq!(found(&[&[&register()]]), (LineEcho::Absent, 1));
    let refusal = refusal(&probe(), ExceptionCode::ILLEGAL_DATA_ADDRESS);
    assert_eq!(found(&[&[&refusal]]), (LineEcho::Absent, 1));
}

#[test]
fn silence_shows_that_the_line_does_not_echo() {
    assert_eq!(found(&[]), (LineEcho::Absent, 1));
}

#[test]
fn an_echo_shows_with_an_answer_behind_it_and_without() {
    assert_eq!(
        found(&[&[&probe_frame(), &register()]]),
        (LineEcho::Present, 1)
    );
    assert_eq!(found(&[&[&probe_frame()]]), (LineEcho::Present, 1));
    assert_eq!(found(&[&[&[0x00], &probe_frame()]]), (LineEcho::Present, 1));
}

#[test]
fn what_noise_hides_is_asked_for_three_times() {
    let noisy: &[&[u8]] = &[&[0x00, 0x7F], &register()];
    assert_eq!(found(&[noisy, noisy, noisy]), (LineEcho::Unknown, 3));
    assert_eq!(found(&[noisy, &[&register()]]), (LineEcho::Absent, 2));
    assert_eq!(
        found(&[noisy, noisy, &[&probe_frame()]]),
        (LineEcho::Present, 3)
    );
    // An echo with a bit flipped and nothing behind it.
    let mut damaged = probe_frame();
    damaged[3] ^= 1;
    assert_eq!(
        found(&[&[&damaged], &[&damaged], &[&damaged]]),
        (LineEcho::Unknown, 3)
    );
}

#[test]
fn a_lost_port_is_told() {
    let mut bench = Bench::new();
    bench.line.hang_up(Duration::from_millis(20));
    let lost = echo::find_out(&mut bench.client, unit(17), &probe(), Patience::default());
    assert!(matches!(lost, Err(Failure::Port(_))), "{lost:?}");
}

#[test]
fn the_read_that_shows_an_echo_is_one_that_the_meter_answers() {
    let shown = |request: &Request| encode_request(unit(17), request).to_string();
    assert_eq!(shown(&probe()), "11 03 00 00 00 01 86 9A");
    for (meter, frame) in [
        ("pqm", "11 03 00 00 00 01 86 9A"),
        ("em24", "11 03 00 0B 00 01 F7 58"),
    ] {
        let profile = builtin::find(meter).expect("built in").profile();
        assert_eq!(shown(&echo::probe(Some(&profile))), frame, "{meter}");
    }
    for meter in builtin::all() {
        let request = echo::probe(Some(&meter.profile()));
        let Request::Read { range, .. } = request else {
            panic!("{}: {request:?}", meter.name);
        };
        assert!(range.count() <= 2, "{}", meter.name);
    }
    // One that can only be written tells nothing, and the point's own function counts.
    let profile = "name = \"m\"\ntitle = \"M\"\nmanual = \"none\"\n\
         [[points]]\nname = \"a\"\naddress = 1\ntype = \"u16\"\naccess = \"write\"\n\
         [[points]]\nname = \"b\"\naddress = 2\ntype = \"u32\"\nfunction = 4\n";
    let profile = load::load("m.toml", profile).expect("it loads");
    assert_eq!(
        shown(&echo::probe(Some(&profile))),
        "11 04 00 02 00 02 D2 9B"
    );
}

/// What a meter does with the word of a loop-back.
fn echoing(frame: &[u8]) -> Vec<u8> {
    match decode_request(frame) {
        Ok((_, Request::ReturnQueryData(word))) => reply(unit(17), Response::QueryData(word)),
        other => panic!("no loop-back: {other:?}"),
    }
}

/// A bench with a meter that does this with every frame.
fn bench(meter: impl FnMut(&[u8]) -> Vec<Chunk> + Send + 'static) -> Bench {
    let bench = Bench::new();
    bench.line.meter(meter);
    bench
}

fn attempts(bench: &mut Bench, count: u64, data: LoopbackData) -> (Vec<Try>, Tally) {
    let mut tally = Tally::default();
    let tries = (1..=count)
        .map(|number| {
            let before = bench.client.counters(unit(17));
            let made = attempt(
                &mut bench.client,
                unit(17),
                number,
                data,
                Patience::default(),
            );
            let after = bench.client.counters(unit(17));
            tally.add(&made.result, Noticed::between(&before, &after));
            made
        })
        .collect();
    (tries, tally)
}

#[test]
fn the_time_runs_from_the_silence_behind_the_request_to_the_first_byte_of_the_answer() {
    let settings = LineSettings::default();
    let delay = settings.silence() + Duration::from_micros(12_340) + settings.transfer_time(8);
    let mut bench = bench(move |frame| vec![(delay, echoing(frame))]);
    let (tries, _) = attempts(&mut bench, 3, LoopbackData::Any);
    let shown: Vec<String> = tries
        .iter()
        .map(|made| {
            let time = made.result.as_ref().expect("an answer");
            format!("{} {:04X} {time}", made.number, made.word)
        })
        .collect();
    assert_eq!(shown, ["1 0000 12.3", "2 FFFF 12.3", "3 5555 12.3"]);
    let sent = bench.line.sent();
    assert_eq!(
        rtu::Hex(&sent[1].frame).to_string(),
        "11 08 00 00 FF FF E3 2B"
    );
}

#[test]
fn an_answer_that_comes_after_its_time_is_never_taken_for_the_next() {
    for data in [LoopbackData::Any, LoopbackData::Zero] {
        // Every second answer comes half a second after its time.
        let mut count = 0;
        let mut bench = bench(move |frame| {
            count += 1;
            let delay = if count % 2 == 1 { 1500 } else { 40 };
            vec![(Duration::from_millis(delay), echoing(frame))]
        });
        let (tries, tally) = attempts(&mut bench, 4, data);
        let answered: Vec<bool> = tries.iter().map(|made| made.result.is_ok()).collect();
        assert_eq!(answered, [false, true, false, true], "{data}");
        let sent = bench.sent_at();
        assert!(sent[1] >= sent[0] + Duration::from_millis(1500), "{sent:?}");
        let summary = tally.summary(LineEcho::Absent);
        assert_eq!(summary.noticed.late, 2, "{data}");
        assert_eq!(
            summary.to_string(),
            "the line is bad: 2 of 4 answered, 2 late answers"
        );
    }
}

#[test]
fn each_try_is_made_once_and_tells_what_came() {
    let frames: [fn(Vec<u8>) -> Vec<u8>; 5] = [
        |answer| answer,
        |mut answer| {
            answer[4] ^= 0x10;
            answer
        },
        |mut answer| {
            answer.truncate(5);
            answer
        },
        |_| Vec::new(),
        |answer| [vec![0x00, 0xFF, 0x00], answer].concat(),
    ];
    let mut next = 0;
    let mut bench = bench(move |frame| {
        next += 1;
        vec![(LONG, frames[next - 1](echoing(frame)))]
    });
    let (tries, tally) = attempts(&mut bench, 5, LoopbackData::Any);
    let shown: Vec<String> = tries
        .iter()
        .map(|made| match &made.result {
            Ok(_) => "back".to_owned(),
            Err(failure) => failure.to_string(),
        })
        .collect();
    assert_eq!(
        shown,
        [
            "back",
            "the answer was damaged: 8 bytes without a valid CRC",
            "the answer broke off after 5 of 8 bytes",
            "no answer within 1s",
            "back",
        ]
    );
    assert_eq!(bench.frames(), 5);
    assert_eq!(
        tally.summary(LineEcho::Absent).to_string(),
        "the line is bad: 2 of 5 answered, 1 damaged answer, 1 answer broken off, 3 noise bytes"
    );
}

#[test]
fn a_word_that_comes_back_as_another_is_no_answer() {
    let mut bench = bench(|_| vec![(LONG, reply(unit(17), Response::QueryData(0x1234)))]);
    let (tries, _) = attempts(&mut bench, 1, LoopbackData::Any);
    let failure = tries[0].result.as_ref().expect_err("no answer");
    assert_eq!(
        failure.to_string(),
        "the unit answered something else: 0x1234, and 0x0000 was sent"
    );
}

#[test]
fn on_a_line_that_echoes_a_word_has_come_back_when_it_came_twice() {
    for (has_meter, expected) in [(true, 3), (false, 0)] {
        let mut bench = bench(move |frame| {
            let own = frame.to_vec();
            let answer = match decode_request(frame) {
                _ if !has_meter => Vec::new(),
                Ok((_, Request::ReturnQueryData(_))) => echoing(frame),
                _ => support::script::true_reply(frame),
            };
            vec![(Duration::ZERO, own), (LONG, answer)]
        });
        let echo = echo::find_out(&mut bench.client, unit(17), &probe(), Patience::default());
        assert_eq!(echo.expect("the port is there"), LineEcho::Present);
        let (tries, tally) = attempts(&mut bench, 3, LoopbackData::Any);
        let answered = tries.iter().filter(|made| made.result.is_ok()).count();
        assert_eq!(answered, expected);
        let words = if has_meter {
            "the line is good: 3 of 3 answered, no damage, no noise"
        } else {
            "the line is bad: only our own echo comes back, no meter answers"
        };
        assert_eq!(tally.summary(LineEcho::Present).to_string(), words);
    }
}
