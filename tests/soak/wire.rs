//! What the two ends of a line share, and the client's end of it: when requests left, what came and
//! when the port was empty.
//!
//! # The proof that an answer came too late
//!
//! Each request is stamped before it is written, and each look at the port that finds nothing is
//! remembered with the time at which it *began*. Bytes that are received later were not there at that
//! time. So an answer to A that was received while B was asked came provably late when the last empty
//! look before it began later than the time the client promises, counted from the last time A was
//! sent. What the client would have to know to tell such an answer from the right one is in no frame.

use std::collections::VecDeque;
use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use meterpoll::codec::rtu::Hex;
use meterpoll::codec::{Reply, Request, Response, rtu};
use meterpoll::transport::serial::Serial;
use meterpoll::transport::{Clock, OpenError, Transport, TransportError};

use crate::truth::Registers;

/// So many of the last events of a line are kept.
const EVENTS: usize = 160;

/// One thing that happened on a line.
#[derive(Debug, Clone)]
pub(crate) struct Event {
    pub(crate) at: Duration,
    pub(crate) what: What,
    pub(crate) bytes: Vec<u8>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum What {
    /// The client is about to write this.
    Asked,
    /// The client was given this; the port was empty at that time.
    Given { empty_at: Duration },
    /// The meter has written this, that much later than it meant to.
    Written { late: Duration },
    /// The meter was too late for this.
    Withheld { late: Duration },
}

impl fmt::Display for Event {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ms = |time: Duration| time.as_secs_f64() * 1000.0;
        write!(f, "{:>12.3} ms  ", ms(self.at))?;
        match self.what {
            What::Asked => f.write_str("client asks"),
            What::Given { empty_at } => write!(f, "client is given (empty at {:.3})", ms(empty_at)),
            What::Written { late } => write!(f, "meter wrote ({:.3} late)", ms(late)),
            What::Withheld { late } => write!(f, "meter withheld ({:.3} late)", ms(late)),
        }?;
        write!(f, "  {}", Hex(&self.bytes))
    }
}

/// Both ends of a line.
#[derive(Default)]
pub(crate) struct Wire {
    state: Mutex<State>,
    is_true: AtomicBool,
}

#[derive(Default)]
struct State {
    /// When requests left that the meter has not taken yet.
    stamps: VecDeque<Duration>,
    /// Whether the meter has anything on its way.
    is_busy: bool,
    events: VecDeque<Event>,
    empty_at: Duration,
}

impl State {
    fn note(&mut self, at: Duration, what: What, bytes: &[u8]) {
        if self.events.len() == EVENTS {
            self.events.pop_front();
        }
        self.events.push_back(Event {
            at,
            what,
            bytes: bytes.to_vec(),
        });
    }
}

impl Wire {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(crate) fn note(&self, at: Duration, what: What, bytes: &[u8]) {
        self.state().note(at, what, bytes);
    }

    /// Switches all faults off, or on again.
    pub(crate) fn be_true(&self, is_true: bool) {
        self.is_true.store(is_true, Ordering::SeqCst);
    }

    /// Whether the meter answers everything truly.
    pub(crate) fn is_true(&self) -> bool {
        self.is_true.load(Ordering::SeqCst)
    }

    /// The meter takes the next request: when it left.
    pub(crate) fn take_stamp(&self) -> Option<Duration> {
        let mut state = self.state();
        state.is_busy = true;
        state.stamps.pop_front()
    }

    /// Whether the meter has anything on its way now.
    pub(crate) fn set_busy(&self, is_busy: bool) {
        self.state().is_busy = is_busy;
    }

    /// Whether all requests have been dealt with, and nothing is on its way any more.
    pub(crate) fn is_idle(&self) -> bool {
        let state = self.state();
        !state.is_busy && state.stamps.is_empty()
    }

    /// The last events.
    pub(crate) fn events(&self) -> Vec<Event> {
        self.state().events.iter().cloned().collect()
    }

