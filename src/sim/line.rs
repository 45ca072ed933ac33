//! A line with simulated meters on it.

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Duration;

use super::meter::Meter;
use crate::codec::{Unit, UnitRange};
use crate::transport::{Clock, Transport, TransportError};

/// A line inside the program. What is sent into it is heard by every meter on it at once, and
/// their answers can be received at once: pace and silence are the matter of
/// [`crate::transport::Line`].
pub struct SimulatedLine {
    meters: Vec<Meter>,
    clock: Arc<dyn Clock>,
    /// What the meters have said and nobody has received yet.
    answers: VecDeque<u8>,
}

impl SimulatedLine {
    /// The unit of the one meter on the line that [`Self::new`] makes.
    pub const PQM_UNIT: u16 = 17;

    /// A line with one PQM on it, unit 17, whose load comes from `seed`.
    ///
    /// # Panics
    /// Never: 17 is a unit.
    pub fn new(seed: u64, clock: Arc<dyn Clock>) -> Self {
        #[expect(clippy::expect_used, reason = "a constant in range")]
        let unit = Unit::new(Self::PQM_UNIT, UnitRange::Standard).expect("17 is a unit");
        Self::with_meters(vec![Meter::pqm(unit, seed)], clock)
    }

    /// A line with these meters on it. Two of the same unit both answer, one after the other.
    pub fn with_meters(meters: Vec<Meter>, clock: Arc<dyn Clock>) -> Self {
        Self {
            meters,
            clock,
            answers: VecDeque::new(),
        }
    }
}

impl Transport for SimulatedLine {
    fn send(&mut self, frame: &[u8]) -> Result<(), TransportError> {
        let now = self.clock.utc_now();
        for meter in &self.meters {
            if let Some(answer) = meter.answer(frame, now) {
                self.answers.extend(answer.as_bytes());
            }
        }
        Ok(())
    }

    /// Hands over what has been answered; without an answer the whole of `wait` passes on the
    /// clock.
    fn receive(&mut self, into: &mut [u8], wait: Duration) -> Result<usize, TransportError> {
        if self.answers.is_empty() {
            self.clock.sleep(wait);
            return Ok(0);
        }
        let count = self.answers.len().min(into.len());
        for (place, byte) in into.iter_mut().zip(self.answers.drain(..count)) {
            *place = byte;
        }
        Ok(count)
    }

    fn discard_input(&mut self) -> Result<(), TransportError> {
        self.answers.clear();
        Ok(())
    }
}
