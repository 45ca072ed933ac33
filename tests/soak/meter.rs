//! The meter at the other end of a line: true by itself, and made a liar by fault rules.
//!
//! # It is never later than it means to be
//!
//! The latest that a fault makes an answer begin is 40 ms after the request was heard, and the client
//! reckons with it until 72 ms after it was sent. A request is not heard when the meter takes it more
//! than [`HEARING`] after it was sent, and nothing is written more than [`WRITING`] after it was due. So
//! an answer begins 65 ms after its request was sent, at the most, as far as the meter's own clock can
//! tell; what is left is the time between its look at the clock and the client's port. Only stalls are
//! longer, and only lines have them where the client can tell answers apart however late they are.

use std::fs::File;
use std::io::{Read, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

use fastrand::Rng;
use meterpoll::codec::length::{self, Direction};
use meterpoll::transport::faulty::{FaultCounts, FaultTally};
use meterpoll::transport::{Clock, FaultScript, Faulty, Timing, Transport};
use rustix::event::{PollFd, PollFlags, Timespec, poll};

use crate::pty;
use crate::truth::Registers;
use crate::truthful::Truthful;
use crate::wire::{What, Wire};

/// How long after it was sent a request may be taken.
const HEARING: Duration = Duration::from_millis(15);

/// How long after it was due an answer may be written.
const WRITING: Duration = Duration::from_millis(10);

/// Without anything to do, the meter looks up this often.
const IDLE: Duration = Duration::from_secs(1);

/// How a meter stalls: it, or what carries its bytes, holds all answers back for a while and then
/// gives them in their order. By far later than the client waits, which is twice the time-out and
/// 32 ms for adapters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Stalls {
    /// The share of requests with which one begins.
    pub(crate) rate: f64,
    pub(crate) shortest: Duration,
    pub(crate) longest: Duration,
    /// Between the end of one and the beginning of the next.
    pub(crate) apart: Duration,
}

/// What a meter is to be.
pub(crate) struct Nature {
    pub(crate) registers: Registers,
    pub(crate) script: FaultScript,
    pub(crate) stalls: Option<Stalls>,
    pub(crate) seed: u64,
}

/// What happened at the meter beside its faults.
#[derive(Default)]
pub(crate) struct Mishaps {
    pub(crate) stalls: AtomicU64,
    /// Requests not heard, and pieces of answers not written, since the meter was late itself.
    pub(crate) withheld: AtomicU64,
}

/// A meter that runs. It ends when dropped.
pub(crate) struct RunningMeter {
    pub(crate) path: String,
    pub(crate) mishaps: Arc<Mishaps>,
    tally: FaultTally,
    /// Held open, so that the line does not hang up between two clients.
    slave: Option<std::os::fd::OwnedFd>,
    thread: Option<JoinHandle<()>>,
}

impl RunningMeter {
    pub(crate) fn start(nature: Nature, wire: &Arc<Wire>, clock: &Arc<dyn Clock>) -> Self {
        let (master, slave, path) = pty::pair().expect("a pty pair");
        let registers = nature.registers;
        let answer: Answer = Box::new(move |frame| registers.answer(frame).unwrap_or_default());
        let truth = Truthful::new(answer);
        let script = nature.script.with_seed(nature.seed);
        let faulty = Faulty::new(truth, script, Timing::Unpaced, Arc::clone(clock));
        let mishaps = Arc::new(Mishaps::default());
        let tally = faulty.tally();
        let mut meter = Meter {
            master,
            faulty,
            registers: nature.registers,
            stalls: nature.stalls,
            stall: Duration::ZERO,
            held: Vec::new(),
            chance: Rng::with_seed(nature.seed),
            mishaps: Arc::clone(&mishaps),
            wire: Arc::clone(wire),
            clock: Arc::clone(clock),
        };
        Self {
            path,
            mishaps,
            tally,
            slave: Some(slave),
            // It ends with an error when the line is closed.
            thread: Some(std::thread::spawn(move || drop(meter.serve()))),
        }
    }

    /// How often it was late itself so far.
    pub(crate) fn withheld(&self) -> u64 {
        self.mishaps.withheld.load(Ordering::SeqCst)
    }

    /// What went through the fault rules so far.
    pub(crate) fn counts(&self) -> FaultCounts {
        self.tally.counts()
    }
}

