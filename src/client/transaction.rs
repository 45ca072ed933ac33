//! A client on a line: what it remembers, and how it waits for what may still come.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use jiff::Timestamp;
use log::info;

use super::answer_times::AnswerTimes;
use super::attempt::{Asked, forget_oldest};
use super::belief::{self, Echo};
use super::counters::{Counters, Ledger};
use super::debts::{Debts, Next};
use super::failure::Failure;
use super::patience::Patience;
use super::recent::Recent;
use crate::codec::{ExceptionCode, Frame, FunctionCode, Reply, Request, Unit};
use crate::transport::Line;

/// Allowance for adapters that hold bytes back: two of the 16 ms periods of a common USB chip.
pub(super) const ADAPTER_LATENCY: Duration = Duration::from_millis(32);

/// Waits are cut into pieces of this length where the program may be stopped meanwhile.
const PIECE: Duration = Duration::from_millis(50);

/// A Modbus client on one line.
pub struct Client {
    pub(super) line: Line,
    pub(super) echo: Echo,
    /// Whether the line echoes; unknown until an echo was seen, or an answer with nothing before
    /// it.
    pub(super) echoes: Option<bool>,
    /// Whether anything was sent yet: the pause is one between requests.
    pub(super) sent: bool,
    pub(super) debts: Debts,
    pub(super) recent: Recent,
    /// How many loop-backs have served as barriers.
    pub(super) barriers: u16,
    pub(super) answer_times: AnswerTimes,
    pub(super) ledger: Ledger,
    /// Raised when the program is to stop.
    stop: Option<Arc<AtomicBool>>,
}

impl Client {
    /// Takes over a line.
    pub fn new(line: Line, echo: Echo) -> Self {
        Self {
            line,
            echo,
            echoes: None,
            sent: false,
            debts: Debts::default(),
            recent: Recent::default(),
            barriers: 0,
            answer_times: AnswerTimes::default(),
            ledger: Ledger::default(),
            stop: None,
        }
    }

    /// From now on, once `stop` is raised, waits no longer than it must: half a second for the answer
    /// to what it has sent, and for nothing else.
    pub fn stop_when(&mut self, stop: Arc<AtomicBool>) {
        self.stop = Some(stop);
    }

    /// Whether the program is to stop.
    pub(super) fn is_stopping(&self) -> bool {
        let stop = self.stop.as_ref();
        stop.is_some_and(|stop| stop.load(Ordering::Relaxed))
    }

    /// As much of a wait as may pass before somebody looks whether the program is to stop.
    pub(super) fn piece_of(&self, wait: Duration) -> Duration {
        match &self.stop {
            Some(_) => wait.min(PIECE),
            None => wait,
        }
    }

    /// The time in UTC, from the line's clock.
    pub fn utc_now(&self) -> Timestamp {
        self.line.utc_now()
    }

    /// How long a unit takes to begin its answer to a read, beyond the t3.5 after which it knows that
    /// the request has ended: the median of its last answers on this line, `None` before the first.
    pub fn answer_time(&self, unit: Unit) -> Option<Duration> {
        self.answer_times.median(unit)
    }

    /// Whether the line sends our own bytes back, as far as that has shown; `None` before.
    pub const fn echoes(&self) -> Option<bool> {
        self.echoes
    }

    /// Whether the port is lost, as far as that has been noticed.
    pub const fn is_lost(&self) -> bool {
        self.line.loss().is_some()
    }

    /// What has been counted of a unit so far.
    pub fn counters(&self, unit: Unit) -> Counters {
        self.ledger.get(unit)
    }

    /// Sends one loop-back (function 08, sub-function 0) and returns how long the unit took to
    /// begin its answer, beyond the t3.5 after which it knows that the request has ended. One attempt;
    /// what is still owed for earlier requests, the same included, is waited for first.
    ///
    /// # Errors
    /// [`Failure`], of which an exception is one.
    pub fn loop_back(
        &mut self,
        unit: Unit,
        word: u16,
        patience: Patience,
    ) -> Result<Duration, Failure> {
        let asked = Asked::new(unit, Request::ReturnQueryData(word), patience);
        self.regain(patience)?;
        self.settle(Next::Unlike(unit))?;
        let answer = self.attempt(&asked, patience.pause)?;
        self.take(unit, &asked.frame, &answer.reply);
        match answer.reply {
            Reply::Normal(_) => Ok(answer.took),
            Reply::Exception { code, .. } => Err(Failure::Exception(code)),
        }
    }

