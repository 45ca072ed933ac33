//! Requests and answers over a line: silences, deadline, retries, and what may still come.

use std::time::Duration;

use jiff::Timestamp;
use log::info;

use super::answer_times::{AnswerTimes, Arrivals};
use super::belief::{self, Certainty, Echo, Evidence, Expectation, Verdict};
use super::debts::Debts;
use super::failure::Failure;
use super::regain::regain;
use crate::codec::rtu::{self, Frame};
use crate::codec::{Reply, Request, Response, Unit};
use crate::transport::Line;
use crate::transport::line::Quiet;

/// Allowance for adapters that hold bytes back: two of the 16 ms periods of a common USB chip.
pub(super) const ADAPTER_LATENCY: Duration = Duration::from_millis(32);

/// A gap this long after a damaged answer means that nothing more comes: six of those periods.
const GAP: Duration = Duration::from_millis(100);

/// Unrecognised bytes are kept up to this many, the longest frame behind a longest frame of noise;
/// older ones are let go, so that endless noise costs no memory.
const MOST_RECEIVED: usize = 512;

/// Fewer stray bytes than the shortest frame has are noise on an idle line, not a damaged answer.
const SHORTEST_FRAME: usize = 4;

/// How patient the client is with one meter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Patience {
    /// How long an answer may take to begin; its transfer time comes on top.
    pub timeout: Duration,
    /// How long the meter may take at the worst: as long, past the time-out, nothing else is asked
    /// of a unit that has not answered.
    pub longest_answer: Duration,
    /// How many times a request is repeated when the line fails.
    pub retries: u32,
    /// Least time between the end of anything on the line and the next request; t3.5 is kept
    /// anyway.
    pub pause: Duration,
}

impl Default for Patience {
    /// One second, two retries, no pause.
    fn default() -> Self {
        Self {
            timeout: Duration::from_secs(1),
            longest_answer: Duration::from_secs(1),
            retries: 2,
            pause: Duration::ZERO,
        }
    }
}

/// One request on its way.
#[derive(Clone, Copy)]
struct Asked<'a> {
    unit: Unit,
    request: &'a Request,
    frame: &'a Frame,
    patience: Patience,
}

impl<'a> Asked<'a> {
    fn expectation(&self, echo: Echo, echoes: Option<bool>) -> Expectation<'a> {
        Expectation::new(self.unit, self.request, self.frame, echo, echoes)
    }
}

/// A Modbus client on one line.
pub struct Client {
    line: Line,
    echo: Echo,
    /// Whether the line echoes; unknown until an echo was seen, or an answer with nothing before
    /// it.
    echoes: Option<bool>,
    /// Whether anything was sent yet: the pause is one between requests.
    sent: bool,
    debts: Debts,
    answer_times: AnswerTimes,
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
            answer_times: AnswerTimes::default(),
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

    /// Leaves the line, and lets no late answer be taken for one to whoever opens it next: what
    /// may still come is waited for. Takes no time when every request was answered, or when the
    /// port was lost already.
    ///
    /// # Errors
    /// [`Failure::Port`] when the port is lost meanwhile.
    pub fn finish(mut self) -> Result<(), Failure> {
        if self.line.loss().is_some() {
            return Ok(());
        }
        if self.debts.wait_until(None, self.line.now()).is_some() {
            info!("waiting for answers that may still come");
        }
        self.settle(None)
    }

