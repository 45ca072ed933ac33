//! The strict loader: TOML text to a checked [`Profile`], or one error with file, line and key.

mod identity;
mod limits;
mod operation;
mod point;
mod scaling;
mod syntax;
mod whole;
mod writing;

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;
use std::time::Duration;

use toml::Spanned;
use wildmatch::WildMatch;

use super::error::{Problem, ProfileError};
use super::format::{IdentificationTable, LabelTable, LineTable, PointTable, ProfileFile};
use super::model::{Group, Identification, Limits, Profile};
use super::point::{Names, Point};
use crate::transport::{LineSettings, Parity, StopBits};

pub(super) use point::number as code_number;

/// Loads a profile; `file` is how errors name it.
///
/// # Errors
/// [`ProfileError`] for the first thing that is wrong.
pub fn load(file: &str, text: &str) -> Result<Profile, ProfileError> {
    let (_, profile) = checked(&Source { file, text })?;
    Ok(profile)
}

/// The file with the places of its keys, and the profile it makes.
pub(super) fn checked(source: &Source<'_>) -> Result<(ProfileFile, Profile), ProfileError> {
    let table: ProfileFile =
        toml::from_str(source.text).map_err(|error| syntax::explain(source, &error))?;
    source.name(&table.name, "name")?;
    let limits = limits::limits(source, &table.limits)?;
    let labels = shared_labels(source, &table.labels)?;
    let points = points(source, &table.points, &labels, &limits)?;
    let factors = scaling::factors(source, &table.factors, &points)?;
    scaling::references(source, &table.points, &points, &factors)?;
    writing::references(source, &table.points, &points)?;
    let identities = identity::identities(source, &table.identities, &points)?;
    let groups = groups(source, &table.groups, &points)?;
    let identification = table
        .identification
        .as_ref()
        .map(|table| identification(source, table, &points))
        .transpose()?;
    let command_registers = whole::command_registers(source, &table, &limits)?;
    let known = operation::Known {
        points: &points,
        labels: &labels,
        limits: &limits,
        command_registers,
    };
    let operations = operation::operations(source, &table.operations, &known)?;
    let clock = whole::clock(source, &table, &points)?;
    let status_bits = whole::status_bits(source, &table, &limits)?;
    let distinct = whole::distinct(source, &table, &points)?;
    let profile = Profile {
        name: table.name.as_ref().clone(),
        title: table.title.clone(),
        manual: table.manual.clone(),
        line: line(source, &table.line)?,
        limits,
        identification,
        groups,
        factors,
        points,
        identities,
        operations,
        command_registers,
        clock,
        status_bits,
        distinct,
    };
    Ok((table, profile))
}

/// The longest time a profile can give; sums of a few such stay far from any limit.
const LONGEST_TIME: Duration = Duration::from_secs(24 * 60 * 60);

/// The text being loaded: turns places in it into errors.
pub(super) struct Source<'a> {
    pub(super) file: &'a str,
    pub(super) text: &'a str,
}

impl Source<'_> {
    /// The line of a place in the text, from 1.
    pub(super) fn line_of(&self, offset: usize) -> usize {
        let bytes = self.text.bytes().take(offset);
        bytes.filter(|byte| *byte == b'\n').count() + 1
    }

    fn error(&self, at: Range<usize>, key: impl Into<String>, problem: Problem) -> ProfileError {
        ProfileError {
            file: self.file.to_owned(),
            line: self.line_of(at.start),
            key: key.into(),
            problem: Box::new(problem),
        }
    }

    fn value<T>(&self, found: &Spanned<T>, key: &str, expected: impl Into<String>) -> ProfileError {
        let shown = self.text.get(found.span()).unwrap_or_default();
        let lines: Vec<&str> = shown.lines().map(str::trim).collect();
        let problem = Problem::Value {
            found: lines.join(" "),
            expected: expected.into(),
        };
        self.error(found.span(), key, problem)
    }

    fn name(&self, name: &Spanned<String>, key: &str) -> Result<(), ProfileError> {
        let text = name.as_ref();
        let fits = text.starts_with(|first: char| first.is_ascii_lowercase())
            && text
                .chars()
                .all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_');
        if fits {
            return Ok(());
        }
        Err(self.error(name.span(), key, Problem::Name(text.clone())))
    }

    fn bounded(
        &self,
        found: Option<&Spanned<u16>>,
        key: &str,
        most: u16,
    ) -> Result<u16, ProfileError> {
        match found {
            None => Ok(most),
            Some(number) if (1..=most).contains(number.as_ref()) => Ok(*number.as_ref()),
            Some(number) => Err(self.value(number, key, format!("1 to {most}"))),
        }
    }

    fn duration(
        &self,
        found: Option<&Spanned<String>>,
        key: &str,
        default: Duration,
    ) -> Result<Duration, ProfileError> {
        let Some(text) = found else {
            return Ok(default);
        };
        humantime::parse_duration(text.as_ref())
            .ok()
            .filter(|time| *time <= LONGEST_TIME)
            .ok_or_else(|| {
                let expected = "a duration with its unit, such as \"500ms\", at most 24h";
                self.value(text, key, expected)
            })
    }
}

/// A name that nothing has.
fn unknown(
    source: &Source<'_>,
    name: &Spanned<String>,
    what: &'static str,
    key: &str,
) -> ProfileError {
    let found = name.as_ref().clone();
    source.error(name.span(), key, Problem::Unknown { what, found })
}