impl Drop for RunningMeter {
    fn drop(&mut self) {
        drop(self.slave.take());
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// What it would answer.
type Answer = Box<dyn FnMut(&[u8]) -> Vec<u8> + Send>;

struct Meter {
    master: File,
    faulty: Faulty<Truthful<Answer>>,
    registers: Registers,
    stalls: Option<Stalls>,
    /// When the last stall ends, or has ended.
    stall: Duration,
    /// What is held back until then.
    held: Vec<Vec<u8>>,
    chance: Rng,
    mishaps: Arc<Mishaps>,
    wire: Arc<Wire>,
    clock: Arc<dyn Clock>,
}

impl Meter {
    /// Until the line is closed, which is an error.
    fn serve(&mut self) -> std::io::Result<()> {
        let mut heard = Vec::new();
        let mut chunk = [0; 512];
        loop {
            let due = self.next_due();
            self.wire.set_busy(due.is_some() || !heard.is_empty());
            let wait = due.map_or(IDLE, |due| due.saturating_sub(self.clock.now()));
            if self.is_asked(wait)? {
                let count = self.master.read(&mut chunk)?;
                heard.extend_from_slice(&chunk[..count]);
                while let Some(length) = length::of_frame(&heard, Direction::Request)
                    && length <= heard.len()
                {
                    let frame: Vec<u8> = heard.drain(..length).collect();
                    self.hear(&frame)?;
                }
            }
            self.deliver()?;
        }
    }

    /// When there is something to write.
    fn next_due(&self) -> Option<Duration> {
        let held = (!self.held.is_empty()).then_some(self.stall);
        [held, self.faulty.next_due()].into_iter().flatten().min()
    }

    fn is_asked(&self, wait: Duration) -> std::io::Result<bool> {
        let mut poll_for = [PollFd::new(&self.master, PollFlags::IN)];
        let wait = Timespec {
            tv_sec: wait.as_secs().cast_signed(),
            tv_nsec: wait.subsec_nanos().into(),
        };
        Ok(poll(&mut poll_for, Some(&wait))? > 0)
    }

    fn hear(&mut self, frame: &[u8]) -> std::io::Result<()> {
        // What is overdue must not pass as if it were due now.
        self.deliver()?;
        let stamp = self.wire.take_stamp().unwrap_or_default();
        let now = self.clock.now();
        let late = now.saturating_sub(stamp);
        if late > HEARING {
            self.withhold(late, frame);
            return Ok(());
        }
        if self.wire.is_true() {
            let answer = self.registers.answer(frame).unwrap_or_default();
            return self.write(&answer, now);
        }
        if let Some(stalls) = self.stalls {
            let [whether, how_long] = [self.chance.f64(), self.chance.f64()];
            if whether < stalls.rate && now >= self.stall + stalls.apart {
                self.mishaps.stalls.fetch_add(1, Ordering::Relaxed);
                let spread = stalls.longest.saturating_sub(stalls.shortest);
                self.stall = now + stalls.shortest + spread.mul_f64(how_long);
            }
        }
        // It has no transport behind that can be lost, and no rule hangs up.
        let _ = self.faulty.send(frame);
        self.pass_on(now)
    }

    /// Writes what is due.
    fn deliver(&mut self) -> std::io::Result<()> {
        let mut last = None;
        while let Some(due) = self.next_due().filter(|due| *due <= self.clock.now()) {
            if due == self.stall {
                for bytes in std::mem::take(&mut self.held) {
                    self.write(&bytes, due)?;
                }
            }
            self.pass_on(due)?;
            // What is made each millisecond is never over with by catching up.
            if last.replace(due) >= Some(due) {
                break;
            }
        }
        Ok(())
    }

    /// Takes what the rules give by now, which was due at `due`.
    fn pass_on(&mut self, due: Duration) -> std::io::Result<()> {
        let mut chunk = [0; 512];
        while let Ok(count @ 1..) = self.faulty.receive(&mut chunk, Duration::ZERO) {
            if self.clock.now() < self.stall || !self.held.is_empty() {
                self.held.push(chunk[..count].to_vec());
            } else {
                self.write(&chunk[..count], due)?;
            }
        }
        Ok(())
    }

    fn write(&mut self, bytes: &[u8], due: Duration) -> std::io::Result<()> {
        let late = self.clock.now().saturating_sub(due);
        if late > WRITING {
            self.withhold(late, bytes);
            return Ok(());
        }
        if bytes.is_empty() {
            return Ok(());
        }
        self.master.write_all(bytes)?;
        let now = self.clock.now();
        let late = now.saturating_sub(due);
        self.wire.note(now, What::Written { late }, bytes);
        Ok(())
    }

    fn withhold(&self, late: Duration, bytes: &[u8]) {
        self.mishaps.withheld.fetch_add(1, Ordering::SeqCst);
        self.wire
            .note(self.clock.now(), What::Withheld { late }, bytes);
    }
}
