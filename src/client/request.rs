//! A request until it is answered or has failed for good: retries, and how a late answer to
//! something else is told from the right one.
//!
//! # What tells a late answer, what that costs and what it proves
//!
//! * *Waiting* before something else is asked (`debts`): costs as much again as the time-out, once
//!   for each request that failed, and less when the late answer is seen. It proves nothing about an
//!   answer that comes later still. It is always done all the same: a meter that is late would else
//!   be talked over, and would not hear the next request.
//! * *The same request again*: costs nothing, and proves all, for whichever answer comes is right.
//!   So a retry is byte for byte the request that failed.
//! * *The other of the functions 03 and 04*, where both read the same registers: costs nothing. An
//!   answer to what was asked before has the wrong function, however late it comes. It is used for as
//!   long as late answers are remembered, and serves for one failure in that time; when the other
//!   function is owed an answer as well, there is nothing left to alternate with.
//! * *A loop-back* (function 08): costs a transaction, 25 to 70 ms at 9600 baud with most meters,
//!   and a time-out where the unit is silent. Its answer proves that nothing asked before will be
//!   answered any more: a meter answers one request after the other, and what carries its bytes
//!   keeps their order. Needed where the functions cannot be alternated, or both are owed answers.
//!   When it meets silence the request is not even sent: the unit would most likely not answer that
//!   either. A meter that does not have the function after all is lost for no longer than late
//!   answers are remembered.
//! * *A second look*: what is, byte for byte, what the unit has just answered to something else may be
//!   a second copy of that, as a repeater or a gateway can make it: registers or a refusal. It is asked
//!   for once more. Costs one transaction, and only where two answers are equal. Where copies come
//!   again, the time by which they come later is kept free behind every answer for a minute. The
//!   same question asked again at once uses the other function, where there is one.
//!
//! A unit that says that it is busy (06), or still at work (05), has not answered: should it do so all
//! the same, that is told like a late answer. A gateway's word (0A, 0B) is none of the unit's.
//!
//! The first two always, then the functions, then the loop-back: the cheapest first. For a meter of
//! which nothing is known only waiting is left, and an answer that is later than that and as long as
//! the next one is believed: nothing in a frame tells it from the right one.

use std::time::Duration;

use log::info;

use super::attempt::Asked;
use super::debts::Next;
use super::failure::Failure;
use super::patience::{Patience, QueryData};
use super::transaction::Client;
use crate::codec::{ExceptionCode, Reply, Request, Response, Unit};

/// How long to wait before a unit that was busy is asked again, time after time.
pub(super) const BUSY_WAITS: [Duration; 3] = [
    Duration::from_millis(100),
    Duration::from_millis(200),
    Duration::from_millis(400),
];

/// The first word of a loop-back that serves as a barrier, where any word does: unlike noise.
const FIRST_BARRIER: u16 = 0xA5C2;

/// So often registers are asked for once more that were the answer to something else.
const MOST_LOOKS: usize = 4;

/// An answer that may be a second copy of another.
struct Doubtful {
    reply: Reply,
    /// How long ago the other was believed.
    age: Duration,
}

impl Client {
    /// Sends a request that changes nothing and returns its answer, repeating it when the line
    /// fails or the unit is busy. A port that was lost is opened again first: it is waited for as
    /// long as the attempts would take, [`Patience::timeout`] each.
    ///
    /// # Errors
    /// [`Failure`] of the last attempt. A request during which the port is lost is never repeated.
    pub fn request(
        &mut self,
        unit: Unit,
        request: &Request,
        patience: Patience,
    ) -> Result<Response, Failure> {
        self.repeat(unit, request, patience, false)
    }

    /// The same for a request that the unit may not answer however often it is asked: a first
    /// attempt that meets silence is the last one.
    ///
    /// # Errors
    /// As [`Self::request`].
    pub fn try_request(
        &mut self,
        unit: Unit,
        request: &Request,
        patience: Patience,
    ) -> Result<Response, Failure> {
        self.repeat(unit, request, patience, true)
    }

