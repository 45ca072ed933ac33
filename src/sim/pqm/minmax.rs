//! Minima and maxima of a PQM since they were cleared.

use std::cell::OnceCell;

use super::Reading;
use super::state::Cleared;
use super::table::{DEMANDS, QUANTITIES};
use crate::sim::history::{Extremes, since};
use crate::sim::words::rounded;

type OfQuantities = [Extremes; QUANTITIES.len()];

/// Worked out for the first of each kind that is asked for.
#[derive(Default)]
pub(super) struct Since {
    current: OnceCell<OfQuantities>,
    voltage: OnceCell<OfQuantities>,
    power: OnceCell<OfQuantities>,
    frequency: OnceCell<OfQuantities>,
    demand: OnceCell<[Extremes; DEMANDS.len()]>,
}

impl Since {
    /// Those of a row of [`QUANTITIES`], in steps of its register; `None` when they were never
    /// cleared.
    pub(super) fn of_quantity(&self, reading: &Reading<'_>, row: usize) -> Option<Extremes> {
        let (name, ..) = QUANTITIES.get(row)?;
        let (what, extremes) = match name.split('_').next()? {
            "current" => (Cleared::Current, &self.current),
            "voltage" => (Cleared::Voltage, &self.voltage),
            "frequency" => (Cleared::Frequency, &self.frequency),
            _ => (Cleared::Power, &self.power),
        };
        let cleared = reading.cleared(what)?;
        let extremes = extremes.get_or_init(|| {
            since::extremes(cleared, reading.now, |at| {
                let then = reading.pqm.read(at);
                QUANTITIES.map(|(_, quantity, step)| steps(then.raw(quantity, step)))
            })
        });
        let extremes = extremes.get(row)?;
        Some(reading.by_its_clock(extremes))
    }

    /// Those of a row of [`DEMANDS`], in steps of its register; `None` when they were never cleared.
    pub(super) fn of_demand(&self, reading: &Reading<'_>, row: usize) -> Option<Extremes> {
        // What is cleared with the running demands is all of them.
        let cleared = [Cleared::MaximumDemand, Cleared::Demand].map(|what| reading.cleared(what));
        let cleared = cleared.into_iter().flatten().max()?;
        let extremes = self.demand.get_or_init(|| {
            since::extremes(cleared, reading.now, |at| {
                let demand = reading.demand_at(at);
                DEMANDS.map(|(_, metered, step)| steps(rounded(demand.get(metered) / step)))
            })
        });
        let extremes = extremes.get(row)?;
        Some(reading.by_its_clock(extremes))
    }
}

#[expect(
    clippy::cast_precision_loss,
    reason = "registers have 32 bits, a double holds 53"
)]
const fn steps(register: i128) -> f64 {
    register as f64
}
