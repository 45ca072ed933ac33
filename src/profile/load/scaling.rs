//! Scales: numbers, factors that follow from setup registers, spans.

use std::collections::BTreeMap;

use rust_decimal::Decimal;
use toml::Spanned;

use super::point::code;
use super::{Source, unknown};
use crate::codec::value::RegisterType;
use crate::profile::error::{Problem, ProfileError};
use crate::profile::format::{
    BandTable, FactorTable, Number, OnlyWithTable, OperandKey, PointTable, ScaleKey, SpanTable,
};
use crate::profile::point::Point;
use crate::profile::scaling::{Band, Factor, Operand, Rule, Scaling, in_order, times};

/// The scale of one point; which names there are is checked when all points and factors are known.
pub(super) fn scaling(
    source: &Source<'_>,
    row: &PointTable,
    kind: RegisterType,
    key: &impl Fn(&str) -> String,
) -> Result<Scaling, ProfileError> {
    if let Some(span) = &row.span {
        if let Some(scale) = &row.scale {
            let problem = Problem::Conflict("give either scale or span");
            return Err(source.error(scale.span(), key("scale"), problem));
        }
        integer(source, span, kind, key("span"))?;
        return spanned(source, span.as_ref(), key);
    }
    let Some(scale) = &row.scale else {
        return Ok(Scaling::NONE);
    };
    let key = key("scale");
    match scale.as_ref() {
        ScaleKey::Number(number) => {
            let shown = Spanned::new(scale.span(), *number);
            scaled(source, &shown, kind, &key).map(Scaling::Times)
        }
        ScaleKey::Factor(name) => {
            integer(source, scale, kind, key)?;
            Ok(Scaling::TimesFactor(name.clone()))
        }
        ScaleKey::Bands(bands) => {
            integer(source, scale, kind, key.clone())?;
            banded(source, scale, bands, kind, &key)
        }
    }
}

fn integer<T>(
    source: &Source<'_>,
    found: &Spanned<T>,
    kind: RegisterType,
    key: String,
) -> Result<(), ProfileError> {
    if kind.is_integer() {
        return Ok(());
    }
    let problem = Problem::Conflict("only an integer has such a scale");
    Err(source.error(found.span(), key, problem))
}

/// A number that every raw number of the type can be multiplied with exactly.
fn scaled(
    source: &Source<'_>,
    scale: &Spanned<Number>,
    kind: RegisterType,
    key: &str,
) -> Result<Decimal, ProfileError> {
    if !kind.is_number() {
        let problem = Problem::Conflict("only a number has a scale");
        return Err(source.error(scale.span(), key, problem));
    }
    let exact = decimal(*scale.as_ref()).filter(|scale| !scale.is_zero());
    let Some(exact) = exact else {
        return Err(source.value(scale, key, "a number other than 0, of at most 28 digits"));
    };
    if let Some((least, most)) = kind.bounds()
        && (times(least, 0, exact).is_none() || times(most, 0, exact).is_none())
    {
        let expected = format!("a number that every {kind} can be multiplied with exactly");
        return Err(source.value(scale, key, expected));
    }
    Ok(exact)
}

/// The number as it was written.
pub(super) fn decimal(number: Number) -> Option<Decimal> {
    match number {
        Number::Integer(number) => Some(Decimal::from(number)),
        // The shortest form that reads back the same is what was written.
        Number::Float(number) => Decimal::from_str_exact(&number.to_string()).ok(),
    }
}

fn banded(
    source: &Source<'_>,
    scale: &Spanned<ScaleKey>,
    tables: &[BandTable],
    kind: RegisterType,
    key: &str,
) -> Result<Scaling, ProfileError> {
    if tables.is_empty() {
        return Err(source.value(scale, key, "a list of { raw, factor }"));
    }
    let (least, most) = kind.bounds().unwrap_or_default();
    let holds = |number: i64| (least..=most).contains(&number.into());
    let mut bands: Vec<Band> = Vec::with_capacity(tables.len());
    for table in tables {
        let factor = scaled(source, &table.factor, kind, &format!("{key}.factor"))?;
        let (lowest, highest) = match *table.raw.as_ref().as_slice() {
            [lowest, highest] if lowest <= highest && holds(lowest) && holds(highest) => {
                (lowest.into(), highest.into())
            }
            _ => {
                let expected = format!("[lowest, highest] raw number of {kind}");
                return Err(source.value(&table.raw, &format!("{key}.raw"), expected));
            }
        };
        if bands
            .iter()
            .any(|band| lowest <= band.highest && band.lowest <= highest)
        {
            let problem = Problem::Conflict("these raw numbers have a factor already");
            return Err(source.error(table.raw.span(), format!("{key}.raw"), problem));
        }
        bands.push(Band {
            lowest,
            highest,
            factor,
        });
    }
    Ok(Scaling::TimesByRaw(bands))
}

