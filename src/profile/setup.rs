//! What points depend on: which others are read besides those asked for, and the numbers for scales
//! that follow from them.

use std::collections::{BTreeMap, BTreeSet};

use rust_decimal::Decimal;

use super::model::Profile;
use super::point::Point;
use super::scaling::{Factor, Operand, Rule, Scaling, in_order, times};
use super::value::Missing;
use crate::codec::value::Raw;

/// The setup registers that points depend on, and how.
#[derive(Debug, Clone, Default)]
pub struct Setup {
    points: Vec<Point>,
    /// Each behind those it follows from.
    factors: Vec<Factor>,
}

impl Setup {
    /// What `points` of this meter depend on; nothing for registers of an unknown one.
    pub fn of(points: &[Point], profile: Option<&Profile>) -> Self {
        let Some(profile) = profile else {
            return Self::default();
        };
        let names: BTreeSet<&str> = points
            .iter()
            .flat_map(|point| profile.setup_of(point))
            .collect();
        // The loader lets no factor come back to itself.
        let order = in_order(&profile.factors).unwrap_or_default();
        let factors = order.iter().filter_map(|index| profile.factors.get(*index));
        Self {
            points: names
                .into_iter()
                .filter_map(|name| profile.point(name).cloned())
                .collect(),
            factors: factors.cloned().collect(),
        }
    }

    /// The same with further points, of which others depend on what they hold.
    #[must_use]
    pub fn with(mut self, points: impl IntoIterator<Item = Point>) -> Self {
        for point in points {
            if !self.points.iter().any(|known| known.name == point.name) {
                self.points.push(point);
            }
        }
        self
    }

    /// The points that others depend on, by name.
    pub fn points(&self) -> &[Point] {
        &self.points
    }

    /// Those of them that are read besides `points`: the ones that are not among them.
    pub fn besides<'a>(&'a self, points: &'a [Point]) -> impl Iterator<Item = &'a Point> {
        let is_asked = |needed: &Point| points.iter().any(|point| point.name == needed.name);
        self.points.iter().filter(move |needed| !is_asked(needed))
    }

    /// The names of those that this point needs.
    pub fn needed_by<'a>(&'a self, point: &'a Point) -> BTreeSet<&'a str> {
        needed(point, &self.factors)
    }

    /// What follows from setup registers: `registers` has those that were read, by the names of
    /// their points.
    pub fn scales(&self, registers: &BTreeMap<String, Vec<u16>>) -> Scales {
        let mut scales = Scales::default();
        for point in &self.points {
            let raw = match registers.get(&point.name) {
                Some(registers) => setting(point, registers),
                None => Err(Missing::Mismatch),
            };
            let number = raw.and_then(|raw| {
                let number = raw.zip(point.constant_scale());
                let number = number.and_then(|(raw, scale)| times(raw, 0, scale));
                number.ok_or(Missing::Mismatch)
            });
            scales.settings.insert(point.name.clone(), raw);
            scales.numbers.insert(point.name.clone(), number);
        }
        for factor in &self.factors {
            let number = scales.follow(&factor.rule);
            scales.numbers.insert(factor.name.clone(), number);
        }
        scales
    }
}

/// The names of the setup points that a point of a meter with these factors needs.
pub(super) fn needed<'a>(point: &'a Point, factors: &'a [Factor]) -> BTreeSet<&'a str> {
    let mut open = point.scaling.names();
    let mut seen: BTreeSet<&str> = open.iter().copied().collect();
    let mut points: BTreeSet<&str> = point.only_with.iter().map(|with| &*with.point).collect();
    while let Some(name) = open.pop() {
        match factors.iter().find(|factor| factor.name == name) {
            Some(factor) => {
                let names = factor.names().into_iter();
                open.extend(names.filter(|name| seen.insert(name)));
            }
            None => {
                points.insert(name);
            }
        }
    }
    points
}

/// The raw number of a setup point, which must be one that could have been written there: a
/// transformer ratio of 0 would make every reading 0. `None` where it is no number, a date say.
fn setting(point: &Point, registers: &[u16]) -> Result<Option<i128>, Missing> {
    let raw = match point.raw_value(registers)? {
        Raw::Integer(number) => number,
        Raw::Word(word) => word.into(),
        _ => return Ok(None),
    };
    let also = &point.writing().also;
    match point.limits {
        Some((lowest, highest))
            if !(lowest..=highest).contains(&raw)
                && !also.iter().any(|number| i128::from(*number) == raw) =>
        {
            Err(Missing::Mismatch)
        }
        _ => Ok(Some(raw)),
    }
}

/// The numbers to scale with, as they follow from the setup of one meter.
#[derive(Debug, Clone, Default)]
pub struct Scales {
    /// The raw numbers of setup points.
    settings: BTreeMap<String, Result<Option<i128>, Missing>>,
    /// The numbers of setup points and factors.
    numbers: BTreeMap<String, Result<Decimal, Missing>>,
}

impl Scales {
    /// The raw number that a setup point holds; `None` for a value that is no number.
    ///
    /// # Errors
    /// Why it holds none; [`Missing::Mismatch`] too when it was not read.
    pub fn setting(&self, name: &str) -> Result<Option<i128>, Missing> {
        let setting = self.settings.get(name).copied();
        setting.unwrap_or(Err(Missing::Mismatch))
    }

    /// The number of a factor or of a setup point.
    ///
    /// # Errors
    /// [`Missing::Mismatch`] when a register it follows from was not read or holds what it cannot:
    /// nothing can be scaled with that.
    pub(super) fn named(&self, name: &str) -> Result<Decimal, Missing> {
        let number = self.numbers.get(name).copied();
        number.unwrap_or(Err(Missing::Mismatch))
    }

    /// The number that a raw one is multiplied with: nothing is measured in steps of 0.
    pub(super) fn step(&self, name: &str) -> Result<Decimal, Missing> {
        self.named(name).and_then(|step| {
            if step.is_zero() {
                Err(Missing::Mismatch)
            } else {
                Ok(step)
            }
        })
    }

    /// The number of an operand.
    pub(super) fn operand(&self, operand: &Operand) -> Result<Decimal, Missing> {
        match operand {
            Operand::Number(number) => Ok(*number),
            Operand::Named { name, negative } => {
                let number = self.named(name)?;
                Ok(if *negative { -number } else { number })
            }
        }
    }

    /// The first of the numbers a point is scaled by that there is none of, or that makes no scale:
    /// a step of 0, or an end of a span that is its other end.
    pub fn lacking<'a>(&self, point: &'a Point) -> Option<&'a str> {
        let is_nothing = match &point.scaling {
            Scaling::TimesFactor(name) => self.step(name).is_err(),
            Scaling::Span { low, high, .. } => self.operand(low) == self.operand(high),
            Scaling::Times(_) | Scaling::TimesByRaw(_) => false,
        };
        let mut names = point.scaling.names().into_iter();
        names.find(|name| is_nothing || self.named(name).is_err())
    }

    fn follow(&self, rule: &Rule) -> Result<Decimal, Missing> {
        match rule {
            Rule::Product(operands) => {
                operands.iter().try_fold(Decimal::ONE, |product, operand| {
                    let product = product.checked_mul(self.operand(operand)?);
                    product.ok_or(Missing::Mismatch)
                })
            }
            Rule::Choice {
                by,
                cases,
                otherwise,
            } => {
                let code = self.setting(by)?.and_then(|code| u16::try_from(code).ok());
                let case = code.and_then(|code| cases.get(&code));
                let chosen = case.or(otherwise.as_ref());
                self.operand(chosen.ok_or(Missing::Mismatch)?)
            }
        }
    }
}
