//! A line on which everything that happens was written down before.

#![allow(dead_code, reason = "each test file uses its share")]

use std::collections::{BTreeMap, VecDeque};
use std::io;
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::Duration;

use meterpoll::client::{Client, Echo};
use meterpoll::codec::rtu::{self, Destination};
use meterpoll::codec::{
    ReadFunction, ReadValues, RegisterRange, Reply, Request, Response, Unit, UnitRange,
};
use meterpoll::transport::{
    Clock, Line, LineSettings, OpenError, Timing, Transport, TransportError,
};

use super::clock::FakeClock;

/// Bytes, and when their last one is there: a delay after the end of the request on the wire.
pub(crate) type Chunk = (Duration, Vec<u8>);

/// What a meter does with a request.
type Meter = Box<dyn FnMut(&[u8]) -> Vec<Chunk> + Send>;

/// A frame that was sent.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Sent {
    /// When it was written.
    pub(crate) at: Duration,
    /// How long the wire had been silent then, in both directions.
    pub(crate) silence: Duration,
    /// The bytes of the one write.
    pub(crate) frame: Vec<u8>,
}

/// A scripted medium. Clones share one line, so that a test can look on.
#[derive(Clone)]
pub(crate) struct ScriptedLine {
    clock: Arc<FakeClock>,
    settings: LineSettings,
    state: Arc<Mutex<State>>,
}

#[derive(Default)]
struct State {
    answers: VecDeque<Vec<Chunk>>,
    meter: Option<Meter>,
    /// What is under way, by the time it is there; the number keeps the order.
    due: BTreeMap<(Duration, usize), Vec<u8>>,
    scheduled: usize,
    endless: Option<Endless>,
    hang_up: Option<Duration>,
    /// The port is lost while this frame is sent, counted from 1.
    breaking: Option<usize>,
    /// When the port is lost again, once it was opened again.
    next_hang_up: Option<Duration>,
    /// When the port is there again, once it hung up.
    back: Option<Duration>,
    /// What opening it before that comes to; it is not there where nothing is said.
    absence: Option<fn() -> OpenError>,
    /// When it was tried to open the port again.
    reopened: Vec<Duration>,
    sent: Vec<Sent>,
    /// End of the last byte in either direction.
    wire_end: Duration,
}

/// Bytes that come again and again.
struct Endless {
    next: Duration,
    every: Duration,
    bytes: Box<dyn FnMut() -> Vec<u8> + Send>,
}

impl State {
    fn schedule(&mut self, at: Duration, bytes: Vec<u8>) {
        self.scheduled += 1;
        self.due.insert((at, self.scheduled), bytes);
    }

    /// Puts the endless bytes that are there by `until` on their way.
    fn unroll(&mut self, until: Duration) {
        let Some(mut endless) = self.endless.take() else {
            return;
        };
        while endless.next <= until {
            let bytes = (endless.bytes)();
            self.schedule(endless.next, bytes);
            endless.next += endless.every;
        }
        self.endless = Some(endless);
    }
}

impl ScriptedLine {
    pub(crate) fn new(clock: Arc<FakeClock>, settings: LineSettings) -> Self {
        Self {
            clock,
            settings,
            state: Arc::default(),
        }
    }

    /// The answer to the next request that has none yet; requests beyond the script meet silence.
    pub(crate) fn answer(&self, chunks: Vec<Chunk>) {
        self.state().answers.push_back(chunks);
    }

    /// What happens at every request beyond the script.
    pub(crate) fn meter(&self, meter: impl FnMut(&[u8]) -> Vec<Chunk> + Send + 'static) {
        self.state().meter = Some(Box::new(meter));
    }

    /// Bytes nobody asked for.
    pub(crate) fn inject(&self, at: Duration, bytes: &[u8]) {
        self.state().schedule(at, bytes.to_vec());
    }

    /// Bytes nobody asked for, again and again.
    pub(crate) fn inject_endlessly(
        &self,
        from: Duration,
        every: Duration,
        bytes: impl FnMut() -> Vec<u8> + Send + 'static,
    ) {
        self.state().endless = Some(Endless {
            next: from,
            every,
            bytes: Box::new(bytes),
        });
    }

