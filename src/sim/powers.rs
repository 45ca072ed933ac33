//! Powers that add up in the registers.

use super::load::{Quantity, Values};
use super::words::rounded;

/// Power registers of the phases and of all three. They are worked out from each other after
/// rounding, so that they add up to the last digit.
pub(super) struct Powers {
    real: [i128; 4],
    reactive: [i128; 4],
    apparent: [i128; 4],
    factor: [i128; 4],
}

impl Powers {
    /// In steps of so many W, var and VA, and of that much of a power factor.
    pub(super) fn of(values: &Values, power_step: f64, factor_step: f64) -> Self {
        use Quantity as Q;

        let with_total = |phases: [Quantity; 3]| {
            let [a, b, c] = phases.map(|quantity| rounded(values.get(quantity) / power_step));
            [a, b, c, a + b + c]
        };
        let real = with_total([Q::RealPowerA, Q::RealPowerB, Q::RealPowerC]);
        let reactive = with_total([Q::ReactivePowerA, Q::ReactivePowerB, Q::ReactivePowerC]);
        let apparent =
            [0, 1, 2, 3].map(|row| rounded(float(real[row]).hypot(float(reactive[row]))));
        let factor =
            [0, 1, 2, 3].map(|row| rounded(float(real[row]) / float(apparent[row]) / factor_step));
        Self {
            real,
            reactive,
            apparent,
            factor,
        }
    }

    /// The register of a quantity that is a power or a power factor.
    pub(super) const fn get(&self, quantity: Quantity) -> Option<i128> {
        Some(match quantity {
            Quantity::RealPowerA => self.real[0],
            Quantity::RealPowerB => self.real[1],
            Quantity::RealPowerC => self.real[2],
            Quantity::RealPowerTotal => self.real[3],
            Quantity::ReactivePowerA => self.reactive[0],
            Quantity::ReactivePowerB => self.reactive[1],
            Quantity::ReactivePowerC => self.reactive[2],
            Quantity::ReactivePowerTotal => self.reactive[3],
            Quantity::ApparentPowerA => self.apparent[0],
            Quantity::ApparentPowerB => self.apparent[1],
            Quantity::ApparentPowerC => self.apparent[2],
            Quantity::ApparentPowerTotal => self.apparent[3],
            Quantity::PowerFactorA => self.factor[0],
            Quantity::PowerFactorB => self.factor[1],
            Quantity::PowerFactorC => self.factor[2],
            Quantity::PowerFactorTotal => self.factor[3],
            _ => return None,
        })
    }
}

#[expect(
    clippy::cast_precision_loss,
    reason = "registers have 32 bits, a double holds 53"
)]
const fn float(register: i128) -> f64 {
    register as f64
}
