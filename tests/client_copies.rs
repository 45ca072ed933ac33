//! Answers that come twice, as a repeater or a gateway makes them: the second copy of one is never the
//! answer to something else.

#[path = "support/clock.rs"]
mod clock;
#[path = "support/script.rs"]
mod script;
#[path = "support/ways.rs"]
mod ways;

use std::time::Duration;

use meterpoll::client::{Patience, Ways};
use meterpoll::codec::rtu::decode_request;
use meterpoll::codec::{ExceptionCode, ReadFunction, ReadValues, RegisterRange, Request, Response};

use self::script::{Bench, read, reply, true_response, unit};
use self::ways::{BOTH, FUNCTIONS_ONLY, answer, exception, ms, twice};

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

/// A meter that has no register 1, on a line with a repeater: everything comes again so much later.
fn repeated(think: Duration, later: Duration) -> Bench {
    let bench = Bench::known();
    bench.clock.advance(ms(1500));
    bench.line.meter(move |frame| {
        let answer = match frame[3] {
            1 => exception(frame, ExceptionCode::ILLEGAL_DATA_ADDRESS),
            _ => answer(frame),
        };
        vec![(think, answer.clone()), (think + later, answer)]
    });
    bench
}

#[test]
fn a_second_copy_of_a_refusal_is_not_the_answer_to_the_next_register() {
    for ways in [Ways::default(), FUNCTIONS_ONLY, BOTH] {
        for (think, later) in [(100, 30), (40, 20), (500, 200)] {
            let mut bench = repeated(ms(think), ms(later));
            bench.reads(1, ways).expect_err("it has none");
            for address in 2..8 {
                bench.reads(address, ways).expect("an answer");
            }
        }
    }
}

#[test]
fn a_late_answer_that_comes_twice_is_not_the_answer_to_the_next_register() {
    for ways in [Ways::default(), FUNCTIONS_ONLY, BOTH] {
        let mut bench = Bench::known();
        let mut delay = ms(1300);
        bench.line.meter(move |frame| {
            let chunks = twice(frame, delay, ms(60));
            delay = ms(100);
            chunks
        });
        assert!(bench.reads(1, ways).is_err());
        for address in 2..5 {
            bench.reads(address, ways).expect("an answer");
        }
    }
}

#[test]
fn registers_that_were_the_same_by_chance_hold_nobody_up_for_long() {
    let mut bench = Bench::known();
    bench.clock.advance(ms(1500));
    let mut count = 0;
    bench.line.meter(move |_| {
        count += 1;
        // The same twice, and then another number.
        let values = ReadValues::new(vec![if count < 3 { 7 } else { count }]).unwrap();
        let function = ReadFunction::HoldingRegisters;
        vec![(
            ms(500),
            reply(unit(17), Response::Registers { function, values }),
        )]
    });
    for address in 1..4 {
        let request = read(address, 1);
        let response = bench
            .client
            .request(unit(17), &request, Patience::default());
        assert!(response.is_ok());
    }
    let before = bench.now();
    let response = bench
        .client
        .request(unit(17), &read(4, 1), Patience::default());
    assert!(response.is_ok());
    assert!(bench.now() < before + ms(520));
}

#[test]
fn a_register_read_over_and_over_behind_a_repeater_does_not_shift_the_others() {
    let mut bench = Bench::known();
    let mut tick = 0;
    bench.line.meter(move |frame| {
        tick += 1;
        let Ok((_, Request::Read { function, range })) = decode_request(frame) else {
            panic!("no read");
        };
        let values = ReadValues::new(vec![range.start().get() << 8 | tick]).unwrap();
        let answer = reply(unit(17), Response::Registers { function, values });
        vec![(ms(100), answer.clone()), (ms(160), answer)]
    });
    for address in [1, 1, 2, 3] {
        let patience = Patience {
            ways: BOTH,
            ..Patience::default()
        };
        let response = bench.client.request(unit(17), &read(address, 1), patience);
        let Ok(Response::Registers { values, .. }) = response else {
            panic!("{response:?}");
        };
        assert_eq!(values.into_vec()[0] >> 8, address);
    }
}
