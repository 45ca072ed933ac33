//! How a late answer is told from the right one, beside by waiting: by the other of the functions 03
//! and 04, and by a loop-back.

#[path = "support/clock.rs"]
mod clock;
#[path = "support/script.rs"]
mod script;
#[path = "support/ways.rs"]
mod ways;

use std::time::Duration;

use meterpoll::client::{Failure, Patience, QueryData, Ways};
use meterpoll::codec::{ExceptionCode, Response};

use self::script::{Bench, read, truth, unit};
use self::ways::{BOTH, FUNCTIONS_ONLY, LOOPBACK_ONLY, TOO_LATE, answer, exception, ms};

#[test]
fn an_answer_later_than_the_wait_has_the_wrong_function() {
    let mut bench = Bench::new();
    bench.answer_late(TOO_LATE);
    assert!(bench.reads(1, FUNCTIONS_ONLY).is_err());
    bench.reads(2, FUNCTIONS_ONLY).expect("an answer");
    assert_eq!(bench.asked(), ["03 0x0001", "04 0x0002"]);
    assert_eq!(bench.client.counters(unit(17)).late, 1);
}

#[test]
fn the_other_function_is_used_for_as_long_as_the_late_answer_is_remembered() {
    let mut bench = Bench::new();
    bench.be_silent();
    assert!(bench.reads(1, FUNCTIONS_ONLY).is_err());
    bench.answer_after(ms(10));
    for address in 2..5 {
        bench.reads(address, FUNCTIONS_ONLY).expect("an answer");
    }
    bench.clock.advance(ms(10_000));
    bench.reads(5, FUNCTIONS_ONLY).expect("an answer");
    assert_eq!(
        bench.asked(),
        [
            "03 0x0001",
            "04 0x0002",
            "04 0x0003",
            "04 0x0004",
            "03 0x0005"
        ]
    );
}

#[test]
fn a_retry_is_the_same_frame_whatever_its_function() {
    let mut bench = Bench::new();
    bench.be_silent();
    let patience = Patience {
        ways: FUNCTIONS_ONLY,
        ..Patience::default()
    };
    for address in [1, 2] {
        let failure = bench.client.request(unit(17), &read(address, 1), patience);
        assert!(failure.is_err());
    }
    assert_eq!(
        bench.asked(),
        [
            "03 0x0001",
            "03 0x0001",
            "03 0x0001",
            "04 0x0002",
            "04 0x0002",
            "04 0x0002"
        ]
    );
}

#[test]
fn what_failed_with_the_other_function_is_asked_with_it_again_at_once() {
    let mut bench = Bench::new();
    bench.be_silent();
    assert!(bench.reads(1, FUNCTIONS_ONLY).is_err());
    assert!(bench.reads(2, FUNCTIONS_ONLY).is_err());
    let failed = bench.now();
    assert!(bench.reads(2, FUNCTIONS_ONLY).is_err());
    assert_eq!(bench.sent_at()[2], failed);
    assert_eq!(bench.asked(), ["03 0x0001", "04 0x0002", "04 0x0002"]);
}

#[test]
fn a_meter_that_refuses_the_other_function_is_asked_with_the_usual_one() {
    let mut bench = Bench::new();
    bench.be_silent();
    assert!(bench.reads(1, FUNCTIONS_ONLY).is_err());
    bench.line.meter(|frame| {
        let answer = match frame[1] {
            4 => exception(frame, ExceptionCode::ILLEGAL_FUNCTION),
            _ => answer(frame),
        };
        vec![(ms(10), answer)]
    });
    bench.reads(2, FUNCTIONS_ONLY).expect("an answer");
    bench.reads(3, FUNCTIONS_ONLY).expect("an answer");
    assert_eq!(
        bench.asked(),
        ["03 0x0001", "04 0x0002", "03 0x0002", "03 0x0003"]
    );
}