    fn repeat(
        &mut self,
        unit: Unit,
        request: &Request,
        patience: Patience,
        ends_with_silence: bool,
    ) -> Result<Response, Failure> {
        let wanted = Asked::new(unit, request.clone(), patience);
        self.regain(patience)?;
        let mut asked = self.told_apart(&wanted)?;
        let give_up = self.line.now() + patience.in_all();
        let mut retries = 1..=patience.retries;
        let mut busy_waits = BUSY_WAITS.iter();
        let mut faults_of_memory = 1..=1;
        let mut doubtful = Vec::new();
        let mut pause = patience.pause;
        loop {
            let answer = self.attempt(&asked, pause);
            pause = patience.pause;
            let failure = match answer {
                Ok(answer) => match self.believe(&asked, answer.reply, &mut doubtful) {
                    None if doubtful.len() > MOST_LOOKS => {
                        self.hold_for_copies(&asked, &doubtful);
                        doubtful.clear();
                        self.settle(Next::Unlike(unit))?;
                        let found = "only copies of what it answered before".to_owned();
                        Failure::Mismatch { found }
                    }
                    None => continue,
                    Some(Reply::Normal(response)) => return Ok(response),
                    Some(Reply::Exception { code, .. }) => Failure::Exception(code),
                },
                Err(failure) => failure,
            };
            match failure {
                Failure::Exception(ExceptionCode::SERVER_DEVICE_BUSY) => {
                    self.ledger.of(unit).busy += 1;
                    let in_time = |wait: &&Duration| self.line.now() + **wait < give_up;
                    let wait = busy_waits.next().filter(in_time);
                    let Some(wait) = wait.filter(|_| !self.is_stopping()) else {
                        return Err(failure);
                    };
                    info!("unit {unit}: busy, asking again in {} ms", wait.as_millis());
                    pause = pause.max(*wait);
                    continue;
                }
                // A meter may take one function only, whatever its profile says.
                Failure::Exception(code) if asked != wanted && !code.is_of_gateway() => {
                    info!("unit {unit}: refused, asking with the usual function");
                    self.settle(Next::Request(unit, &wanted.frame))?;
                    self.make_sure(&wanted)?;
                    asked = wanted.clone();
                    continue;
                }
                Failure::Exception(ExceptionCode::MEMORY_PARITY_ERROR)
                    if faults_of_memory.next().is_some() =>
                {
                    info!("unit {unit}: {failure}; asking once more");
                }
                failure => {
                    let ends = ends_with_silence && failure.is_silence();
                    let is_worth_it = failure.is_worth_a_retry() && !self.is_stopping();
                    let retry = retries
                        .next()
                        .filter(|retry| is_worth_it && !(ends && *retry == 1));
                    let Some(retry) = retry else {
                        return Err(failure);
                    };
                    info!(
                        "unit {unit}: {failure}; retry {retry} of {}",
                        patience.retries
                    );
                }
            }
            self.ledger.of(unit).retries += 1;
        }
    }

    /// Takes an answer as paid; `None` for one that may be a second copy of another and has to be
    /// asked for once more. `doubtful` holds such ones meanwhile.
    fn believe(
        &mut self,
        asked: &Asked,
        reply: Reply,
        doubtful: &mut Vec<Doubtful>,
    ) -> Option<Reply> {
        if reply.exception().is_some_and(ExceptionCode::is_of_gateway) {
            return Some(reply);
        }
        let now = self.line.now();
        let Asked { unit, frame, .. } = asked;
        let since = now.saturating_sub(asked.patience.of_copies());
        if doubtful.iter().any(|doubtful| doubtful.reply == reply) {
            // Both are answers, and they really are the same.
            self.debts.answered(*unit, frame, now);
        } else if let Some(before) = self.recent.before(since, *unit, frame, &reply) {
            info!("unit {unit}: the same as it answered before, asking once more");
            let age = now.saturating_sub(before);
            doubtful.push(Doubtful { reply, age });
            return None;
        } else if !doubtful.is_empty() {
            self.hold_for_copies(asked, doubtful);
        }
        if let Some(delay) = self.recent.delay(*unit, now) {
            self.debts.hold(*unit, now + delay + delay / 2);
        }
        self.take(*unit, frame, &reply);
        Some(reply)
    }

