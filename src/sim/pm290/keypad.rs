//! Somebody at the keys of a PM290.

use jiff::Timestamp;

use crate::codec::RegisterRange;

/// When the keys of the meter are in use. Until they are left alone again it answers exception 06
/// to whatever touches tables 6 to 11 (page 18).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Keypad {
    /// Never.
    Idle,
    /// Always.
    InUse,
    /// In the first two seconds of every hour, UTC.
    Hourly,
}

/// Seconds that the keys are in use of each hour.
const IN_USE: i64 = 2;

impl Keypad {
    /// Whether they stand in the way of a request for these registers.
    pub(super) fn blocks(self, range: RegisterRange, now: Timestamp) -> bool {
        let is_in_use = match self {
            Self::Idle => false,
            Self::InUse => true,
            Self::Hourly => now.as_second().rem_euclid(3600) < IN_USE,
        };
        let table = |address: u32| address >> 8;
        let touches = table(range.end() - 1) >= 6 && table(range.start().get().into()) <= 11;
        is_in_use && touches
    }
}
