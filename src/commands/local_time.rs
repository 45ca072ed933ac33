//! The clock on the wall, which is what meters keep.

use std::fmt;
use std::time::Duration;

use jiff::civil::DateTime;
use jiff::tz::TimeZone;
use jiff::{Timestamp, Zoned};

use super::CommandError;

/// What stands for the present.
pub(super) const NOW: &str = "now";

/// A time to set a clock to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Moment {
    /// The one at which it is sent.
    Now,
    /// Another one, local time.
    At(DateTime),
}

impl Moment {
    /// `now`, a local date and time, or one with an offset, which becomes local time.
    ///
    /// # Errors
    /// [`CommandError::NoMoment`] for anything else.
    pub(super) fn parse(text: &str) -> Result<Self, CommandError> {
        let text = text.trim();
        if text == NOW {
            return Ok(Self::Now);
        }
        let local = || -> Option<DateTime> {
            if let Ok(zoned) = text.parse::<Zoned>() {
                return Some(at(zoned.timestamp()));
            }
            match text.parse::<Timestamp>() {
                Ok(instant) => Some(at(instant)),
                // Without a time of day it would be midnight, which nobody has said.
                Err(_) if !text.contains(':') => None,
                Err(_) => text.parse().ok(),
            }
        };
        local().map(Self::At).ok_or_else(|| CommandError::NoMoment {
            found: text.to_owned(),
        })
    }

    /// The local time that a clock shows at `now` when it was set to this moment so long before.
    pub(super) fn civil(self, now: Timestamp, since: Duration) -> DateTime {
        match self {
            Self::Now => at(now),
            Self::At(moment) => moment.saturating_add(since),
        }
    }
}

impl fmt::Display for Moment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Now => f.write_str("this computer's local time"),
            Self::At(moment) => write!(f, "{} {:.3}", moment.date(), moment.time()),
        }
    }
}

fn at(instant: Timestamp) -> DateTime {
    instant.to_zoned(TimeZone::system()).datetime()
}