    /// Waits for what other units may still answer, which a request of this one waits for anyway: so
    /// that the time at which reading it begins is the time at which it is asked. A port that is lost
    /// shows when it is.
    pub fn let_others_finish(&mut self, unit: Unit) {
        if self.line.loss().is_none() {
            let _ = self.settle(Next::AnyOf(unit));
        }
    }

    /// Leaves the line, and lets no late answer be taken for one to whoever opens it next: what
    /// may still come is waited for. Takes no time when every request was answered, or when the
    /// port was lost already.
    ///
    /// # Errors
    /// [`Failure::Port`] when the port is lost meanwhile.
    pub fn finish(mut self) -> Result<(), Failure> {
        let settled = if self.line.loss().is_some() {
            Ok(())
        } else {
            self.say_what_is_owed();
            self.settle(Next::Nothing)
        };
        for (unit, counters) in self.ledger.all() {
            info!("unit {unit}: {counters}");
        }
        settled
    }

    fn say_what_is_owed(&mut self) {
        let until = self.debts.wait_until(Next::Nothing, self.line.now());
        if until.is_some() {
            info!("waiting for answers that may still come");
        }
    }

    /// Waits for the answers that earlier attempts may still get, and throws them away, as far as
    /// `next` asks for it.
    pub(super) fn settle(&mut self, next: Next<'_>) -> Result<(), Failure> {
        let mut received = Vec::new();
        // What came in time has come in time, even when nobody has looked for a while.
        let mut wait = Duration::ZERO;
        while self.debts.is_owed() {
            self.line.receive_into(&mut received, wait)?;
            while let Some(late) = self.debts.late_in(&received, None, self.echo, self.echoes) {
                info!("unit {}: a late answer was thrown away", late.unit);
                received.drain(..late.end);
                self.ledger.of(late.unit).late += 1;
                self.take(late.unit, &late.frame, &late.reply);
            }
            forget_oldest(&mut received);
            if self.is_stopping() {
                break;
            }
            let Some(until) = self.debts.wait_until(next, self.line.now()) else {
                break;
            };
            wait = self.piece_of(until.saturating_sub(self.line.now()));
        }
        self.debts.expire(self.line.now());
        Ok(())
    }

    /// Takes an answer as paid, and remembers it, for a second copy of it may follow. What a gateway
    /// says pays nothing: the unit behind it can still answer. A unit that is at work may do so as
    /// well. After an answer to a loop-back nothing asked before comes any more: a meter answers one
    /// request after the other, and what carries its bytes keeps their order.
    pub(super) fn take(&mut self, unit: Unit, frame: &Frame, reply: &Reply) {
        if reply.exception().is_some_and(ExceptionCode::is_of_gateway) {
            return;
        }
        let now = self.line.now();
        self.recent.note(now, unit, frame, reply);
        if reply.exception().is_some_and(ExceptionCode::is_at_work) {
            self.debts.put_off(unit, frame);
        } else if reply.function() == FunctionCode::Diagnostics && self.knows_echo() {
            self.debts.answered_at_last(unit, frame);
        } else {
            self.debts.answered(unit, frame, now);
        }
    }

    /// How long the normal answer to a request takes on the wire.
    pub(super) fn transfer_time(&self, request: &Request) -> Duration {
        let timing = self.line.timing();
        timing.transfer_time(belief::answer_length(request))
    }

    /// Whether it is known if the own bytes come back, so that an answer that looks like the
    /// request can be told from its echo.
    pub fn knows_echo(&self) -> bool {
        self.echo != Echo::Auto || self.echoes.is_some()
    }
}
