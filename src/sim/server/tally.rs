//! What a server has heard and said.

use std::collections::BTreeMap;
use std::fmt;

use super::words::frames;
use crate::codec::{ExceptionCode, FunctionCode, Reply, rtu};
use crate::words::counted;

/// Counts of what was heard and said.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Tally {
    /// By function code: requests that were for the units here, or for all.
    requests: BTreeMap<u8, u64>,
    answers: u64,
    exceptions: BTreeMap<ExceptionCode, u64>,
    /// Pieces that went out and were no whole, right frame.
    spoiled: u64,
    /// Requests to units that are not here.
    foreign: u64,
    /// Requests for which there was no room among those that wait.
    lost: u64,
    /// Stretches of bytes that were no request.
    damaged: u64,
}

impl Tally {
    /// Requests that were for the units here, or for all.
    pub fn requests(&self) -> u64 {
        self.requests.values().sum()
    }

    /// Requests with this function code.
    pub fn requests_with(&self, function: FunctionCode) -> u64 {
        let count = self.requests.get(&function.get());
        count.copied().unwrap_or_default()
    }

    /// Normal responses that went out whole and right.
    pub const fn answers(&self) -> u64 {
        self.answers
    }

    /// Exception responses with this code.
    pub fn exceptions(&self, code: ExceptionCode) -> u64 {
        self.exceptions.get(&code).copied().unwrap_or_default()
    }

    /// Stretches of bytes that were no request.
    pub const fn not_understood(&self) -> u64 {
        self.damaged
    }

    pub(super) fn request(&mut self, frame: &[u8]) {
        let function = frame.get(1).copied().unwrap_or_default();
        *self.requests.entry(function).or_default() += 1;
    }

    pub(super) fn answer(&mut self, bytes: &[u8]) {
        for frame in frames(bytes) {
            match rtu::decode_reply(frame) {
                Ok((_, Reply::Normal(_))) => self.answers += 1,
                Ok((_, Reply::Exception { code, .. })) => {
                    *self.exceptions.entry(code).or_default() += 1;
                }
                Err(_) => self.spoiled += 1,
            }
        }
    }

    pub(super) const fn foreign(&mut self) {
        self.foreign += 1;
    }

    pub(super) const fn lost(&mut self) {
        self.lost += 1;
    }

    pub(super) const fn damaged(&mut self) {
        self.damaged += 1;
    }
}

impl fmt::Display for Tally {
    /// `3 requests (function 03: 2, 04: 1), 2 answers, 1 exception (02: 1)`, and what else there was.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&counted(self.requests(), "request", "requests"))?;
        if !self.requests.is_empty() {
            let functions = self.requests.iter();
            let functions = functions.map(|(function, count)| format!("{function:02X}: {count}"));
            write!(f, " (function {})", listed(functions))?;
        }
        write!(f, ", {}", counted(self.answers, "answer", "answers"))?;
        if !self.exceptions.is_empty() {
            let count: u64 = self.exceptions.values().sum();
            let codes = self.exceptions.iter();
            let codes = codes.map(|(code, count)| format!("{:02X}: {count}", code.0));
            let exceptions = counted(count, "exception", "exceptions");
            write!(f, ", {exceptions} ({})", listed(codes))?;
        }
        for (number, what) in [
            (self.spoiled, "spoiled"),
            (self.foreign, "to other units"),
            (self.lost, "lost because too many waited"),
            (self.damaged, "not understood"),
        ] {
            if number > 0 {
                write!(f, ", {number} {what}")?;
            }
        }
        Ok(())
    }
}

fn listed(items: impl Iterator<Item = String>) -> String {
    items.collect::<Vec<_>>().join(", ")
}