    /// Answers of the unit come twice: all that is under way by now looks like an answer, and every
    /// answer will from now on.
    fn hold_for_copies(&mut self, asked: &Asked, copies: &[Doubtful]) {
        let delay = copies.iter().map(|copy| copy.age).max().unwrap_or_default();
        let unit = asked.unit;
        info!(
            "unit {unit}: answers come twice, {} ms later",
            delay.as_millis()
        );
        self.ledger.of(unit).copies += copies.len() as u64;
        let now = self.line.now();
        self.recent.learn_delay(now, unit, delay);
        self.debts.hold(unit, now + asked.patience.at_the_most());
    }

    /// The form of a request of which no late answer to something else can be taken for its
    /// answer, as far as the meter's ways give one; and waits as long as that needs.
    fn told_apart(&mut self, wanted: &Asked) -> Result<Asked, Failure> {
        let Asked { unit, patience, .. } = *wanted;
        let other = patience
            .ways
            .interchangeable_reads
            .then(|| wanted.request.with_other_function())
            .flatten()
            .map(|request| Asked::new(unit, request, patience));
        let forms = || std::iter::once(wanted).chain(&other);
        let same = forms().find(|form| self.debts.awaits(unit, &form.frame));
        let first = same.unwrap_or(wanted);
        self.settle(Next::Request(unit, &first.frame))?;
        if same.is_some() {
            return Ok(first.clone());
        }
        // A second copy of the answer to the same question is told by the function as well.
        let since = self.line.now().saturating_sub(patience.at_the_most());
        let sure = forms()
            .filter(|form| !self.is_doubtful(form))
            .min_by_key(|form| self.recent.is_repeated(since, unit, &form.frame));
        if let Some(form) = sure {
            return Ok(form.clone());
        }
        self.make_sure(wanted)?;
        Ok(wanted.clone())
    }

    pub(super) fn is_doubtful(&self, asked: &Asked) -> bool {
        self.debts.doubt(asked.unit, &asked.request, &asked.frame)
    }

    /// Makes as sure as can be that no late answer is taken for the one to this, by a loop-back where
    /// the meter has it and its answer cannot be its echo.
    ///
    /// # Errors
    /// [`Failure`] of the loop-back, or [`Failure::Ambiguous`] where it has proved nothing.
    pub(super) fn make_sure(&mut self, wanted: &Asked) -> Result<(), Failure> {
        if let Some(data) = wanted.patience.ways.loopback
            && self.knows_echo()
        {
            // The answer can be that to a loop-back before, and proves no more than that one then.
            let owed = self.debts.loop_backs(wanted.unit);
            let mut barriers = 0..=owed;
            while self.is_doubtful(wanted) {
                if barriers.next().is_none() {
                    return Err(Failure::Ambiguous);
                }
                self.loop_back_first(wanted, data)?;
            }
            return Ok(());
        }
        // What is left of the doubt nothing can remove.
        self.debts.forget(wanted.unit, wanted.request.function());
        Ok(())
    }

    fn loop_back_first(&mut self, wanted: &Asked, data: QueryData) -> Result<(), Failure> {
        let Asked { unit, patience, .. } = *wanted;
        info!("unit {unit}: sending a loop-back, behind which no late answer comes");
        let mut retries = 0..patience.retries;
        loop {
            let barrier = Request::ReturnQueryData(self.barrier(data));
            let barrier = Asked::new(unit, barrier, patience);
            let failure = match self.attempt(&barrier, patience.pause) {
                Ok(answer) => {
                    self.take(unit, &barrier.frame, &answer.reply);
                    match answer.reply.exception() {
                        Some(code) if code.is_of_gateway() => Failure::Exception(code),
                        _ => return Ok(()),
                    }
                }
                Err(failure) => failure,
            };
            let can_help = failure.is_worth_a_retry() && !failure.is_silence();
            if !can_help || retries.next().is_none() {
                return Err(failure);
            }
            self.ledger.of(unit).retries += 1;
        }
    }

    /// The word of a loop-back: another one each time, where the meter takes any, so that a late one
    /// is told from it.
    const fn barrier(&mut self, data: QueryData) -> u16 {
        match data {
            QueryData::Zero => 0,
            QueryData::Any => {
                self.barriers = self.barriers.wrapping_add(1);
                FIRST_BARRIER ^ self.barriers
            }
        }
    }
}
