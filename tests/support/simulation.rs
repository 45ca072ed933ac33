//! The real program as a simulated meter.

#![allow(dead_code, reason = "each test file uses its share")]

use std::io::{BufRead, BufReader, Read};
use std::os::unix::process::ExitStatusExt;
use std::path::PathBuf;
use std::process::{Child, ChildStderr, ChildStdout, Stdio};

use super::program::{Program, kill};

/// A run of `meterpoll simulate`. It is killed when dropped.
pub(crate) struct Simulation {
    child: Child,
    /// What the first line on stdout says.
    pub(crate) path: String,
    stdout: BufReader<ChildStdout>,
    stderr: ChildStderr,
}

/// How it ended: its exit code or the signal, what came on stdout after the first line, and stderr.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Ended {
    pub(crate) code: Option<i32>,
    pub(crate) signal: Option<i32>,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl Ended {
    /// With nothing more on stdout.
    pub(crate) fn with(code: i32, stderr: &str) -> Self {
        Self {
            code: Some(code),
            signal: None,
            stdout: String::new(),
            stderr: stderr.to_owned(),
        }
    }

    /// By a signal, with nothing more on stdout.
    pub(crate) fn by(signal: i32, stderr: &str) -> Self {
        Self {
            code: None,
            signal: Some(signal),
            stdout: String::new(),
            stderr: stderr.to_owned(),
        }
    }
}

impl Simulation {
    /// Starts it with these arguments, split at spaces, and waits until it is there.
    pub(crate) fn new(arguments: &str) -> Self {
        Self::start(&Program::new(&format!("simulate {arguments}")))
    }

    pub(crate) fn start(program: &Program) -> Self {
        let mut child = program
            .command()
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program starts");
        let mut first = String::new();
        let stdout = child.stdout.take().expect("it is piped");
        let mut stdout = BufReader::new(stdout);
        stdout.read_line(&mut first).expect("a line");
        let stderr = child.stderr.take().expect("it is piped");
        let path = first.trim_end().to_owned();
        let mut simulation = Self {
            child,
            path,
            stdout,
            stderr,
        };
        if simulation.path.is_empty() {
            let _ = simulation.child.kill();
            panic!("it did not start: {:?}", simulation.wait());
        }
        simulation
    }

    /// The address without its scheme.
    pub(crate) fn address(&self) -> &str {
        self.path.split_once("://").expect("a scheme").1
    }

    /// A run of `read-registers` on it, with these arguments.
    pub(crate) fn reading(&self, arguments: &str) -> Program {
        // The pace of a line is not what is tested here.
        let path = &self.path;
        Program::new(&format!("read-registers -p {path} -b 115200 {arguments}"))
    }

    /// Sends a signal, `INT` or `TERM`, and waits for the end.
    pub(crate) fn stop(mut self, signal: &str) -> Ended {
        kill(&self.child, signal);
        self.wait()
    }

    /// Waits for an end of its own.
    pub(crate) fn ended(mut self) -> Ended {
        self.wait()
    }

    fn wait(&mut self) -> Ended {
        let (mut stdout, mut stderr) = (String::new(), String::new());
        self.stderr.read_to_string(&mut stderr).expect("text");
        self.stdout.read_to_string(&mut stdout).expect("text");
        let status = self.child.wait().expect("it ends");
        Ended {
            code: status.code(),
            signal: status.signal(),
            stdout,
            stderr,
        }
    }
}

impl Drop for Simulation {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A path that is a test's own, with nothing there.
pub(crate) fn free_path(name: &str) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_file(&path);
    path
}
