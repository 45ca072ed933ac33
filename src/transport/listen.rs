//! A server over TCP: several clients at once, each on a connection of its own.
//!
//! A thread accepts, and one a connection reads: so nothing here depends on what the system offers
//! to wait for several sockets. What they read waits in a queue of bounded length.

use std::collections::BTreeMap;
use std::io::{self, Read, Write};
use std::net::{Shutdown, SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::thread;
use std::time::Duration;

use thiserror::Error;

use super::outside::CHUNK;
use super::{Afterwards, ClientId, Heard, OpenError, Outside, TransportError};

/// The most clients at once; one more is turned away.
const MOST_CLIENTS: usize = 64;

/// The most pieces that wait in the queue; who sends faster waits.
const MOST_WAITING: usize = 64;

/// How long a client may leave what it is sent unread, before it is given up: its window is far
/// larger than an answer.
const WRITE_WAIT: Duration = Duration::from_millis(500);

/// Time between two tries to accept when the system has run out of what that takes.
const TRY_AGAIN: Duration = Duration::from_millis(50);

/// Why nobody can connect.
#[derive(Debug, Error)]
pub enum ListenError {
    /// Not an address.
    #[error("'{address}' is no address to listen on")]
    Address {
        /// What was given.
        address: String,
    },
    /// Another program listens there.
    #[error("{address} is in use by another program")]
    InUse {
        /// The address.
        address: String,
    },
    /// Anything else.
    #[error("{address} cannot be listened on")]
    Other {
        /// The address.
        address: String,
        /// What the system said.
        source: io::Error,
    },
}

/// A listening socket and the clients that have come.
pub struct Listener {
    address: SocketAddr,
    clients: BTreeMap<ClientId, TcpStream>,
    events: Receiver<Event>,
    is_over: Arc<AtomicBool>,
}

enum Event {
    Came(ClientId, TcpStream),
    Bytes(ClientId, Vec<u8>),
    Left(ClientId),
}

impl Listener {
    /// Listens on `address`, `127.0.0.1:5020`; port 0 is any that is free.
    ///
    /// # Errors
    /// [`ListenError`].
    pub fn open(address: &str) -> Result<Self, ListenError> {
        let name = || address.to_owned();
        let socket = TcpListener::bind(address).map_err(|source| match source.kind() {
            io::ErrorKind::InvalidInput => ListenError::Address { address: name() },
            io::ErrorKind::AddrInUse => ListenError::InUse { address: name() },
            _ => ListenError::Other {
                address: name(),
                source,
            },
        })?;
        let bound = socket.local_addr().map_err(|source| ListenError::Other {
            address: name(),
            source,
        })?;
        let (sender, events) = sync_channel(MOST_WAITING);
        let is_over = Arc::new(AtomicBool::new(false));
        let is_over_there = Arc::clone(&is_over);
        thread::Builder::new()
            .spawn(move || accept(&socket, &sender, &is_over_there))
            .map_err(|source| ListenError::Other {
                address: name(),
                source,
            })?;
        Ok(Self {
            address: bound,
            clients: BTreeMap::new(),
            events,
            is_over,
        })
    }

    /// Where it listens, with the port that was found for 0.
    pub const fn address(&self) -> SocketAddr {
        self.address
    }

    fn forget(&mut self, client: ClientId) {
        if let Some(stream) = self.clients.remove(&client) {
            let _ = stream.shutdown(Shutdown::Both);
        }
    }
}

impl Outside for Listener {
    fn hear(&mut self, wait: Duration) -> Result<Heard, TransportError> {
        let event = match self.events.recv_timeout(wait) {
            Ok(event) => event,
            Err(RecvTimeoutError::Timeout) => return Ok(Heard::Nothing),
            Err(RecvTimeoutError::Disconnected) => {
                return Err(TransportError::Lost {
                    port: self.address.to_string(),
                    source: io::ErrorKind::NotConnected.into(),
                });
            }
        };
        Ok(match event {
            Event::Came(_, stream) if self.clients.len() >= MOST_CLIENTS => {
                log::warn!("a client was turned away: there are {MOST_CLIENTS} already");
                let _ = stream.shutdown(Shutdown::Both);
                Heard::Nothing
            }
            Event::Came(client, stream) => {
                self.clients.insert(client, stream);
                Heard::Nothing
            }
            Event::Bytes(client, bytes) if self.clients.contains_key(&client) => {
                Heard::Bytes(client, bytes)
            }
            // Of a client that was turned away or hung up on.
            Event::Bytes(..) => Heard::Nothing,
            Event::Left(client) => {
                self.forget(client);
                Heard::Left(client)
            }
        })
    }

    fn say(&mut self, client: ClientId, bytes: &[u8]) -> Result<(), TransportError> {
        if let Some(stream) = self.clients.get_mut(&client)
            && stream.write_all(bytes).is_err()
        {
            self.forget(client);
        }
        Ok(())
    }

    fn hang_up(&mut self, client: ClientId) -> Result<Afterwards, OpenError> {
        self.forget(client);
        Ok(Afterwards::Open)
    }

    /// The system delivers what was written after the end of the program.
    fn finish(&mut self, _: Duration) {
        for stream in self.clients.values() {
            let _ = stream.shutdown(Shutdown::Write);
        }
    }
}

impl Drop for Listener {
    fn drop(&mut self) {
        self.is_over.store(true, Ordering::SeqCst);
        for stream in self.clients.values() {
            let _ = stream.shutdown(Shutdown::Both);
        }
        // Wakes the thread that accepts, which then closes the socket. An address of all the
        // machine's own is reached through the loopback.
        let mut address = self.address;
        if address.ip().is_unspecified() {
            address.set_ip(match address {
                SocketAddr::V4(_) => std::net::Ipv4Addr::LOCALHOST.into(),
                SocketAddr::V6(_) => std::net::Ipv6Addr::LOCALHOST.into(),
            });
        }
        let _ = TcpStream::connect_timeout(&address, WRITE_WAIT);
        // Until all threads have ended; those of clients that have come and were not heard of yet
        // end with their streams.
        while let Ok(event) = self.events.recv_timeout(WRITE_WAIT) {
            if let Event::Came(_, stream) = event {
                let _ = stream.shutdown(Shutdown::Both);
            }
        }
    }
}

fn accept(socket: &TcpListener, events: &SyncSender<Event>, is_over: &AtomicBool) {
    for number in 1.. {
        let accepted = socket.accept();
        if is_over.load(Ordering::SeqCst) {
            return;
        }
        let client = ClientId(number);
        let came = accepted.and_then(|(stream, _)| {
            stream.set_nodelay(true)?;
            stream.set_write_timeout(Some(WRITE_WAIT))?;
            Ok((stream.try_clone()?, stream))
        });
        match came {
            Err(error) => give_up(&error),
            Ok((reader, writer)) => {
                if events.send(Event::Came(client, writer)).is_err() {
                    return;
                }
                let theirs = events.clone();
                let started = thread::Builder::new().spawn(move || read(client, reader, &theirs));
                if let Err(error) = started {
                    give_up(&error);
                    if events.send(Event::Left(client)).is_err() {
                        return;
                    }
                }
            }
        }
    }
}

/// The system has run out of what a client takes: others end some time.
fn give_up(error: &io::Error) {
    log::debug!("a client could not connect: {error}");
    thread::sleep(TRY_AGAIN);
}

fn read(client: ClientId, mut stream: TcpStream, events: &SyncSender<Event>) {
    let mut chunk = [0; CHUNK];
    loop {
        let event = match stream.read(&mut chunk) {
            Ok(0) => Event::Left(client),
            Ok(count) => Event::Bytes(client, chunk.get(..count).unwrap_or_default().to_vec()),
            Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
            Err(_) => Event::Left(client),
        };
        let is_last = matches!(event, Event::Left(_));
        if events.send(event).is_err() || is_last {
            return;
        }
    }
}