fn spanned(
    source: &Source<'_>,
    table: &SpanTable,
    key: &impl Fn(&str) -> String,
) -> Result<Scaling, ProfileError> {
    if *table.full.as_ref() == 0 {
        return Err(source.value(&table.full, &key("span.full"), "above 0"));
    }
    let low = operand(source, &table.low, &key("span.low"))?;
    let high = operand(source, &table.high, &key("span.high"))?;
    if low == high {
        let expected = "another than low: between them lies nothing";
        return Err(source.value(&table.high, &key("span.high"), expected));
    }
    Ok(Scaling::Span {
        full: *table.full.as_ref(),
        low,
        high,
    })
}

fn operand(
    source: &Source<'_>,
    found: &Spanned<OperandKey>,
    key: &str,
) -> Result<Operand, ProfileError> {
    match found.as_ref() {
        OperandKey::Number(number) => decimal(*number)
            .map(Operand::Number)
            .ok_or_else(|| source.value(found, key, "a number of at most 28 digits")),
        OperandKey::Name(name) => {
            let (negative, name) = signed(name);
            Ok(Operand::Named {
                name: name.to_owned(),
                negative,
            })
        }
    }
}

/// A name that may stand behind a minus.
fn signed(name: &str) -> (bool, &str) {
    match name.strip_prefix('-') {
        Some(name) => (true, name),
        None => (false, name),
    }
}

/// All factors, each of them of things there are and none of itself.
pub(super) fn factors(
    source: &Source<'_>,
    tables: &BTreeMap<Spanned<String>, FactorTable>,
    points: &[Point],
) -> Result<Vec<Factor>, ProfileError> {
    let mut factors = Vec::with_capacity(tables.len());
    for (name, table) in tables {
        let key = format!("factors.{}", name.as_ref());
        source.name(name, &key)?;
        if points.iter().any(|point| point.name == *name.as_ref()) {
            let problem = Problem::Conflict("there is a point of this name");
            return Err(source.error(name.span(), key, problem));
        }
        factors.push(Factor {
            name: name.as_ref().clone(),
            rule: rule(source, name, table, &key)?,
        });
    }
    for (name, table) in tables {
        let key = format!("factors.{}", name.as_ref());
        for found in operands(table) {
            named(source, found, points, &factors, &key)?;
        }
        if let Some(by) = &table.by {
            let key = format!("{key}.by");
            code_point(
                source,
                &named_point(source, by, points, "point", &key)?,
                &key,
            )?;
        }
    }
    if let Err(circle) = in_order(&factors) {
        let first = circle.first().copied();
        let way = circle.into_iter().chain(first);
        let names: Vec<&str> = way.map(|index| factors[index].name.as_str()).collect();
        let place = tables.keys().find(|name| name.as_ref() == names[0]);
        let key = format!("factors.{}", names[0]);
        let problem = Problem::Cycle(names.join(" needs "));
        return Err(source.error(place.map_or(0..0, Spanned::span), key, problem));
    }
    Ok(factors)
}

fn rule(
    source: &Source<'_>,
    name: &Spanned<String>,
    table: &FactorTable,
    key: &str,
) -> Result<Rule, ProfileError> {
    match (&table.product, &table.by, &table.cases) {
        (Some(product), None, None) if table.otherwise.is_none() && !product.is_empty() => {
            let operands = product.iter().map(|found| operand(source, found, key));
            operands.collect::<Result<_, _>>().map(Rule::Product)
        }
        (None, Some(by), Some(cases)) if !cases.is_empty() => {
            let mut by_code = BTreeMap::new();
            for (written, found) in cases {
                let number = code(source, written, &format!("{key}.cases"))?;
                if by_code
                    .insert(number, operand(source, found, key)?)
                    .is_some()
                {
                    let problem = Problem::Conflict("this code has a case already");
                    return Err(source.error(written.span(), format!("{key}.cases"), problem));
                }
            }
            let otherwise = table.otherwise.as_ref();
            Ok(Rule::Choice {
                by: by.as_ref().clone(),
                cases: by_code,
                otherwise: otherwise
                    .map(|found| operand(source, found, key))
                    .transpose()?,
            })
        }
        _ => {
            let problem = Problem::Conflict(
                "give product = [...], or by = a point and cases = { code = number }",
            );
            Err(source.error(name.span(), key, problem))
        }
    }
}

fn operands(table: &FactorTable) -> impl Iterator<Item = &Spanned<OperandKey>> {
    let product = table.product.iter().flatten();
    let cases = table.cases.iter().flat_map(BTreeMap::values);
    product.chain(cases).chain(&table.otherwise)
}

