//! Writes and broadcasts on the clock of the test: one attempt, whatever becomes of it.

mod support {
    pub(crate) mod clock;
    pub(crate) mod script;
    pub(crate) mod written;
}

use std::time::Duration;

use meterpoll::client::{Echo, Failure, Patience, QueryData, Unwritten, Ways};
use meterpoll::codec::rtu::encode_broadcast;
use meterpoll::codec::{Broadcast, ExceptionCode, Write};
use meterpoll::transport::LineSettings;

use support::script::{Bench, read, reply, true_reply, true_response, unit};
use support::written::{answer, block, coil, ms, outcome, refusal, sealed, set};

/// At 9600 8N1: t3.5.
const SILENCE: Duration = Duration::from_nanos(3_645_833);

/// A bench whose line is known not to echo.
fn known() -> Bench {
    let mut bench = Bench::new();
    bench.line.answer(vec![(
        ms(10),
        reply(unit(17), true_response(unit(17), 1, 1)),
    )]);
    let clean = bench
        .client
        .request(unit(17), &read(1, 1), Patience::default());
    assert!(clean.is_ok() && bench.client.echoes() == Some(false));
    bench
}

/// What comes of a write whose first request is answered like this, and how often it was sent.
fn told(write: &Write, answered: Vec<(Duration, Vec<u8>)>) -> (String, usize) {
    let mut bench = known();
    bench.line.answer(answered);
    let result = bench.client.write(unit(17), write, Patience::default());
    (outcome(&result), bench.frames() - 1)
}

#[test]
fn a_write_that_is_confirmed_was_sent_once() {
    for write in [set(0x1028, 500), coil(14), block(0x1028, &[500, 10_000])] {
        let answered = vec![(ms(10), answer(&write))];
        assert_eq!(told(&write, answered), ("done".to_owned(), 1));
    }
}

#[test]
fn a_write_that_nobody_answers_is_sent_once_and_its_outcome_is_unknown() {
    for write in [set(0x1028, 500), coil(14), block(0x1028, &[500, 10_000])] {
        let found = "outcome unknown: no answer within 1s".to_owned();
        assert_eq!(told(&write, Vec::new()), (found, 1));
    }
}

#[test]
fn whatever_else_comes_in_place_of_the_answer_leaves_the_outcome_unknown() {
    let write = set(0x1028, 500);
    let good = answer(&write);
    let mut damaged = good.clone();
    damaged[4] ^= 1;
    for (came, found) in [
        (
            damaged,
            "the answer was damaged: 8 bytes without a valid CRC",
        ),
        (
            good[..5].to_vec(),
            "the answer broke off after 5 of 8 bytes",
        ),
        (
            answer(&set(0x1029, 500)),
            "the unit answered something else: 0x1029 written, and 0x1028 was sent",
        ),
        (
            answer(&block(0x1028, &[500])),
            "the unit answered something else: an answer to function 16 (Write Multiple Registers)",
        ),
        (
            sealed(&[18, 6, 0x10, 0x28, 0x01, 0xF4]),
            "no answer within 1s, only 1 frame of other units",
        ),
    ] {
        let found = format!("outcome unknown: {found}");
        assert_eq!(told(&write, vec![(ms(10), came)]), (found, 1));
    }
}

#[test]
fn an_answer_for_other_registers_than_were_written_confirms_nothing() {
    let written = block(0x1028, &[500, 10_000]);
    for other in [
        block(0x1029, &[500, 10_000]),
        block(0x1028, &[500]),
        block(0x1028, &[1, 2, 3]),
    ] {
        let (found, frames) = told(&written, vec![(ms(10), answer(&other))]);
        assert!(found.starts_with("outcome unknown: "), "{found}");
        assert_eq!(frames, 1);
    }
}

#[test]
fn an_operation_that_is_answered_with_another_state_is_not_done() {
    let mut body = answer(&coil(14));
    body.truncate(6);
    body[4] = 0;
    let (found, frames) = told(&coil(14), vec![(ms(10), sealed(&body))]);
    assert!(found.starts_with("outcome unknown: "), "{found}");
    assert_eq!(frames, 1);
}

#[test]
fn another_value_in_the_answer_is_what_the_meter_stored() {
    let answered = vec![(ms(10), answer(&set(0x1028, 400)))];
    let found = ("stored 400".to_owned(), 1);
    assert_eq!(told(&set(0x1028, 500), answered), found);
}

#[test]
fn a_refusal_is_told_with_its_code_and_the_write_not_sent_again() {
    for code in [0x00, 0x01, 0x02, 0x03, 0x04, 0x08, 0x0A, 0x63, 0xFF] {
        let write = set(0x1028, 500);
        let answered = vec![(ms(10), refusal(&write, code))];
        let found = format!("the meter refused: {}", ExceptionCode(code));
        assert_eq!(told(&write, answered), (found, 1));
    }
}

