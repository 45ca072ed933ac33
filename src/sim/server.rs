//! The simulated line with clients on it: what they send is cut into requests and sent into the
//! line, and what comes out of the line is sent to them.
//!
//! All meters share one line, however many clients there are, as they do behind a serial device
//! server: one request is under way at a time, and those of other clients wait until the line has
//! nothing more to say, or for [`TURN`]. So the numbers of requests in a fault script count all of
//! them. A client that asks again before it was answered does so at its own risk, as on a line, and
//! hears whatever the line says then. With Modbus TCP all requests wait as long as the line has
//! something to say: each answer bears the number of its request.

mod cutter;
mod tally;
mod words;

use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;
use std::time::Duration;

use log::{info, trace};
use thiserror::Error;

use self::cutter::{Cut, Cutter};
use super::line::SimulatedLine;
use super::meter::Meter;
use crate::codec::length::{Direction, of_frame};
use crate::codec::mbap::{self, Header};
use crate::codec::rtu::{self, Hex};
use crate::transport::faulty::{FaultCounts, FaultKind, FaultScript, Faulty};
use crate::transport::{
    Afterwards, ClientId, Clock, Heard, OpenError, Outside, Timing, Transport, TransportError,
};

pub use tally::Tally;

/// How long a client may wait for others: what no answer comes to must not keep the line for ever.
pub const TURN: Duration = Duration::from_secs(1);

/// The most requests that wait for their turn; more are lost, as in a device of little memory.
const MOST_WAITING: usize = 64;

/// How the clients frame what they send.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Framing {
    /// As on a serial line; silence of `gap` ends what has no end of its own.
    Rtu {
        /// Longer than any pause that a client makes inside a request.
        gap: Duration,
    },
    /// With the header of Modbus TCP.
    Tcp,
}

impl Framing {
    /// Whether faults of this kind can be shown to such clients: a connection that is framed by
    /// lengths carries whole frames.
    pub const fn shows(self, kind: FaultKind) -> bool {
        match self {
            Self::Rtu { .. } => true,
            Self::Tcp => matches!(
                kind,
                FaultKind::Late
                    | FaultKind::Delay
                    | FaultKind::Silence
                    | FaultKind::Twice
                    | FaultKind::WrongUnit
                    | FaultKind::Stranger
                    | FaultKind::WrongFunction
                    | FaultKind::WrongCount
                    | FaultKind::Exception
                    | FaultKind::ExceptionFor
                    | FaultKind::HangUp
            ),
        }
    }
}

/// How a server serves.
#[derive(Debug, Clone)]
pub struct Service {
    /// How clients frame what they send.
    pub framing: Framing,
    /// How long the meters take before they answer.
    pub answer_time: Duration,
    /// What goes wrong.
    pub script: FaultScript,
    /// After so many requests nothing more is heard; `None` goes on for ever.
    pub count: Option<u64>,
}

/// Why there is nobody to serve any more.
#[derive(Debug, Error)]
pub enum ServeError {
    /// The clients' side is gone.
    #[error(transparent)]
    Lost(#[from] TransportError),
    /// After a hang-up it cannot be opened again.
    #[error(transparent)]
    Reopen(#[from] OpenError),
}

/// How things stand after a turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum State {
    /// There is more to come.
    Serving,
    /// As many requests as were to be heard have been, and all that is answered to them is out, but
    /// for what has no end.
    Done,
    /// The line has hung up for good.
    HungUp,
}

/// A request and who asks.
struct Request {
    client: ClientId,
    transaction: Option<u16>,
    frame: Vec<u8>,
}

/// Meters on a line, and clients outside of it.
pub struct Server<O> {
    outside: O,
    line: Faulty<SimulatedLine>,
    service: Service,
    clock: Arc<dyn Clock>,
    cutters: BTreeMap<ClientId, Cutter>,
    waiting: VecDeque<Request>,
    /// Who hears what the line says, and for which transaction.
    asker: Option<(ClientId, Option<u16>)>,
    asked_at: Duration,
    /// When the meters will have begun to answer.
    answer_at: Option<Duration>,
    /// What the line has said of a frame that is not whole; with [`Framing::Tcp`] alone.
    partial: Vec<u8>,
    tally: Tally,
    traced_at: Duration,
}

impl<O: Outside> Server<O> {
    /// Serves the clients outside with these meters.
    pub fn new(outside: O, meters: Vec<Meter>, service: Service, clock: Arc<dyn Clock>) -> Self {
        let line = SimulatedLine::with_meters(meters, Arc::clone(&clock))
            .with_answer_time(service.answer_time);
        // A request has ended when its last byte is heard.
        let script = service.script.clone();
        let traced_at = clock.now();
        let line = Faulty::new(line, script, Timing::Unpaced, Arc::clone(&clock));
        Self {
            outside,
            line,
            service,
            clock,
            cutters: BTreeMap::new(),
            waiting: VecDeque::new(),
            asker: None,
            asked_at: Duration::ZERO,
            answer_at: None,
            partial: Vec::new(),
            tally: Tally::default(),
            traced_at,
        }
    }

