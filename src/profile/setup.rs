//! What scales depend on: which registers are read besides those asked for, and the factors that
//! follow from them.

use std::collections::{BTreeMap, BTreeSet};

use rust_decimal::Decimal;

use super::model::Profile;
use super::point::Point;
use super::scaling::{Factor, Operand, Rule, times};
use super::value::Missing;
use crate::codec::value::{self, Raw};

/// The setup registers that points depend on, and how.
#[derive(Debug, Clone, Default)]
pub struct Setup {
    points: Vec<Point>,
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
        Self {
            points: names
                .into_iter()
                .filter_map(|name| profile.point(name).cloned())
                .collect(),
            factors: profile.factors.clone(),
        }
    }

    /// The points that scales depend on, by name.
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

    /// Works with the registers of the setup points: `registers` has those that were read, by name.
    pub fn scales<'a>(&'a self, registers: &'a BTreeMap<String, Vec<u16>>) -> Scales<'a> {
        Scales {
            setup: self,
            registers,
        }
    }
}

/// The names of the setup points that a point of a meter with these factors needs.
pub(super) fn needed<'a>(point: &'a Point, factors: &'a [Factor]) -> BTreeSet<&'a str> {
    let mut open = point.scaling.names();
    let mut points: BTreeSet<&str> = point.only_with.iter().map(|with| &*with.point).collect();
    while let Some(name) = open.pop() {
        // The loader lets no factor come back to itself, so this ends.
        match factors.iter().find(|factor| factor.name == name) {
            Some(factor) => open.extend(factor.names()),
            None => {
                points.insert(name);
            }
        }
    }
    points
}

/// Setup registers as they were read, ready to scale with.
#[derive(Debug, Clone, Copy)]
pub struct Scales<'a> {
    setup: &'a Setup,
    registers: &'a BTreeMap<String, Vec<u16>>,
}

static NO_SETUP: Setup = Setup {
    points: Vec::new(),
    factors: Vec::new(),
};

static NO_REGISTERS: BTreeMap<String, Vec<u16>> = BTreeMap::new();

impl Scales<'_> {
    /// For points that depend on no setup.
    pub const fn none() -> Scales<'static> {
        Scales {
            setup: &NO_SETUP,
            registers: &NO_REGISTERS,
        }
    }

    /// The number of an operand.
    ///
    /// # Errors
    /// [`Missing::Mismatch`] when a register it follows from was not read or holds what it cannot:
    /// nothing can be scaled with that.
    pub fn operand(&self, operand: &Operand) -> Result<Decimal, Missing> {
        match operand {
            Operand::Number(number) => Ok(*number),
            Operand::Named { name, negative } => {
                let number = self.named(name)?;
                Ok(if *negative { -number } else { number })
            }
        }
    }

    /// The number of a factor or of a setup point.
    ///
    /// # Errors
    /// As [`Self::operand`].
    pub fn named(&self, name: &str) -> Result<Decimal, Missing> {
        let factor = self.setup.factors.iter().find(|factor| factor.name == name);
        let Some(factor) = factor else {
            let (point, raw) = self.raw(name)?;
            let scale = point.constant_scale().ok_or(Missing::Mismatch)?;
            return times(raw, 0, scale).ok_or(Missing::Mismatch);
        };
        match &factor.rule {
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
                let chosen = cases.get(&self.code(by)?).or(otherwise.as_ref());
                self.operand(chosen.ok_or(Missing::Mismatch)?)
            }
        }
    }

    /// The raw number of a setup point of one register.
    ///
    /// # Errors
    /// As [`Self::operand`].
    pub fn code(&self, name: &str) -> Result<u16, Missing> {
        let (_, raw) = self.raw(name)?;
        u16::try_from(raw).map_err(|_| Missing::Mismatch)
    }

    /// Whether a setup point holds something that can be scaled with.
    pub fn has(&self, name: &str) -> bool {
        self.raw(name).is_ok()
    }

    /// A setup point and its raw number, which must be one that could have been written there: a
    /// transformer ratio of 0 would make every reading 0.
    fn raw(&self, name: &str) -> Result<(&Point, i128), Missing> {
        let point = self.setup.points.iter().find(|point| point.name == name);
        let registers = self.registers.get(name);
        let (Some(point), Some(registers)) = (point, registers) else {
            return Err(Missing::Mismatch);
        };
        let raw = match value::decode(point.kind, point.order, registers) {
            Ok(Raw::Integer(number)) => number,
            Ok(Raw::Word(word)) => word.into(),
            _ => return Err(Missing::Mismatch),
        };
        match point.limits {
            Some((lowest, highest)) if !(lowest..=highest).contains(&raw) => Err(Missing::Mismatch),
            _ => Ok((point, raw)),
        }
    }
}
