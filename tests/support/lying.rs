//! A meter behind a line that lies, on the clock of the test.

#![allow(dead_code, reason = "each test file uses its share")]

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Duration;

use meterpoll::codec::rtu::{self, Hex};
use meterpoll::transport::faulty::{FaultScript, Faulty};
use meterpoll::transport::{Clock, OpenError, Timing, Transport, TransportError};

#[path = "clock.rs"]
mod clock;

pub(crate) use clock::FakeClock;

/// Three registers of unit 17 from 0x006B.
pub(crate) const READ: [u8; 8] = [
    0x11, // unit
    0x03, // function
    0x00, 0x6B, // first register
    0x00, 0x03, // how many
    0x76, 0x87, // CRC
];

/// What the meter answers to [`READ`]: in each register its unit and its address.
pub(crate) const TRUE: &str = "11 03 06 11 6B 11 6C 11 6D C2 A1";

/// The unit that answers nothing.
pub(crate) const SILENT: u8 = 99;

/// The unit that says everything twice.
pub(crate) const TWICE: u8 = 98;

/// A frame with its CRC.
pub(crate) fn sealed(body: &[u8]) -> Vec<u8> {
    [body, &rtu::check(body)].concat()
}

/// A read of some registers.
pub(crate) fn read(unit: u8, function: u8, address: u8, count: u8) -> Vec<u8> {
    sealed(&[unit, function, 0, address, 0, count])
}

/// Answers at once, and in each register with its unit and its address; of all other
/// requests the first six bytes come back. Waits on the clock.
pub(crate) struct Meter {
    clock: Arc<FakeClock>,
    answers: VecDeque<u8>,
    /// What handing over bytes takes.
    effort: Duration,
}

/// What [`Meter`] says to a request.
pub(crate) fn truth(request: &[u8]) -> Vec<u8> {
    match request {
        [0 | SILENT, ..] => Vec::new(),
        [unit, function @ (3 | 4), _, address, _, count, ..] => {
            let mut body = vec![*unit, *function, count * 2];
            for offset in 0..*count {
                body.extend([*unit, address.wrapping_add(offset)]);
            }
            sealed(&body)
        }
        [unit, function, a, b, c, d, ..] => sealed(&[*unit, *function, *a, *b, *c, *d]),
        _ => Vec::new(),
    }
}

impl Transport for Meter {
    fn send(&mut self, frame: &[u8]) -> Result<(), TransportError> {
        let times = if frame.first() == Some(&TWICE) { 2 } else { 1 };
        self.answers.extend(truth(frame).repeat(times));
        Ok(())
    }

    fn receive(&mut self, into: &mut [u8], wait: Duration) -> Result<usize, TransportError> {
        if self.answers.is_empty() {
            self.clock.sleep(wait);
        }
        self.clock.advance(self.effort);
        let count = self.answers.len().min(into.len());
        for (place, byte) in into.iter_mut().zip(self.answers.drain(..count)) {
            *place = byte;
        }
        Ok(count)
    }

    fn discard_input(&mut self) -> Result<(), TransportError> {
        self.answers.clear();
        Ok(())
    }

    fn reopen(&mut self) -> Result<(), OpenError> {
        self.answers.clear();
        Ok(())
    }
}

/// The meter, and the line that lies about it.
pub(crate) struct Lying {
    pub(crate) clock: Arc<FakeClock>,
    pub(crate) line: Faulty<Meter>,
}

impl Lying {
    /// A line with these rules, without a pace of its own.
    pub(crate) fn new(rules: &[&str]) -> Self {
        Self::with(FaultScript::parse(rules).unwrap(), Timing::Unpaced)
    }

    pub(crate) fn with(script: FaultScript, timing: Timing) -> Self {
        Self::made(script, timing, Duration::ZERO)
    }

    /// The same as [`Self::new`], with a meter that takes a millisecond to hand over bytes.
    pub(crate) fn slow(rules: &[&str]) -> Self {
        let effort = Duration::from_millis(1);
        Self::made(FaultScript::parse(rules).unwrap(), Timing::Unpaced, effort)
    }

    fn made(script: FaultScript, timing: Timing, effort: Duration) -> Self {
        let clock = Arc::new(FakeClock::new());
        let meter = Meter {
            clock: Arc::clone(&clock),
            answers: VecDeque::new(),
            effort,
        };
        let line = Faulty::new(meter, script, timing, Arc::clone(&clock) as Arc<dyn Clock>);
        Self { clock, line }
    }

    /// Sends a request, and says what is heard until so many milliseconds later.
    pub(crate) fn ask(&mut self, request: &[u8], milliseconds: u64) -> Vec<String> {
        self.line.send(request).unwrap();
        self.listen(milliseconds)
    }

    /// What is heard for so many milliseconds from now: each piece in hex, behind how many
    /// milliseconds from now it came (whole microseconds). A lost port ends it.
    pub(crate) fn listen(&mut self, milliseconds: u64) -> Vec<String> {
        let start = self.clock.now();
        let end = start + Duration::from_millis(milliseconds);
        let mut heard = Vec::new();
        let mut chunk = [0; 512];
        loop {
            let left = end.saturating_sub(self.clock.now());
            let count = match self.line.receive(&mut chunk, left) {
                Ok(0) if left.is_zero() => return heard,
                Ok(count) => count,
                Err(error) => {
                    heard.push(format!("{error}"));
                    return heard;
                }
            };
            if count > 0 {
                let passed = self.clock.now().saturating_sub(start);
                let (whole, part) = (passed.as_millis(), passed.subsec_micros() % 1000);
                let part = if part == 0 {
                    String::new()
                } else {
                    format!(".{part:03}")
                };
                heard.push(format!("{whole}{part}: {}", Hex(&chunk[..count])));
            }
        }
    }

    /// Lets so many milliseconds pass, and throws away what arrives and whether the port is lost.
    pub(crate) fn listen_to_nothing(&mut self, milliseconds: u64) {
        self.bytes(0, 512);
        self.clock.advance(Duration::from_millis(milliseconds));
        self.line.discard_input().ok();
    }

    /// The bytes of so many milliseconds from now, taken at most `room` at a time; a lost port ends
    /// them.
    pub(crate) fn bytes(&mut self, milliseconds: u64, room: usize) -> Vec<u8> {
        let end = self.clock.now() + Duration::from_millis(milliseconds);
        let mut chunk = vec![0; room];
        let mut heard = Vec::new();
        loop {
            let left = end.saturating_sub(self.clock.now());
            match self.line.receive(&mut chunk, left) {
                Ok(0) if left.is_zero() => return heard,
                Ok(count) => heard.extend_from_slice(&chunk[..count]),
                Err(_) => return heard,
            }
        }
    }

    /// The bytes that come at once, in hex.
    pub(crate) fn at_once(&mut self, request: &[u8]) -> String {
        let heard = self.ask(request, 0);
        match heard.as_slice() {
            [] => String::new(),
            [one] => one.strip_prefix("0: ").unwrap_or(one).to_owned(),
            several => panic!("{several:?}"),
        }
    }
}