    /// The port is lost at this moment.
    pub(crate) fn hang_up(&self, at: Duration) {
        self.state().hang_up = Some(at);
    }

    /// The port is lost while this frame is sent, counted from 1.
    pub(crate) fn hang_up_at_frame(&self, number: usize) {
        self.state().breaking = Some(number);
    }

    /// A port that was lost can be opened again from this moment on.
    pub(crate) fn come_back(&self, at: Duration) {
        self.state().back = Some(at);
    }

    /// Once it was opened again, it is lost at this moment.
    pub(crate) fn hang_up_again(&self, at: Duration) {
        self.state().next_hang_up = Some(at);
    }

    /// Before that it cannot be opened for this reason.
    pub(crate) fn until_then(&self, error: fn() -> OpenError) {
        self.state().absence = Some(error);
    }

    /// When it was tried to open the port again.
    pub(crate) fn reopened(&self) -> Vec<Duration> {
        self.state().reopened.clone()
    }

    /// All frames sent so far.
    pub(crate) fn sent(&self) -> Vec<Sent> {
        self.state().sent.clone()
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().expect("no test thread panicked with it")
    }

    fn lost() -> TransportError {
        TransportError::Lost {
            port: "scripted".to_owned(),
            source: io::Error::from(io::ErrorKind::BrokenPipe),
        }
    }
}

impl Transport for ScriptedLine {
    fn send(&mut self, frame: &[u8]) -> Result<(), TransportError> {
        let now = self.clock.now();
        let mut state = self.state();
        if state.breaking == Some(state.sent.len() + 1) {
            state.breaking = None;
            state.hang_up = Some(now);
        }
        if state.hang_up.is_some_and(|at| at <= now) {
            return Err(Self::lost());
        }
        // What came while nobody listened was on the wire all the same.
        state.unroll(now);
        let heard = state.due.keys().map(|(at, _)| *at).filter(|at| *at <= now);
        let wire_end = heard.max().unwrap_or_default().max(state.wire_end);
        state.sent.push(Sent {
            at: now,
            silence: now.saturating_sub(wire_end),
            frame: frame.to_vec(),
        });
        let end = now + self.settings.transfer_time(frame.len());
        state.wire_end = end;
        let chunks = match state.answers.pop_front() {
            Some(chunks) => chunks,
            None => match state.meter.as_mut() {
                Some(meter) => meter(frame),
                None => Vec::new(),
            },
        };
        for (delay, bytes) in chunks {
            state.schedule(end + delay, bytes);
        }
        Ok(())
    }

    fn receive(&mut self, into: &mut [u8], wait: Duration) -> Result<usize, TransportError> {
        let start = self.clock.now();
        let until = start + wait;
        let mut state = self.state();
        state.unroll(until);
        let next = state.due.keys().next().map(|(at, _)| *at);
        let arrival = next.filter(|at| *at <= until);
        let moment = arrival.unwrap_or(until).max(start);
        if let Some(at) = state.hang_up.filter(|at| *at <= moment) {
            self.clock.advance(at.saturating_sub(start));
            return Err(Self::lost());
        }
        self.clock.advance(moment.saturating_sub(start));
        // All that is there by now comes at once, as from a driver's buffer.
        let mut count = 0;
        while let Some(entry) = state.due.first_entry() {
            let at = entry.key().0;
            if at > moment || count == into.len() {
                break;
            }
            let mut bytes = entry.remove();
            let taken = bytes.len().min(into.len() - count);
            into[count..count + taken].copy_from_slice(&bytes[..taken]);
            count += taken;
            state.wire_end = state.wire_end.max(at);
            if taken < bytes.len() {
                state.due.insert((at, 0), bytes.split_off(taken));
            }
        }
        Ok(count)
    }

    fn discard_input(&mut self) -> Result<(), TransportError> {
        let now = self.clock.now();
        let mut state = self.state();
        state.unroll(now);
        if state.hang_up.is_some_and(|at| at <= now) {
            return Err(Self::lost());
        }
        state.due.retain(|(at, _), _| *at > now);
        Ok(())
    }

