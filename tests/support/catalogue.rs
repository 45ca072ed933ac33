//! One case of the catalogue of faults (`tests/catalogue.md`): a meter that tells the truth, a line
//! that lies about it as rules say, written as users type them after `--fault`, and the client, on a
//! clock that only moves when somebody waits.
//!
//! Three things hold in every case and are checked without being asked for: a value that is
//! reported is the true one; the first read without a fault, as the case ends, gives the right
//! value with one attempt; and t3.5 was kept before every frame, each of which was one write.

#![allow(dead_code, reason = "each test file uses its share")]

use std::sync::{Arc, Mutex};
use std::time::Duration;

use meterpoll::client::{Client, Counters, Echo, Failure, Patience, Ways};
use meterpoll::codec::rtu::{Destination, decode_request};
use meterpoll::codec::{ReadFunction, RegisterRange, Request, Response};
use meterpoll::transport::faulty::FaultTally;
use meterpoll::transport::{
    Clock, FaultScript, Faulty, Line, LineSettings, OpenError, Timing, Transport, TransportError,
};

use super::clock::FakeClock;
use super::script::{Chunk, ScriptedLine, Sent, reply, true_reply, truth, unit};

/// The time-out of every case.
pub(crate) const T: Duration = Duration::from_secs(1);

/// How long the meter takes before it begins to answer.
pub(crate) const THINKS: Duration = Duration::from_millis(10);

/// At 9600 8N1: t3.5, a request of 8 characters, an answer with three registers.
pub(crate) const SILENCE: Duration = Duration::from_nanos(3_645_833);
pub(crate) const REQUEST: Duration = Duration::from_nanos(8_333_333);
pub(crate) const ANSWER: Duration = Duration::from_nanos(11_458_333);

/// Two periods of an adapter that holds bytes back.
pub(crate) const ADAPTER: Duration = Duration::from_millis(32);

/// The unit that is read, and what is read of it where nothing else is said.
pub(crate) const UNIT: u16 = 17;
pub(crate) const REGISTERS: u16 = 3;

/// What is read as a case ends: no other read touches it.
const LAST: u16 = 0x0F00;

pub(crate) const fn ms(milliseconds: u64) -> Duration {
    Duration::from_millis(milliseconds)
}

/// A case. As it is dropped, it makes sure that the line is well again.
pub(crate) struct Case {
    pub(crate) clock: Arc<FakeClock>,
    pub(crate) client: Client,
    patience: Patience,
    sent: Arc<Mutex<Vec<Sent>>>,
    tallies: Vec<FaultTally>,
}

impl Case {
    /// The meter behind a line with these rules, at 9600 8N1, two retries.
    pub(crate) fn new<'a>(rules: impl IntoIterator<Item = &'a str>) -> Self {
        Self::layered([rules])
    }

    /// The same with several such lines in a row, the one at the meter first: so two faults can
    /// meet in one answer.
    pub(crate) fn layered<'a, R: IntoIterator<Item = &'a str>>(
        layers: impl IntoIterator<Item = R>,
    ) -> Self {
        let clock = Arc::new(FakeClock::new());
        Self::on(&clock, layers, |frame| vec![(THINKS, answer(frame))])
    }

    /// The same with a meter of its own ways.
    pub(crate) fn on<'a, R: IntoIterator<Item = &'a str>>(
        clock: &Arc<FakeClock>,
        layers: impl IntoIterator<Item = R>,
        meter: impl FnMut(&[u8]) -> Vec<Chunk> + Send + 'static,
    ) -> Self {
        let settings = LineSettings::default();
        let timing = Timing::Paced(settings);
        let meter_line = ScriptedLine::new(Arc::clone(clock), settings);
        meter_line.meter(meter);
        // A port that a rule takes away is there again at once.
        meter_line.come_back(Duration::ZERO);
        let mut transport: Box<dyn Transport> = Box::new(meter_line);
        let mut tallies = Vec::new();
        for rules in layers {
            let script = FaultScript::parse(rules).expect("rules");
            let clock = Arc::clone(clock) as Arc<dyn Clock>;
            let faulty = Faulty::new(transport, script, timing, clock);
            tallies.push(faulty.tally());
            transport = Box::new(faulty);
        }
        let sent = Arc::default();
        let watch = Watch {
            inner: transport,
            clock: Arc::clone(clock),
            settings,
            wire_end: Duration::ZERO,
            sent: Arc::clone(&sent),
        };
        let shared = Arc::clone(clock) as Arc<dyn Clock>;
        let line = Line::new(Box::new(watch), shared, timing).expect("the line is open");
        Self {
            clock: Arc::clone(clock),
            client: Client::new(line, Echo::Auto),
            patience: Patience {
                timeout: T,
                longest_answer: T,
                ..Patience::default()
            },
            sent,
            tallies,
        }
    }

    pub(crate) fn retries(mut self, retries: u32) -> Self {
        self.patience.retries = retries;
        self
    }

    pub(crate) fn pause(mut self, pause: Duration) -> Self {
        self.patience.pause = pause;
        self
    }

    pub(crate) fn ways(mut self, ways: Ways) -> Self {
        self.patience.ways = ways;
        self
    }

    /// Sends a read and gives what is reported, unchecked.
    pub(crate) fn ask(&mut self, number: u16, request: &Request) -> Result<Vec<u16>, Failure> {
        let unit = unit(number);
        match self.client.request(unit, request, self.patience)? {
            Response::Registers { values, .. } => Ok(values.into_vec()),
            other => panic!("{other:?}"),
        }
    }

    /// Reads registers of a unit: what is reported is the truth.
    #[track_caller]
    pub(crate) fn try_read(
        &mut self,
        number: u16,
        address: u16,
        count: u16,
    ) -> Result<(), Failure> {
        let request = read(ReadFunction::HoldingRegisters, address, count);
        let values = self.ask(number, &request)?;
        assert_eq!(values, truths(number, address, count));
        Ok(())
    }

    /// Three registers of the unit are read, and are right.
    #[track_caller]
    pub(crate) fn reads(&mut self, address: u16) {
        if let Err(failure) = self.try_read(UNIT, address, REGISTERS) {
            panic!("0x{address:04X}: {failure}");
        }
    }

    /// Reading them fails; says why.
    #[track_caller]
    pub(crate) fn fails(&mut self, address: u16) -> String {
        let failure = self.try_read(UNIT, address, REGISTERS);
        failure.expect_err("a failure").to_string()
    }

    pub(crate) fn now(&self) -> Duration {
        self.clock.now()
    }

    /// The frames sent so far.
    pub(crate) fn sent(&self) -> Vec<Sent> {
        self.sent.lock().expect("no test thread panicked").clone()
    }

    /// How many frames were sent so far.
    pub(crate) fn attempts(&self) -> usize {
        self.sent().len()
    }

    /// What was counted of the unit.
    pub(crate) fn counters(&self) -> Counters {
        self.client.counters(unit(UNIT))
    }

    fn faults(&self) -> u64 {
        let counts = self.tallies.iter().map(FaultTally::counts);
        counts.map(|counts| counts.all_faults()).sum()
    }
}