#[test]
fn a_unit_that_is_still_at_work_has_accepted() {
    let write = set(0x1028, 500);
    let answered = vec![(ms(10), refusal(&write, 5))];
    assert_eq!(told(&write, answered), ("accepted".to_owned(), 1));
}

#[test]
fn a_gateway_whose_unit_is_silent_does_not_know_either() {
    let write = set(0x1028, 500);
    let (found, frames) = told(&write, vec![(ms(10), refusal(&write, 0x0B))]);
    assert!(found.starts_with("outcome unknown: "), "{found}");
    assert_eq!(frames, 1);
}

#[test]
fn a_busy_unit_is_written_to_again_and_heard_out_from_the_second_time_on() {
    let mut bench = known();
    let write = set(0x1028, 500);
    for _ in 0..3 {
        bench.line.answer(vec![(ms(10), refusal(&write, 6))]);
    }
    bench.line.answer(vec![(ms(10), answer(&write))]);
    let result = bench.client.write(unit(17), &write, Patience::default());
    assert_eq!(outcome(&result), "done");
    let sent = bench.line.sent();
    let silences = sent[2..].iter().map(|sent| sent.silence.as_millis());
    // A second copy of the first word of it may hide that the write is carried out.
    assert_eq!(silences.collect::<Vec<_>>(), [100, 1000, 1000]);
    assert!(sent[1..].iter().all(|again| again.frame == sent[1].frame));
    let counters = bench.client.counters(unit(17));
    assert_eq!((counters.busy, counters.retries), (3, 3));
}

#[test]
fn a_copy_of_busy_behind_the_second_request_does_not_have_it_sent_again() {
    let mut bench = known();
    let write = set(0x1028, 500);
    let busy = refusal(&write, 6);
    // A repeater brings the first answer once more 150 ms later, when the write is out again.
    bench
        .line
        .answer(vec![(ms(10), busy.clone()), (ms(160), busy)]);
    bench.line.answer(vec![(ms(300), answer(&write))]);
    let result = bench.client.write(unit(17), &write, Patience::default());
    assert_eq!(outcome(&result), "done");
    assert_eq!(bench.frames(), 1 + 2);
}

#[test]
fn a_unit_that_stays_busy_has_refused() {
    let mut bench = known();
    let write = set(0x1028, 500);
    let busy = refusal(&write, 6);
    bench.line.meter(move |_| vec![(ms(10), busy.clone())]);
    let result = bench.client.write(unit(17), &write, Patience::default());
    assert!(
        matches!(
            result,
            Err(Unwritten::Refused(ExceptionCode::SERVER_DEVICE_BUSY))
        ),
        "{result:?}"
    );
    assert_eq!(bench.frames(), 1 + 4);
}

#[test]
fn what_was_written_again_after_busy_and_is_lost_then_is_not_sent_a_third_time() {
    let mut bench = known();
    let write = set(0x1028, 500);
    bench.line.answer(vec![(ms(10), refusal(&write, 6))]);
    let result = bench.client.write(unit(17), &write, Patience::default());
    assert_eq!(outcome(&result), "outcome unknown: no answer within 1s");
    assert_eq!(bench.frames(), 1 + 2);
}

#[test]
fn no_write_goes_out_while_a_read_may_still_be_answered() {
    let mut bench = known();
    let once = Patience {
        retries: 0,
        ..Patience::default()
    };
    // The read's answer is 700 ms late.
    bench.line.meter(|frame| match frame[1] {
        3 => vec![(ms(1700), true_reply(frame))],
        _ => vec![(ms(10), frame.to_vec())],
    });
    let failed = bench.client.request(unit(17), &read(2, 1), once);
    assert!(failed.is_err());
    let result = bench.client.write(unit(17), &set(0x1028, 500), once);
    assert_eq!(outcome(&result), "done");
    let sent = bench.line.sent();
    assert!(sent[2].at >= sent[1].at + ms(1700), "{sent:?}");
    assert_eq!(bench.client.counters(unit(17)).late, 1);
}

#[test]
fn a_late_answer_to_one_write_does_not_confirm_the_next() {
    let mut bench = known();
    let first = set(0x1028, 500);
    bench.line.answer(vec![(ms(1700), answer(&first))]);
    let result = bench.client.write(unit(17), &first, Patience::default());
    assert_eq!(outcome(&result), "outcome unknown: no answer within 1s");
    // The same again, and nobody hears it.
    let result = bench.client.write(unit(17), &first, Patience::default());
    assert_eq!(outcome(&result), "outcome unknown: no answer within 1s");
    assert_eq!(bench.client.counters(unit(17)).late, 1);
    assert_eq!(bench.frames(), 1 + 2);
}

