//! A run of the real program that a test follows while it goes on.

#![allow(dead_code, reason = "each test file uses its share")]

use std::io::{BufRead, BufReader, Read};
use std::os::unix::process::ExitStatusExt;
use std::process::{Child, ChildStdout, Command, Stdio};

use super::program::{Program, without_times};

/// A run, and what it has said so far. Nothing takes what it says on stderr before it ends.
pub(crate) struct Run {
    pub(crate) child: Child,
    out: BufReader<ChildStdout>,
    said: String,
}

/// How a run ended: its exit code or the signal, and all it said.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct End {
    pub(crate) code: Option<i32>,
    pub(crate) signal: Option<i32>,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl Run {
    /// Starts the program with these arguments, split at spaces.
    pub(crate) fn start(arguments: &str) -> Self {
        let mut child = Program::new(arguments)
            .command()
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program starts");
        let out = BufReader::new(child.stdout.take().expect("it is piped"));
        Self {
            child,
            out,
            said: String::new(),
        }
    }

    /// Waits until so many lines have come on stdout.
    pub(crate) fn wait_for_lines(&mut self, lines: usize) {
        while self.said.lines().count() < lines {
            assert_ne!(self.out.read_line(&mut self.said).expect("text"), 0);
        }
    }

    /// Sends a signal, `INT` or `TERM`.
    pub(crate) fn signal(&self, signal: &str) {
        send(&self.child, signal);
    }

    /// Waits for the end.
    pub(crate) fn end(mut self) -> End {
        self.out.read_to_string(&mut self.said).expect("text");
        let output = self.child.wait_with_output().expect("it ends");
        End {
            code: output.status.code(),
            signal: output.status.signal(),
            stdout: self.said,
            stderr: String::from_utf8(output.stderr).expect("text"),
        }
    }

    /// Waits for the end and compares.
    #[track_caller]
    pub(crate) fn ends(self, code: i32, stdout: &str, stderr: &str) {
        let end = self.end();
        let found = (end.code, without_times(&end.stdout), end.stderr);
        assert_eq!(found, (Some(code), stdout.to_owned(), stderr.to_owned()));
    }
}

/// Sends a signal to a child.
pub(crate) fn send(child: &Child, signal: &str) {
    let pid = child.id().to_string();
    let status = Command::new("kill").args(["-s", signal, &pid]).status();
    assert!(status.expect("kill is there").success());
}
