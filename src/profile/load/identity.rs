//! Identities, each told by its keys.

use rust_decimal::Decimal;
use toml::Spanned;

use super::scaling::decimal;
use super::{Source, unknown};
use crate::profile::error::{Problem, ProfileError};
use crate::profile::format::IdentityTable;
use crate::profile::identity::{Identity, Law};
use crate::profile::point::Point;

const KEY: &str = "identities";

/// All identities, of points there are.
pub(super) fn identities(
    source: &Source<'_>,
    tables: &[Spanned<IdentityTable>],
    points: &[Point],
) -> Result<Vec<Identity>, ProfileError> {
    let identities = tables.iter().map(|table| {
        for name in names(table.as_ref()) {
            let Some(point) = points.iter().find(|point| point.name == *name.as_ref()) else {
                return Err(unknown(source, name, "point", KEY));
            };
            if !point.kind.is_number() || !point.access.readable() {
                return Err(source.value(name, KEY, "a number that can be read"));
            }
        }
        let Some(law) = law(source, table.as_ref())? else {
            let problem = Problem::Conflict(
                "give sum and of, mean and of, apparent and real and reactive, power_factor and \
                 real and apparent, line_voltage and between, or near and one_of",
            );
            return Err(source.error(table.span(), KEY, problem));
        };
        Ok(Identity {
            law,
            tolerance: tolerance(source, table.as_ref().tolerance.as_ref())?,
        })
    });
    identities.collect()
}

/// Every point a table names.
fn names(table: &IdentityTable) -> impl Iterator<Item = &Spanned<String>> {
    let single = [
        &table.sum,
        &table.mean,
        &table.apparent,
        &table.real,
        &table.reactive,
        &table.power_factor,
        &table.line_voltage,
        &table.near,
    ];
    let several = table
        .of
        .iter()
        .flatten()
        .chain(table.between.iter().flatten());
    single.into_iter().flatten().chain(several)
}

/// The law that has these keys and no others.
fn law(source: &Source<'_>, table: &IdentityTable) -> Result<Option<Law>, ProfileError> {
    let text = |name: &Spanned<String>| name.as_ref().clone();
    let all = |names: &[Spanned<String>]| names.iter().map(text).collect();
    let IdentityTable {
        sum,
        mean,
        of,
        apparent,
        real,
        reactive,
        power_factor,
        line_voltage,
        between,
        near,
        one_of,
        tolerance: _,
    } = table;
    let lists = (of, between, one_of);
    let powers = (apparent, real, reactive, power_factor);
    Ok(Some(match (sum, mean, powers, line_voltage, near, lists) {
        (Some(whole), None, (None, None, None, None), None, None, (Some(parts), None, None))
            if !parts.is_empty() =>
        {
            Law::Sum {
                whole: text(whole),
                parts: all(parts),
            }
        }
        (None, Some(mean), (None, None, None, None), None, None, (Some(parts), None, None))
            if !parts.is_empty() =>
        {
            Law::Mean {
                mean: text(mean),
                parts: all(parts),
            }
        }
        (
            None,
            None,
            (Some(apparent), Some(real), Some(reactive), None),
            None,
            None,
            (None, None, None),
        ) => Law::Apparent {
            apparent: text(apparent),
            real: text(real),
            reactive: text(reactive),
        },
        (
            None,
            None,
            (Some(apparent), Some(real), None, Some(power_factor)),
            None,
            None,
            (None, None, None),
        ) => Law::PowerFactor {
            power_factor: text(power_factor),
            real: text(real),
            apparent: text(apparent),
        },
        (None, None, (None, None, None, None), Some(line), None, (None, Some(phases), None)) => {
            Law::LineVoltage {
                line: text(line),
                phases: phases.each_ref().map(text),
            }
        }
        (None, None, (None, None, None, None), None, Some(point), (None, None, Some(targets)))
            if !targets.is_empty() =>
        {
            Law::Near {
                point: text(point),
                targets: targets
                    .iter()
                    .map(|target| number(source, target))
                    .collect::<Result<_, _>>()?,
            }
        }
        _ => return Ok(None),
    }))
}

fn number(
    source: &Source<'_>,
    found: &Spanned<crate::profile::format::Number>,
) -> Result<Decimal, ProfileError> {
    decimal(*found.as_ref())
        .ok_or_else(|| source.value(found, KEY, "a number of at most 28 digits"))
}

fn tolerance(
    source: &Source<'_>,
    found: Option<&Spanned<crate::profile::format::Number>>,
) -> Result<Decimal, ProfileError> {
    let Some(found) = found else {
        return Ok(Identity::TOLERANCE);
    };
    number(source, found)
        .ok()
        .filter(|part| *part > Decimal::ZERO && *part < Decimal::ONE)
        .ok_or_else(|| source.value(found, "identities.tolerance", "above 0 and below 1"))
}
