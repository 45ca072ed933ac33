//! How the raw integer of a register becomes a figure, where that takes more than one factor: some
//! meters measure in parts of a full scale that follows from their wiring and their transformers.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

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

/// Indices of factors, each behind those it follows from.
///
/// # Errors
/// The indices of factors that follow from each other in a circle, in the order of the way round.
pub(super) fn in_order(factors: &[Factor]) -> Result<Vec<usize>, Vec<usize>> {
    let places: BTreeMap<&str, usize> = factors
        .iter()
        .enumerate()
        .map(|(index, factor)| (factor.name.as_str(), index))
        .collect();
    let needs: Vec<BTreeSet<usize>> = factors
        .iter()
        .map(|factor| {
            let names = factor.names().into_iter();
            names.filter_map(|name| places.get(name).copied()).collect()
        })
        .collect();
    let mut needed_by: Vec<Vec<usize>> = vec![Vec::new(); factors.len()];
    for (index, needs) in needs.iter().enumerate() {
        for need in needs {
            needed_by[*need].push(index);
        }
    }
    // A factor comes when all that it follows from has come.
    let mut waits: Vec<usize> = needs.iter().map(BTreeSet::len).collect();
    let mut order: Vec<usize> = (0..factors.len())
        .filter(|index| waits[*index] == 0)
        .collect();
    let mut next = 0;
    while let Some(index) = order.get(next).copied() {
        next += 1;
        for waiting in &needed_by[index] {
            waits[*waiting] -= 1;
            if waits[*waiting] == 0 {
                order.push(*waiting);
            }
        }
    }
    match waits.iter().position(|waits| *waits > 0) {
        None => Ok(order),
        Some(stuck) => Err(circle(stuck, &needs, &waits)),
    }
}

/// A way round among factors that wait for each other, from one that cannot come.
fn circle(stuck: usize, needs: &[BTreeSet<usize>], waits: &[usize]) -> Vec<usize> {
    let mut way = vec![stuck];
    loop {
        let last = way[way.len() - 1];
        // What cannot come waits for something that cannot come either.
        let Some(next) = needs[last].iter().copied().find(|need| waits[*need] > 0) else {
            return way;
        };
        if let Some(start) = way.iter().position(|index| *index == next) {
            return way.split_off(start);
        }
        way.push(next);
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

impl fmt::Display for Scaling {
    /// `0.1`, `ct_ratio`, `1 at raw 40..70; 0.1 at raw 0, 400..700`, `0..9999 → -pmax..pmax`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Times(scale) => scale.fmt(f),
            Self::TimesFactor(name) => f.write_str(name),
            Self::TimesByRaw(bands) => {
                let raw = bands.iter().map(|band| (raw(band), &band.factor));
                f.write_str(&by_result(raw, "at raw"))
            }
            Self::Span { full, low, high } => write!(f, "0..{full} → {low}..{high}"),
        }
    }
}

/// The raw numbers of a band.
fn raw(band: &Band) -> String {
    let Band {
        lowest, highest, ..
    } = band;
    if lowest == highest {
        lowest.to_string()
    } else {
        format!("{lowest}..{highest}")
    }
}

/// Cases that have one result together: `3 for raw wiring 1, 4; 2 for raw wiring 0`.
fn by_result<T: PartialEq + fmt::Display>(
    cases: impl Iterator<Item = (String, T)>,
    condition: &str,
) -> String {
    let mut results: Vec<(T, Vec<String>)> = Vec::new();
    for (case, result) in cases {
        match results.iter_mut().find(|(known, _)| *known == result) {
            Some((_, cases)) => cases.push(case),
            None => results.push((result, vec![case])),
        }
    }
    let results = results.iter();
    let texts: Vec<String> = results
        .map(|(result, cases)| format!("{result} {condition} {}", cases.join(", ")))
        .collect();
    texts.join("; ")
}

impl fmt::Display for Operand {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => number.fmt(f),
            Self::Named { name, negative } => {
                write!(f, "{}{name}", ["", "-"][usize::from(*negative)])
            }
        }
    }
}

impl fmt::Display for Factor {
    /// As a formula: `imax = 1.2 × ct_primary`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} = {}", self.name, self.rule)
    }
}

impl fmt::Display for Rule {
    /// `1.2 × ct_primary`; `3 for raw wiring 1, 4; 2 for raw wiring 0; else 1`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Product(operands) => {
                let operands: Vec<String> = operands.iter().map(Operand::to_string).collect();
                f.write_str(&operands.join(" × "))
            }
            Self::Choice {
                by,
                cases,
                otherwise,
            } => {
                let cases = cases
                    .iter()
                    .map(|(code, result)| (code.to_string(), result));
                f.write_str(&by_result(cases, &format!("for raw {by}")))?;
                match otherwise {
                    None => Ok(()),
                    Some(result) => write!(f, "; else {result}"),
                }
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
        let decimals = decimals(span_step(full, low, high)?)?;
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

/// What one raw step of a span is; `None` where it has no end.
pub(super) fn span_step(full: u16, low: Decimal, high: Decimal) -> Option<Decimal> {
    high.checked_sub(low)?.checked_div(full.into())
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