#[test]
fn a_later_answer_still_is_told_by_a_loop_back() {
    let mut bench = known();
    let patience = Patience {
        ways: Ways {
            interchangeable_reads: false,
            loopback: Some(QueryData::Any),
        },
        ..Patience::default()
    };
    // Nobody waits for what is 2.5 s late; it comes ahead of the answer to the loop-back.
    let first = answer(&set(0x1028, 500));
    bench.line.meter(move |frame| match (frame[1], frame[5]) {
        (6, 0xF4) => vec![(ms(3500), first.clone())],
        _ => vec![(ms(900), frame.to_vec())],
    });
    let result = bench.client.write(unit(17), &set(0x1028, 500), patience);
    assert_eq!(outcome(&result), "outcome unknown: no answer within 1s");
    bench.clock.advance(ms(1800));
    let result = bench.client.write(unit(17), &set(0x1028, 400), patience);
    assert_eq!(outcome(&result), "done");
    let functions: Vec<u8> = bench.line.sent().iter().map(|sent| sent.frame[1]).collect();
    assert_eq!(functions, [3, 6, 8, 6]);
}

#[test]
fn a_port_that_is_lost_before_a_write_has_sent_nothing() {
    let mut bench = known();
    bench.line.hang_up(bench.now());
    let result = bench
        .client
        .write(unit(17), &set(0x1028, 500), Patience::default());
    assert!(
        matches!(result, Err(Unwritten::NotSent(Failure::Port(_)))),
        "{result:?}"
    );
    assert_eq!(bench.frames(), 1);
}

#[test]
fn a_port_that_is_lost_during_a_write_may_have_carried_it() {
    // While it is sent, and while its answer is waited for.
    for is_sent in [false, true] {
        let mut bench = known();
        if is_sent {
            bench.line.hang_up(bench.now() + ms(100));
        } else {
            bench.line.hang_up_at_frame(2);
        }
        bench.line.come_back(bench.now() + ms(200));
        let result = bench
            .client
            .write(unit(17), &set(0x1028, 500), Patience::default());
        assert!(
            matches!(result, Err(Unwritten::Unknown(Failure::Port(_)))),
            "{result:?}"
        );
        assert_eq!(bench.frames(), 1 + usize::from(is_sent));
    }
}

#[test]
fn nothing_is_written_into_a_line_that_is_never_silent() {
    let mut bench = known();
    bench
        .line
        .inject_endlessly(bench.now(), ms(2), || vec![0x55]);
    let result = bench
        .client
        .write(unit(17), &set(0x1028, 500), Patience::default());
    assert!(
        matches!(result, Err(Unwritten::NotSent(Failure::NeverQuiet { .. }))),
        "{result:?}"
    );
    assert_eq!(bench.frames(), 1);
}

/// What the line does with a write that is answered by its own copy.
#[derive(Debug, Clone, Copy)]
enum Heard {
    EchoAlone,
    AnswerAlone,
    Both,
}

#[test]
fn an_echo_of_a_write_is_no_answer() {
    use Heard::{AnswerAlone, Both, EchoAlone};
    const LOST: &str = "outcome unknown: nothing but the echo of the own request came back";
    for write in [set(0x1028, 500), coil(14)] {
        for (echo, heard, found) in [
            // Nothing is known of the line: one copy can be the one or the other.
            (Echo::Auto, EchoAlone, LOST),
            (Echo::Auto, AnswerAlone, LOST),
            (Echo::Auto, Both, "done"),
            (Echo::On, EchoAlone, LOST),
            (Echo::On, AnswerAlone, LOST),
            (Echo::On, Both, "done"),
            // Somebody has said that there is none.
            (Echo::Off, AnswerAlone, "done"),
        ] {
            let mut bench = Bench::with(LineSettings::default(), echo);
            let copy = answer(&write);
            bench.line.answer(match heard {
                EchoAlone => vec![(ms(0), copy)],
                AnswerAlone => vec![(ms(10), copy)],
                Both => vec![(ms(0), copy.clone()), (ms(10), copy)],
            });
            let result = bench.client.write(unit(17), &write, Patience::default());
            assert_eq!(outcome(&result), found, "{echo:?} {heard:?}");
            assert_eq!(bench.frames(), 1);
        }
    }
}

