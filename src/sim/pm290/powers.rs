//! Powers that add up on scales of which zero is no raw number.

use super::scale::{FULL, clipped};
use super::setup::Wiring;
use crate::sim::load::{Quantity, Values};
use crate::sim::words::rounded;

/// The raw number of nothing: half of 9999, rounded.
const ZERO: i128 = 5000;

/// Raw numbers of the phases and of all three, before they are clipped. They are worked out from
/// each other after rounding, as far as rounded numbers allow.
pub(super) struct Powers {
    active: [i128; 4],
    reactive: [i128; 4],
    apparent: [i128; 4],
    factor: [i128; 4],
    has_phases: bool,
}

impl Powers {
    /// On a scale from as far below zero as `full` lies above.
    pub(super) fn of(values: &Values, full: f64, wiring: Wiring) -> Self {
        use Quantity as Q;

        let with_total = |phases: [Quantity; 3]| {
            let raw = |quantity| from_middle(values.get(quantity) / full * f64::from(FULL));
            let [a, b, c] = phases.map(raw);
            // Each raw number stands for so much above -full: the sum of three for two more of those.
            [a, b, c, a + b + c - i128::from(FULL)]
        };
        let active = with_total([Q::RealPowerA, Q::RealPowerB, Q::RealPowerC]);
        let reactive = with_total([Q::ReactivePowerA, Q::ReactivePowerB, Q::ReactivePowerC]);
        let apparent =
            [0, 1, 2, 3].map(|row| from_middle(middle(active[row]).hypot(middle(reactive[row]))));
        let factor = [0, 1, 2, 3]
            .map(|row| from_middle(middle(active[row]) / middle(apparent[row]) * f64::from(FULL)));
        Self {
            active,
            reactive,
            apparent,
            factor,
            has_phases: wiring.has_four_wires(),
        }
    }

    /// The register of a point that is a power or a power factor. With three wires those of a phase
    /// mean nothing; the guide says that they read 0 in ASCII (page 5) and not what they read here.
    pub(super) fn get(&self, point: &str) -> Option<i128> {
        let (what, phase) = point.rsplit_once('_')?;
        let row = ["a", "b", "c", "total"]
            .iter()
            .position(|name| *name == phase)?;
        let rows = match what {
            "active_power" => &self.active,
            "reactive_power" => &self.reactive,
            "apparent_power" => &self.apparent,
            "power_factor" => &self.factor,
            _ => return None,
        };
        if phase != "total" && !self.has_phases {
            return Some(ZERO);
        }
        Some(clipped(rows[row]))
    }
}

/// How far a raw number lies from the middle of the scale, in half steps: always an odd number.
fn middle(raw: i128) -> f64 {
    #[expect(
        clippy::cast_precision_loss,
        reason = "within a few times 9999; a double holds 53 bits"
    )]
    let raw = raw as f64;
    2.0 * raw - f64::from(FULL)
}

/// The raw number nearest to this many half steps from the middle.
fn from_middle(half_steps: f64) -> i128 {
    rounded(f64::midpoint(half_steps, FULL.into()))
}
