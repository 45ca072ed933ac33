//! What the program ends with.

use super::signals;
use crate::readings::Fault;

/// The exit codes that scripts rely on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum ExitCode {
    /// Everything asked for was done.
    Done = 0,
    /// Some readings are missing, the others were delivered.
    SomeMissing = 1,
    /// The command line or a profile is wrong, or the request was refused before sending.
    Usage = 2,
    /// The port is not there, busy, not permitted, or was lost.
    Port = 3,
    /// No valid answer: silence, damaged or mismatched frames.
    NoAnswer = 4,
    /// The meter refused.
    Refused = 5,
    /// The outcome of a write is unknown, or the value read back differs.
    WriteUnknown = 6,
    /// Output could not be written.
    Output = 7,
    /// Stopped by SIGHUP, as when a window is closed, after the row in hand was finished.
    HungUp = 129,
    /// Stopped by SIGINT, after the row in hand was finished.
    Interrupted = 130,
    /// Stopped by SIGTERM, after the row in hand was finished.
    Terminated = 143,
}

impl ExitCode {
    /// Ends the process: for a signal as the signal would have, else with the code returned.
    pub fn end(self) -> std::process::ExitCode {
        signals::die(self);
        (self as u8).into()
    }

    /// What a whole run amounts to: `delivered` readings and these faults.
    pub(super) fn of(delivered: usize, faults: &[Fault]) -> Self {
        let Some(worst) = faults.iter().max() else {
            return Self::Done;
        };
        if delivered > 0 {
            return Self::SomeMissing;
        }
        match worst {
            Fault::Port => Self::Port,
            Fault::Timeout | Fault::Crc | Fault::Truncated | Fault::Mismatch => Self::NoAnswer,
            Fault::Exception(_) => Self::Refused,
            // The meter answered well; it has no such values.
            Fault::Overflow | Fault::Absent => Self::SomeMissing,
        }
    }
}
