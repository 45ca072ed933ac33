//! A meter at the other end of a pty pair: the test says what it answers, byte by byte.

#![allow(dead_code, reason = "each test file uses its own share")]

use std::io::{ErrorKind, Read, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;

use meterpoll::codec::length::{self, Direction};
use meterpoll::codec::{
    Destination, ExceptionCode, ReadValues, Reply, Request, Response, Unit, UnitRange, rtu,
};
use serialport::{SerialPort, TTYPort};

/// What a meter does with a request: the bytes it answers, if any.
pub(crate) type Behaviour = dyn FnMut(&[u8]) -> Vec<u8> + Send;

/// A meter on a pty. It ends when dropped.
pub(crate) struct PtyMeter {
    path: String,
    seen: Arc<Mutex<Vec<Vec<u8>>>>,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
    // Held open, so that the line does not hang up between two clients.
    _slave: TTYPort,
}

impl PtyMeter {
    /// A meter that does with every request what `behaviour` says.
    pub(crate) fn new(mut behaviour: Box<Behaviour>) -> Self {
        let (mut master, slave) = TTYPort::pair().expect("a pty pair");
        let path = slave.name().expect("a pty has a path");
        let seen = Arc::new(Mutex::new(Vec::new()));
        let stop = Arc::new(AtomicBool::new(false));
        let (requests, stopped) = (Arc::clone(&seen), Arc::clone(&stop));
        let thread = std::thread::spawn(move || {
            master
                .set_timeout(Duration::from_millis(20))
                .expect("a time-out is only stored");
            let mut bytes = Vec::new();
            let mut chunk = [0; 256];
            while !stopped.load(Ordering::Relaxed) {
                match master.read(&mut chunk) {
                    Ok(count) => bytes.extend_from_slice(&chunk[..count]),
                    Err(error) if error.kind() == ErrorKind::TimedOut => continue,
                    Err(_) => return,
                }
                // Two requests can come in one read when the machine is busy.
                while let Some(length) = length::of_frame(&bytes, Direction::Request)
                    && length <= bytes.len()
                {
                    let request: Vec<u8> = bytes.drain(..length).collect();
                    let answer = behaviour(&request);
                    requests.lock().expect("nobody panicked").push(request);
                    let _ = master.write_all(&answer);
                }
            }
        });
        Self {
            path,
            seen,
            stop,
            thread: Some(thread),
            _slave: slave,
        }
    }

    /// A healthy meter at `unit`: register `a` holds [`register`] of `a`, up to 0x03FF.
    pub(crate) fn healthy(unit: u16) -> Self {
        Self::new(Box::new(move |request| {
            answer(unit, request).unwrap_or_default()
        }))
    }

    /// The path a client opens.
    pub(crate) fn path(&self) -> &str {
        &self.path
    }

    /// Every request seen so far.
    pub(crate) fn requests(&self) -> Vec<Vec<u8>> {
        self.seen.lock().expect("nobody panicked").clone()
    }
}

impl Drop for PtyMeter {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// What register `address` of a healthy meter holds: different for every address.
pub(crate) fn register(address: u16) -> u16 {
    address.wrapping_mul(7).wrapping_add(3)
}

/// How a healthy meter at `unit` answers; nothing when it is not meant.
pub(crate) fn answer(unit: u16, request: &[u8]) -> Option<Vec<u8>> {
    let unit = Unit::new(unit, UnitRange::Extended).expect("a unit");
    let (destination, request) = rtu::decode_request(request).ok()?;
    if destination != Destination::Unit(unit) {
        return None;
    }
    let reply = match request {
        Request::Read { function, range } if range.end() <= 0x400 => {
            let first = range.start().get();
            Reply::Normal(Response::Registers {
                function,
                values: ReadValues::new((first..first + range.count()).map(register).collect())
                    .expect("as many as were asked for"),
            })
        }
        other => Reply::Exception {
            function: other.function(),
            code: ExceptionCode::ILLEGAL_DATA_ADDRESS,
        },
    };
    Some(rtu::encode_reply(unit, &reply).as_bytes().to_vec())
}
