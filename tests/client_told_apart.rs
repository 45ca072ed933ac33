//! How a late answer is told from the right one, beside by waiting: by the other of the functions 03
//! and 04, by a loop-back, and by a second look at what may be a copy.

#[path = "support/clock.rs"]
mod clock;
#[path = "support/script.rs"]
mod script;

use std::time::Duration;

use meterpoll::client::{Failure, Patience, QueryData, Ways};
use meterpoll::codec::rtu::{decode_request, encode_reply};
use meterpoll::codec::{
    ExceptionCode, ReadFunction, ReadValues, RegisterRange, Reply, Request, Response,
};

use self::script::{Bench, Chunk, read, reply, true_reply, true_response, truth, unit};

const fn ms(milliseconds: u64) -> Duration {
    Duration::from_millis(milliseconds)
}

/// Later than anybody waits: the time-out is 1 s.
const TOO_LATE: Duration = ms(2100);

const BOTH: Ways = Ways {
    interchangeable_reads: true,
    loopback: Some(QueryData::Any),
};

const LOOPBACK_ONLY: Ways = Ways {
    interchangeable_reads: false,
    ..BOTH
};

const FUNCTIONS_ONLY: Ways = Ways {
    loopback: None,
    ..BOTH
};

impl Bench {
    /// Reads a register of unit 17 with one attempt. A value must be the true one.
    fn reads(&mut self, address: u16, ways: Ways) -> Result<(), Failure> {
        let patience = Patience {
            retries: 0,
            ways,
            ..Patience::default()
        };
        let response = self.client.request(unit(17), &read(address, 1), patience)?;
        let Response::Registers { values, .. } = response else {
            panic!("{response:?}");
        };
        assert_eq!(values.into_vec(), [truth(17, address)]);
        Ok(())
    }

    /// What a meter that tells the truth does with every request.
    fn answer_after(&self, delay: Duration) {
        self.line.meter(move |frame| vec![(delay, answer(frame))]);
    }

    /// The answer to the next request comes so late; those behind it after 200 ms.
    fn answer_late(&self, delay: Duration) {
        let mut delays = vec![ms(200), delay];
        self.line.meter(move |frame| {
            let delay = if delays.len() == 1 {
                delays[0]
            } else {
                delays.pop().unwrap()
            };
            vec![(delay, answer(frame))]
        });
    }

    fn be_silent(&self) {
        self.line.meter(|_| Vec::new());
    }

    /// `03 0x0001`: function and first word of each frame sent.
    fn asked(&self) -> Vec<String> {
        let sent = self.line.sent();
        let frames = sent.iter().map(|sent| sent.frame.as_slice());
        frames
            .map(|frame| format!("{:02} 0x{:02X}{:02X}", frame[1], frame[2], frame[3]))
            .collect()
    }

    /// A bench whose line is known not to echo.
    fn known() -> Self {
        let mut bench = Self::new();
        bench.answer_after(ms(10));
        bench.reads(0x100, Ways::default()).expect("an answer");
        bench
    }
}

/// The true answer to a read, or to a loop-back.
fn answer(frame: &[u8]) -> Vec<u8> {
    match decode_request(frame) {
        Ok((_, Request::ReturnQueryData(word))) => reply(unit(17), Response::QueryData(word)),
        _ => true_reply(frame),
    }
}

fn exception(frame: &[u8], code: ExceptionCode) -> Vec<u8> {
    let (_, request) = decode_request(frame).expect("a request");
    let function = request.function();
    encode_reply(unit(17), &Reply::Exception { function, code })
        .as_bytes()
        .to_vec()
}

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

/// Two answers to a request: one after `first`, a copy of it so much later.
fn twice(frame: &[u8], first: Duration, later: Duration) -> Vec<Chunk> {
    vec![(first, answer(frame)), (first + later, answer(frame))]
}

#[test]
fn a_second_copy_that_comes_late_is_not_the_answer_to_the_next_register() {
    for first in [1, 10, 40] {
        for later in [5, 30, 50, 90, 150, 400] {
            let mut bench = Bench::new();
            bench
                .line
                .meter(move |frame| twice(frame, ms(first), ms(later)));
            for address in 1..40 {
                let patience = Patience::default();
                let response = bench.client.request(unit(17), &read(address, 1), patience);
                let expected = true_response(unit(17), address, 1);
                assert_eq!(response.expect("an answer"), expected);
            }
            let counters = bench.client.counters(unit(17));
            assert!(counters.copies > 0, "{first} {later} {counters}");
        }
    }
}

#[test]
fn a_second_copy_of_a_late_answer_is_not_the_answer_to_the_next_register() {
    for first in [1100, 1500, 1900] {
        for later in [5, 30, 150, 400] {
            let mut bench = Bench::new();
            let mut is_late = true;
            bench.line.meter(move |frame| {
                if std::mem::take(&mut is_late) {
                    return twice(frame, ms(first), ms(later));
                }
                vec![(ms(500), answer(frame))]
            });
            assert!(bench.reads(1, Ways::default()).is_err());
            for address in 2..5 {
                bench.reads(address, Ways::default()).expect("an answer");
            }
        }
    }
}

#[test]
fn registers_that_really_are_the_same_cost_one_more_request_and_no_waiting() {
    let mut bench = Bench::new();
    bench.line.meter(|_| {
        let values = ReadValues::new(vec![7]).unwrap();
        let function = ReadFunction::HoldingRegisters;
        vec![(
            ms(10),
            reply(unit(17), Response::Registers { function, values }),
        )]
    });
    for address in [1, 2, 1, 2] {
        let request = Request::Read {
            function: ReadFunction::HoldingRegisters,
            range: RegisterRange::new(address, 1).unwrap(),
        };
        let response = bench
            .client
            .request(unit(17), &request, Patience::default());
        assert!(response.is_ok());
    }
    assert_eq!(
        bench.asked(),
        [
            "03 0x0001",
            "03 0x0002",
            "03 0x0002",
            "03 0x0001",
            "03 0x0001",
            "03 0x0002",
            "03 0x0002"
        ]
    );
    assert!(bench.now() < ms(250));
    assert_eq!(bench.client.counters(unit(17)).copies, 0);
}

#[test]
fn the_same_registers_of_another_unit_or_of_long_ago_are_no_copy() {
    let mut bench = Bench::new();
    bench.line.meter(|frame| {
        let values = ReadValues::new(vec![7]).unwrap();
        let function = ReadFunction::HoldingRegisters;
        let number = u16::from(frame[0]);
        vec![(
            ms(10),
            reply(unit(number), Response::Registers { function, values }),
        )]
    });
    for (number, address) in [(17, 1), (18, 2)] {
        let response = bench
            .client
            .request(unit(number), &read(address, 1), Patience::default());
        assert!(response.is_ok());
    }
    bench.clock.advance(ms(1000));
    let response = bench
        .client
        .request(unit(17), &read(2, 1), Patience::default());
    assert!(response.is_ok());
    assert_eq!(bench.frames(), 3);
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
