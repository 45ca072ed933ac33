//! What both meters measure: the point, the quantity, the step of its register.

use super::{TENTH, THOUSANDTH};
use crate::sim::load::Quantity;

pub(super) const INSTANT: [(&str, Quantity, f64); 28] = [
    ("voltage_l1_n", Quantity::VoltageAn, TENTH),
    ("voltage_l2_n", Quantity::VoltageBn, TENTH),
    ("voltage_l3_n", Quantity::VoltageCn, TENTH),
    ("voltage_ln_sys", Quantity::VoltageLnAverage, TENTH),
    ("voltage_l1_l2", Quantity::VoltageAb, TENTH),
    ("voltage_l2_l3", Quantity::VoltageBc, TENTH),
    ("voltage_l3_l1", Quantity::VoltageCa, TENTH),
    ("voltage_ll_sys", Quantity::VoltageLlAverage, TENTH),
    ("current_l1", Quantity::CurrentA, THOUSANDTH),
    ("current_l2", Quantity::CurrentB, THOUSANDTH),
    ("current_l3", Quantity::CurrentC, THOUSANDTH),
    ("active_power_l1", Quantity::RealPowerA, TENTH),
    ("active_power_l2", Quantity::RealPowerB, TENTH),
    ("active_power_l3", Quantity::RealPowerC, TENTH),
    ("active_power_sys", Quantity::RealPowerTotal, TENTH),
    ("reactive_power_l1", Quantity::ReactivePowerA, TENTH),
    ("reactive_power_l2", Quantity::ReactivePowerB, TENTH),
    ("reactive_power_l3", Quantity::ReactivePowerC, TENTH),
    ("reactive_power_sys", Quantity::ReactivePowerTotal, TENTH),
    ("apparent_power_l1", Quantity::ApparentPowerA, TENTH),
    ("apparent_power_l2", Quantity::ApparentPowerB, TENTH),
    ("apparent_power_l3", Quantity::ApparentPowerC, TENTH),
    ("apparent_power_sys", Quantity::ApparentPowerTotal, TENTH),
    // Above 0: the load lags.
    ("power_factor_l1", Quantity::PowerFactorA, THOUSANDTH),
    ("power_factor_l2", Quantity::PowerFactorB, THOUSANDTH),
    ("power_factor_l3", Quantity::PowerFactorC, THOUSANDTH),
    ("power_factor_sys", Quantity::PowerFactorTotal, THOUSANDTH),
    // Tenths of a hertz on the EM21 too, as in the first edition of its document.
    ("frequency", Quantity::Frequency, TENTH),
];
