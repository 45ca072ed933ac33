//! Late answers to a request that was sent more than once.

#[path = "support/clock.rs"]
mod clock;
#[path = "support/script.rs"]
mod script;

use std::time::Duration;

use meterpoll::client::{Patience, Ways};
use meterpoll::codec::rtu::encode_reply;
use meterpoll::codec::{ExceptionCode, FunctionCode, Reply};

use self::script::{Bench, read, true_reply, true_response, unit};

const FUNCTIONS: Ways = Ways {
    interchangeable_reads: true,
    loopback: None,
};

const fn ms(milliseconds: u64) -> Duration {
    Duration::from_millis(milliseconds)
}

/// Function 04 is not there.
fn refusal() -> Vec<u8> {
    let reply = Reply::Exception {
        function: FunctionCode::ReadInputRegisters,
        code: ExceptionCode::ILLEGAL_FUNCTION,
    };
    encode_reply(unit(17), &reply).as_bytes().to_vec()
}

#[test]
fn the_first_of_several_late_answers_does_not_pay_for_the_others() {
    let mut bench = Bench::new();
    // To three attempts in a row, 0, 1 and 2 s later: the first is overdue when it comes.
    let mut delays = vec![ms(200), ms(1700), ms(2600), ms(3500)];
    bench.line.meter(move |frame| {
        let delay = delays.pop().unwrap_or(ms(200));
        vec![(delay, true_reply(frame))]
    });
    let silent = bench
        .client
        .request(unit(17), &read(1, 1), Patience::default());
    assert!(silent.is_err());
    let response = bench
        .client
        .request(unit(17), &read(2, 1), Patience::default());
    assert_eq!(response.expect("an answer"), true_response(unit(17), 2, 1));
    assert_eq!(bench.client.counters(unit(17)).late, 3);
}

#[test]
fn the_usual_function_waits_for_what_is_owed_of_the_refused_one() {
    let mut bench = Bench::new();
    let once = Patience {
        retries: 0,
        ways: FUNCTIONS,
        ..Patience::default()
    };
    assert!(bench.client.request(unit(17), &read(1, 1), once).is_err());
    let mut count = 0;
    bench.line.meter(move |frame| {
        count += 1;
        match count {
            1 => vec![(ms(1500), true_reply(frame))],
            2 => vec![(ms(10), refusal())],
            _ => vec![(ms(10), true_reply(frame))],
        }
    });
    let patience = Patience {
        ways: FUNCTIONS,
        ..Patience::default()
    };
    let response = bench.client.request(unit(17), &read(2, 1), patience);
    assert_eq!(response.expect("an answer"), true_response(unit(17), 2, 1));
    let sent = bench.line.sent();
    let functions: Vec<u8> = sent.iter().map(|sent| sent.frame[1]).collect();
    assert_eq!(functions, [3, 4, 4, 3]);
    assert!(sent[3].at >= sent[1].at + ms(1500), "{sent:?}");
}
