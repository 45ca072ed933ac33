//! Writes: sent once, and what is known of them afterwards.
//!
//! A lost answer does not mean a lost request, and to do a thing twice is another thing: clearing a
//! counter, closing a relay, setting a clock. So a write has one attempt. Only a unit that says that
//! it is busy (06) has done nothing and is asked again. All else is told as it is: confirmed, refused,
//! unknown.

use std::time::Duration;

use jiff::Timestamp;
use log::info;
use thiserror::Error;

use super::attempt::Asked;
use super::debts::Next;
use super::failure::Failure;
use super::patience::Patience;
use super::request::BUSY_WAITS;
use super::transaction::Client;
use crate::codec::rtu;
use crate::codec::{Broadcast, ExceptionCode, Reply, Request, Response, Unit, Write};
use crate::transport::line::Quiet;

/// The turnaround that is kept whoever wants the program to stop (SL 2.4.1).
const LEAST_TURNAROUND: Duration = Duration::from_millis(200);

/// What a unit has said to a write that it has taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Confirmation {
    /// It is done.
    Done,
    /// It has stored this instead of the value that was sent (function 06).
    Stored(u16),
    /// It has taken it and is still at work (exception 05). Whether it will be done is not known.
    Accepted,
}

/// A write that is not confirmed.
#[derive(Debug, Error)]
pub enum Unwritten {
    /// It was not sent.
    #[error("not sent: {0}")]
    NotSent(Failure),
    /// It was not sent, for the program is to stop.
    #[error("not sent: the program was stopped")]
    Stopped,
    /// The unit, or a gateway before it, has refused it.
    #[error("the meter refused: {0}")]
    Refused(ExceptionCode),
    /// It was sent and may have been carried out or not.
    #[error("outcome unknown: {0}")]
    Unknown(Failure),
}

impl Client {
    /// Sends a write to one unit, once. What earlier requests may still bring is waited for first, so
    /// that it is not taken for the answer. Where it is not known whether the line echoes, one copy of
    /// a write that its answer repeats (functions 05, 06) confirms nothing: ask something else first.
    ///
    /// # Errors
    /// [`Unwritten`] tells what is known of it.
    pub fn write(
        &mut self,
        unit: Unit,
        write: &Write,
        patience: Patience,
    ) -> Result<Confirmation, Unwritten> {
        self.write_made(unit, &|_| write.clone(), patience)
    }

    /// The same for a write that depends on the time at which it has left the line: `make` makes it, and
    /// again each time that the unit was busy.
    ///
    /// # Errors
    /// As [`Self::write`].
    pub fn write_made(
        &mut self,
        unit: Unit,
        make: &dyn Fn(Timestamp) -> Write,
        patience: Patience,
    ) -> Result<Confirmation, Unwritten> {
        let mut asked = Asked::new(unit, Request::Write(make(self.utc_now())), patience);
        self.regain(patience).map_err(Unwritten::NotSent)?;
        self.settle(Next::Unlike(unit))
            .map_err(Unwritten::NotSent)?;
        if self.is_doubtful(&asked) {
            self.make_sure(&asked).map_err(Unwritten::NotSent)?;
        }
        let give_up = self.line.now() + patience.in_all();
        let mut busy_waits = BUSY_WAITS.iter();
        let mut pause = patience.pause;
        let mut is_first = true;
        loop {
            let silent = self.wait_for_silence(&asked, pause);
            silent.map_err(|failure| {
                self.count(unit, Some(&failure));
                Unwritten::NotSent(failure)
            })?;
            // Whoever stops the program does not want it to be done from now on.
            if self.is_stopping() {
                return Err(if is_first {
                    Unwritten::Stopped
                } else {
                    Unwritten::Refused(ExceptionCode::SERVER_DEVICE_BUSY)
                });
            }
            let write = make(self.leaves_at(asked.frame.as_bytes().len()));
            asked = Asked::new(unit, Request::Write(write.clone()), patience);
            let result = self.exchange(&asked);
            self.count(unit, result.as_ref().err());
            let mut reply = result.map_err(Unwritten::Unknown)?.reply;
            self.take(unit, &asked.frame, &reply);
            if !is_first && reply.exception() == Some(ExceptionCode::SERVER_DEVICE_BUSY) {
                let later = self.hear_out(&asked).map_err(Unwritten::Unknown)?;
                reply = later.unwrap_or(reply);
            }
            is_first = false;
            let code = match reply {
                Reply::Normal(response) => return Ok(confirmation(&write, &response)),
                Reply::Exception { code, .. } => code,
            };
            match code {
                ExceptionCode::ACKNOWLEDGE => return Ok(Confirmation::Accepted),
                // The unit behind the gateway may have carried it out.
                ExceptionCode::GATEWAY_TARGET_DEVICE_FAILED_TO_RESPOND => {
                    return Err(Unwritten::Unknown(Failure::Exception(code)));
                }
                ExceptionCode::SERVER_DEVICE_BUSY => self.ledger.of(unit).busy += 1,
                _ => return Err(Unwritten::Refused(code)),
            }
            let in_time = |wait: &&Duration| self.line.now() + **wait < give_up;
            let wait = busy_waits.next().filter(in_time);
            let Some(wait) = wait.filter(|_| !self.is_stopping()) else {
                return Err(Unwritten::Refused(code));
            };
            info!(
                "unit {unit}: busy, it has done nothing; writing again in {} ms",
                wait.as_millis()
            );
            pause = pause.max(*wait);
            self.ledger.of(unit).retries += 1;
        }
    }

