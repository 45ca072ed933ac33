//! Reads of one register of a meter whose ways are known, or not: a value must be the true one.

#![allow(dead_code, reason = "each test file uses its share")]

use std::time::Duration;

use meterpoll::client::{Failure, Patience, QueryData, Ways};
use meterpoll::codec::rtu::{decode_request, encode_reply};
use meterpoll::codec::{ExceptionCode, Reply, Request, Response};

use super::script::{Bench, Chunk, read, reply, true_reply, truth, unit};

pub(crate) const fn ms(milliseconds: u64) -> Duration {
    Duration::from_millis(milliseconds)
}

/// Later than anybody waits: the time-out is 1 s.
pub(crate) const TOO_LATE: Duration = ms(2100);

pub(crate) const BOTH: Ways = Ways {
    interchangeable_reads: true,
    loopback: Some(QueryData::Any),
};

pub(crate) const LOOPBACK_ONLY: Ways = Ways {
    interchangeable_reads: false,
    ..BOTH
};

pub(crate) const FUNCTIONS_ONLY: Ways = Ways {
    loopback: None,
    ..BOTH
};

impl Bench {
    /// Reads a register of unit 17 with one attempt. A value must be the true one.
    pub(crate) fn reads(&mut self, address: u16, ways: Ways) -> Result<(), Failure> {
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
    pub(crate) fn answer_after(&self, delay: Duration) {
        self.line.meter(move |frame| vec![(delay, answer(frame))]);
    }

    /// The answer to the next request comes so late; those behind it after 200 ms.
    pub(crate) fn answer_late(&self, delay: Duration) {
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

    pub(crate) fn be_silent(&self) {
        self.line.meter(|_| Vec::new());
    }

    /// `03 0x0001`: function and first word of each frame sent.
    pub(crate) fn asked(&self) -> Vec<String> {
        let sent = self.line.sent();
        let frames = sent.iter().map(|sent| sent.frame.as_slice());
        frames
            .map(|frame| format!("{:02} 0x{:02X}{:02X}", frame[1], frame[2], frame[3]))
            .collect()
    }

    /// A bench whose line is known not to echo.
    pub(crate) fn known() -> Self {
        let mut bench = Self::new();
        bench.answer_after(ms(10));
        bench.reads(0x100, Ways::default()).expect("an answer");
        bench
    }
}

/// The true answer to a read, or to a loop-back.
pub(crate) fn answer(frame: &[u8]) -> Vec<u8> {
    match decode_request(frame) {
        Ok((_, Request::ReturnQueryData(word))) => reply(unit(17), Response::QueryData(word)),
        _ => true_reply(frame),
    }
}

pub(crate) fn exception(frame: &[u8], code: ExceptionCode) -> Vec<u8> {
    let (_, request) = decode_request(frame).expect("a request");
    let function = request.function();
    encode_reply(unit(17), &Reply::Exception { function, code })
        .as_bytes()
        .to_vec()
}

/// Two answers to a request: one after `first`, a copy of it so much later.
pub(crate) fn twice(frame: &[u8], first: Duration, later: Duration) -> Vec<Chunk> {
    vec![(first, answer(frame)), (first + later, answer(frame))]
}