    /// The port is there again once it has come back; what is on the wire goes on meanwhile.
    fn reopen(&mut self) -> Result<(), OpenError> {
        let now = self.clock.now();
        let mut state = self.state();
        state.reopened.push(now);
        if state.back.is_none_or(|at| at > now) {
            return Err(state.absence.map_or_else(
                || OpenError::NotThere {
                    port: "scripted".to_owned(),
                },
                |absence| absence(),
            ));
        }
        state.hang_up = state.next_hang_up.take();
        Ok(())
    }
}

/// A client on a scripted line.
pub(crate) struct Bench {
    pub(crate) clock: Arc<FakeClock>,
    pub(crate) line: ScriptedLine,
    pub(crate) client: Client,
}

impl Bench {
    /// 9600 8N1, echoes told apart by themselves.
    pub(crate) fn new() -> Self {
        Self::with(LineSettings::default(), Echo::Auto)
    }

    pub(crate) fn with(settings: LineSettings, echo: Echo) -> Self {
        let clock = Arc::new(FakeClock::new());
        let scripted = ScriptedLine::new(Arc::clone(&clock), settings);
        Self::on(clock, scripted, settings, echo)
    }

    /// On a line that was scripted before the client opens it.
    pub(crate) fn on(
        clock: Arc<FakeClock>,
        scripted: ScriptedLine,
        settings: LineSettings,
        echo: Echo,
    ) -> Self {
        let transport = Box::new(scripted.clone());
        let line = Line::new(
            transport,
            Arc::clone(&clock) as Arc<dyn Clock>,
            Timing::Paced(settings),
        )
        .expect("the line is open");
        Self {
            clock,
            line: scripted,
            client: Client::new(line, echo),
        }
    }

    pub(crate) fn now(&self) -> Duration {
        self.clock.now()
    }

    /// When the frames sent so far were written.
    pub(crate) fn sent_at(&self) -> Vec<Duration> {
        self.line.sent().iter().map(|sent| sent.at).collect()
    }

    /// How many frames were sent so far.
    pub(crate) fn frames(&self) -> usize {
        self.line.sent().len()
    }
}

pub(crate) fn unit(number: u16) -> Unit {
    Unit::new(number, UnitRange::Extended).expect("a unit")
}

/// A read of holding registers.
pub(crate) fn read(start: u16, count: u16) -> Request {
    Request::Read {
        function: ReadFunction::HoldingRegisters,
        range: RegisterRange::new(start, count).expect("a range"),
    }
}

/// What a register holds: different for every pair of unit and address that tests use.
pub(crate) fn truth(unit: u8, address: u16) -> u16 {
    // An odd factor, so no two addresses of a unit have the same value.
    address.wrapping_mul(40_503) ^ (u16::from(unit) << 8)
}

/// What `count` registers hold.
fn truths(unit: Unit, start: u16, count: u16) -> ReadValues {
    let values = (0..count).map(|index| truth(unit.get(), start + index));
    ReadValues::new(values.collect()).expect("1 to 125 registers")
}

/// The response that a read of `count` registers has to have.
pub(crate) fn true_response(unit: Unit, start: u16, count: u16) -> Response {
    Response::Registers {
        function: ReadFunction::HoldingRegisters,
        values: truths(unit, start, count),
    }
}

/// The frame a meter that tells the truth answers a read frame with.
pub(crate) fn true_reply(frame: &[u8]) -> Vec<u8> {
    let Ok((Destination::Unit(unit), Request::Read { function, range })) =
        rtu::decode_request(frame)
    else {
        panic!("no read: {}", rtu::Hex(frame));
    };
    let values = truths(unit, range.start().get(), range.count());
    reply(unit, Response::Registers { function, values })
}

/// The frame of a normal answer.
pub(crate) fn reply(unit: Unit, response: Response) -> Vec<u8> {
    let frame = rtu::encode_reply(unit, &Reply::Normal(response));
    frame.as_bytes().to_vec()
}

/// Bytes one after the other: the first one is there after `delay`, the others follow at `pace`.
pub(crate) fn dripped(delay: Duration, bytes: &[u8], pace: Duration) -> Vec<Chunk> {
    (0..)
        .zip(bytes)
        .map(|(index, byte)| (delay + pace * index, vec![*byte]))
        .collect()
}
