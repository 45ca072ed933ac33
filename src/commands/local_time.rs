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
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Moment {
    /// The one at which it is sent, in this zone.
    Now(TimeZone),
    /// Another one, local time.
    At(DateTime),
}

impl Moment {
    /// `now`, a local date and time, or one with an offset or a zone, which becomes local time.
    ///
    /// # Errors
    /// [`CommandError::NoMoment`] for anything else, [`CommandError::NoTimeZone`] when this computer
    /// does not tell where it is.
    pub(super) fn parse(text: &str) -> Result<Self, CommandError> {
        let text = &text.trim().replace(' ', "T");
        if text == NOW {
            return Self::now();
        }
        let instant = text.parse::<Zoned>().map(|zoned| zoned.timestamp());
        if let Ok(instant) = instant.or_else(|_| text.parse::<Timestamp>()) {
            return Ok(Self::At(instant.to_zoned(zone()?).datetime()));
        }
        // Without a time of day it would be midnight, which nobody has said; a zone that is not known
        // is not to be passed over.
        let is_local = text.contains(':') && !text.contains('[');
        let local = text.parse::<DateTime>().ok().filter(|_| is_local);
        local.map(Self::At).ok_or_else(|| CommandError::NoMoment {
            found: text.to_owned(),
        })
    }

    /// The present.
    ///
    /// # Errors
    /// [`CommandError::NoTimeZone`].
    pub(super) fn now() -> Result<Self, CommandError> {
        Ok(Self::Now(zone()?))
    }

    /// The local time that a clock shows at `now` when it was set to this moment so long before.
    pub(super) fn civil(&self, now: Timestamp, since: Duration) -> DateTime {
        match self {
            Self::Now(zone) => now.to_zoned(zone.clone()).datetime(),
            Self::At(moment) => moment.saturating_add(since),
        }
    }
}

impl fmt::Display for Moment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Now(_) => f.write_str("this computer's local time"),
            Self::At(moment) => write!(f, "{} {:.3}", moment.date(), moment.time()),
        }
    }
}

/// Where this computer is.
fn zone() -> Result<TimeZone, CommandError> {
    TimeZone::try_system().map_err(|error| CommandError::NoTimeZone {
        problem: error.to_string(),
    })
}