    /// Sends a request that changes nothing and returns its answer, repeating it when the line
    /// fails. A port that was lost is opened again first: it is waited for as long as the attempts
    /// would take, [`Patience::timeout`] each.
    ///
    /// # Errors
    /// [`Failure`] of the last attempt. An exception is never repeated, nor is a request during
    /// which the port is lost.
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
        let frame = rtu::encode_request(unit, request);
        let asked = Asked {
            unit,
            request,
            frame: &frame,
            patience,
        };
        regain(&mut self.line, patience)?;
        self.settle(Some((unit, &frame)))?;
        let mut retries = 1..=patience.retries;
        loop {
            match self.attempt(asked) {
                Ok(Reply::Normal(response)) => return Ok(response),
                Ok(Reply::Exception { code, .. }) => return Err(Failure::Exception(code)),
                Err(failure) => {
                    let ends = ends_with_silence && failure.is_silence();
                    let retry = retries
                        .next()
                        .filter(|retry| failure.is_worth_a_retry() && !(ends && *retry == 1));
                    let Some(retry) = retry else {
                        return Err(failure);
                    };
                    info!(
                        "unit {unit}: {failure}; retry {retry} of {}",
                        patience.retries
                    );
                }
            }
        }
    }

    fn attempt(&mut self, asked: Asked<'_>) -> Result<Reply, Failure> {
        let Patience { timeout, pause, .. } = asked.patience;
        let pause = if self.sent { pause } else { Duration::ZERO };
        match self.line.wait_quiet(pause, timeout)? {
            Quiet::Never { discarded } => return Err(Failure::NeverQuiet { discarded }),
            Quiet::Reached { discarded: 0 } => {}
            Quiet::Reached { discarded } => info!("{discarded} stray bytes thrown away"),
        }
        let sent = self.line.send(asked.frame.as_bytes())?;
        self.sent = true;
        let transfer = self.transfer_time(asked.request);
        let owed = (asked.unit, asked.request, asked.frame);
        self.debts.owe(owed, asked.patience, sent, transfer);
        self.listen(asked, sent)
    }

    /// Receives until the answer is there. It must begin within the time-out; one that has begun
    /// gets its transfer time on top.
    fn listen(&mut self, asked: Asked<'_>, sent: Duration) -> Result<Reply, Failure> {
        let expectation = asked.expectation(self.echo, self.echoes);
        let timeout = asked.patience.timeout;
        let begin_by = sent + timeout;
        let end_by = begin_by + self.transfer_time(asked.request) + ADAPTER_LATENCY;
        let mut deadline = begin_by;
        let mut received = Vec::new();
        let mut arrivals = Arrivals::default();
        let mut evidence = Evidence::default();
        loop {
            let left = deadline.saturating_sub(self.line.now());
            // At the deadline one last look: a process that was held up has bytes waiting.
            let came = self.line.receive_into(&mut received, left)?;
            if came == 0 && left.is_zero() {
                return Err(self.give_up(asked, evidence, received.len()));
            }
            if came == 0 {
                continue;
            }
            let is_whole = received.len() <= MOST_RECEIVED;
            arrivals.note(came, self.line.now(), is_whole);
            let verdict = expectation.judge(&received);
            forget_oldest(&mut received);
            match verdict {
                Verdict::Answer(reply, before) => {
                    self.learn_echo(&before);
                    if self.is_clean(asked, &before) {
                        self.echoes.get_or_insert(false);
                    }
                    let is_first = self.debts.answers(asked.unit) == 1;
                    self.debts.paid(asked.unit, self.line.now());
                    if before.stray > 0 {
                        info!("{} stray bytes before the answer skipped", before.stray);
                    }
                    let took = self.line.now().saturating_sub(sent).as_secs_f64() * 1000.0;
                    if is_first {
                        self.measure(asked, sent, &reply, &before, &arrivals);
                        info!("unit {}: answered in {took:.1} ms", asked.unit);
                    } else {
                        info!(
                            "unit {}: answered, perhaps to an earlier attempt",
                            asked.unit
                        );
                    }
                    return Ok(reply);
                }
                Verdict::Waiting(found) => evidence = found,
            }
            self.learn_echo(&evidence);
            if left.is_zero() {
                return Err(self.give_up(asked, evidence, received.len()));
            }
            deadline = if evidence.has_begun() {
                end_by
            } else if evidence.damaged >= Some(Certainty::Likely) {
                begin_by.min(self.line.now() + GAP)
            } else {
                begin_by
            };
        }
    }

    /// Notes how long the meter took to begin this answer to a request that had left at `sent`.
    fn measure(
        &mut self,
        asked: Asked<'_>,
        sent: Duration,
        reply: &Reply,
        before: &Evidence,
        arrivals: &Arrivals,
    ) {
        let Evidence { echoes, stray, .. } = *before;
        let is_countable = *before
            == Evidence {
                echoes,
                stray,
                ..Evidence::default()
            };
        // A refusal tells nothing of how long an answer takes.
        if !is_countable || !matches!(reply, Reply::Normal(_)) {
            return;
        }
        let first = echoes * asked.frame.as_bytes().len() + stray;
        let Some((at, count)) = arrivals.of(first) else {
            return;
        };
        // Bytes that came at once, as adapters deliver them, were on the wire one by one.
        let count = count.min(belief::answer_length(asked.request));
        let timing = self.line.timing();
        let began = at.saturating_sub(timing.transfer_time(count));
        let time = began.saturating_sub(sent + timing.silence());
        self.answer_times.note(asked.unit, time);
    }

    /// The time is up.
    fn give_up(&mut self, asked: Asked<'_>, evidence: Evidence, received: usize) -> Failure {
        if evidence.damaged == Some(Certainty::Certain) {
            self.debts.paid(asked.unit, self.line.now());
        }
        failure(evidence, received, asked.patience.timeout)
    }

    fn learn_echo(&mut self, seen: &Evidence) {
        if seen.echoes > 0 {
            self.echoes = Some(true);
        }
    }

    /// Whether an answer with `before` before it shows that the line does not echo: it was asked
    /// for once, so it is no late one that came ahead of the echo.
    fn is_clean(&self, asked: Asked<'_>, before: &Evidence) -> bool {
        let asked_once = self.debts.answers(asked.unit) == 1;
        asked_once && *before == Evidence::default() && !belief::is_mirrored(asked.request)
    }

    /// Waits for the answers that earlier attempts may still get, and throws them away: before
    /// `next` goes out, or before the line is left.
    fn settle(&mut self, next: Option<(Unit, &Frame)>) -> Result<(), Failure> {
        let mut received = Vec::new();
        while let Some(until) = self.debts.wait_until(next, self.line.now()) {
            let left = until.saturating_sub(self.line.now());
            self.line.receive_into(&mut received, left)?;
            let paid = self.debts.paid_by(&received, self.echo, self.echoes);
            if let Some(unit) = paid {
                info!("unit {unit}: a late answer was thrown away");
                received.clear();
                self.debts.paid(unit, self.line.now());
            }
            forget_oldest(&mut received);
        }
        Ok(())
    }

    /// How long the normal answer to a request takes on the wire.
    fn transfer_time(&self, request: &Request) -> Duration {
        let timing = self.line.timing();
        timing.transfer_time(belief::answer_length(request))
    }
}

/// Endless noise costs no memory.
fn forget_oldest(received: &mut Vec<u8>) {
    let oldest = received.len().saturating_sub(MOST_RECEIVED);
    received.drain(..oldest);
}

/// What the evidence amounts to when the time is up: the most telling thing first.
fn failure(evidence: Evidence, received: usize, timeout: Duration) -> Failure {
    if let Some(found) = evidence.mismatch {
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
