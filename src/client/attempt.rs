//! One attempt: a request goes out once, and its one answer is waited for.

use std::time::Duration;

use log::info;

use super::answer_times::Arrivals;
use super::belief::{self, Certainty, Echo, Evidence, Expectation, Verdict};
use super::failure::Failure;
use super::patience::Patience;
use super::transaction::{ADAPTER_LATENCY, Client};
use crate::codec::rtu::{self, Frame};
use crate::codec::{Reply, Request, Unit};
use crate::transport::TransportError;
use crate::transport::line::Quiet;

/// A gap this long after a damaged answer means that nothing more comes: six periods of an adapter
/// that holds bytes back.
const GAP: Duration = Duration::from_millis(100);

/// How long an answer is still waited for once the program is to stop: longer than any of the four
/// meters usually takes.
const LAST_WAIT: Duration = Duration::from_millis(500);

/// Unrecognised bytes are kept up to this many, the longest frame behind a longest frame of noise;
/// older ones are let go, so that endless noise costs no memory.
const MOST_RECEIVED: usize = 512;

/// Up to so many bytes of noise are kept with what is behind them, which tells when that came.
const MOST_NOISE: usize = 64;

/// Fewer stray bytes than the shortest frame has are noise on an idle line, not a damaged answer.
const SHORTEST_FRAME: usize = 4;

/// One request on its way.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Asked {
    pub(super) unit: Unit,
    pub(super) request: Request,
    pub(super) frame: Frame,
    pub(super) patience: Patience,
}

impl Asked {
    pub(super) fn new(unit: Unit, request: Request, patience: Patience) -> Self {
        let frame = rtu::encode_request(unit, &request);
        Self {
            unit,
            request,
            frame,
            patience,
        }
    }

    fn expectation(&self, echo: Echo, echoes: Option<bool>) -> Expectation<'_> {
        Expectation::new(self.unit, &self.request, &self.frame, echo, echoes)
    }
}

/// An answer that is believed.
pub(super) struct Answer {
    pub(super) reply: Reply,
    /// How long the unit took to begin it, beyond the t3.5 behind the request.
    pub(super) took: Duration,
}

/// Why listening has ended without an answer.
enum End {
    Lost(TransportError),
    TimeIsUp,
}

/// What has been heard since the request went out.
#[derive(Default)]
struct Heard {
    received: Vec<u8>,
    arrivals: Arrivals,
    evidence: Evidence,
    /// Bytes that were let go: they belong to nothing.
    forgotten: usize,
    /// Answers to earlier requests were cut out, with all that was before them.
    is_cut: bool,
}

impl Client {
    /// Sends a request once, after the silence and `pause`, and waits for its answer. The answer is
    /// still owed when this returns: whether it pays is the caller's to say.
    pub(super) fn attempt(&mut self, asked: &Asked, pause: Duration) -> Result<Answer, Failure> {
        let silent = if self.is_stopping() {
            Err(Failure::Stopped)
        } else {
            self.wait_for_silence(asked, pause)
        };
        let result = silent.and_then(|()| self.exchange(asked));
        self.count(asked.unit, result.as_ref().err());
        result
    }

    /// Counts an attempt that has ended like this.
    pub(super) fn count(&mut self, unit: Unit, failure: Option<&Failure>) {
        let counters = self.ledger.of(unit);
        match failure {
            None => counters.answers += 1,
            Some(failure) => counters.fail(failure),
        }
    }

    /// Waits until the line is silent for as long as a request needs it to be, and for `pause`; when
    /// this fails, nothing has been sent.
    pub(super) fn wait_for_silence(
        &mut self,
        asked: &Asked,
        pause: Duration,
    ) -> Result<(), Failure> {
        match self.wait_quiet(pause, asked.patience.timeout)? {
            Quiet::Never { discarded } => return Err(Failure::NeverQuiet { discarded }),
            Quiet::Reached { discarded: 0 } => {}
            Quiet::Reached { discarded } => {
                self.ledger.of(asked.unit).stray += discarded as u64;
                info!("{discarded} stray bytes thrown away");
            }
        }
        Ok(())
    }

    /// Waits until the line is silent, at most for `limit`, and no longer once the program is to stop.
    /// The pause is one between requests.
    pub(super) fn wait_quiet(
        &mut self,
        pause: Duration,
        limit: Duration,
    ) -> Result<Quiet, TransportError> {
        let pause = if self.sent { pause } else { Duration::ZERO };
        let give_up = self.line.now() + limit;
        let mut thrown_away = 0;
        loop {
            let left = give_up.saturating_sub(self.line.now());
            match self.line.wait_quiet(pause, self.piece_of(left))? {
                Quiet::Reached { discarded } => {
                    return Ok(Quiet::Reached {
                        discarded: thrown_away + discarded,
                    });
                }
                Quiet::Never { discarded } => thrown_away += discarded,
            }
            if self.is_stopping() || self.line.now() >= give_up {
                return Ok(Quiet::Never {
                    discarded: thrown_away,
                });
            }
        }
    }