#[test]
fn on_a_line_that_was_seen_to_echo_one_copy_of_a_write_is_no_answer() {
    for (copies, found) in [
        (
            1,
            "outcome unknown: nothing but the echo of the own request came back",
        ),
        (2, "done"),
    ] {
        let mut bench = Bench::new();
        bench
            .line
            .meter(|frame| vec![(ms(0), frame.to_vec()), (ms(10), true_reply(frame))]);
        let read = bench
            .client
            .request(unit(17), &read(1, 1), Patience::default());
        assert!(read.is_ok() && bench.client.echoes() == Some(true));
        let write = set(0x1028, 500);
        let chunks = (0..copies).map(|copy| (ms(copy * 10), answer(&write)));
        bench.line.answer(chunks.collect());
        let result = bench.client.write(unit(17), &write, Patience::default());
        assert_eq!(outcome(&result), found);
        assert_eq!(bench.frames(), 2);
    }
}

#[test]
fn the_echo_of_function_16_is_never_its_answer() {
    let write = block(0x1028, &[500, 10_000]);
    for (is_answered, found) in [
        (
            false,
            "outcome unknown: nothing but the echo of the own request came back",
        ),
        (true, "done"),
    ] {
        let mut bench = Bench::new();
        let answered = answer(&write);
        bench.line.meter(move |frame| {
            let mut chunks = vec![(ms(0), frame.to_vec())];
            if is_answered {
                chunks.push((ms(10), answered.clone()));
            }
            chunks
        });
        let result = bench.client.write(unit(17), &write, Patience::default());
        assert_eq!(outcome(&result), found);
    }
}

#[test]
fn a_broadcast_waits_for_its_turnaround_and_for_nobody() {
    for turnaround in [ms(0), ms(100), ms(200), ms(1500)] {
        let mut bench = known();
        let write = set(0x1028, 500);
        let result = bench
            .client
            .broadcast(&|_| write.clone(), turnaround, Patience::default());
        assert!(result.is_ok());
        let sent = bench.line.sent();
        assert_eq!(sent[1].frame[..6], [0, 6, 0x10, 0x28, 0x01, 0xF4]);
        // 8 bytes at 9600 8N1.
        let end = sent[1].at + Duration::from_nanos(8_333_333);
        assert!(bench.now() >= end + turnaround);
        assert!(bench.now() <= end + turnaround + ms(1));
        // The turnaround is kept before whatever comes next.
        bench.line.meter(|frame| vec![(ms(10), true_reply(frame))]);
        let next = bench
            .client
            .request(unit(17), &read(1, 1), Patience::default());
        assert!(next.is_ok());
        let sent = bench.line.sent();
        assert!(sent[2].silence >= turnaround.max(SILENCE), "{sent:?}");
        assert_eq!(sent.len(), 3);
    }
}

#[test]
fn a_broadcast_is_sent_once_whatever_comes_back() {
    let write = set(0x1028, 500);
    let own = encode_broadcast(Broadcast, &write);
    for came in [
        own.as_bytes().to_vec(),
        refusal(&write, 6),
        answer(&write),
        vec![0x55; 100],
    ] {
        let mut bench = Bench::new();
        bench.line.answer(vec![(ms(1), came)]);
        let result = bench
            .client
            .broadcast(&|_| write.clone(), ms(200), Patience::default());
        assert!(result.is_ok());
        assert_eq!(bench.frames(), 1);
    }
}

#[test]
fn a_broadcast_waits_for_answers_that_are_owed() {
    let mut bench = known();
    let once = Patience {
        retries: 0,
        ..Patience::default()
    };
    assert!(bench.client.request(unit(17), &read(1, 1), once).is_err());
    let result = bench.client.broadcast(&|_| set(0x1028, 500), ms(200), once);
    assert!(result.is_ok());
    let sent = bench.line.sent();
    assert!(sent[2].at >= sent[1].at + ms(2000), "{sent:?}");
}

#[test]
fn a_broadcast_during_which_the_port_is_lost_may_have_been_heard() {
    for is_sent in [false, true] {
        let mut bench = known();
        if is_sent {
            bench.line.hang_up(bench.now() + ms(100));
        } else {
            bench.line.hang_up_at_frame(2);
        }
        bench.line.come_back(bench.now() + ms(150));
        let result = bench
            .client
            .broadcast(&|_| set(0x1028, 500), ms(200), Patience::default());
        assert!(
            matches!(result, Err(Unwritten::Unknown(Failure::Port(_)))),
            "{result:?}"
        );
        assert_eq!(bench.frames(), 1 + usize::from(is_sent));
    }
}

#[test]
fn nothing_is_broadcast_into_a_line_that_is_never_silent() {
    let mut bench = known();
    bench
        .line
        .inject_endlessly(bench.now(), ms(2), || vec![0x55]);
    let result = bench
        .client
        .broadcast(&|_| set(0x1028, 500), ms(200), Patience::default());
    assert!(
        matches!(result, Err(Unwritten::NotSent(Failure::NeverQuiet { .. }))),
        "{result:?}"
    );
    assert_eq!(bench.frames(), 1);
}
