//! The transport that spoils what comes through it.

use std::io;
use std::sync::Arc;
use std::time::Duration;

use fastrand::Rng;

use super::counts::{FaultCounts, FaultTally};
use super::effect::{Effect, Moment};
use super::plan::{Arrival, Case, Fate};
use super::schedule::{Next, Piece, Schedule};
use super::script::FaultScript;
use super::stream::Stream;
use super::when::Asked;
use crate::codec::length::{self, Direction, MOST_FRAME_BYTES};
use crate::transport::{Clock, OpenError, Timing, Transport, TransportError};

/// The most bytes taken from the transport behind at once.
const CHUNK: usize = 512;

/// After this long without another byte, an answer whose length cannot be told is taken to be
/// whole: six of the 16 ms that a common adapter holds bytes back.
const GAP: Duration = Duration::from_millis(100);

/// Wraps a transport: answers that come through it are spoiled as its script says. All others, and
/// all requests, pass unchanged.
pub struct Faulty<T> {
    inner: T,
    script: FaultScript,
    timing: Timing,
    clock: Arc<dyn Clock>,
    tally: FaultTally,
    name: String,
    schedule: Schedule,
    stream: Option<Stream>,
    answer: Answer,
    /// Whether the meter has begun to answer the last request.
    is_answered: bool,
}

/// What becomes of what the transport behind gives.
enum Answer {
    /// It passes.
    Passed,
    /// It is thrown away, until the next request.
    Lost,
    /// It is gathered until it is whole.
    Gathered(Box<Gathered>),
}

/// An answer as far as it has come, and what becomes of it.
struct Gathered {
    case: Case,
    bytes: Vec<u8>,
    last: Duration,
}

impl<T: Transport> Faulty<T> {
    /// Wraps `inner`, which is driven at the pace of `timing`: a request ends when it has been
    /// transferred at that pace.
    pub fn new(inner: T, script: FaultScript, timing: Timing, clock: Arc<dyn Clock>) -> Self {
        Self {
            inner,
            script,
            timing,
            clock,
            tally: FaultTally::default(),
            name: "(faulty)".to_owned(),
            schedule: Schedule::default(),
            stream: None,
            answer: Answer::Passed,
            is_answered: false,
        }
    }

    /// The port's name in the error of a hang-up; else it is `(faulty)`.
    #[must_use]
    pub fn with_name(mut self, name: impl Into<String>) -> Self {
        self.name = name.into();
        self
    }

    /// What it wraps.
    pub const fn behind(&self) -> &T {
        &self.inner
    }

    /// What has happened so far.
    pub fn counts(&self) -> FaultCounts {
        self.tally.counts()
    }

    /// A handle on the counts, for when a line owns the transport.
    pub fn tally(&self) -> FaultTally {
        self.tally.clone()
    }

    /// When, on the clock, [`Transport::receive`] has something to do next: bytes that are due, or
    /// a port that is lost. `None` when nothing is on its way; what the transport behind has to
    /// give is not known before it is asked, so whoever waits on something else calls `receive`
    /// with no wait after each request.
    pub fn next_due(&self) -> Option<Duration> {
        let stream = self.stream.as_ref().and_then(Stream::next_at);
        [self.next_due_of_pieces(), stream]
            .into_iter()
            .flatten()
            .min()
    }

    /// The same, for all but a stream that goes on until the next request.
    pub fn next_due_of_what_ends(&self) -> Option<Duration> {
        let stream = self.stream.as_ref().filter(|stream| stream.ends());
        [self.next_due_of_pieces(), stream.and_then(Stream::next_at)]
            .into_iter()
            .flatten()
            .min()
    }

    fn next_due_of_pieces(&self) -> Option<Duration> {
        let answer = match &self.answer {
            Answer::Gathered(gathered) if !gathered.bytes.is_empty() => {
                Some(gathered.last.saturating_add(GAP))
            }
            _ => None,
        };
        [self.schedule.next_at(), answer]
            .into_iter()
            .flatten()
            .min()
    }

    /// Bytes that are kept: on their way, or of an answer that is not whole yet.
    pub fn kept_bytes(&self) -> usize {
        let gathered = match &self.answer {
            Answer::Gathered(gathered) => gathered.bytes.len(),
            Answer::Passed | Answer::Lost => 0,
        };
        self.schedule.waiting() + gathered
    }

    /// The error of a port that is lost, with which everything on its way is lost as well.
    fn hang_up(&mut self) -> TransportError {
        self.lose_all();
        TransportError::Lost {
            port: self.name.clone(),
            source: io::Error::new(io::ErrorKind::BrokenPipe, "a fault rule hangs up"),
        }
    }

    /// Nothing that is on its way arrives any more.
    fn lose_all(&mut self) {
        self.schedule.clear();
        self.stream = None;
        self.answer = Answer::Lost;
    }

    /// Copies what is due by now into `into`, in the order in which it arrives.
    fn deliver(&mut self, into: &mut [u8]) -> Result<usize, TransportError> {
        let now = self.clock.now();
        let mut count = 0;
        loop {
            let room = into.get_mut(count..).unwrap_or_default();
            if room.is_empty() {
                return Ok(count);
            }
            self.advance_stream(now);
            // Bytes before a hang-up are received before it is.
            if count > 0 && self.schedule.is_hang_up_next(now) {
                return Ok(count);
            }
            match self.schedule.take(room, now) {
                Next::Bytes(0) => return Ok(count),
                Next::Bytes(more) => count += more,
                Next::HangUp => return Err(self.hang_up()),
            }
        }
    }