    /// Sends a request on a silent line and waits for its answer. When this fails, the request may
    /// have been heard all the same.
    pub(super) fn exchange(&mut self, asked: &Asked) -> Result<Answer, Failure> {
        let sent = self.line.send(asked.frame.as_bytes())?;
        self.sent = true;
        self.ledger.of(asked.unit).requests += 1;
        let transfer = self.transfer_time(&asked.request);
        let owed = (asked.unit, &asked.request, &asked.frame);
        self.debts.owe(owed, asked.patience, sent, transfer);
        let mut heard = Heard::default();
        let result = self.listen(asked, sent, &mut heard);
        heard.evidence.stray += heard.forgotten;
        let counters = self.ledger.of(asked.unit);
        counters.echoes += heard.evidence.echoes as u64;
        counters.others += heard.evidence.others as u64;
        let reply = match result {
            Ok(reply) => reply,
            Err(End::Lost(error)) => return Err(error.into()),
            Err(End::TimeIsUp) => {
                let failure = self.give_up(asked, &heard);
                // Else they are the answer's own.
                if failure.is_silence() {
                    self.ledger.of(asked.unit).stray += heard.evidence.stray as u64;
                }
                return Err(failure);
            }
        };
        self.ledger.of(asked.unit).stray += heard.evidence.stray as u64;
        if heard.evidence.stray > 0 {
            info!(
                "{} stray bytes before the answer skipped",
                heard.evidence.stray
            );
        }
        let now = self.line.now();
        let in_all = now.saturating_sub(sent).as_secs_f64() * 1000.0;
        let is_first = self.debts.count(asked.unit) == 1;
        let took = self.measure(asked, sent, &heard);
        if is_first {
            info!("unit {}: answered in {in_all:.1} ms", asked.unit);
            // A refusal tells nothing of how long an answer takes, nor does a loop-back.
            if let (Reply::Normal(_), Some(took)) = (&reply, took)
                && !belief::is_mirrored(&asked.request)
            {
                self.answer_times.note(asked.unit, took);
            }
        } else {
            info!(
                "unit {}: answered, perhaps to an earlier attempt",
                asked.unit
            );
        }
        Ok(Answer {
            reply,
            took: took.unwrap_or_else(|| now.saturating_sub(sent)),
        })
    }

    /// One more answer to what was asked before, which begins within that time; `None` when none does.
    pub(super) fn overhear(
        &mut self,
        asked: &Asked,
        within: Duration,
    ) -> Result<Option<Reply>, Failure> {
        let patience = Patience {
            timeout: within,
            ..asked.patience
        };
        let asked = Asked {
            patience,
            ..asked.clone()
        };
        let now = self.line.now();
        match self.listen(&asked, now, &mut Heard::default()) {
            Ok(reply) => Ok(Some(reply)),
            Err(End::TimeIsUp) => Ok(None),
            Err(End::Lost(error)) => Err(error.into()),
        }
    }

    /// Receives until the answer is there. It must begin within the time-out; one that has begun
    /// gets its transfer time on top.
    fn listen(&mut self, asked: &Asked, sent: Duration, heard: &mut Heard) -> Result<Reply, End> {
        let begin_by = sent + asked.patience.timeout;
        let end_by = begin_by + self.transfer_time(&asked.request) + ADAPTER_LATENCY;
        let mut deadline = begin_by;
        let mut stop_by = None;
        loop {
            if self.is_stopping() {
                stop_by.get_or_insert(self.line.now() + LAST_WAIT);
            }
            deadline = stop_by.map_or(deadline, |stop_by| deadline.min(stop_by));
            let left = deadline.saturating_sub(self.line.now());
            // At the deadline one last look: a process that was held up has bytes waiting.
            let came = self
                .line
                .receive_into(&mut heard.received, self.piece_of(left))
                .map_err(End::Lost)?;
            if came == 0 && left.is_zero() {
                return Err(End::TimeIsUp);
            }
            if came == 0 {
                continue;
            }
            let is_whole = heard.forgotten == 0 && heard.received.len() <= MOST_RECEIVED;
            heard.arrivals.note(came, self.line.now(), is_whole);
            if let Some(reply) = self.judge(asked, heard) {
                return Ok(reply);
            }
            // Noise is not looked at again with every byte that comes.
            if heard.received.len() > MOST_NOISE {
                let useless = asked
                    .expectation(self.echo, self.echoes)
                    .useless(&heard.received);
                heard.received.drain(..useless);
                heard.forgotten += useless;
                heard.evidence.stray = heard.evidence.stray.saturating_sub(useless);
            }
            heard.forgotten += forget_oldest(&mut heard.received);
            if left.is_zero() {
                return Err(End::TimeIsUp);
            }
            deadline = if heard.evidence.has_begun() {
                end_by
            } else if heard.evidence.damaged >= Some(Certainty::Likely) {
                begin_by.min(self.line.now() + GAP)
            } else {
                begin_by
            };
        }
    }

