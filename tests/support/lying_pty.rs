//! A meter that tells the truth at the other end of a pty whose line lies about it, by rules as
//! users type them after `--fault`.

use std::fs::File;
use std::io::{Read, Write};
use std::os::fd::OwnedFd;
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;

use meterpoll::codec::length::{Direction, of_frame};
use meterpoll::transport::{
    Clock, FaultScript, Faulty, LineSettings, SystemClock, Timing, Transport,
};

use super::pty::pair;
use super::script::true_reply;
use super::truthful::Truthful;

/// The meter. It ends when dropped.
pub(crate) struct LyingMeter {
    path: String,
    seen: Arc<Mutex<Vec<Vec<u8>>>>,
    threads: Vec<JoinHandle<()>>,
    /// Held open, so that the line does not hang up between two clients.
    slave: Option<OwnedFd>,
}

impl LyingMeter {
    /// Every unit answers, behind a line with these rules.
    pub(crate) fn new(rules: &[&str]) -> Self {
        Self::with(rules, &[])
    }

    /// The same; these bytes are there before anybody has opened the line.
    pub(crate) fn with(rules: &[&str], stale: &[u8]) -> Self {
        let (mut master, slave, path) = pair().expect("a pty pair");
        master.write_all(stale).expect("nobody hangs up");
        let clock: Arc<dyn Clock> = Arc::new(SystemClock::new());
        let timing = Timing::Paced(LineSettings::default());
        let script = FaultScript::parse(rules).expect("rules");
        let line = Faulty::new(
            Truthful::new(true_reply),
            script,
            timing,
            Arc::clone(&clock),
        );
        let mut reader = master.try_clone().expect("one more descriptor");
        let (came, bytes) = channel();
        let reading = std::thread::spawn(move || {
            let mut chunk = [0; 256];
            // Reading fails when nobody has the other end open any more.
            while let Ok(count) = reader.read(&mut chunk) {
                if came.send(chunk[..count].to_vec()).is_err() {
                    return;
                }
            }
        });
        let seen = Arc::default();
        let requests = Arc::clone(&seen);
        let serving = std::thread::spawn(move || serve(line, &*clock, &bytes, master, &requests));
        Self {
            path,
            seen,
            threads: vec![reading, serving],
            slave: Some(slave),
        }
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

impl Drop for LyingMeter {
    fn drop(&mut self) {
        drop(self.slave.take());
        for thread in self.threads.drain(..) {
            let _ = thread.join();
        }
    }
}

/// Gives requests to the line, and what comes through it back when it is due.
fn serve(
    mut line: Faulty<impl Transport>,
    clock: &dyn Clock,
    bytes: &Receiver<Vec<u8>>,
    mut master: File,
    requests: &Mutex<Vec<Vec<u8>>>,
) {
    /// Nothing is due: until a request comes.
    const LONG: Duration = Duration::from_secs(60);
    let mut received = Vec::new();
    let mut chunk = [0; 512];
    loop {
        let wait = line
            .next_due()
            .map_or(LONG, |due| due.saturating_sub(clock.now()));
        match bytes.recv_timeout(wait) {
            Ok(more) => received.extend(more),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return,
        }
        while let Some(length) = of_frame(&received, Direction::Request)
            && received.len() >= length
        {
            let request: Vec<u8> = received.drain(..length).collect();
            requests
                .lock()
                .expect("nobody panicked")
                .push(request.clone());
            let _ = line.send(&request);
        }
        while let Ok(count @ 1..) = line.receive(&mut chunk, Duration::ZERO) {
            if master.write_all(&chunk[..count]).is_err() {
                return;
            }
        }
    }
}
