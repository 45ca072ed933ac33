//! LIN3, the conversion of the PM290's measurements, and its full scales (page 19).

use super::setup::Setup;
use crate::sim::words::rounded;

/// The highest raw number: what lies above the full scale shows as this.
pub(super) const FULL: i32 = 9999;

/// The ends of the scales.
#[derive(Debug, Clone, Copy)]
pub(super) struct FullScale {
    /// Vmax, V.
    pub(super) voltage: f64,
    /// Imax, A.
    pub(super) current: f64,
    /// Pmax, W, var and VA; the other end is as far below zero.
    pub(super) power: f64,
}

impl FullScale {
    /// Vmax is 660 V without voltage transformers, else 144 V times their ratio; Imax is 1.2 times
    /// the primary of the current transformers; Pmax is three times the product of both where
    /// voltages are measured to neutral, else twice.
    pub(super) fn of(setup: Setup) -> Self {
        let voltage = match setup.pt_ratio {
            10 => 660.0,
            tenths => 144.0 * f64::from(tenths) / 10.0,
        };
        let current = 1.2 * f64::from(setup.ct_primary);
        let phases = if setup.wiring.is_to_neutral() {
            3.0
        } else {
            2.0
        };
        Self {
            voltage,
            current,
            power: phases * voltage * current,
        }
    }
}

/// The raw number of a value: 0 stands for `low` and all below, 9999 for `high` and all above.
pub(super) fn lin3(value: f64, low: f64, high: f64) -> i128 {
    clipped(rounded(f64::from(FULL) * (value - low) / (high - low)))
}

/// A raw number as the meter can show it.
pub(super) fn clipped(raw: i128) -> i128 {
    raw.clamp(0, FULL.into())
}