    /// The answer, if it is there; answers to what was asked before are dropped.
    fn judge(&mut self, asked: &Asked, heard: &mut Heard) -> Option<Reply> {
        loop {
            let expectation = asked.expectation(self.echo, self.echoes);
            match expectation.judge(&heard.received) {
                Verdict::Answer(reply, before) => {
                    heard.evidence = before;
                    self.learn_echo(&heard.evidence);
                    if self.is_clean(asked, heard) {
                        self.echoes = Some(false);
                    }
                    return Some(reply);
                }
                Verdict::Waiting(found) => heard.evidence = found,
            }
            self.learn_echo(&heard.evidence);
            // A frame of the unit that does not answer this may answer what was asked before.
            heard.evidence.mismatch.as_ref()?;
            let others = Some((asked.unit, &asked.frame));
            let late = self
                .debts
                .late_in(&heard.received, others, self.echo, self.echoes)?;
            info!(
                "unit {}: an answer to an earlier request was dropped",
                late.unit
            );
            self.ledger.of(late.unit).late += 1;
            self.take(late.unit, &late.frame, &late.reply);
            heard.received.drain(..late.end);
            heard.arrivals = Arrivals::useless();
            heard.is_cut = true;
        }
    }

    /// How long the unit took to begin an answer to a request that had left at `sent`; `None` when
    /// the bytes do not tell.
    fn measure(&self, asked: &Asked, sent: Duration, heard: &Heard) -> Option<Duration> {
        let Evidence { echoes, stray, .. } = heard.evidence;
        let countable = Evidence {
            echoes,
            stray,
            ..Evidence::default()
        };
        if heard.evidence != countable {
            return None;
        }
        let first = echoes * asked.frame.as_bytes().len() + stray;
        let (at, count) = heard.arrivals.of(first)?;
        // Bytes that came at once, as adapters deliver them, were on the wire one by one.
        let count = count.min(belief::answer_length(&asked.request));
        let timing = self.line.timing();
        let began = at.saturating_sub(timing.transfer_time(count));
        Some(began.saturating_sub(sent + timing.silence()))
    }

    /// The time is up.
    fn give_up(&mut self, asked: &Asked, heard: &Heard) -> Failure {
        let Evidence {
            stray,
            damaged,
            mismatch,
            ..
        } = &heard.evidence;
        // A line that echoes does so whether or not anybody answers; nothing here can have been an
        // echo that was damaged.
        if *stray < asked.frame.as_bytes().len()
            && damaged.is_none()
            && mismatch.is_none()
            && !heard.is_cut
        {
            self.echoes.get_or_insert(false);
        }
        if heard.evidence.damaged == Some(Certainty::Certain) {
            self.debts.answered_badly(asked.unit, &asked.frame);
        }
        let received = heard.received.len() + heard.forgotten;
        if self.is_stopping() && heard.evidence == Evidence::default() && received == 0 {
            return Failure::Stopped;
        }
        failure(
            &heard.evidence,
            received.min(MOST_RECEIVED),
            asked.patience.timeout,
        )
    }

    fn learn_echo(&mut self, seen: &Evidence) {
        if seen.echoes > 0 && self.echoes != Some(true) {
            info!("the line sends our own bytes back");
            self.echoes = Some(true);
        }
    }

    /// Whether an answer has come with nothing before it, so that the line does not echo: it was
    /// asked for once, so it is no late one that came ahead of the echo.
    fn is_clean(&self, asked: &Asked, heard: &Heard) -> bool {
        self.debts.count(asked.unit) == 1
            && heard.evidence == Evidence::default()
            && heard.forgotten == 0
            && !heard.is_cut
            && !belief::is_mirrored(&asked.request)
    }
}

/// Endless noise costs no memory. Returns how many bytes were let go.
pub(super) fn forget_oldest(received: &mut Vec<u8>) -> usize {
    let oldest = received.len().saturating_sub(MOST_RECEIVED);
    received.drain(..oldest);
    oldest
}

/// What the evidence amounts to when the time is up: the most telling thing first.
fn failure(evidence: &Evidence, received: usize, timeout: Duration) -> Failure {
    if let Some(found) = &evidence.mismatch {
        let found = found.clone();
        return Failure::Mismatch { found };
    }
    if evidence.damaged.is_some() {
        return Failure::Damaged { received };
    }
    // Behind other bytes, a last one like the unit's number is as well noise.
    if let Some((begun, expected)) = evidence.begun
        && (begun > 1 || received == 1)
    {
        return Failure::Truncated {
            received: begun,
            expected,
        };
    }
    if evidence.others == 0 && evidence.stray >= SHORTEST_FRAME {
        return Failure::Damaged { received };
    }
    if evidence.echoes > 0 && evidence.others == 0 {
        return Failure::OnlyEcho;
    }
    Failure::Silence {
        timeout,
        others: evidence.others,
        stray: evidence.stray,
    }
}
