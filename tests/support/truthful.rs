//! A line in memory that answers at once.

use std::collections::VecDeque;
use std::time::Duration;

use meterpoll::transport::{OpenError, Transport, TransportError};

/// Answers each request with what this function says, and waits for nothing.
pub(crate) struct Truthful<F> {
    answer: F,
    answers: VecDeque<u8>,
}

impl<F: FnMut(&[u8]) -> Vec<u8>> Truthful<F> {
    pub(crate) fn new(answer: F) -> Self {
        let answers = VecDeque::new();
        Self { answer, answers }
    }
}

impl<F: FnMut(&[u8]) -> Vec<u8> + Send> Transport for Truthful<F> {
    fn send(&mut self, frame: &[u8]) -> Result<(), TransportError> {
        self.answers.extend((self.answer)(frame));
        Ok(())
    }

    fn receive(&mut self, into: &mut [u8], _: Duration) -> Result<usize, TransportError> {
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

    fn reopen(&mut self) -> Result<(), OpenError> {
        self.answers.clear();
        Ok(())
    }
}