    /// Puts the next bytes of a stream into the schedule, when they are due before all in it.
    fn advance_stream(&mut self, now: Duration) {
        let Some(stream) = &mut self.stream else {
            return;
        };
        let is_next = match (stream.next_at(), self.schedule.next_at()) {
            (Some(stream), Some(piece)) => stream < piece,
            (stream, _) => stream.is_some(),
        };
        if is_next {
            let made = stream.make(now);
            self.schedule
                .add(made.map(|(at, bytes)| Piece::whole(at, bytes)));
        }
    }

    /// Takes what the transport behind gives within `wait` and does with it what is to be done.
    /// Returns how many bytes came.
    fn take_in(&mut self, wait: Duration) -> Result<usize, TransportError> {
        let mut chunk = [0; CHUNK];
        let count = self.inner.receive(&mut chunk, wait)?;
        let bytes = chunk.get(..count).unwrap_or_default();
        let now = self.clock.now();
        if count > 0 {
            self.note_answer();
        }
        match &mut self.answer {
            Answer::Lost => {}
            Answer::Passed => self.pass(bytes, now),
            Answer::Gathered(gathered) => {
                gathered.bytes.extend_from_slice(bytes);
                if count > 0 {
                    gathered.last = now;
                }
                self.spoil_when_whole(now);
            }
        }
        Ok(count)
    }

    fn note_answer(&mut self) {
        if !self.is_answered {
            self.is_answered = true;
            self.tally.answer();
        }
    }

    fn pass(&mut self, bytes: &[u8], now: Duration) {
        if !bytes.is_empty() {
            self.schedule.add([Piece::whole(now, bytes.to_vec())]);
        }
    }

    /// Spoils the answer when it is whole; what is behind it passes.
    fn spoil_when_whole(&mut self, now: Duration) {
        let Answer::Gathered(gathered) = &self.answer else {
            return;
        };
        let received = gathered.bytes.len();
        let length = length::of_frame(&gathered.bytes, Direction::Response);
        let is_over = received > MOST_FRAME_BYTES || now >= gathered.last.saturating_add(GAP);
        let length = match length {
            Some(length) if length <= received => length,
            _ if is_over && received > 0 => received,
            _ => return,
        };
        let Answer::Gathered(gathered) = std::mem::replace(&mut self.answer, Answer::Passed) else {
            return;
        };
        let Gathered {
            case, mut bytes, ..
        } = *gathered;
        let behind = bytes.split_off(length);
        let arrival = case.answer(bytes, now);
        self.arrive(arrival);
        self.pass(&behind, now);
    }

    fn arrive(&mut self, arrival: Arrival) {
        self.schedule.add(arrival.pieces);
        if arrival.stream.is_some() {
            self.stream = arrival.stream;
        }
    }

    /// Counts a request, and says what happens to it and by what chance.
    fn decide(&self, frame: &[u8]) -> Option<(Effect, Rng)> {
        let asked = Asked {
            number: self.tally.request(),
            unit: frame.first().copied(),
            function: frame.get(1).copied(),
        };
        let decision = self.script.decide(asked)?;
        self.tally.fault(decision.kind);
        Some((decision.effect.clone(), decision.chance))
    }
}

impl<T: Transport> Transport for Faulty<T> {
    fn send(&mut self, frame: &[u8]) -> Result<(), TransportError> {
        if self.schedule.take_hang_up(self.clock.now()) {
            return Err(self.hang_up());
        }
        // What was said to the request before is not taken for the answer to this one.
        self.take_in(Duration::ZERO)?;
        self.stream = None;
        self.answer = Answer::Passed;
        self.is_answered = false;
        let fault = self.decide(frame);
        if let Some((Effect::HangUp(Moment::Before), _)) = fault {
            return Err(self.hang_up());
        }
        self.inner.send(frame)?;
        let Some((effect, chance)) = fault else {
            return Ok(());
        };
        // As a line counts it: from when the write is over.
        let now = self.clock.now();
        let mut case = Case {
            effect,
            chance,
            request: frame.to_vec(),
            end: now + self.timing.transfer_time(frame.len()),
        };
        let arrival = case.at_once();
        self.arrive(arrival);
        self.answer = match case.fate() {
            Fate::Lost => Answer::Lost,
            Fate::Spoiled => Answer::Gathered(Box::new(Gathered {
                case,
                bytes: Vec::new(),
                last: now,
            })),
        };
        Ok(())
    }

    fn receive(&mut self, into: &mut [u8], wait: Duration) -> Result<usize, TransportError> {
        let deadline = self.clock.now().saturating_add(wait);
        loop {
            let count = self.deliver(into)?;
            if count > 0 {
                return Ok(count);
            }
            let now = self.clock.now();
            let until = self.next_due().map_or(deadline, |due| due.min(deadline));
            let left = until.saturating_sub(now);
            if matches!(self.answer, Answer::Passed) {
                let count = self.inner.receive(into, left)?;
                if count > 0 {
                    self.note_answer();
                    return Ok(count);
                }
                return self.deliver(into);
            }
            let came = self.take_in(left)?;
            if came == 0 || self.clock.now() >= deadline {
                return self.deliver(into);
            }
        }
    }

    fn discard_input(&mut self) -> Result<(), TransportError> {
        if self.schedule.take_hang_up(self.clock.now()) {
            return Err(self.hang_up());
        }
        // An answer that is to come later is not among what has arrived.
        self.take_in(Duration::ZERO)?;
        // Not sooner: what was taken in just now has arrived.
        let now = self.clock.now();
        self.schedule.discard(now);
        if let Some(stream) = &mut self.stream {
            stream.skip(now);
        }
        self.inner.discard_input()
    }

    fn reopen(&mut self) -> Result<(), OpenError> {
        self.lose_all();
        self.inner.reopen()
    }
}