    /// What was heard and said so far.
    pub const fn tally(&self) -> &Tally {
        &self.tally
    }

    /// What the fault script did so far.
    pub fn faults(&self) -> FaultCounts {
        self.line.counts()
    }

    /// Waits until all that was said has been taken, where that can be known, and ends.
    pub fn finish(&mut self, limit: Duration) {
        self.outside.finish(limit);
    }

    /// Waits for something to happen, at most `patience`, and does what follows.
    ///
    /// # Errors
    /// [`ServeError`] when there is nobody to serve any more.
    pub fn turn(&mut self, patience: Duration) -> Result<State, ServeError> {
        let now = self.clock.now();
        let until = self.next_due().map(|due| due.saturating_sub(now));
        let wait = until.map_or(patience, |until| until.min(patience));
        match self.outside.hear(wait)? {
            Heard::Nothing => {}
            Heard::Bytes(client, bytes) => self.hear(client, &bytes)?,
            Heard::Left(client) => self.forget(client),
        }
        let now = self.clock.now();
        let over: Vec<(ClientId, Cut)> = self
            .cutters
            .iter_mut()
            .filter_map(|(client, cutter)| Some((*client, cutter.over(now)?)))
            .collect();
        for (client, cut) in over {
            self.take(client, cut)?;
        }
        let mut state = self.serve()?;
        if state == State::Serving && self.is_done() {
            state = State::Done;
        }
        Ok(state)
    }

    /// When there is something to do, whatever comes from outside.
    fn next_due(&self) -> Option<Duration> {
        let gap = self.cutters.values().filter_map(Cutter::deadline).min();
        let turn = self.asked_at.saturating_add(TURN);
        let may_cut_in = !self.waiting.is_empty() && self.service.framing != Framing::Tcp;
        let turn = may_cut_in.then_some(turn);
        [self.line.next_due(), self.answer_at, gap, turn]
            .into_iter()
            .flatten()
            .min()
    }

    fn hear(&mut self, client: ClientId, bytes: &[u8]) -> Result<(), ServeError> {
        self.trace('<', bytes);
        let now = self.clock.now();
        let framing = self.service.framing;
        let cutter = self.cutters.entry(client);
        let cuts = cutter
            .or_insert_with(|| Cutter::new(framing))
            .push(bytes, now);
        cuts.into_iter().try_for_each(|cut| self.take(client, cut))
    }

    fn take(&mut self, client: ClientId, cut: Cut) -> Result<(), ServeError> {
        match cut {
            Cut::Damaged { bytes } => {
                info!("heard {bytes} bytes that are no request");
                self.tally.damaged();
            }
            Cut::Hopeless(error) => {
                info!("heard what is not Modbus TCP: {error}");
                self.tally.damaged();
                self.outside.hang_up(client)?;
                self.forget(client);
            }
            Cut::Request { transaction, frame } => {
                let unit = frame.first().copied().unwrap_or_default();
                if unit != 0 && !self.line.behind().has_unit(unit) {
                    info!("heard a request to unit {unit}, which is not here");
                    self.tally.foreign();
                } else if self.waiting.len() < MOST_WAITING {
                    self.waiting.push_back(Request {
                        client,
                        transaction,
                        frame,
                    });
                } else {
                    info!("lost a request to unit {unit}: {MOST_WAITING} wait already");
                    self.tally.lost();
                }
            }
        }
        Ok(())
    }

    /// Sends what is due, and the requests whose turn it is.
    fn serve(&mut self) -> Result<State, ServeError> {
        let mut state = self.deliver()?;
        while state == State::Serving
            && !self.has_heard_all()
            && let Some(request) = self.next_request()
        {
            state = self.ask(&request)?;
        }
        if self.has_heard_all() {
            self.waiting.clear();
        }
        Ok(state)
    }

