//! Shows every byte that goes over a transport.

use std::sync::Arc;
use std::time::Duration;

use log::trace;

use super::{Clock, OpenError, Transport, TransportError};
use crate::codec::rtu::Hex;

/// Wraps a transport and logs what it carries: direction, hex, and the time since the bytes
/// before. One line a write or a read, so that a frame that arrives in pieces shows as pieces.
pub struct Traced<T> {
    inner: T,
    clock: Arc<dyn Clock>,
    last: Option<Duration>,
}

impl<T: Transport> Traced<T> {
    /// Wraps `inner`; times come from `clock`.
    pub fn new(inner: T, clock: Arc<dyn Clock>) -> Self {
        Self {
            inner,
            clock,
            last: None,
        }
    }

    fn log(&mut self, direction: char, bytes: &[u8]) {
        let now = self.clock.now();
        let since = now.saturating_sub(self.last.unwrap_or(now));
        self.last = Some(now);
        let milliseconds = since.as_secs_f64() * 1000.0;
        trace!("{direction} {:>9.3} ms  {}", milliseconds, Hex(bytes));
    }
}

impl<T: Transport> Transport for Traced<T> {
    fn send(&mut self, frame: &[u8]) -> Result<(), TransportError> {
        self.inner.send(frame)?;
        self.log('>', frame);
        Ok(())
    }

    fn receive(&mut self, into: &mut [u8], wait: Duration) -> Result<usize, TransportError> {
        let count = self.inner.receive(into, wait)?;
        if count > 0 {
            self.log('<', into.get(..count).unwrap_or_default());
        }
        Ok(count)
    }

    fn discard_input(&mut self) -> Result<(), TransportError> {
        self.inner.discard_input()
    }

    fn reopen(&mut self) -> Result<(), OpenError> {
        let result = self.inner.reopen();
        match &result {
            Ok(()) => trace!("opened again"),
            Err(error) => trace!("not opened again: {error}"),
        }
        result
    }
}
