//! Why a reading is missing.

use std::fmt;

use crate::client::Failure;
use crate::codec::ExceptionCode;
use crate::profile::Missing;

/// Why a reading is missing, from the least to the worst. Prints as the `status` of outputs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Fault {
    /// `absent`: the meter has no such value now.
    Absent,
    /// `overflow`: the quantity is beyond what the meter measures.
    Overflow,
    /// `exception:N`: the meter refused.
    Exception(ExceptionCode),
    /// `mismatch`: the meter answered something else, or registers that hold no value.
    Mismatch,
    /// `truncated`: the answer broke off.
    Truncated,
    /// `crc`: the answer was damaged.
    Crc,
    /// `timeout`: no answer.
    Timeout,
    /// `port`: the port was lost.
    Port,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Absent => f.write_str("absent"),
            Self::Overflow => f.write_str("overflow"),
            Self::Exception(code) => write!(f, "exception:{}", code.0),
            Self::Mismatch => f.write_str("mismatch"),
            Self::Truncated => f.write_str("truncated"),
            Self::Crc => f.write_str("crc"),
            Self::Timeout => f.write_str("timeout"),
            Self::Port => f.write_str("port"),
        }
    }
}

impl From<&Failure> for Fault {
    fn from(failure: &Failure) -> Self {
        match failure {
            Failure::Silence { .. }
            | Failure::Stopped
            | Failure::OnlyEcho
            | Failure::Ambiguous
            | Failure::NeverQuiet { .. } => Self::Timeout,
            Failure::Truncated { .. } => Self::Truncated,
            Failure::Damaged { .. } => Self::Crc,
            Failure::Mismatch { .. } => Self::Mismatch,
            Failure::Exception(code) => Self::Exception(*code),
            Failure::Port(_) => Self::Port,
        }
    }
}

impl From<Missing> for Fault {
    fn from(missing: Missing) -> Self {
        match missing {
            Missing::Overflow => Self::Overflow,
            Missing::Absent => Self::Absent,
            Missing::Mismatch => Self::Mismatch,
        }
    }
}