    /// When a frame of so many bytes will have left the line that is sent now.
    fn leaves_at(&self, bytes: usize) -> Timestamp {
        self.utc_now() + self.line.timing().transfer_time(bytes)
    }

    /// Listens for an answer behind one that says that the unit is busy, for the time-out: a second copy
    /// of the one before, as a repeater makes them, says so too while the write is carried out.
    fn hear_out(&mut self, asked: &Asked) -> Result<Option<Reply>, Failure> {
        let until = self.line.now() + asked.patience.timeout;
        loop {
            let left = until.saturating_sub(self.line.now());
            let Some(reply) = self.overhear(asked, left)? else {
                return Ok(None);
            };
            self.take(asked.unit, &asked.frame, &reply);
            if reply.exception() != Some(ExceptionCode::SERVER_DEVICE_BUSY) {
                return Ok(Some(reply));
            }
        }
    }

    /// Sends a write to all units at once, and lets `turnaround` pass, in which they carry it out and
    /// say nothing (SL 2.4.1: usually 100 to 200 ms); not all of it once the program is to stop. It is
    /// never repeated. `make` makes it as it is right at the time when it will have left the line, which
    /// is returned.
    ///
    /// # Errors
    /// [`Unwritten`], of which no unit can be the cause.
    pub fn broadcast(
        &mut self,
        make: &dyn Fn(Timestamp) -> Write,
        turnaround: Duration,
        patience: Patience,
    ) -> Result<Timestamp, Unwritten> {
        self.regain(patience).map_err(Unwritten::NotSent)?;
        // Whoever is late would be talked over, and would not hear it.
        self.settle(Next::Nothing).map_err(Unwritten::NotSent)?;
        match self.wait_quiet(patience.pause, patience.timeout) {
            Ok(Quiet::Reached { .. }) => {}
            Ok(Quiet::Never { discarded }) => {
                return Err(Unwritten::NotSent(Failure::NeverQuiet { discarded }));
            }
            Err(lost) => return Err(Unwritten::NotSent(lost.into())),
        }
        if self.is_stopping() {
            return Err(Unwritten::Stopped);
        }
        let frame = |time| rtu::encode_broadcast(Broadcast, &make(time));
        let left_at = self.leaves_at(frame(self.utc_now()).as_bytes().len());
        info!("broadcasting {}", frame(left_at));
        let unknown = |lost| Unwritten::Unknown(Failure::Port(lost));
        let sent = self.line.send(frame(left_at).as_bytes()).map_err(unknown)?;
        self.sent = true;
        let (least, until) = (sent + LEAST_TURNAROUND.min(turnaround), sent + turnaround);
        let mut heard = Vec::new();
        loop {
            let now = self.line.now();
            let until = if self.is_stopping() { least } else { until };
            let left = until.saturating_sub(now);
            if left.is_zero() {
                return Ok(left_at);
            }
            let wait = self.piece_of(left);
            self.line.receive_into(&mut heard, wait).map_err(unknown)?;
            heard.clear();
        }
    }
}

/// What an answer says that belief has let pass.
fn confirmation(write: &Write, response: &Response) -> Confirmation {
    match (write, response) {
        (Write::Register { value, .. }, Response::Register { value: stored, .. })
            if value != stored =>
        {
            Confirmation::Stored(*stored)
        }
        _ => Confirmation::Done,
    }
}
