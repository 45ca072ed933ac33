//! How the raw integer of a register becomes a figure, where that takes more than one factor: some
//! meters measure in parts of a full scale that follows from their wiring and their transformers.

use std::collections::BTreeMap;

use rust_decimal::{Decimal, RoundingStrategy};
use serde::{Deserialize, Serialize};

use super::value::Missing;

/// What makes a figure of a raw number.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub enum Scaling {
    /// Multiplied with a number.
    Times(Decimal),
    /// Multiplied with a [`Factor`] of the meter, by its name.
    TimesFactor(String),
    /// Multiplied with one number or another, by where the raw number lies.
    TimesByRaw(Vec<Band>),
    /// A part of a span: raw 0 is its low end, raw `full` its high end, and there is nothing
    /// beyond.
    Span {
        /// The raw number at the high end, above 0.
        full: u16,
        /// The figure at raw 0.
        low: Operand,
        /// The figure at raw `full`.
        high: Operand,
    },
}

/// Raw numbers that share a factor.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Band {
    /// The lowest of them.
    pub lowest: i128,
    /// The highest.
    pub highest: i128,
    /// What they are multiplied with.
    pub factor: Decimal,
}

/// A number, or the name of what has one.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub enum Operand {
    /// The number itself.
    Number(Decimal),
    /// That of a factor or of a point.
    Named {
        /// Its name.
        name: String,
        /// Whether it is taken from below zero.
        negative: bool,
    },
}

/// A number that follows from setup registers.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Factor {
    /// Its name.
    pub name: String,
    /// How it is worked out.
    pub rule: Rule,
}

/// How a factor is worked out.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub enum Rule {
    /// These multiplied.
    Product(Vec<Operand>),
    /// One of several, by the raw number of a point of one register.
    Choice {
        /// The point.
        by: String,
        /// What each of its raw numbers gives.
        cases: BTreeMap<u16, Operand>,
        /// What all others give; without it they give no factor.
        otherwise: Option<Operand>,
    },
}

impl Factor {
    /// What it is worked out from: names of factors and points.
    pub fn names(&self) -> Vec<&str> {
        let (by, operands): (Option<&str>, Vec<&Operand>) = match &self.rule {
            Rule::Product(operands) => (None, operands.iter().collect()),
            Rule::Choice {
                by,
                cases,
                otherwise,
            } => (Some(by), cases.values().chain(otherwise).collect()),
        };
        let named = operands.into_iter().filter_map(Operand::name);
        by.into_iter().chain(named).collect()
    }
}

impl Operand {
    /// The name it goes by, unless it is a number.
    pub fn name(&self) -> Option<&str> {
        match self {
            Self::Number(_) => None,
            Self::Named { name, .. } => Some(name),
        }
    }
}

impl Scaling {
    /// As it is: times one.
    pub const NONE: Self = Self::Times(Decimal::ONE);

    /// Names of factors and points that it takes.
    pub fn names(&self) -> Vec<&str> {
        match self {
            Self::Times(_) | Self::TimesByRaw(_) => Vec::new(),
            Self::TimesFactor(name) => vec![name],
            Self::Span { low, high, .. } => {
                [low, high].into_iter().filter_map(Operand::name).collect()
            }
        }
    }
}

/// `mantissa` with this many decimals times the scale, exactly and with all their decimals; `None`
/// where a decimal does not hold that many digits.
pub(super) fn times(mantissa: i128, decimals: u32, scale: Decimal) -> Option<Decimal> {
    let product = mantissa.checked_mul(scale.mantissa())?;
    Decimal::try_from_i128_with_scale(product, decimals + scale.scale()).ok()
}

/// The decimals that a figure of a span shows at least.
const LEAST_DECIMALS: u32 = 2;

/// Where `raw` of `full` lies between `low` and `high`. The quotient has no end of digits: it is
/// worked out with 28 and rounded to a tenth of a raw step or finer, so that no two raw numbers
/// look the same, and to hundredths at the coarsest.
///
/// # Errors
/// [`Missing::Mismatch`] when the raw number lies outside 0 to `full` or the span is nothing.
pub(super) fn within(
    raw: i128,
    full: u16,
    low: Decimal,
    high: Decimal,
) -> Result<Decimal, Missing> {
    let part = || {
        let raw = u16::try_from(raw).ok().filter(|raw| *raw <= full)?;
        let span = high.checked_sub(low)?;
        let decimals = decimals(span.checked_div(full.into())?)?;
        let exact = span
            .checked_mul(raw.into())?
            .checked_div(full.into())?
            .checked_add(low)?;
        let away = RoundingStrategy::MidpointAwayFromZero;
        let mut figure = exact.round_dp_with_strategy(decimals, away);
        // Round figures have as many decimals as the others.
        figure.rescale(decimals);
        Some(figure)
    };
    part().ok_or(Missing::Mismatch)
}

/// How many decimals a tenth of a step takes; `None` for no step at all.
fn decimals(step: Decimal) -> Option<u32> {
    if step.is_zero() {
        return None;
    }
    let mut decimals = LEAST_DECIMALS;
    // A unit of the last decimal is at most a tenth of a step.
    while Decimal::new(10, decimals) > step.abs() && decimals < Decimal::MAX_SCALE {
        decimals += 1;
    }
    Some(decimals)
}
