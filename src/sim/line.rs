//! A line with simulated meters on it.

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Duration;

use super::meter::Meter;
use crate::codec::{Unit, UnitRange};
use crate::transport::{Clock, OpenError, Transport, TransportError};

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
    /// The unit of the EM24-DIN on the line that [`Self::new`] makes.
    pub const EM24_UNIT: u16 = 1;
    /// The unit of its PM290.
    pub const PM290_UNIT: u16 = 2;
    /// The unit of its EM21.
    pub const EM21_UNIT: u16 = 3;
    /// The unit of its PQM.
    pub const PQM_UNIT: u16 = 17;

    /// A line with one meter of each kind on it; their loads come from `seed`.
    pub fn new(seed: u64, clock: Arc<dyn Clock>) -> Self {
        Self::with_meters(Self::meters(seed), clock)
    }

    /// The meters on the line that [`Self::new`] makes, each with a load of its own.
    ///
    /// # Panics
    /// Never: the constants are units.
    pub fn meters(seed: u64) -> Vec<Meter> {
        #[expect(clippy::expect_used, reason = "constants in range")]
        let unit = |number| Unit::new(number, UnitRange::Standard).expect("1 to 247");
        vec![
            Meter::em24(unit(Self::EM24_UNIT), seed.wrapping_add(1)),
            Meter::pm290(unit(Self::PM290_UNIT), seed.wrapping_add(2)),
            Meter::em21(unit(Self::EM21_UNIT), seed.wrapping_add(3)),
            Meter::pqm(unit(Self::PQM_UNIT), seed),
        ]
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

    /// Nothing to do: a line inside the program is never lost.
    fn reopen(&mut self) -> Result<(), OpenError> {
        Ok(())
    }
}
