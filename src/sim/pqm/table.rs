//! Which quantity a point shows, and in which steps.

use super::words::{date_of, time_of};
use crate::sim::history::{Extremes, Metered};
use crate::sim::load::Quantity;
use crate::sim::model::Content;
use crate::sim::words::rounded;

/// Steps of the registers, in the units of [`Quantity`].
const WHOLE: f64 = 1.0;
pub(super) const TEN_WATTS: f64 = 10.0;
pub(super) const HUNDREDTH: f64 = 0.01;
const TENTH_PERCENT: f64 = 0.001;

/// What is measured: the point, the quantity, the step of its register.
pub(super) const QUANTITIES: [(&str, Quantity, f64); Quantity::COUNT] = [
    ("voltage_an", Quantity::VoltageAn, WHOLE),
    ("voltage_bn", Quantity::VoltageBn, WHOLE),
    ("voltage_cn", Quantity::VoltageCn, WHOLE),
    ("voltage_ln_avg", Quantity::VoltageLnAverage, WHOLE),
    ("voltage_ab", Quantity::VoltageAb, WHOLE),
    ("voltage_bc", Quantity::VoltageBc, WHOLE),
    ("voltage_ca", Quantity::VoltageCa, WHOLE),
    ("voltage_ll_avg", Quantity::VoltageLlAverage, WHOLE),
    (
        "voltage_unbalance",
        Quantity::VoltageUnbalance,
        TENTH_PERCENT,
    ),
    ("current_a", Quantity::CurrentA, WHOLE),
    ("current_b", Quantity::CurrentB, WHOLE),
    ("current_c", Quantity::CurrentC, WHOLE),
    ("current_avg", Quantity::CurrentAverage, WHOLE),
    ("current_n", Quantity::CurrentN, WHOLE),
    (
        "current_unbalance",
        Quantity::CurrentUnbalance,
        TENTH_PERCENT,
    ),
    ("real_power_a", Quantity::RealPowerA, TEN_WATTS),
    ("real_power_b", Quantity::RealPowerB, TEN_WATTS),
    ("real_power_c", Quantity::RealPowerC, TEN_WATTS),
    ("real_power_total", Quantity::RealPowerTotal, TEN_WATTS),
    ("reactive_power_a", Quantity::ReactivePowerA, TEN_WATTS),
    ("reactive_power_b", Quantity::ReactivePowerB, TEN_WATTS),
    ("reactive_power_c", Quantity::ReactivePowerC, TEN_WATTS),
    (
        "reactive_power_total",
        Quantity::ReactivePowerTotal,
        TEN_WATTS,
    ),
    ("apparent_power_a", Quantity::ApparentPowerA, TEN_WATTS),
    ("apparent_power_b", Quantity::ApparentPowerB, TEN_WATTS),
    ("apparent_power_c", Quantity::ApparentPowerC, TEN_WATTS),
    (
        "apparent_power_total",
        Quantity::ApparentPowerTotal,
        TEN_WATTS,
    ),
    ("power_factor_a", Quantity::PowerFactorA, HUNDREDTH),
    ("power_factor_b", Quantity::PowerFactorB, HUNDREDTH),
    ("power_factor_c", Quantity::PowerFactorC, HUNDREDTH),
    ("power_factor_total", Quantity::PowerFactorTotal, HUNDREDTH),
    ("frequency", Quantity::Frequency, HUNDREDTH),
];

/// What is averaged over a quarter of an hour: the point, the quantity, the step of its register.
pub(super) const DEMANDS: [(&str, Metered, f64); 7] = [
    ("demand_current_a", Metered::CurrentA, WHOLE),
    ("demand_current_b", Metered::CurrentB, WHOLE),
    ("demand_current_c", Metered::CurrentC, WHOLE),
    ("demand_current_n", Metered::CurrentN, WHOLE),
    ("demand_real", Metered::RealPower, TEN_WATTS),
    ("demand_reactive", Metered::ReactivePower, TEN_WATTS),
    ("demand_apparent", Metered::ApparentPower, TEN_WATTS),
];

/// What the end of a point's name asks for.
#[derive(Debug, Clone, Copy)]
pub(super) enum Statistic {
    Minimum,
    MinimumTime,
    MinimumDate,
    Maximum,
    MaximumTime,
    MaximumDate,
}

impl Statistic {
    const ENDINGS: [(&'static str, Self); 6] = [
        ("_min", Self::Minimum),
        ("_min_time", Self::MinimumTime),
        ("_min_date", Self::MinimumDate),
        ("_max", Self::Maximum),
        ("_max_time", Self::MaximumTime),
        ("_max_date", Self::MaximumDate),
    ];

    pub(super) fn split(point: &str) -> (&str, Option<Self>) {
        let split = |(ending, statistic): &(&str, Self)| {
            Some((point.strip_suffix(*ending)?, Some(*statistic)))
        };
        Self::ENDINGS
            .iter()
            .find_map(split)
            .unwrap_or((point, None))
    }

    pub(super) fn of(self, extremes: &Extremes, step: f64) -> Content {
        match self {
            // Rounded outwards, so that no rounded value lies past them.
            Self::Minimum => Content::Number(rounded((extremes.lowest / step).floor())),
            Self::Maximum => Content::Number(rounded((extremes.highest / step).ceil())),
            Self::MinimumTime => time_of(extremes.lowest_at),
            Self::MinimumDate => date_of(extremes.lowest_at),
            Self::MaximumTime => time_of(extremes.highest_at),
            Self::MaximumDate => date_of(extremes.highest_at),
        }
    }
}
