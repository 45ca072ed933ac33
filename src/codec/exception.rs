//! Exception codes: why a meter refuses.

use std::fmt;

/// An exception code (AP 7). Unknown codes survive and print as numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ExceptionCode(pub u8);

impl ExceptionCode {
    /// 01: the meter does not know the function.
    pub const ILLEGAL_FUNCTION: Self = Self(0x01);
    /// 02: there is no such register, or not that many from there.
    pub const ILLEGAL_DATA_ADDRESS: Self = Self(0x02);
    /// 03: a value or count the meter does not take.
    pub const ILLEGAL_DATA_VALUE: Self = Self(0x03);
    /// 04: the meter failed while it tried.
    pub const SERVER_DEVICE_FAILURE: Self = Self(0x04);
    /// 05: accepted, still working.
    pub const ACKNOWLEDGE: Self = Self(0x05);
    /// 06: busy, nothing was done.
    pub const SERVER_DEVICE_BUSY: Self = Self(0x06);
    /// 08: a memory parity error.
    pub const MEMORY_PARITY_ERROR: Self = Self(0x08);
    /// 0A: a gateway has no path.
    pub const GATEWAY_PATH_UNAVAILABLE: Self = Self(0x0A);
    /// 0B: a gateway got no answer from the meter behind it.
    pub const GATEWAY_TARGET_DEVICE_FAILED_TO_RESPOND: Self = Self(0x0B);

    /// Whether a gateway says so (0A, 0B), and not the unit behind it: that one can still answer.
    pub const fn is_of_gateway(self) -> bool {
        matches!(
            self,
            Self::GATEWAY_PATH_UNAVAILABLE | Self::GATEWAY_TARGET_DEVICE_FAILED_TO_RESPOND
        )
    }

    /// Whether the unit says that it is at work (05, 06): what was asked may be answered all the
    /// same.
    pub const fn is_at_work(self) -> bool {
        matches!(self, Self::ACKNOWLEDGE | Self::SERVER_DEVICE_BUSY)
    }

    /// The standard's name, where the code has one.
    pub const fn name(self) -> Option<&'static str> {
        Some(match self {
            Self::ILLEGAL_FUNCTION => "ILLEGAL FUNCTION",
            Self::ILLEGAL_DATA_ADDRESS => "ILLEGAL DATA ADDRESS",
            Self::ILLEGAL_DATA_VALUE => "ILLEGAL DATA VALUE",
            Self::SERVER_DEVICE_FAILURE => "SERVER DEVICE FAILURE",
            Self::ACKNOWLEDGE => "ACKNOWLEDGE",
            Self::SERVER_DEVICE_BUSY => "SERVER DEVICE BUSY",
            Self::MEMORY_PARITY_ERROR => "MEMORY PARITY ERROR",
            Self::GATEWAY_PATH_UNAVAILABLE => "GATEWAY PATH UNAVAILABLE",
            Self::GATEWAY_TARGET_DEVICE_FAILED_TO_RESPOND => {
                "GATEWAY TARGET DEVICE FAILED TO RESPOND"
            }
            _ => return None,
        })
    }
}

impl fmt::Display for ExceptionCode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.name() {
            Some(name) => write!(f, "exception {:02X} ({name})", self.0),
            None => write!(f, "exception {:02X}", self.0),
        }
    }
}
