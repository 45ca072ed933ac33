//! What the client does with each exception code.

#[path = "support/clock.rs"]
mod clock;
#[path = "support/script.rs"]
mod script;

use std::time::Duration;

use meterpoll::client::{Failure, Patience};
use meterpoll::codec::rtu::encode_reply;
use meterpoll::codec::{ExceptionCode, FunctionCode, Reply, Response};

use self::script::{Bench, read, true_reply, true_response, unit};

const fn ms(milliseconds: u64) -> Duration {
    Duration::from_millis(milliseconds)
}

/// An exception to a read of holding registers.
fn refusal(code: u8) -> Vec<u8> {
    let reply = Reply::Exception {
        function: FunctionCode::ReadHoldingRegisters,
        code: ExceptionCode(code),
    };
    encode_reply(unit(17), &reply).as_bytes().to_vec()
}

/// A meter that refuses so many times with this code, 5 ms after each request, and then answers
/// truly.
fn refusing(times: usize, code: u8) -> Bench {
    let bench = Bench::new();
    let mut left = times;
    bench.line.meter(move |frame| {
        let answer = if left == 0 {
            true_reply(frame)
        } else {
            left -= 1;
            refusal(code)
        };
        vec![(ms(5), answer)]
    });
    bench
}

impl Bench {
    fn read(&mut self, patience: Patience) -> Result<Response, Failure> {
        self.client.request(unit(17), &read(0x6B, 3), patience)
    }

    /// The read is refused with this code.
    fn assert_refused(&mut self, patience: Patience, code: u8) {
        match self.read(patience) {
            Err(Failure::Exception(found)) => assert_eq!(found, ExceptionCode(code)),
            other => panic!("{other:?}"),
        }
    }

    fn assert_reads(&mut self, patience: Patience) {
        let response = self.read(patience).expect("an answer");
        assert_eq!(response, true_response(unit(17), 0x6B, 3));
    }

    /// The silences before the frames sent so far, but for the first, in whole milliseconds.
    fn silences(&self) -> Vec<u128> {
        let sent = self.line.sent();
        sent.iter()
            .skip(1)
            .map(|sent| sent.silence.as_millis())
            .collect()
    }
}

#[test]
fn a_refusal_is_asked_about_once() {
    for code in [1, 2, 3, 4, 5, 7, 0x0A, 0x00, 0x63, 0xFF] {
        let mut bench = refusing(usize::MAX, code);
        bench.assert_refused(Patience::default(), code);
        assert_eq!(bench.frames(), 1, "{code}");
    }
}

#[test]
fn a_busy_unit_is_not_waited_for_beyond_a_second_when_the_time_out_is_short() {
    let patience = Patience {
        timeout: ms(300),
        retries: 0,
        ..Patience::default()
    };
    let bench = Bench::new();
    // It takes so long to say so that the third wait would end too late.
    bench.line.meter(|_| vec![(ms(290), refusal(6))]);
    let mut bench = bench;
    bench.assert_refused(patience, 6);
    assert_eq!(bench.silences(), [100, 200]);
}

#[test]
fn a_pause_longer_than_the_wait_is_kept_before_a_busy_unit_is_asked_again() {
    let mut bench = refusing(2, 6);
    bench.assert_reads(Patience {
        pause: ms(150),
        ..Patience::default()
    });
    assert_eq!(bench.silences(), [150, 200]);
}

#[test]
fn a_fault_of_memory_is_asked_about_once_more_whatever_the_retries() {
    for retries in [0, 2] {
        let patience = Patience {
            retries,
            ..Patience::default()
        };
        let mut bench = refusing(1, 8);
        bench.assert_reads(patience);
        assert_eq!(bench.frames(), 2);
        let mut bench = refusing(usize::MAX, 8);
        bench.assert_refused(patience, 8);
        assert_eq!(bench.frames(), 2);
    }
}

#[test]
fn a_gateway_whose_unit_does_not_answer_is_asked_as_often_as_a_silent_unit() {
    let mut bench = refusing(2, 0x0B);
    bench.assert_reads(Patience::default());
    let mut bench = refusing(usize::MAX, 0x0B);
    bench.assert_refused(Patience::default(), 0x0B);
    assert_eq!(bench.frames(), 3);
}

#[test]
fn what_a_gateway_gave_up_can_come_late_and_is_thrown_away() {
    let mut bench = Bench::new();
    bench
        .line
        .meter(|frame| vec![(ms(5), refusal(0x0B)), (ms(900), true_reply(frame))]);
    bench.assert_refused(
        Patience {
            retries: 0,
            ..Patience::default()
        },
        0x0B,
    );
    bench.line.meter(|frame| vec![(ms(40), true_reply(frame))]);
    let response = bench
        .client
        .request(unit(17), &read(0x80, 3), Patience::default());
    assert_eq!(response.ok(), Some(true_response(unit(17), 0x80, 3)));
    assert_eq!(bench.client.counters(unit(17)).late, 1);
}