#[test]
fn a_refusal_of_both_functions_is_the_usual_ones() {
    let mut bench = Bench::new();
    bench.be_silent();
    assert!(bench.reads(1, FUNCTIONS_ONLY).is_err());
    bench.line.meter(|frame| {
        let code = ExceptionCode(frame[1]);
        vec![(ms(10), exception(frame, code))]
    });
    match bench.reads(2, FUNCTIONS_ONLY) {
        Err(Failure::Exception(code)) => assert_eq!(code, ExceptionCode(3)),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_loop_back_goes_first_when_both_functions_are_owed_answers() {
    let mut bench = Bench::known();
    bench.be_silent();
    assert!(bench.reads(1, BOTH).is_err());
    assert!(bench.reads(2, BOTH).is_err());
    bench.answer_after(ms(10));
    bench.reads(3, BOTH).expect("an answer");
    bench.reads(4, BOTH).expect("an answer");
    assert_eq!(
        bench.asked()[1..],
        [
            "03 0x0001",
            "04 0x0002",
            "08 0x0000",
            "03 0x0003",
            "03 0x0004"
        ]
    );
}

#[test]
fn a_loop_back_goes_first_after_one_failure_where_functions_do_not_alternate() {
    let mut bench = Bench::known();
    bench.answer_late(TOO_LATE);
    assert!(bench.reads(1, LOOPBACK_ONLY).is_err());
    bench.reads(2, LOOPBACK_ONLY).expect("an answer");
    assert_eq!(bench.asked()[1..], ["03 0x0001", "08 0x0000", "03 0x0002"]);
}

#[test]
fn a_loop_back_holds_the_word_that_the_meter_takes() {
    for (data, word) in [
        (QueryData::Zero, [0x00, 0x00]),
        (QueryData::Any, [0xA5, 0xC3]),
    ] {
        let ways = Ways {
            loopback: Some(data),
            ..LOOPBACK_ONLY
        };
        let mut bench = Bench::known();
        bench.answer_late(TOO_LATE);
        assert!(bench.reads(1, ways).is_err());
        bench.reads(2, ways).expect("an answer");
        assert_eq!(bench.line.sent()[2].frame[4..6], word);
    }
}

#[test]
fn a_refused_loop_back_serves_as_well() {
    let mut bench = Bench::known();
    bench.be_silent();
    assert!(bench.reads(1, LOOPBACK_ONLY).is_err());
    bench.line.meter(|frame| {
        let answer = match frame[1] {
            8 => exception(frame, ExceptionCode::ILLEGAL_FUNCTION),
            _ => answer(frame),
        };
        vec![(ms(10), answer)]
    });
    bench.reads(2, LOOPBACK_ONLY).expect("an answer");
    assert_eq!(bench.asked()[1..], ["03 0x0001", "08 0x0000", "03 0x0002"]);
}

#[test]
fn a_request_behind_a_loop_back_that_meets_silence_is_not_sent() {
    let mut bench = Bench::known();
    bench.be_silent();
    assert!(bench.reads(1, LOOPBACK_ONLY).is_err());
    match bench.reads(2, LOOPBACK_ONLY) {
        Err(failure) => assert_eq!(failure.to_string(), "no answer within 1s"),
        Ok(()) => panic!("nothing was asked"),
    }
    assert_eq!(bench.asked()[1..], ["03 0x0001", "08 0x0000"]);
    // Nor the next one.
    bench
        .reads(3, LOOPBACK_ONLY)
        .expect_err("nothing was asked");
    assert_eq!(bench.asked()[1..], ["03 0x0001", "08 0x0000", "08 0x0000"]);
    bench.answer_after(ms(10));
    bench.reads(2, LOOPBACK_ONLY).expect("an answer");
    assert_eq!(bench.asked()[4..], ["08 0x0000", "03 0x0002"]);
}

#[test]
fn a_meter_that_has_no_loop_back_after_all_is_read_again_10_s_later() {
    let mut bench = Bench::known();
    bench.be_silent();
    assert!(bench.reads(1, LOOPBACK_ONLY).is_err());
    bench.line.meter(|frame| match frame[1] {
        8 => Vec::new(),
        _ => vec![(ms(10), answer(frame))],
    });
    let mut tries = 0;
    while bench.reads(2, LOOPBACK_ONLY).is_err() {
        tries += 1;
    }
    assert_eq!(tries, 5);
    bench.reads(3, LOOPBACK_ONLY).expect("an answer");
}

#[test]
fn an_answer_that_is_long_overdue_is_not_reckoned_with() {
    let mut bench = Bench::known();
    bench.be_silent();
    assert!(bench.reads(1, BOTH).is_err());
    bench.clock.advance(ms(11_100));
    bench.answer_after(ms(10));
    bench.reads(2, BOTH).expect("an answer");
    assert!(bench.reads(3, BOTH).is_ok());
    assert_eq!(bench.asked()[1..], ["03 0x0001", "03 0x0002", "03 0x0003"]);
}

#[test]
fn a_damaged_answer_to_a_loop_back_is_asked_for_again() {
    let mut bench = Bench::known();
    bench.be_silent();
    assert!(bench.reads(1, LOOPBACK_ONLY).is_err());
    let mut damage = 1;
    bench.line.meter(move |frame| {
        let mut bytes = answer(frame);
        bytes[6] ^= damage;
        damage = 0;
        vec![(ms(10), bytes)]
    });
    let patience = Patience {
        retries: 1,
        ways: LOOPBACK_ONLY,
        ..Patience::default()
    };
    let response = bench.client.request(unit(17), &read(2, 1), patience);
    assert!(response.is_ok());
    assert_eq!(
        bench.asked()[1..],
        ["03 0x0001", "08 0x0000", "08 0x0000", "03 0x0002"]
    );
}

#[test]
fn a_late_answer_behind_an_echo_does_not_hide_that_the_line_echoes() {
    let mut bench = Bench::new();
    let mut late = None;
    bench.line.meter(move |frame| {
        let echo = (Duration::ZERO, frame.to_vec());
        match late.take() {
            None => {
                late = Some(answer(frame));
                Vec::new()
            }
            Some(first) => vec![echo, (ms(100), first), (ms(200), answer(frame))],
        }
    });
    assert!(bench.reads(1, FUNCTIONS_ONLY).is_err());
    assert_eq!(bench.client.echoes(), Some(false));
    bench.reads(2, FUNCTIONS_ONLY).expect("an answer");
    assert_eq!(bench.client.echoes(), Some(true));
}

#[test]
fn silence_without_a_byte_shows_that_the_line_does_not_echo() {
    let mut bench = Bench::new();
    bench.be_silent();
    assert!(bench.reads(1, LOOPBACK_ONLY).is_err());
    bench.answer_after(ms(10));
    bench.reads(2, LOOPBACK_ONLY).expect("an answer");
    assert_eq!(bench.asked(), ["03 0x0001", "08 0x0000", "03 0x0002"]);
}

#[test]
fn no_loop_back_is_sent_while_its_answer_may_be_its_echo() {
    let mut bench = Bench::new();
    // Damage that could be a damaged echo.
    bench
        .line
        .meter(|_| vec![(ms(10), vec![0x11, 0x03, 0x02, 0, 0, 0, 0, 0, 0])]);
    assert!(bench.reads(1, LOOPBACK_ONLY).is_err());
    bench.answer_after(ms(10));
    bench.reads(2, LOOPBACK_ONLY).expect("an answer");
    assert_eq!(bench.asked(), ["03 0x0001", "03 0x0002"]);
}

#[test]
fn a_loop_back_that_can_be_taken_for_one_before_is_sent_again() {
    let ways = Ways {
        loopback: Some(QueryData::Zero),
        ..LOOPBACK_ONLY
    };
    let mut bench = Bench::known();
    bench.be_silent();
    assert!(bench.reads(1, ways).is_err());
    assert!(bench.reads(2, ways).is_err());
    assert!(bench.reads(1, ways).is_err());
    // Nothing of all that comes any more, but nobody knows.
    bench.answer_after(ms(10));
    bench.reads(2, ways).expect("an answer");
    assert_eq!(
        bench.asked()[1..],
        [
            "03 0x0001",
            "08 0x0000",
            "03 0x0001",
            "08 0x0000",
            "08 0x0000",
            "03 0x0002"
        ]
    );
}

#[test]
fn what_has_happened_is_counted_and_told() {
    let mut bench = Bench::new();
    let mut count = 0;
    bench.line.meter(move |frame| {
        count += 1;
        match count {
            1 => Vec::new(),
            2 => vec![(ms(10), [&[0x00, 0xFF], &answer(frame)[..]].concat())],
            3 => vec![(ms(10), answer(frame)[..4].to_vec())],
            4 => vec![(ms(10), exception(frame, ExceptionCode::SERVER_DEVICE_BUSY))],
            _ => vec![(ms(10), answer(frame))],
        }
    });
    for address in [1, 2] {
        let patience = Patience {
            ways: FUNCTIONS_ONLY,
            ..Patience::default()
        };
        let response = bench.client.request(unit(17), &read(address, 1), patience);
        assert!(response.is_ok());
    }
    assert_eq!(
        bench.client.counters(unit(17)).to_string(),
        "5 requests, 3 answers, 2 retries, 1 silence, 1 truncated answer, 1 time busy, 2 stray bytes"
    );
    assert_eq!(
        bench.client.counters(unit(18)).to_string(),
        "0 requests, 0 answers"
    );
}

#[test]
fn what_a_gateway_says_is_no_barrier() {
    let gateway = ExceptionCode::GATEWAY_TARGET_DEVICE_FAILED_TO_RESPOND;
    let mut bench = Bench::known();
    let mut count = 0;
    bench.line.meter(move |frame| {
        count += 1;
        match count {
            1 => vec![(TOO_LATE, answer(frame))],
            2 => vec![(ms(10), exception(frame, gateway))],
            _ => vec![(ms(300), answer(frame))],
        }
    });
    assert!(bench.reads(1, LOOPBACK_ONLY).is_err());
    match bench.reads(2, LOOPBACK_ONLY) {
        Err(Failure::Exception(code)) => assert_eq!(code, gateway),
        other => panic!("{other:?}"),
    }
    bench.reads(2, LOOPBACK_ONLY).expect("an answer");
}

#[test]
fn a_late_word_of_a_gateway_does_not_end_the_wait() {
    let gateway = ExceptionCode::GATEWAY_TARGET_DEVICE_FAILED_TO_RESPOND;
    let mut bench = Bench::known();
    let mut is_first = true;
    bench.line.meter(move |frame| {
        if std::mem::take(&mut is_first) {
            let refusal = exception(frame, gateway);
            vec![(ms(1100), refusal), (ms(1500), answer(frame))]
        } else {
            vec![(ms(900), answer(frame))]
        }
    });
    assert!(bench.reads(1, Ways::default()).is_err());
    bench.reads(2, Ways::default()).expect("an answer");
}

#[test]
fn late_answers_to_loop_backs_prove_no_more_than_they_can() {
    let ways = Ways {
        loopback: Some(QueryData::Zero),
        ..LOOPBACK_ONLY
    };
    let mut bench = Bench::known();
    // All of them come, in order, and far too late.
    bench.answer_after(ms(4500));
    for address in [1, 2, 1, 2, 2, 2] {
        let _ = bench.reads(address, ways);
    }
}

#[test]
fn an_adapter_that_came_back_is_not_known_to_be_without_echo() {
    let mut bench = Bench::known();
    let mut is_first = true;
    bench.line.meter(move |frame| {
        if std::mem::take(&mut is_first) {
            return vec![(ms(3500), answer(frame))];
        }
        // Another adapter by now: it echoes, and the meter has no loop-back.
        let mut chunks = vec![(Duration::ZERO, frame.to_vec())];
        if frame[1] != 8 {
            chunks.push((ms(600), answer(frame)));
        }
        chunks
    });
    assert!(bench.reads(1, LOOPBACK_ONLY).is_err());
    let now = bench.now();
    bench.line.come_back(now);
    bench.line.hang_up(now);
    assert!(bench.reads(9, LOOPBACK_ONLY).is_err());
    for address in [2, 3] {
        let _ = bench.reads(address, LOOPBACK_ONLY);
    }
}

#[test]
fn what_a_busy_unit_answers_all_the_same_is_not_the_answer_to_the_next_register() {
    for ways in [Ways::default(), FUNCTIONS_ONLY, BOTH] {
        let mut bench = Bench::known();
        let mut count = 0;
        bench.line.meter(move |frame| {
            count += 1;
            let busy = exception(frame, ExceptionCode::SERVER_DEVICE_BUSY);
            match count {
                1 => vec![(ms(10), answer(frame)[..4].to_vec())],
                2 => vec![(ms(10), busy), (ms(800), answer(frame))],
                _ => vec![(ms(40), answer(frame))],
            }
        });
        let patience = Patience {
            ways,
            ..Patience::default()
        };
        for address in 1..20 {
            let response = bench.client.request(unit(17), &read(address, 1), patience);
            let Ok(Response::Registers { values, .. }) = response else {
                panic!("{response:?}");
            };
            assert_eq!(values.into_vec(), [truth(17, address)]);
        }
    }
}

#[test]
fn a_busy_unit_holds_nobody_up_once_it_has_answered_where_its_ways_are_known() {
    let mut bench = Bench::known();
    let mut count = 0;
    bench.line.meter(move |frame| {
        count += 1;
        match count {
            1 | 2 => vec![(ms(10), exception(frame, ExceptionCode::SERVER_DEVICE_BUSY))],
            _ => vec![(ms(10), answer(frame))],
        }
    });
    bench.reads(1, FUNCTIONS_ONLY).expect("an answer");
    let answered = bench.now();
    bench.reads(2, FUNCTIONS_ONLY).expect("an answer");
    assert!(bench.now() < answered + ms(30));
}
