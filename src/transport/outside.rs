//! Where the clients of a server are.

use std::time::Duration;

use super::serial::Serial;
use super::{LineSettings, OpenError, Transport, TransportError};

/// The most bytes taken at once: more than any frame has.
pub(super) const CHUNK: usize = 512;

/// One of the clients. On a line there is no telling them apart: all are the same one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct ClientId(pub u64);

impl ClientId {
    /// Whoever is on the line.
    pub const LINE: Self = Self(0);
}

/// What came from outside.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Heard {
    /// Nothing yet.
    Nothing,
    /// These bytes, of a client.
    Bytes(ClientId, Vec<u8>),
    /// This client is gone.
    Left(ClientId),
}

/// What is left after a server has hung up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Afterwards {
    /// Clients can come again.
    Open,
    /// None would find the way back.
    Closed,
}

/// Where the clients of a server are: they send requests, and hear its answers.
pub trait Outside {
    /// Waits for something to come, at most `wait`. It can return [`Heard::Nothing`] early, so
    /// callers look at the clock.
    ///
    /// # Errors
    /// [`TransportError`] when nobody can be heard any more.
    fn hear(&mut self, wait: Duration) -> Result<Heard, TransportError>;

    /// Sends bytes to a client, in one write. What a client does not take is lost.
    ///
    /// # Errors
    /// [`TransportError`] when nobody can be reached any more. A single client that is gone is no
    /// error: [`Self::hear`] tells.
    fn say(&mut self, client: ClientId, bytes: &[u8]) -> Result<(), TransportError>;

    /// Hangs up, as a line that is pulled out does.
    ///
    /// # Errors
    /// [`OpenError`] when what was closed cannot be opened again.
    fn hang_up(&mut self, client: ClientId) -> Result<Afterwards, OpenError>;

    /// Waits until the clients have taken what was said to them, at most `limit`, where that can be
    /// known.
    fn finish(&mut self, limit: Duration);
}

impl Outside for Box<dyn Outside> {
    fn hear(&mut self, wait: Duration) -> Result<Heard, TransportError> {
        (**self).hear(wait)
    }

    fn say(&mut self, client: ClientId, bytes: &[u8]) -> Result<(), TransportError> {
        (**self).say(client, bytes)
    }

    fn hang_up(&mut self, client: ClientId) -> Result<Afterwards, OpenError> {
        (**self).hang_up(client)
    }

    fn finish(&mut self, limit: Duration) {
        (**self).finish(limit);
    }
}

/// A serial port with clients at its other end.
pub struct SerialOutside(Serial);

impl SerialOutside {
    /// Opens the port.
    ///
    /// # Errors
    /// What [`Serial::open`] finds.
    pub fn open(name: &str, settings: LineSettings) -> Result<Self, OpenError> {
        Serial::open(name, settings).map(Self)
    }
}

impl Outside for SerialOutside {
    fn hear(&mut self, wait: Duration) -> Result<Heard, TransportError> {
        let mut chunk = [0; CHUNK];
        let count = self.0.receive(&mut chunk, wait)?;
        Ok(heard_on_line(&chunk, count))
    }

    fn say(&mut self, _: ClientId, bytes: &[u8]) -> Result<(), TransportError> {
        self.0.send(bytes)
    }

    fn hang_up(&mut self, _: ClientId) -> Result<Afterwards, OpenError> {
        self.0.reopen()?;
        Ok(Afterwards::Open)
    }

    /// The driver sends what it has taken, and nothing tells when.
    fn finish(&mut self, _: Duration) {}
}

/// The first `count` bytes of a chunk, from a line.
pub(super) fn heard_on_line(chunk: &[u8], count: usize) -> Heard {
    match chunk.get(..count) {
        None | Some([]) => Heard::Nothing,
        Some(bytes) => Heard::Bytes(ClientId::LINE, bytes.to_vec()),
    }
}