fn line(source: &Source<'_>, table: &LineTable) -> Result<LineSettings, ProfileError> {
    let default = LineSettings::default();
    let baud = match &table.baud {
        Some(baud) if *baud.as_ref() == 0 => {
            return Err(source.value(baud, "line.baud", "above 0"));
        }
        Some(baud) => *baud.as_ref(),
        None => default.baud,
    };
    let parity = match &table.parity {
        None => default.parity,
        Some(text) => match text.as_ref().as_str() {
            "none" => Parity::None,
            "even" => Parity::Even,
            "odd" => Parity::Odd,
            _ => return Err(source.value(text, "line.parity", "\"none\", \"even\" or \"odd\"")),
        },
    };
    let stop_bits = match &table.stop_bits {
        None => default.stop_bits,
        Some(bits) => match bits.as_ref() {
            1 => StopBits::One,
            2 => StopBits::Two,
            _ => return Err(source.value(bits, "line.stop_bits", "1 or 2")),
        },
    };
    Ok(LineSettings {
        baud,
        parity,
        stop_bits,
    })
}

/// The tables of `[labels]`, by name.
type SharedLabels = BTreeMap<String, Arc<Names>>;

/// All of them, used or not.
fn shared_labels(
    source: &Source<'_>,
    tables: &BTreeMap<Spanned<String>, LabelTable>,
) -> Result<SharedLabels, ProfileError> {
    let tables = tables.iter().map(|(name, table)| {
        let key = format!("labels.{}", name.as_ref());
        source.name(name, &key)?;
        let names = point::label_names(source, table, &key)?;
        Ok((name.as_ref().clone(), Arc::new(names)))
    });
    tables.collect()
}

/// All points by address, each name once, no two on the same registers.
fn points(
    source: &Source<'_>,
    rows: &[PointTable],
    labels: &SharedLabels,
    limits: &Limits,
) -> Result<Vec<Point>, ProfileError> {
    let mut places: BTreeMap<String, usize> = BTreeMap::new();
    let mut points: Vec<(Point, Range<usize>)> = Vec::with_capacity(rows.len());
    for row in rows {
        let place = row.name.span().start;
        for point in point::row(source, row, labels, limits)? {
            if let Some(first) = places.insert(point.name.clone(), place) {
                let first = source.line_of(first);
                let problem = Problem::DuplicateName { first };
                return Err(source.error(row.name.span(), format!("{}.name", point.name), problem));
            }
            points.push((point, row.address.span()));
        }
    }
    points.sort_by_key(|(point, _)| (point.range, point.alone));
    overlaps(source, &points, limits)?;
    Ok(points.into_iter().map(|(point, _)| point).collect())
}

/// Two points on one register are a slip of the pen, unless one of them is read alone (the meter
/// then answers such a request with something else) or functions that are not interchangeable read
/// them.
fn overlaps(
    source: &Source<'_>,
    points: &[(Point, Range<usize>)],
    limits: &Limits,
) -> Result<(), ProfileError> {
    let read_with = |point: &Point| {
        let own = point.function.filter(|_| !limits.interchangeable_reads);
        own.unwrap_or_else(|| limits.read_function())
    };
    // The point that reaches furthest so far, a function each.
    let mut furthest: Vec<&(Point, Range<usize>)> = Vec::new();
    for entry in points.iter().filter(|(point, _)| !point.alone) {
        let (point, span) = entry;
        let before = furthest
            .iter()
            .position(|(other, _)| read_with(other) == read_with(point));
        let Some(at) = before else {
            furthest.push(entry);
            continue;
        };
        let (other, other_span) = furthest[at];
        if point.range.overlaps(other.range) {
            let problem = Problem::Overlap {
                range: point.range.to_string(),
                other: other.name.clone(),
                line: source.line_of(other_span.start),
            };
            return Err(source.error(span.clone(), format!("{}.address", point.name), problem));
        }
        furthest[at] = entry;
    }
    Ok(())
}

fn groups(
    source: &Source<'_>,
    table: &BTreeMap<Spanned<String>, Vec<Spanned<String>>>,
    points: &[Point],
) -> Result<Vec<Group>, ProfileError> {
    let mut groups = Vec::with_capacity(table.len());
    for (name, patterns) in table {
        let key = format!("groups.{}", name.as_ref());
        source.name(name, &key)?;
        let mut members: Vec<usize> = Vec::new();
        for pattern in patterns {
            let glob = WildMatch::new(pattern.as_ref());
            let matches = points.iter().enumerate();
            let mut found = false;
            for (index, _) in matches.filter(|(_, point)| glob.matches(&point.name)) {
                found = true;
                if !members.contains(&index) {
                    members.push(index);
                }
            }
            if !found {
                return Err(unknown(source, pattern, "point", &key));
            }
        }
        groups.push(Group {
            name: name.as_ref().clone(),
            members,
        });
    }
    Ok(groups)
}

fn identification(
    source: &Source<'_>,
    table: &IdentificationTable,
    points: &[Point],
) -> Result<Identification, ProfileError> {
    let (name, key) = (table.point.as_ref(), "identification.point");
    let Some(point) = points.iter().find(|point| point.name == *name) else {
        return Err(unknown(source, &table.point, "point", key));
    };
    if point.kind.registers() != 1 || !point.access.readable() {
        return Err(source.value(
            &table.point,
            key,
            "a point of one register that can be read",
        ));
    }
    if table.codes.as_ref().is_empty() {
        return Err(source.value(&table.codes, "identification.codes", "a list of codes"));
    }
    Ok(Identification {
        point: table.point.as_ref().clone(),
        codes: table.codes.as_ref().clone(),
    })
}