    /// Whether what was believed since `start` came provably later than `promised` after it was last
    /// asked for. The first answer to something else decides: what follows may follow from it.
    pub(crate) fn was_too_late(
        &self,
        start: Duration,
        promised: Duration,
        registers: Registers,
    ) -> bool {
        let events = self.events();
        let asked = |event: &&Event| event.what == What::Asked;
        let requests: Vec<usize> = (0..events.len())
            .filter(|index| events[*index].what == What::Asked)
            .collect();
        for (nth, index) in requests.iter().enumerate() {
            if events[*index].at < start {
                continue;
            }
            let end = requests.get(nth + 1).copied().unwrap_or(events.len());
            let given = &events[*index..end];
            let Some((other, empty_at)) = stranger(given, registers) else {
                continue;
            };
            let mut before = events[..*index].iter().rev().filter(asked);
            let last = before.find(|event| is_read_of(&event.bytes, &other, registers));
            return last.is_some_and(|event| empty_at >= event.at + promised);
        }
        false
    }
}

/// An answer that fits a request and is not to it.
struct Stranger {
    unit: u8,
    values: Vec<u16>,
}

/// The first answer behind a request that fits it and belongs to another, and when the port was
/// empty before it.
fn stranger(events: &[Event], registers: Registers) -> Option<(Stranger, Duration)> {
    let request = events.first()?;
    let mut bytes = Vec::new();
    let mut empty = Vec::new();
    for event in events {
        if let What::Given { empty_at } = event.what {
            bytes.extend_from_slice(&event.bytes);
            empty.resize(bytes.len(), empty_at);
        }
    }
    let (_, Request::Read { function, range }) = rtu::decode_request(&request.bytes).ok()? else {
        return None;
    };
    let length = 5 + 2 * usize::from(range.count());
    (0..bytes.len()).find_map(|at| {
        let frame = rtu::checked_window(&bytes, at, length)?;
        let (
            unit,
            Reply::Normal(Response::Registers {
                function: of,
                values,
            }),
        ) = rtu::decode_reply(frame).ok()?
        else {
            return None;
        };
        let values = values.into_vec();
        let other = Stranger {
            unit: unit.get(),
            values,
        };
        let fits = request.bytes.first() == Some(&other.unit) && of == function;
        let is_own = is_read_of(&request.bytes, &other, registers);
        (fits && !is_own).then_some((other, empty[at]))
    })
}

/// Whether a request is answered by these registers.
fn is_read_of(request: &[u8], answer: &Stranger, registers: Registers) -> bool {
    let Ok((_, Request::Read { function, range })) = rtu::decode_request(request) else {
        return false;
    };
    let (start, count) = (range.start().get(), range.count());
    request.first() == Some(&answer.unit)
        && registers
            .read(answer.unit.into(), function, start, count)
            .as_ref()
            == Some(&answer.values)
}

/// The client's end: a serial port that is watched.
pub(crate) struct Watched {
    port: Serial,
    wire: Arc<Wire>,
    clock: Arc<dyn Clock>,
}

impl Watched {
    pub(crate) const fn new(port: Serial, wire: Arc<Wire>, clock: Arc<dyn Clock>) -> Self {
        Self { port, wire, clock }
    }
}

impl Transport for Watched {
    fn send(&mut self, frame: &[u8]) -> Result<(), TransportError> {
        let now = self.clock.now();
        let mut state = self.wire.state();
        state.stamps.push_back(now);
        state.note(now, What::Asked, frame);
        drop(state);
        self.port.send(frame)
    }

    fn receive(&mut self, into: &mut [u8], wait: Duration) -> Result<usize, TransportError> {
        let began = self.clock.now();
        let count = self.port.receive(into, wait)?;
        let now = self.clock.now();
        let mut state = self.wire.state();
        if count == 0 {
            state.empty_at = began;
        } else {
            let empty_at = state.empty_at;
            state.note(now, What::Given { empty_at }, &into[..count]);
        }
        Ok(count)
    }

    fn discard_input(&mut self) -> Result<(), TransportError> {
        self.port.discard_input()
    }

    fn reopen(&mut self) -> Result<(), OpenError> {
        self.port.reopen()
    }
}
