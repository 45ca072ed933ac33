//! Scales that are hardly what the meter does.

use rust_decimal::Decimal;
use rust_decimal::prelude::ToPrimitive;

use super::{Matter, Review, Row};
use crate::codec::value::RegisterType;
use crate::profile::identity::Law;
use crate::profile::point::{Access, Labels, Point};
use crate::profile::scaling::{Operand, Scaling};

/// Parts of names of numbers that have no unit.
const UNITLESS: [&str; 13] = [
    "factor",
    "pf",
    "cos",
    "phi",
    "ratio",
    "crest",
    "thdf",
    "multiplier",
    "prescaler",
    "coefficient",
    "counter",
    "version",
    "revision",
];

/// Between these lies every mains frequency, with room for a network in trouble.
const MAINS: (i64, i64) = (45, 65);

impl Review<'_> {
    pub(super) fn scales(&mut self) {
        for row in self.rows.clone() {
            let key = if row.table.span.is_some() {
                "span"
            } else {
                "scale"
            };
            let scale = row.table.scale.as_ref().map(toml::Spanned::span);
            let span = row.table.span.as_ref().map(toml::Spanned::span);
            let at = scale.or(span).unwrap_or_else(|| row.place());
            if let Some(matter) = self.scale(&row) {
                self.tell(&at, row.key(key), matter);
            }
            if row.table.unit.is_none() && is_of_a_unit(row.point) {
                self.tell(&at, row.key("unit"), Matter::NoUnit);
            }
            if is_energy(row.point) && row.point.kind == RegisterType::I16 {
                self.tell(
                    &row.table.kind.span(),
                    row.key("type"),
                    Matter::SignedCounter,
                );
            }
        }
    }

    /// The first thing that is odd about a scale.
    fn scale(&self, row: &Row<'_>) -> Option<Matter> {
        let point = row.point;
        if !point.kind.is_number() {
            return None;
        }
        if is_mains(point) && !can_be_mains(point) {
            return Some(Matter::NoMains);
        }
        let factor = point.constant_scale()?;
        if !point.kind.is_integer() {
            return (factor != Decimal::ONE).then_some(Matter::ScaledFloat);
        }
        if !is_power_of_ten(factor) {
            return Some(Matter::OddFactor { factor });
        }
        if factor >= Decimal::ONE && self.is_power_factor(point) {
            return Some(Matter::WholePowerFactor);
        }
        let is_percentage = point.unit.as_deref() == Some("%");
        (factor > Decimal::ONE && is_percentage)
            .then_some(Matter::CoarsePercentage { step: factor })
    }

    /// Whether an identity or its name says that it is one.
    fn is_power_factor(&self, point: &Point) -> bool {
        let is_said = self.profile.identities.iter().any(|identity| {
            matches!(&identity.law, Law::PowerFactor { power_factor, .. } if *power_factor == point.name)
        });
        let is_named = point.name.starts_with("power_factor")
            && point.access == Access::Read
            && point.labels == Labels::None;
        is_said || is_named
    }
}

fn is_power_of_ten(factor: Decimal) -> bool {
    let mut mantissa = factor.mantissa();
    while mantissa != 0 && mantissa % 10 == 0 {
        mantissa /= 10;
    }
    mantissa == 1
}

/// Whether it is scaled and by its name can have a unit.
fn is_of_a_unit(point: &Point) -> bool {
    let is_scaled = point.kind.is_number() && point.scaling != Scaling::NONE;
    let has_none = point.name.split('_').any(|part| UNITLESS.contains(&part));
    is_scaled && point.labels == Labels::None && !has_none
}

fn is_energy(point: &Point) -> bool {
    let unit = point.unit.as_deref().unwrap_or_default();
    ["Wh", "varh", "VAh"].iter().any(|end| unit.ends_with(end))
}

/// Whether it is measured, in hertz: a setpoint may be a difference.
fn is_mains(point: &Point) -> bool {
    point.unit.as_deref() == Some("Hz") && point.access == Access::Read
}

/// Whether some raw number gives a mains frequency, as far as that can be told from the profile.
fn can_be_mains(point: &Point) -> bool {
    let Some((lowest, highest)) = point.limits.or_else(|| point.kind.bounds()) else {
        return true;
    };
    let holds = |lowest: i128, highest: i128, factor: Decimal| {
        let (low, high) = MAINS;
        let first = Decimal::from(low).checked_div(factor);
        let last = Decimal::from(high).checked_div(factor);
        let whole = |number: Option<Decimal>, round: fn(&Decimal) -> Decimal| {
            number.and_then(|number| round(&number).to_i128())
        };
        match (whole(first, Decimal::ceil), whole(last, Decimal::floor)) {
            (Some(first), Some(last)) => first.max(lowest) <= last.min(highest),
            _ => true,
        }
    };
    match &point.scaling {
        Scaling::Times(factor) if factor.is_sign_positive() => holds(lowest, highest, *factor),
        Scaling::TimesByRaw(bands) => bands.iter().any(|band| {
            band.factor.is_sign_negative() || holds(band.lowest, band.highest, band.factor)
        }),
        Scaling::Span {
            low: Operand::Number(low),
            high: Operand::Number(high),
            ..
        } => *low <= Decimal::from(MAINS.1) && *high >= Decimal::from(MAINS.0),
        _ => true,
    }
}
