//! `clock=now`: the points that set a meter's clock, both from one moment.

use std::fmt;
use std::time::Duration;

use jiff::Timestamp;

use crate::commands::CommandError;
use crate::commands::local_time::Moment;
use crate::profile::Profile;
use crate::profile::assignment::Assignment;
use crate::profile::writing::ClockPoints;

/// The name under which both points are set.
pub(super) const NAME: &str = "clock";

/// The points that set a meter's clock, and the moment they are set to.
#[derive(Debug, Clone)]
pub(super) struct ClockSetting<'a> {
    profile: &'a Profile,
    points: &'a ClockPoints,
    moment: Moment,
}

impl<'a> ClockSetting<'a> {
    /// What `clock=VALUE` means for this meter; `None` for anything else.
    ///
    /// # Errors
    /// [`CommandError`] for a meter without a clock and for a value that is no moment.
    pub(super) fn parse(
        typed: &str,
        profile: Option<&'a Profile>,
    ) -> Result<Option<Self>, CommandError> {
        let Some((NAME, value)) = typed.split_once('=') else {
            return Ok(None);
        };
        let Some(profile) = profile else {
            return Ok(None);
        };
        if profile.point(NAME).is_some() {
            return Ok(None);
        }
        let points = profile.clock.as_ref();
        let points = points.ok_or_else(|| CommandError::NoClock {
            meter: profile.name.clone(),
        })?;
        Ok(Some(Self {
            profile,
            points,
            moment: Moment::parse(value)?,
        }))
    }

    /// What the clock is to show when it is `now`, so long after it was set.
    pub(super) fn assignments(&self, now: Timestamp, since: Duration) -> Vec<Assignment> {
        let moment = self.moment.civil(now, since);
        let values = [
            (&self.points.time, format!("{:.3}", moment.time())),
            (&self.points.date, moment.date().to_string()),
        ];
        let assignments = values.into_iter().filter_map(|(name, value)| {
            // The loader has looked for both.
            let point = self.profile.point(name)?;
            Some(Assignment::new(point.clone(), value))
        });
        assignments.collect()
    }
}

impl fmt::Display for ClockSetting<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.moment.fmt(f)
    }
}
