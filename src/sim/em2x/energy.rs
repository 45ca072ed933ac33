//! Counters of energy that add up to the last digit.
//!
//! A week adds a whole number of steps to each of them, which drops less than one a week. So the
//! sums of whole weeks are whole as well, and what holds within a week holds always.

use crate::sim::history::{Metered, Sums};
use crate::sim::load::Load;
use crate::sim::wave::{Moment, PERIOD_SECONDS};
use crate::sim::words::counter;

/// Watt seconds in a tenth of a kilowatt hour.
const STEP: f64 = 3.6e5;

/// The week, from 2020, at whose beginning the partial counters were set to zero.
const PARTIAL_WEEK: i32 = 260;

const HOUR: u32 = 3600;
const DAYS: u32 = 7;

/// The night, tariff 2, lasts from 22:00 to 06:00 UTC.
const NIGHT_BEGINS: u32 = 22;
const NIGHT_ENDS: u32 = 6;

/// Tenths of a kilowatt hour of each phase, and of a kilovar hour of all three.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Steps([i128; 4]);

impl Steps {
    const ZERO: Self = Self([0; 4]);

    fn of(sums: &Sums) -> Self {
        let metered = [
            Metered::RealPowerA,
            Metered::RealPowerB,
            Metered::RealPowerC,
            Metered::ReactivePower,
        ];
        Self(metered.map(|metered| counter(sums.get(metered) / STEP)))
    }

    /// Of one phase, 0 to 2.
    pub(super) const fn phase(&self, phase: usize) -> i128 {
        self.0[phase]
    }

    /// Of all phases: their sum.
    pub(super) const fn active(&self) -> i128 {
        self.0[0] + self.0[1] + self.0[2]
    }

    /// Reactive energy of all phases.
    pub(super) const fn reactive(&self) -> i128 {
        self.0[3]
    }

    fn plus(self, times: i128, other: Self) -> Self {
        Self([0, 1, 2, 3].map(|row| self.0[row] + times * other.0[row]))
    }
}

/// All counters at one instant.
#[derive(Debug, Default)]
pub(super) struct Energy {
    /// Since 2020.
    pub(super) total: Steps,
    /// Since the partial counters were set to zero.
    pub(super) partial: Steps,
    /// Of `total`, what was taken by night.
    pub(super) night: Steps,
}

impl Energy {
    pub(super) fn of(load: &Load, moment: Moment) -> Self {
        if moment.week < 0 {
            let none = Steps::ZERO;
            return Self {
                total: none,
                partial: none,
                night: none,
            };
        }
        let history = load.history();
        let until = |moment| Steps::of(&history.sums(load, moment));
        let end = Moment::in_week(PERIOD_SECONDS);
        let moment_of_week = Moment { week: 0, ..moment };
        let (this_week, week) = (until(moment_of_week), until(end));
        // What a week has brought by night when so many seconds of it have brought so much.
        let by_night = |seconds: u32, so_far: Steps| {
            let until_hour = |hour: u32| match hour * HOUR {
                second if second <= seconds => until(Moment::in_week(second)),
                _ => so_far,
            };
            (0..=DAYS).fold(Steps::ZERO, |sum, day| {
                let midnight = 24 * day;
                let begin = midnight.saturating_sub(24 - NIGHT_BEGINS);
                let stop = (midnight + NIGHT_ENDS).min(24 * DAYS);
                sum.plus(1, until_hour(stop)).plus(-1, until_hour(begin))
            })
        };
        let weeks = i128::from(moment.week);
        let partial_weeks = match moment.week - PARTIAL_WEEK {
            since if since >= 0 => since.into(),
            _ => weeks,
        };
        Self {
            total: this_week.plus(weeks, week),
            partial: this_week.plus(partial_weeks, week),
            night: by_night(moment.second, this_week).plus(weeks, by_night(PERIOD_SECONDS, week)),
        }
    }

    /// What has been added since it was `earlier`.
    pub(super) fn since(&self, earlier: &Self) -> Self {
        Self {
            total: self.total.plus(-1, earlier.total),
            partial: self.partial.plus(-1, earlier.partial),
            night: self.night.plus(-1, earlier.night),
        }
    }

    /// Of `total`, what was taken by day: tariff 1.
    pub(super) fn day(&self) -> Steps {
        self.total.plus(-1, self.night)
    }
}

/// Whether tariff 2 is in force.
pub(super) const fn is_night(moment: Moment) -> bool {
    let hour = moment.second / HOUR % 24;
    hour >= NIGHT_BEGINS || hour < NIGHT_ENDS
}
