//! Runs the real binary and compares everything it does. The default expectation is silence and
//! success: a test says what else it wants to see.

#![allow(dead_code, reason = "each test file uses its own share")]

use std::ffi::OsString;
use std::io::Write;
use std::path::PathBuf;
use std::process::{Child, Command, Output, Stdio};

/// One run of the program and what is expected of it.
#[must_use = "call run()"]
pub(crate) struct Program {
    arguments: Vec<OsString>,
    variables: Vec<(&'static str, OsString)>,
    folder: Option<PathBuf>,
    stdout: String,
    stderr: String,
    code: i32,
}

impl Program {
    /// A run with these arguments, split at spaces.
    pub(crate) fn new(arguments: &str) -> Self {
        Self {
            arguments: arguments.split_whitespace().map(OsString::from).collect(),
            // A configuration folder of the person who runs the tests must not matter.
            variables: vec![("XDG_CONFIG_HOME", "/nonexistent".into())],
            folder: None,
            stdout: String::new(),
            stderr: String::new(),
            code: 0,
        }
    }

    /// One more argument, spaces and all.
    pub(crate) fn argument(mut self, argument: impl Into<OsString>) -> Self {
        self.arguments.push(argument.into());
        self
    }

    /// More arguments, split at spaces.
    pub(crate) fn arguments(mut self, arguments: &str) -> Self {
        let arguments = arguments.split_whitespace().map(OsString::from);
        self.arguments.extend(arguments);
        self
    }

    /// An environment variable.
    pub(crate) fn variable(mut self, name: &'static str, value: impl Into<OsString>) -> Self {
        self.variables.push((name, value.into()));
        self
    }

    /// The folder it runs in, in place of the package's own.
    pub(crate) fn folder(mut self, folder: impl Into<PathBuf>) -> Self {
        self.folder = Some(folder.into());
        self
    }

    /// What stdout must be; times read `<time>`.
    pub(crate) fn stdout(mut self, expected: impl Into<String>) -> Self {
        self.stdout = expected.into();
        self
    }

    /// What stderr must be; times read `<time>`.
    pub(crate) fn stderr(mut self, expected: impl Into<String>) -> Self {
        self.stderr = expected.into();
        self
    }

    /// What the exit code must be.
    pub(crate) fn code(mut self, expected: i32) -> Self {
        self.code = expected;
        self
    }

    /// The command, to be run by the test itself.
    pub(crate) fn command(&self) -> Command {
        let mut command = Command::new(binary());
        command
            .args(&self.arguments)
            .env_remove("METERPOLL_PORT")
            .envs(self.variables.iter().map(|(name, value)| (name, value)))
            .stdin(Stdio::null());
        if let Some(folder) = &self.folder {
            command.current_dir(folder);
        }
        command
    }

    /// Runs it and returns what it did, unchecked.
    pub(crate) fn output(&self) -> Output {
        self.command().output().expect("the program starts")
    }

    /// Runs it and compares.
    #[track_caller]
    pub(crate) fn run(self) {
        let output = self.output();
        let stdout = without_times(&String::from_utf8_lossy(&output.stdout));
        let stderr = without_times(&String::from_utf8_lossy(&output.stderr));
        let found = (output.status.code(), stdout.as_str(), stderr.as_str());
        let expected = (Some(self.code), self.stdout.as_str(), self.stderr.as_str());
        if found != expected {
            let mut err = std::io::stderr().lock();
            let _ = writeln!(err, "--- stdout\n{stdout}--- stderr\n{stderr}---");
        }
        assert_eq!(found, expected, "{:?}", self.arguments);
    }
}

/// The program under test.
pub(crate) fn binary() -> PathBuf {
    PathBuf::from(env!("CARGO_BIN_EXE_meterpoll"))
}

/// Sends a signal, `INT` or `TERM`, to a child.
pub(crate) fn kill(child: &Child, signal: &str) {
    let pid = child.id().to_string();
    let status = Command::new("kill").args(["-s", signal, &pid]).status();
    assert!(status.expect("kill is there").success());
}

/// Replaces every time stamp with `<time>`: `2026-11-22T04:16:33.123Z` as data has it, and
/// `2026-11-22 04:16:33 UTC` as headings have it.
pub(crate) fn without_times(text: &str) -> String {
    const SHAPES: [&str; 2] = ["dddd-dd-ddTdd:dd:dd.dddZ", "dddd-dd-dd dd:dd:dd UTC"];
    let mut result = String::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let stamp = SHAPES.iter().find(|shape| has_shape(rest, shape));
        if let Some(shape) = stamp {
            result.push_str("<time>");
            rest = &rest[shape.len()..];
        } else {
            result.push(first);
            rest = &rest[first.len_utf8()..];
        }
    }
    result
}

fn has_shape(text: &str, shape: &str) -> bool {
    text.len() >= shape.len()
        && text
            .bytes()
            .zip(shape.bytes())
            .all(|(found, wanted)| match wanted {
                b'd' => found.is_ascii_digit(),
                _ => found == wanted,
            })
}
