//! Why there is no answer.

use std::time::Duration;

use thiserror::Error;

use crate::codec::ExceptionCode;
use crate::transport::TransportError;
use crate::words::counted;

/// A request that was not answered as it should be, after all its attempts.
#[derive(Debug, Error)]
pub enum Failure {
    /// Nothing that could be an answer began in time.
    #[error("no answer within {}{}", humantime::format_duration(*.timeout), noticed(*.others, *.stray))]
    Silence {
        /// How long was waited for an answer to begin.
        timeout: Duration,
        /// Valid frames of other units seen meanwhile.
        others: usize,
        /// Bytes that belong to no frame.
        stray: usize,
    },
    /// The program was stopped before an answer began.
    #[error("no answer before the program was stopped")]
    Stopped,
    /// Only the own request came back.
    #[error("nothing but the echo of the own request came back")]
    OnlyEcho,
    /// An answer began and broke off.
    #[error("the answer broke off after {received} of {expected} bytes")]
    Truncated {
        /// Bytes that came.
        received: usize,
        /// Bytes the answer has.
        expected: usize,
    },
    /// An answer came damaged, or bytes that are no frame at all.
    #[error("the answer was damaged: {received} bytes without a valid CRC")]
    Damaged {
        /// Bytes that came.
        received: usize,
    },
    /// A valid frame from the unit that does not answer this request.
    #[error("the unit answered something else: {found}")]
    Mismatch {
        /// What is wrong with it.
        found: String,
    },
    /// The meter refused.
    #[error("the meter refused: {0}")]
    Exception(ExceptionCode),
    /// Nothing was asked: a late answer to something else could not have been told from the right
    /// one.
    #[error("not asked, for a late answer to an earlier request could be taken for its answer")]
    Ambiguous,
    /// The line was never silent, so nothing could be asked.
    #[error("the line is never silent: {discarded} bytes came before a request could be sent")]
    NeverQuiet {
        /// Bytes thrown away.
        discarded: usize,
    },
    /// The port is gone.
    #[error(transparent)]
    Port(#[from] TransportError),
}

impl Failure {
    /// Whether asking again can help: the line failed, not the meter or the port.
    pub fn is_worth_a_retry(&self) -> bool {
        match self {
            // The line behind a gateway is a line as well.
            Self::Exception(code) => {
                *code == ExceptionCode::GATEWAY_TARGET_DEVICE_FAILED_TO_RESPOND
            }
            Self::Port(_) | Self::Ambiguous | Self::NeverQuiet { .. } | Self::Stopped => false,
            _ => true,
        }
    }

    /// Whether the port was lost before, and did not come back for this request. Asking anything
    /// else is likely to be as much in vain.
    pub const fn is_port_away(&self) -> bool {
        matches!(self, Self::Port(TransportError::NotBack { .. }))
    }

    /// Whether the unit said nothing at all.
    pub const fn is_silence(&self) -> bool {
        matches!(self, Self::Silence { .. } | Self::OnlyEcho)
    }
}

/// What else was heard while nothing answered.
fn noticed(others: usize, stray: usize) -> String {
    let mut heard = Vec::new();
    if others > 0 {
        let frames = counted(others as u64, "frame", "frames");
        heard.push(format!("{frames} of other units"));
    }
    if stray > 0 {
        heard.push(counted(stray as u64, "stray byte", "stray bytes"));
    }
    if heard.is_empty() {
        return String::new();
    }
    format!(", only {}", heard.join(" and "))
}
