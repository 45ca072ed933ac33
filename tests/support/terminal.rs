//! The program with a terminal for somebody who answers its questions.

#![allow(dead_code, reason = "each test file uses its share")]

use std::fs::File;
use std::io::{Read, Write};
use std::os::fd::OwnedFd;
use std::os::unix::process::ExitStatusExt;
use std::process::{Child, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;

use rustix::event::{PollFd, PollFlags, Timespec, poll};

use super::program::{Program, kill};
use super::pty::pair;
use super::waiting::wait_until;

/// A run whose stdin and stderr are a terminal; stdout is not.
pub(crate) struct Terminal {
    child: Child,
    master: Option<File>,
    said: Arc<Mutex<Vec<u8>>>,
    reading: Option<JoinHandle<()>>,
    /// Tells the thread that reads to let the terminal go.
    is_gone: Arc<AtomicBool>,
}

/// How it ended, and all it said.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct End {
    pub(crate) code: Option<i32>,
    pub(crate) signal: Option<i32>,
    pub(crate) stdout: String,
    pub(crate) terminal: String,
}

impl Terminal {
    /// Starts it.
    pub(crate) fn start(program: &Program) -> Self {
        let (master, slave, _) = pair().expect("a pty pair");
        let same = |slave: &OwnedFd| Stdio::from(slave.try_clone().expect("one more descriptor"));
        let child = program
            .command()
            .stdin(same(&slave))
            .stdout(Stdio::piped())
            .stderr(same(&slave))
            .spawn()
            .expect("the program starts");
        let said: Arc<Mutex<Vec<u8>>> = Arc::default();
        let (heard, mut reader) = (Arc::clone(&said), master.try_clone().expect("a descriptor"));
        let is_gone: Arc<AtomicBool> = Arc::default();
        let gone = Arc::clone(&is_gone);
        let reading = std::thread::spawn(move || {
            let mut chunk = [0; 256];
            while !gone.load(Ordering::SeqCst) {
                // A thread that waits in a read would hold the terminal.
                let mut there = [PollFd::new(&reader, PollFlags::IN)];
                let millisecond = Timespec {
                    tv_sec: 0,
                    tv_nsec: 1_000_000,
                };
                if poll(&mut there, Some(&millisecond)).is_ok_and(|ready| ready == 0) {
                    continue;
                }
                // Reading fails once the program has ended.
                let Ok(count @ 1..) = reader.read(&mut chunk) else {
                    return;
                };
                let mut heard = heard.lock().expect("nobody panicked");
                heard.extend_from_slice(&chunk[..count]);
            }
        });
        Self {
            child,
            master: Some(master),
            said,
            reading: Some(reading),
            is_gone,
        }
    }

    /// What it has said on the terminal so far.
    pub(crate) fn said(&self) -> String {
        let said = self.said.lock().expect("nobody panicked").clone();
        String::from_utf8(said).expect("UTF-8")
    }

    /// Waits until it has asked so often.
    pub(crate) fn is_asked(&self, times: usize) {
        wait_until(|| self.said().matches("Type yes: ").count() == times);
    }

    /// Types something.
    pub(crate) fn types(&mut self, text: &str) {
        let master = self.master.as_mut().expect("it is there");
        master.write_all(text.as_bytes()).expect("it is read");
    }

    /// The terminal is gone. What it said before stays.
    pub(crate) fn hangs_up(&mut self) {
        drop(self.master.take());
        self.is_gone.store(true, Ordering::SeqCst);
        if let Some(reading) = self.reading.take() {
            reading.join().expect("it did not panic");
        }
    }

    /// Sends a signal, `INT` or `TERM`.
    pub(crate) fn signal(&self, signal: &str) {
        kill(&self.child, signal);
    }

    /// Waits for the end.
    pub(crate) fn end(mut self) -> End {
        let mut stdout = String::new();
        let mut out = self.child.stdout.take().expect("it is piped");
        out.read_to_string(&mut stdout).expect("text");
        let status = self.child.wait().expect("it ends");
        drop(self.master.take());
        if let Some(reading) = self.reading.take() {
            reading.join().expect("it did not panic");
        }
        End {
            code: status.code(),
            signal: status.signal(),
            stdout,
            terminal: self.said(),
        }
    }
}

impl Drop for Terminal {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
