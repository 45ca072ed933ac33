//! A line with simulated meters on it.

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Duration;

use super::kinds;
use super::meter::Meter;
use crate::transport::{Clock, OpenError, Transport, TransportError};

/// A line inside the program. What is sent into it is heard by every meter on it at once, and
/// their answers can be received at once, or after a time that the meters take: pace and silence are
/// the matter of [`crate::transport::Line`].
pub struct SimulatedLine {
    meters: Vec<Meter>,
    clock: Arc<dyn Clock>,
    answer_time: Duration,
    /// What the meters have said and nobody has received yet, and when each of it begins.
    answers: VecDeque<(Duration, Vec<u8>)>,
}

impl SimulatedLine {
    /// A line with one meter of each kind on it; their loads come from `seed`.
    pub fn new(seed: u64, clock: Arc<dyn Clock>) -> Self {
        Self::with_meters(Self::meters(seed), clock)
    }

    /// The meters on the line that [`Self::new`] makes, each with a load of its own: those of
    /// [`kinds`].
    pub fn meters(seed: u64) -> Vec<Meter> {
        kinds::usual_meters(seed)
    }

    /// A line with these meters on it. Two of the same unit both answer, one after the other.
    pub fn with_meters(meters: Vec<Meter>, clock: Arc<dyn Clock>) -> Self {
        Self {
            meters,
            clock,
            answer_time: Duration::ZERO,
            answers: VecDeque::new(),
        }
    }

    /// The same line with meters that take so long before they answer.
    #[must_use]
    pub const fn with_answer_time(mut self, answer_time: Duration) -> Self {
        self.answer_time = answer_time;
        self
    }

    /// Whether a meter on it answers as this unit by now.
    pub fn has_unit(&self, unit: u8) -> bool {
        self.meters.iter().any(|meter| meter.unit().get() == unit)
    }

    /// When the next answer begins, on the clock; `None` when there is none to come.
    fn next_due(&self) -> Option<Duration> {
        self.answers.front().map(|(due, _)| *due)
    }
}

impl Transport for SimulatedLine {
    fn send(&mut self, frame: &[u8]) -> Result<(), TransportError> {
        let now = self.clock.utc_now();
        for meter in &mut self.meters {
            if let Some(answer) = meter.answer(frame, now) {
                let due = self.clock.now().saturating_add(self.answer_time);
                self.answers.push_back((due, answer.as_bytes().to_vec()));
            }
        }
        Ok(())
    }

    /// Hands over what has been answered; as long as that is nothing, time passes on the clock, at
    /// most `wait`.
    fn receive(&mut self, into: &mut [u8], wait: Duration) -> Result<usize, TransportError> {
        let now = self.clock.now();
        let left = self.next_due().map(|due| due.saturating_sub(now));
        let left = left.unwrap_or(Duration::MAX);
        if !left.is_zero() {
            self.clock.sleep(left.min(wait));
        }
        let now = self.clock.now();
        let mut count = 0;
        while let Some((due, answer)) = self.answers.front_mut()
            && *due <= now
            && let Some(room) = into.get_mut(count..).filter(|room| !room.is_empty())
        {
            let taken = answer.len().min(room.len());
            for (place, byte) in room.iter_mut().zip(answer.drain(..taken)) {
                *place = byte;
            }
            count += taken;
            if answer.is_empty() {
                self.answers.pop_front();
            }
        }
        Ok(count)
    }

    fn discard_input(&mut self) -> Result<(), TransportError> {
        let now = self.clock.now();
        self.answers.retain(|(due, _)| *due > now);
        Ok(())
    }

    /// Nothing to do: a line inside the program is never lost.
    fn reopen(&mut self) -> Result<(), OpenError> {
        Ok(())
    }
}