impl Drop for Case {
    fn drop(&mut self) {
        if std::thread::panicking() {
            return;
        }
        let (attempts, faults) = (self.attempts(), self.faults());
        self.patience.retries = 0;
        self.reads(LAST);
        assert_eq!(self.faults(), faults, "no rule applies to the last read");
        let sent = self.sent();
        let others = sent[attempts..].iter().filter(|sent| sent.frame[1] == 8);
        assert_eq!(sent.len(), attempts + 1 + others.count());
        for sent in sent {
            assert!(sent.silence >= SILENCE, "{sent:?}");
            assert!(decode_request(&sent.frame).is_ok(), "{sent:?}");
        }
    }
}

/// A read of a function's registers.
pub(crate) fn read(function: ReadFunction, address: u16, count: u16) -> Request {
    let range = RegisterRange::new(address, count).expect("a range");
    Request::Read { function, range }
}

/// What registers of a unit hold.
pub(crate) fn truths(number: u16, address: u16, count: u16) -> Vec<u16> {
    let number = unit(number).get();
    (address..)
        .take(usize::from(count))
        .map(|address| truth(number, address))
        .collect()
}

/// What the meter answers: the truth.
pub(crate) fn answer(frame: &[u8]) -> Vec<u8> {
    match decode_request(frame) {
        Ok((Destination::Unit(unit), Request::ReturnQueryData(word))) => {
            reply(unit, Response::QueryData(word))
        }
        _ => true_reply(frame),
    }
}

/// Looks at the wire next to the client.
struct Watch {
    inner: Box<dyn Transport>,
    clock: Arc<FakeClock>,
    settings: LineSettings,
    wire_end: Duration,
    sent: Arc<Mutex<Vec<Sent>>>,
}

impl Transport for Watch {
    fn send(&mut self, frame: &[u8]) -> Result<(), TransportError> {
        let now = self.clock.now();
        self.sent
            .lock()
            .expect("no test thread panicked")
            .push(Sent {
                at: now,
                silence: now.saturating_sub(self.wire_end),
                frame: frame.to_vec(),
            });
        self.inner.send(frame)?;
        self.wire_end = now + self.settings.transfer_time(frame.len());
        Ok(())
    }

    fn receive(&mut self, into: &mut [u8], wait: Duration) -> Result<usize, TransportError> {
        let count = self.inner.receive(into, wait)?;
        if count > 0 {
            self.wire_end = self.wire_end.max(self.clock.now());
        }
        Ok(count)
    }

    fn discard_input(&mut self) -> Result<(), TransportError> {
        self.inner.discard_input()
    }

    fn reopen(&mut self) -> Result<(), OpenError> {
        self.inner.reopen()
    }
}
