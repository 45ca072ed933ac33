//! A transport with the manners of a Modbus line.

use std::sync::Arc;
use std::time::Duration;

use jiff::Timestamp;

use super::{Clock, OpenError, Timing, Transport, TransportError};

/// The most bytes taken from the transport at once.
const CHUNK: usize = 512;

/// A line: a transport, its pace, and when it was last heard.
pub struct Line {
    transport: Box<dyn Transport>,
    clock: Arc<dyn Clock>,
    timing: Timing,
    /// End of the last byte in either direction; for our own bytes an estimate, since neither a
    /// write nor a drain tells when the wire went quiet.
    quiet_since: Duration,
    /// How long an adapter needs after its port was opened.
    settle: Duration,
    loss: Option<Loss>,
}

/// A port that was lost and was not opened again yet.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Loss {
    /// The port as it was named.
    pub port: String,
    /// When that was noticed.
    pub at: Duration,
}

/// How waiting for silence ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quiet {
    /// The line is silent; this many stray bytes were thrown away.
    Reached {
        /// Bytes thrown away.
        discarded: usize,
    },
    /// The line was never silent long enough.
    Never {
        /// Bytes thrown away.
        discarded: usize,
    },
}

impl Line {
    /// Takes over an open transport. What arrived before is thrown away, and the line counts as
    /// busy from this moment: the first frame waits until it has been seen silent.
    ///
    /// # Errors
    /// [`TransportError`] when the port is gone already.
    pub fn new(
        mut transport: Box<dyn Transport>,
        clock: Arc<dyn Clock>,
        timing: Timing,
    ) -> Result<Self, TransportError> {
        transport.discard_input()?;
        let quiet_since = clock.now();
        Ok(Self {
            transport,
            clock,
            timing,
            quiet_since,
            settle: Duration::ZERO,
            loss: None,
        })
    }

    /// The same line with an adapter that needs so long after its port was opened. That has passed
    /// now, and passes again whenever the port is reopened.
    #[must_use]
    pub const fn settling(mut self, settle: Duration) -> Self {
        self.settle = settle;
        self
    }

    /// Opens the port again, as [`Self::new`] wants it: what arrived before is thrown away, and
    /// the line counts as busy until this moment, and until the last frame has left it.
    ///
    /// # Errors
    /// [`OpenError`] when it cannot be opened, or is gone again.
    pub fn reopen(&mut self) -> Result<(), OpenError> {
        self.transport.reopen()?;
        if !self.settle.is_zero() {
            self.clock.sleep(self.settle);
        }
        match self.transport.discard_input() {
            Ok(()) => {}
            Err(TransportError::NotBack { source, .. }) => return Err(source),
            Err(TransportError::Lost { port, source }) => {
                return Err(OpenError::Other { port, source });
            }
        }
        // What was being sent as the port was lost may still be on its way out of the adapter.
        self.quiet_since = self.quiet_since.max(self.now());
        self.loss = None;
        Ok(())
    }

    /// The loss of the port; `None` while it is open.
    pub const fn loss(&self) -> Option<&Loss> {
        self.loss.as_ref()
    }

    /// Lets this much time pass.
    pub fn sleep(&self, time: Duration) {
        self.clock.sleep(time);
    }

    /// Monotonic time.
    pub fn now(&self) -> Duration {
        self.clock.now()
    }

    /// The time in UTC.
    pub fn utc_now(&self) -> Timestamp {
        self.clock.utc_now()
    }

    /// The pace of this line.
    pub const fn timing(&self) -> Timing {
        self.timing
    }

    /// Waits until the line has been silent for t3.5, or for `pause` where that is longer, and
    /// throws away what arrives meanwhile. Gives up when the line is still talking after `limit`.
    ///
    /// # Errors
    /// [`TransportError`] when the port is gone.
    pub fn wait_quiet(
        &mut self,
        pause: Duration,
        limit: Duration,
    ) -> Result<Quiet, TransportError> {
        let silence = self.timing.silence().max(pause);
        let give_up = self.now() + silence + limit;
        let mut discarded = 0;
        let mut chunk = [0; CHUNK];
        loop {
            let left = (self.quiet_since + silence).saturating_sub(self.now());
            match self.receive(&mut chunk, left)? {
                0 if self.now() >= self.quiet_since + silence => {
                    return Ok(Quiet::Reached { discarded });
                }
                0 => {}
                count => discarded += count,
            }
            if self.now() >= give_up {
                return Ok(Quiet::Never { discarded });
            }
        }
    }

    /// Sends a frame in one write and returns when its last byte will have left the wire. The
    /// caller has waited for silence.
    ///
    /// # Errors
    /// [`TransportError`] when the port is gone.
    pub fn send(&mut self, frame: &[u8]) -> Result<Duration, TransportError> {
        let sent = self.transport.send(frame);
        self.heed(sent)?;
        // Counted from when the write is over: however long it was held up, never too early.
        self.quiet_since = self.now() + self.timing.transfer_time(frame.len());
        Ok(self.quiet_since)
    }

    /// Waits for bytes, at most `wait`, appends them to `into` and returns how many came.
    ///
    /// # Errors
    /// [`TransportError`] when the port is gone.
    pub fn receive_into(
        &mut self,
        into: &mut Vec<u8>,
        wait: Duration,
    ) -> Result<usize, TransportError> {
        let mut chunk = [0; CHUNK];
        let count = self.receive(&mut chunk, wait)?;
        into.extend_from_slice(chunk.get(..count).unwrap_or_default());
        Ok(count)
    }

    fn receive(&mut self, chunk: &mut [u8], wait: Duration) -> Result<usize, TransportError> {
        let came = self.transport.receive(chunk, wait);
        let count = self.heed(came)?;
        if count > 0 {
            self.quiet_since = self.quiet_since.max(self.now());
        }
        Ok(count)
    }

    /// Notes when the port is lost.
    fn heed<T>(&mut self, result: Result<T, TransportError>) -> Result<T, TransportError> {
        if let Err(error) = &result
            && self.loss.is_none()
        {
            self.loss = Some(Loss {
                port: error.port().to_owned(),
                at: self.now(),
            });
        }
        result
    }
}
