//! What has been set to zero over the line (EM21 page 10, EM24 page 13), and what shows because of it.

use jiff::Timestamp;

use super::em24::hours;
use super::energy::Energy;
use super::inputs;
use crate::sim::history::{Metered, since};
use crate::sim::load::Load;
use crate::sim::wave::Moment;

/// What had been counted when it was set to zero.
#[derive(Debug, Default)]
pub(super) struct Resets {
    energy: Energy,
    /// Hundredths of an hour.
    pub(super) hours: i128,
    counters: [i128; 3],
    demand: Option<Timestamp>,
}

const COUNTERS: [&str; 3] = ["counter_1", "counter_2", "counter_3"];

impl Resets {
    /// Sets to zero what belongs to the point of this name. All meters, which are not the hours, are
    /// taken to be the total ones, with those of phases and tariffs, and the partial ones: which there
    /// are is on a page that could not be had.
    pub(super) fn reset(&mut self, point: &str, load: &Load, now: Timestamp) {
        let moment = Moment::of(now);
        let energy = || Energy::of(load, moment);
        match point {
            "reset_all_meters" => self.energy = energy(),
            "reset_total_meters" => {
                self.energy = Energy {
                    partial: self.energy.partial,
                    ..energy()
                }
            }
            "reset_partial_meters" => self.energy.partial = energy().partial,
            "reset_hour_counter" => self.hours = hours(moment),
            "reset_counters" => {
                let counted = |counter| inputs::get(counter, moment).unwrap_or_default();
                self.counters = COUNTERS.map(counted);
            }
            "reset_demand_max" => self.demand = Some(now),
            _ => {}
        }
    }

    /// What has been counted since.
    pub(super) fn energy(&self, load: &Load, moment: Moment) -> Energy {
        Energy::of(load, moment).since(&self.energy)
    }

    /// What a point of this name had counted; 0 for what is no counter.
    pub(super) fn counter(&self, point: &str) -> i128 {
        let counters = COUNTERS.iter().zip(self.counters);
        let mut counted = counters.filter(|(name, _)| **name == point);
        counted.next().map_or(0, |(_, counted)| counted)
    }

    /// The highest demand since.
    pub(super) fn highest(&self, load: &Load, metered: Metered, now: Timestamp) -> f64 {
        let history = load.history();
        let Some(cleared) = self.demand else {
            return history.of_demand(metered).highest;
        };
        let demand = |at| [history.demand(load, Moment::of(at)).get(metered)];
        let [extremes] = since::extremes(cleared, now, demand);
        extremes.highest
    }
}
