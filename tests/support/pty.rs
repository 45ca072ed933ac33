//! A meter at the other end of a pty pair: the test says what it answers, byte by byte.

#![allow(dead_code, reason = "each test file uses its own share")]

use std::collections::BTreeMap;
use std::error::Error;
use std::fs::File;
use std::io::{Read, Write};
use std::os::fd::OwnedFd;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;

use meterpoll::codec::length::{self, Direction};
use meterpoll::codec::{
    Destination, ExceptionCode, ReadValues, Reply, Request, Response, Unit, UnitRange, rtu,
};
use rustix::fs::{Mode, OFlags, open};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};

/// What a meter does with a request: the bytes it answers, if any.
pub(crate) type Behaviour = dyn FnMut(&[u8]) -> Vec<u8> + Send;

/// Bytes from the client's end upon which the other one is closed. No client sends them.
const HANG_UP: [u8; 8] = [0xFF, 0x08, 0xDE, 0xAD, 0xDE, 0xAD, 0x00, 0x00];

/// A meter on a pty. It ends when dropped.
pub(crate) struct PtyMeter {
    path: String,
    seen: Arc<Mutex<Vec<Vec<u8>>>>,
    answered: Arc<AtomicUsize>,
    thread: Option<JoinHandle<()>>,
    /// Held open, so that the line does not hang up between two clients.
    slave: Option<OwnedFd>,
}

impl PtyMeter {
    /// A meter that does with every request what `behaviour` says.
    pub(crate) fn new(behaviour: Box<Behaviour>) -> Self {
        Self::hanging_up(behaviour, usize::MAX)
    }

    /// The same on a line that hangs up in place of an answer to this request, counted from 1.
    pub(crate) fn hanging_up(mut behaviour: Box<Behaviour>, last: usize) -> Self {
        let (mut master, slave, path) = pair().expect("a pty pair");
        let seen = Arc::new(Mutex::new(Vec::new()));
        let requests = Arc::clone(&seen);
        let answered = Arc::new(AtomicUsize::new(0));
        let answers = Arc::clone(&answered);
        let thread = std::thread::spawn(move || {
            let mut bytes = Vec::new();
            let mut chunk = [0; 256];
            // Reading fails when nobody has the other end open any more.
            while let Ok(count) = master.read(&mut chunk) {
                bytes.extend_from_slice(&chunk[..count]);
                while let Some(length) = length::of_frame(&bytes, Direction::Request)
                    && bytes.len() >= length
                {
                    let request: Vec<u8> = bytes.drain(..length).collect();
                    if request == HANG_UP {
                        return;
                    }
                    let mut requests = requests.lock().expect("nobody panicked");
                    requests.push(request.clone());
                    if requests.len() == last {
                        return;
                    }
                    drop(requests);
                    let _ = master.write_all(&behaviour(&request));
                    answers.fetch_add(1, Ordering::SeqCst);
                }
            }
        });
        Self {
            path,
            seen,
            answered,
            thread: Some(thread),
            slave: Some(slave),
        }
    }

    /// A healthy meter at `unit`: register `a` holds [`register`] of `a`, up to 0x03FF.
    pub(crate) fn healthy(unit: u16) -> Self {
        Self::new(Box::new(move |request| {
            answer(unit, request).unwrap_or_default()
        }))
    }

    /// A meter at each of these units that holds these registers; it refuses to read any other.
    pub(crate) fn holding(units: &'static [u16], registers: &[(u16, u16)]) -> Self {
        let held: BTreeMap<u16, u16> = registers.iter().copied().collect();
        Self::new(Box::new(move |request| {
            let answers = units.iter().filter_map(|unit| {
                answer_with(*unit, request, |address| held.get(&address).copied())
            });
            answers.flatten().collect()
        }))
    }

    /// Hangs up: on return the port is gone.
    pub(crate) fn hang_up(&mut self) {
        let written = rustix::io::write(self.client_end(), &HANG_UP);
        assert_eq!(written.expect("the line is open"), HANG_UP.len());
        if let Some(thread) = self.thread.take() {
            thread.join().expect("the meter did not panic");
        }
    }

    /// Whether so many requests were answered, with nothing perhaps, and the client has taken all
    /// the bytes.
    pub(crate) fn has_answered(&self, requests: usize) -> bool {
        self.answered.load(Ordering::SeqCst) >= requests
            && rustix::io::ioctl_fionread(self.client_end()).expect("the line is open") == 0
    }

    /// The client's end, held open beside the client.
    pub(crate) fn client_end(&self) -> &OwnedFd {
        self.slave.as_ref().expect("it is held until the end")
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
        drop(self.slave.take());
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// Both ends of a raw pty and the path of the second; no child process inherits either.
pub(crate) fn pair() -> Result<(File, OwnedFd, String), Box<dyn Error>> {
    let flags = OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC;
    let master = openpt(flags)?;
    grantpt(&master)?;
    unlockpt(&master)?;
    let path = ptsname(&master, Vec::new())?.into_string()?;
    let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC;
    let slave = open(path.as_str(), flags, Mode::empty())?;
    let mut attributes = tcgetattr(&slave)?;
    attributes.make_raw();
    tcsetattr(&slave, OptionalActions::Now, &attributes)?;
    Ok((File::from(master), slave, path))
}

/// What register `address` of a healthy meter holds: different for every address.
pub(crate) fn register(address: u16) -> u16 {
    address.wrapping_mul(7).wrapping_add(3)
}

/// How a healthy meter at `unit` answers; nothing when it is not meant.
pub(crate) fn answer(unit: u16, request: &[u8]) -> Option<Vec<u8>> {
    answer_with(unit, request, |address| {
        (address < 0x400).then(|| register(address))
    })
}

/// How a meter at `unit` answers that holds these registers; nothing when it is not meant.
pub(crate) fn answer_with(
    unit: u16,
    request: &[u8],
    held: impl Fn(u16) -> Option<u16>,
) -> Option<Vec<u8>> {
    let unit = Unit::new(unit, UnitRange::Extended).expect("a unit");
    let (destination, request) = rtu::decode_request(request).ok()?;
    if destination != Destination::Unit(unit) {
        return None;
    }
    let values = match request {
        Request::Read { range, .. } => {
            let first = range.start().get();
            (first..=u16::MAX)
                .take(range.count().into())
                .map(held)
                .collect()
        }
        _ => None,
    };
    let reply = match (request, values) {
        (Request::Read { function, .. }, Some(values)) => Reply::Normal(Response::Registers {
            function,
            values: ReadValues::new(values).expect("as many as were asked for"),
        }),
        (other, _) => Reply::Exception {
            function: other.function(),
            code: ExceptionCode::ILLEGAL_DATA_ADDRESS,
        },
    };
    Some(rtu::encode_reply(unit, &reply).as_bytes().to_vec())
}