/// Checks the name in an operand, if it is one.
fn named(
    source: &Source<'_>,
    found: &Spanned<OperandKey>,
    points: &[Point],
    factors: &[Factor],
    key: &str,
) -> Result<(), ProfileError> {
    match found.as_ref() {
        OperandKey::Number(_) => Ok(()),
        OperandKey::Name(name) => {
            let (_, name) = signed(name);
            let name = Spanned::new(found.span(), name.to_owned());
            factor_or_point(source, &name, points, factors, key)
        }
    }
}

fn factor_or_point(
    source: &Source<'_>,
    name: &Spanned<String>,
    points: &[Point],
    factors: &[Factor],
    key: &str,
) -> Result<(), ProfileError> {
    if factors.iter().any(|factor| factor.name == *name.as_ref()) {
        return Ok(());
    }
    if name.as_ref().parse::<f64>().is_ok() {
        return Err(source.value(name, key, "a number, without quotes, or a name"));
    }
    number_point(
        source,
        &named_point(source, name, points, "factor or point", key)?,
        key,
    )
}

/// A point by its name, and where that stands.
struct NamedPoint<'a> {
    name: &'a Spanned<String>,
    point: &'a Point,
}

fn named_point<'a>(
    source: &Source<'_>,
    name: &'a Spanned<String>,
    points: &'a [Point],
    what: &'static str,
    key: &str,
) -> Result<NamedPoint<'a>, ProfileError> {
    let point = points.iter().find(|point| point.name == *name.as_ref());
    let point = point.ok_or_else(|| unknown(source, name, what, key))?;
    Ok(NamedPoint { name, point })
}

/// Checks that a point can be read for the sake of another, and depends on none itself.
fn plain_point(source: &Source<'_>, found: &NamedPoint<'_>, key: &str) -> Result<(), ProfileError> {
    if found.point.access.readable() && found.point.only_with.is_none() {
        return Ok(());
    }
    let expected = "a point that can be read and depends on no other";
    Err(source.value(found.name, key, expected))
}

/// Checks that a point can be read for the sake of another, and that a number comes of it.
fn number_point(
    source: &Source<'_>,
    found: &NamedPoint<'_>,
    key: &str,
) -> Result<(), ProfileError> {
    let NamedPoint { name, point } = found;
    let is_whole =
        point.kind.is_integer() || matches!(point.kind, RegisterType::Hex | RegisterType::Bits);
    let is_readable = point.access.readable() && point.only_with.is_none();
    if is_whole && is_readable && point.constant_scale().is_some() {
        return Ok(());
    }
    let expected = "an integer that can be read and whose scale is a number";
    Err(source.value(name, key, expected))
}

/// Checks that a point can be read for the sake of another, and holds one of a few codes.
fn code_point(source: &Source<'_>, found: &NamedPoint<'_>, key: &str) -> Result<(), ProfileError> {
    number_point(source, found, key)?;
    if found.point.kind.registers() == 1 {
        return Ok(());
    }
    Err(source.value(found.name, key, "a point of one register"))
}

/// Checks what the scales of points refer to.
pub(super) fn references(
    source: &Source<'_>,
    rows: &[PointTable],
    points: &[Point],
    factors: &[Factor],
) -> Result<(), ProfileError> {
    for row in rows {
        let key = |key: &str| format!("{}.{key}", row.name.as_ref());
        if let Some(scale) = &row.scale
            && let ScaleKey::Factor(name) = scale.as_ref()
        {
            let name = Spanned::new(scale.span(), name.clone());
            factor_or_point(source, &name, points, factors, &key("scale"))?;
        }
        if let Some(span) = &row.span {
            let SpanTable { low, high, .. } = span.as_ref();
            named(source, low, points, factors, &key("span.low"))?;
            named(source, high, points, factors, &key("span.high"))?;
        }
        if let Some(with) = &row.only_with {
            depends(source, with, points, &key("only_with"))?;
        }
    }
    Ok(())
}

/// Checks that a point can be read for the sake of another that depends on it.
pub(super) fn depends(
    source: &Source<'_>,
    with: &OnlyWithTable,
    points: &[Point],
    key: &str,
) -> Result<(), ProfileError> {
    let OnlyWithTable { point, codes } = with;
    let at = format!("{key}.point");
    let found = named_point(source, point, points, "point", &at)?;
    match codes {
        None => plain_point(source, &found, &at),
        Some(codes) if codes.as_ref().is_empty() => {
            Err(source.value(codes, &format!("{key}.codes"), "a list of codes"))
        }
        Some(_) => code_point(source, &found, &at),
    }
}
