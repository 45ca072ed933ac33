//! A file of values that simulated meters hold: CSV with a header, a value a row.
//!
//! Its columns are `point`, `value` and, where rows are for one unit only, `unit_id`; others are
//! passed over, so that readings in long CSV can be played back. An empty value is left to the
//! model, and of several rows for one point the last one counts.

use std::io;
use std::path::Path;

use csv::ReaderBuilder;
use jiff::Timestamp;
use thiserror::Error;

use super::meter::{Meter, Setting, SettingError};

/// What is wrong with a file of values, and where.
#[derive(Debug, Error)]
pub enum ValuesError {
    /// The file cannot be read.
    #[error("the values in {file} cannot be read")]
    Unreadable {
        /// The file.
        file: String,
        /// What the system said.
        source: io::Error,
    },
    /// The file is not CSV, or not UTF-8.
    #[error("{file}:{line}: {problem}")]
    Malformed {
        /// The file.
        file: String,
        /// The line, from 1.
        line: u64,
        /// What is wrong there.
        problem: &'static str,
    },
    /// A file without a header.
    #[error("{file} is empty: its first line names the columns, point,value")]
    Empty {
        /// The file.
        file: String,
    },
    /// A column that must be there.
    #[error("{file}:1: there is no column '{column}' in the header, which has {found}")]
    NoColumn {
        /// The file.
        file: String,
        /// The column.
        column: &'static str,
        /// The columns there are.
        found: String,
    },
    /// A unit that is not simulated.
    #[error("{file}:{line}: unit_id is '{found}', and the units here are {units}")]
    Unit {
        /// The file.
        file: String,
        /// The line, from 1.
        line: u64,
        /// What stands there.
        found: String,
        /// The units that are simulated.
        units: String,
    },
    /// A value that a meter cannot hold.
    #[error("{file}:{line}: {name}: {problem}")]
    Setting {
        /// The file.
        file: String,
        /// The line, from 1.
        line: u64,
        /// The point or register.
        name: String,
        /// What is wrong with it.
        problem: SettingError,
    },
}

/// A row that says something.
struct Row {
    line: u64,
    /// The place of its meter; `None` for all of them.
    meter: Option<usize>,
    setting: Setting,
}

/// Makes meters hold the values of a file.
///
/// # Errors
/// [`ValuesError`] for the first thing that is wrong.
pub fn apply(file: &Path, meters: &mut [Meter], now: Timestamp) -> Result<(), ValuesError> {
    let name = file.display().to_string();
    let text = std::fs::read(file).map_err(|source| ValuesError::Unreadable {
        file: name.clone(),
        source,
    })?;
    let rows = rows(&name, &text, meters)?;
    let mut found = vec![None; rows.len()];
    for (place, meter) in meters.iter_mut().enumerate() {
        let is_for = |row: &&Row| row.meter.is_none_or(|meter| meter == place);
        let (indices, settings): (Vec<usize>, Vec<Setting>) = rows
            .iter()
            .enumerate()
            .filter(|(_, row)| is_for(row))
            .map(|(index, row)| (index, row.setting.clone()))
            .unzip();
        let mut failed = meter.fix(&settings, now).into_iter().peekable();
        for (position, index) in indices.into_iter().enumerate() {
            let error = failed.next_if(|(failed, _)| *failed == position);
            let outcome = error.map_or(Ok(()), |(_, error)| Err(error));
            if let Some(found) = found.get_mut(index) {
                *found = Some(better(found.take(), outcome));
            }
        }
    }
    for (row, outcome) in rows.into_iter().zip(found) {
        if let Some(Err(problem)) = outcome {
            return Err(ValuesError::Setting {
                file: name,
                line: row.line,
                name: row.setting.name,
                problem,
            });
        }
    }
    Ok(())
}

/// What a row comes to on several meters: it is for those that have its point, and there must be
/// one.
fn better(
    before: Option<Result<(), SettingError>>,
    now: Result<(), SettingError>,
) -> Result<(), SettingError> {
    match (before, now) {
        (None, now) => now,
        (Some(Err(before)), now) if before.is_of_another_meter() => now,
        (Some(before), Err(now)) if now.is_of_another_meter() => before,
        (Some(before), now) => before.and(now),
    }
}

fn rows(file: &str, text: &[u8], meters: &[Meter]) -> Result<Vec<Row>, ValuesError> {
    // Some spreadsheets begin their files with this mark.
    let text = text.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(text);
    if text.trim_ascii().is_empty() {
        let file = file.to_owned();
        return Err(ValuesError::Empty { file });
    }
    let mut reader = ReaderBuilder::new().from_reader(text);
    let malformed = |error: csv::Error| malformed(file, &error);
    let header = reader.headers().map_err(malformed)?.clone();
    let column = |wanted: &str| header.iter().position(|name| name.trim() == wanted);
    let needed = |wanted: &'static str| {
        column(wanted).ok_or_else(|| ValuesError::NoColumn {
            file: file.to_owned(),
            column: wanted,
            found: header.iter().collect::<Vec<_>>().join(", "),
        })
    };
    let (point, value, unit) = (needed("point")?, needed("value")?, column("unit_id"));
    let mut rows = Vec::new();
    for record in reader.records() {
        let record = record.map_err(malformed)?;
        let cell = |column: usize| record.get(column).unwrap_or_default();
        if cell(value).is_empty() {
            continue;
        }
        let line = record.position().map_or(0, csv::Position::line);
        let unit = unit.map(cell).map(str::trim);
        let meter = match unit.filter(|unit| !unit.is_empty()) {
            None => None,
            Some(unit) => {
                let mut known = meters.iter();
                let place = known.position(|meter| meter.unit().to_string() == unit);
                Some(place.ok_or_else(|| ValuesError::Unit {
                    file: file.to_owned(),
                    line,
                    found: unit.to_owned(),
                    units: units(meters),
                })?)
            }
        };
        let setting = Setting {
            name: cell(point).trim().to_owned(),
            value: cell(value).to_owned(),
        };
        rows.push(Row {
            line,
            meter,
            setting,
        });
    }
    Ok(rows)
}

fn units(meters: &[Meter]) -> String {
    let units = meters.iter().map(|meter| meter.unit().to_string());
    units.collect::<Vec<_>>().join(", ")
}

fn malformed(file: &str, error: &csv::Error) -> ValuesError {
    let problem = match error.kind() {
        csv::ErrorKind::Utf8 { .. } => "not UTF-8: save the file in that encoding",
        csv::ErrorKind::UnequalLengths { .. } => "has more cells or fewer than the header",
        _ => "not CSV",
    };
    ValuesError::Malformed {
        file: file.to_owned(),
        line: error.position().map_or(0, csv::Position::line),
        problem,
    }
}
