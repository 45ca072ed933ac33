//! Moves bytes and keeps the line's time.
//!
//! A [`Transport`] is a medium: the [`serial`] port, or the simulated line in [`crate::sim`].
//! [`traced`] wraps any of them and shows the bytes, [`faulty`] spoils them. [`line::Line`] adds what
//! the standard asks of everybody on a wire: silence before each frame. [`clock`] is where time comes
//! from, so that all of this runs on a fake one in tests. [`ports`] tells which serial ports there
//! are, [`holder`] who has one open; `lock` sees whether one is held before it is opened.
//!
//! A server has its clients on an [`Outside`]: a serial port, a pty or sockets ([`outside`],
//! `pty`, [`listen`]).

pub mod clock;
pub mod error;
pub mod faulty;
pub mod holder;
pub mod line;
pub mod listen;
mod lock;
pub mod outside;
pub mod ports;
#[cfg(unix)]
pub mod pty;
pub mod serial;
pub mod settings;
pub mod traced;

use std::time::Duration;

pub use clock::{Clock, SystemClock};
pub use error::{Existing, OpenError, PtyError, TransportError};
pub use faulty::{FaultScript, Faulty};
pub use line::Line;
pub use outside::{Afterwards, ClientId, Heard, Outside};
pub use settings::{LineSettings, Parity, StopBits, Timing};

/// A medium that carries bytes both ways.
pub trait Transport: Send {
    /// Sends the whole frame in one write.
    ///
    /// # Errors
    /// [`TransportError`] when the medium is gone.
    fn send(&mut self, frame: &[u8]) -> Result<(), TransportError>;

    /// Waits for bytes, at most `wait`, and returns how many came; 0 means none yet. It can return
    /// 0 early, so callers look at the clock.
    ///
    /// # Errors
    /// [`TransportError`] when the medium is gone.
    fn receive(&mut self, into: &mut [u8], wait: Duration) -> Result<usize, TransportError>;

    /// Throws away what has arrived and was not received yet.
    ///
    /// # Errors
    /// [`TransportError`] when the medium is gone.
    fn discard_input(&mut self) -> Result<(), TransportError>;

    /// Closes the medium, whatever state it is in, and opens it again by the same name. Where that
    /// fails it stays closed, and can be opened again later.
    ///
    /// # Errors
    /// [`OpenError`] when it cannot be opened; an error of closing is only logged.
    fn reopen(&mut self) -> Result<(), OpenError>;
}

impl Transport for Box<dyn Transport> {
    fn send(&mut self, frame: &[u8]) -> Result<(), TransportError> {
        (**self).send(frame)
    }

    fn receive(&mut self, into: &mut [u8], wait: Duration) -> Result<usize, TransportError> {
        (**self).receive(into, wait)
    }

    fn discard_input(&mut self) -> Result<(), TransportError> {
        (**self).discard_input()
    }

    fn reopen(&mut self) -> Result<(), OpenError> {
        (**self).reopen()
    }
}
