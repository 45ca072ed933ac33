//! Figures, back into raw numbers.

use rust_decimal::Decimal;
use rust_decimal::prelude::ToPrimitive;

use super::EncodeError;
use crate::codec::value::RegisterType;
use crate::profile::point::Point;
use crate::profile::scaling::{Band, Scaling, times, within};
use crate::profile::setup::Scales;
use crate::profile::value::Missing;

/// The raw number that these digits in hex are, given as `text`; `None` when they are no digits.
pub(super) fn from_hex(
    kind: RegisterType,
    digits: &str,
    text: &str,
) -> Option<Result<i128, EncodeError>> {
    let is_hex = |digit: char| digit.is_ascii_hexdigit();
    if digits.is_empty() || !digits.chars().all(is_hex) {
        return None;
    }
    // Integer types have bounds; nothing else comes here.
    let (lowest, highest) = kind.bounds()?;
    // Of a signed type every pattern of bits is a number.
    let patterns = 1_i128 << (16 * u32::from(kind.registers()).min(4));
    let most = if lowest < 0 { patterns - 1 } else { highest };
    // More digits than 128 bits are beyond the range as well.
    let raw = i128::from_str_radix(digits, 16).ok();
    Some(match raw.filter(|raw| *raw <= most) {
        Some(raw) if raw > highest => Ok(raw - patterns),
        Some(raw) => Ok(raw),
        None => Err(EncodeError::RawRange {
            found: text.to_owned(),
            // No type has more than 64 bits.
            highest: u64::try_from(most).unwrap_or(u64::MAX),
        }),
    })
}

/// The raw number of `figure`, which was given as `text`.
pub(super) fn raw(
    point: &Point,
    figure: Decimal,
    text: &str,
    scales: &Scales,
) -> Result<i128, EncodeError> {
    let no_scale = |_| EncodeError::NoScale {
        factor: scales.lacking(point).unwrap_or("scale").to_owned(),
    };
    match &point.scaling {
        Scaling::Times(scale) => by_factor(point, figure, text, *scale),
        Scaling::TimesFactor(name) => {
            let scale = scales.step(name).map_err(no_scale)?;
            by_factor(point, figure, text, scale)
        }
        Scaling::TimesByRaw(bands) => by_band(bands, figure, text).ok_or(EncodeError::NoStep {
            found: figure,
            scale: point.scaling.to_string(),
        }),
        Scaling::Span { full, low, high } => {
            let low = scales.operand(low).map_err(no_scale)?;
            let high = scales.operand(high).map_err(no_scale)?;
            if low == high {
                return Err(no_scale(Missing::Mismatch));
            }
            let full = *full;
            Span { full, low, high }.raw(figure, text)
        }
    }
}

/// The raw number that gives exactly this figure.
fn quotient(figure: Decimal, scale: Decimal) -> Option<i128> {
    let (raw, rest) = division(figure, scale)?;
    (rest == 0).then_some(raw)
}

/// How many whole steps lie below the figure, and what is left over, in no unit in particular.
fn division(figure: Decimal, scale: Decimal) -> Option<(i128, i128)> {
    let power = |decimals| 10_i128.checked_pow(decimals);
    // Without their common zeros both stay small.
    let (figure, scale) = (figure.normalize(), scale.normalize());
    let decimals = figure.scale().max(scale.scale());
    let whole = |number: Decimal| {
        number
            .mantissa()
            .checked_mul(power(decimals - number.scale())?)
    };
    let (figure, scale) = (whole(figure)?, whole(scale)?);
    let (figure, scale) = if scale < 0 {
        (figure.checked_neg()?, scale.checked_neg()?)
    } else {
        (figure, scale)
    };
    let raw = figure.checked_div_euclid(scale)?;
    Some((raw, figure.rem_euclid(scale)))
}

fn by_factor(
    point: &Point,
    figure: Decimal,
    text: &str,
    scale: Decimal,
) -> Result<i128, EncodeError> {
    // Integer types have bounds; nothing else comes here.
    let (lowest, highest) = point.kind.bounds().unwrap_or_default();
    let out_of_range = || {
        let ends = [lowest, highest].map(|raw| times(raw, 0, scale).unwrap_or_default());
        let [one, other] = ends;
        EncodeError::OutOfRange {
            found: text.to_owned(),
            lowest: one.min(other),
            highest: one.max(other),
        }
    };
    let (raw, rest) = division(figure, scale).ok_or_else(out_of_range)?;
    if !(lowest..=highest).contains(&raw) {
        return Err(out_of_range());
    }
    if rest == 0 {
        return Ok(raw);
    }
    let [one, other] = [raw, raw + 1].map(|raw| times(raw, 0, scale).unwrap_or_default());
    Err(EncodeError::BetweenSteps {
        found: figure,
        below: one.min(other),
        above: one.max(other),
    })
}

/// Two bands can give the same figure, with more decimals or less: the one that shows as `text` is
/// meant, else the first.
fn by_band(bands: &[Band], figure: Decimal, text: &str) -> Option<i128> {
    let of_band = |band: &Band| {
        let raw = quotient(figure, band.factor)?;
        let is_in = (band.lowest..=band.highest).contains(&raw);
        is_in.then_some((raw, band.factor))
    };
    let found: Vec<(i128, Decimal)> = bands.iter().filter_map(of_band).collect();
    let shows = |(raw, factor): &&(i128, Decimal)| {
        times(*raw, 0, *factor).is_some_and(|shown| shown.to_string() == text)
    };
    let raw = found.iter().find(shows).or(found.first())?;
    Some(raw.0)
}

/// A span with known ends.
struct Span {
    full: u16,
    low: Decimal,
    high: Decimal,
}

impl Span {
    /// What a raw number shows as.
    fn shown(&self, raw: i128) -> Option<Decimal> {
        within(raw, self.full, self.low, self.high).ok()
    }

    /// The raw number that shows as the figure.
    fn raw(&self, figure: Decimal, text: &str) -> Result<i128, EncodeError> {
        let (low, high) = (self.low.min(self.high), self.low.max(self.high));
        if figure < low || figure > high {
            return Err(EncodeError::OutOfRange {
                found: text.to_owned(),
                lowest: low,
                highest: high,
            });
        }
        let mut shown = self.near(figure).unwrap_or_default();
        shown.sort_unstable();
        if let Some((_, raw)) = shown.iter().find(|(shown, _)| *shown == figure) {
            return Ok(*raw);
        }
        let below = shown.iter().rev().find(|(shown, _)| *shown < figure);
        let above = shown.iter().find(|(shown, _)| *shown > figure);
        Err(EncodeError::BetweenSteps {
            found: figure,
            below: below.map_or(low, |(shown, _)| *shown),
            above: above.map_or(high, |(shown, _)| *shown),
        })
    }

    /// The raw numbers around a figure and what they show as. That is rounded, so the one meant is
    /// the nearest or next to it.
    fn near(&self, figure: Decimal) -> Option<Vec<(Decimal, i128)>> {
        let span = self.high.checked_sub(self.low)?;
        let part = figure.checked_sub(self.low)?;
        let part = part.checked_mul(self.full.into())?.checked_div(span)?;
        let nearest = part.round().to_i128()?;
        let around = nearest - 1..=nearest + 1;
        Some(
            around
                .filter_map(|raw| Some((self.shown(raw)?, raw)))
                .collect(),
        )
    }
}