    fn next_request(&mut self) -> Option<Request> {
        let next = self.waiting.front()?;
        let is_own = self.asker.is_some_and(|(asker, _)| asker == next.client);
        let has_waited = self.clock.now() >= self.asked_at.saturating_add(TURN);
        let may_cut_in = self.service.framing != Framing::Tcp && (is_own || has_waited);
        if may_cut_in || self.is_quiet() {
            self.waiting.pop_front()
        } else {
            None
        }
    }

    fn ask(&mut self, request: &Request) -> Result<State, ServeError> {
        info!("asked: {}", words::request(&request.frame));
        self.tally.request(&request.frame);
        self.partial.clear();
        self.asker = Some((request.client, request.transaction));
        self.asked_at = self.clock.now();
        if self.line.send(&request.frame).is_err() {
            return self.hang_up();
        }
        self.answer_at = Some(self.asked_at.saturating_add(self.service.answer_time));
        self.deliver()
    }

    /// Sends what the line has said by now. What comes while that is sent is left to the next turn:
    /// a stream that is faster than it is sent would keep the server here for ever.
    fn deliver(&mut self) -> Result<State, ServeError> {
        let now = self.clock.now();
        if self.answer_at.is_some_and(|at| at <= now) {
            self.answer_at = None;
        }
        let mut chunk = [0; 512];
        loop {
            match self.line.receive(&mut chunk, Duration::ZERO) {
                Ok(0) => return Ok(State::Serving),
                Ok(count) => self.say(chunk.get(..count).unwrap_or_default())?,
                Err(_) => return self.hang_up(),
            }
            if self.line.next_due().is_some_and(|due| due > now) {
                return Ok(State::Serving);
            }
        }
    }

    fn say(&mut self, bytes: &[u8]) -> Result<(), ServeError> {
        let Some((client, transaction)) = self.asker else {
            return Ok(());
        };
        let Some(transaction) = transaction else {
            self.tell(bytes);
            self.trace('>', bytes);
            return Ok(self.outside.say(client, bytes)?);
        };
        self.partial.extend_from_slice(bytes);
        while let Some(length) = of_frame(&self.partial, Direction::Response)
            && length <= self.partial.len()
        {
            let frame: Vec<u8> = self.partial.drain(..length).collect();
            self.tell(&frame);
            // Faults that leave no whole frame are not in the script.
            if let Ok((unit, data_unit)) = rtu::open(&frame) {
                let framed = mbap::encode(Header { transaction, unit }, data_unit);
                self.trace('>', &framed);
                self.outside.say(client, &framed)?;
            }
        }
        Ok(())
    }

    fn tell(&mut self, bytes: &[u8]) {
        info!("answered: {}", words::answer(bytes));
        self.tally.answer(bytes);
    }

    /// As [`crate::transport::traced::Traced`] shows bytes, from the meters' side.
    fn trace(&mut self, direction: char, bytes: &[u8]) {
        let now = self.clock.now();
        let since = now.saturating_sub(self.traced_at).as_secs_f64() * 1000.0;
        self.traced_at = now;
        trace!("{direction} {since:>9.3} ms  {}", Hex(bytes));
    }

    fn hang_up(&mut self) -> Result<State, ServeError> {
        self.answer_at = None;
        let Some((client, _)) = self.asker else {
            return Ok(State::Serving);
        };
        info!("hung up");
        self.forget(client);
        Ok(match self.outside.hang_up(client)? {
            Afterwards::Open => State::Serving,
            Afterwards::Closed => State::HungUp,
        })
    }

    fn forget(&mut self, client: ClientId) {
        self.cutters.remove(&client);
        self.waiting.retain(|request| request.client != client);
        if self.asker.is_some_and(|(asker, _)| asker == client) {
            self.asker = None;
        }
    }

    fn has_heard_all(&self) -> bool {
        let heard = self.tally.requests();
        self.service.count.is_some_and(|count| heard >= count)
    }

    /// Whether the line has nothing more to say.
    fn is_quiet(&self) -> bool {
        self.line.next_due().is_none() && self.answer_at.is_none()
    }

    /// Whether nothing more is to be heard, or said: however late an answer is, it is waited for.
    fn is_done(&self) -> bool {
        let has_ended = self.answer_at.is_none() && self.line.next_due_of_what_ends().is_none();
        self.has_heard_all() && has_ended && (self.is_quiet() || self.has_gone_on_for_ever())
    }

    /// What has no end does not keep the server.
    fn has_gone_on_for_ever(&self) -> bool {
        const LONGEST: Duration = Duration::from_secs(10);
        self.clock.now() >= self.asked_at.saturating_add(LONGEST)
    }
}
