//! What a profile that loads may lack all the same: what its writer has probably forgotten or
//! mistaken. Only clear cases are told, for advice that is mostly wrong is not read.

mod groups;
mod matter;
mod points;
mod scales;
mod tables;

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;

use super::error::ProfileError;
use super::format::{PointTable, ProfileFile};
use super::load::{Source, checked};
use super::model::Profile;
use super::point::Point;

pub use matter::Matter;

/// Something to look at again.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Advice {
    /// The line, from 1; of a missing key that of what it is missing from.
    pub line: usize,
    /// The key, `current_a.scale`.
    pub key: String,
    /// What about it.
    pub matter: Matter,
}

/// Loads a profile and says what it may lack, line by line; `file` is its path.
///
/// # Errors
/// [`ProfileError`] as [`super::load::load`].
pub fn advise(file: &str, text: &str) -> Result<(Profile, Vec<Advice>), ProfileError> {
    let source = Source { file, text };
    let (table, profile) = checked(&source)?;
    let by_name: BTreeMap<&str, &Point> = profile
        .points
        .iter()
        .map(|point| (point.name.as_str(), point))
        .collect();
    let mut rows = Vec::new();
    let mut row_of = BTreeMap::new();
    for table in &table.points {
        let name = table.name.as_ref();
        let names: Vec<String> = match &table.repeat {
            None => vec![name.clone()],
            Some(repeat) => (1..=*repeat.as_ref())
                .map(|place| format!("{name}_{place}"))
                .collect(),
        };
        let mut points = names.iter().filter_map(|name| by_name.get(name.as_str()));
        if let Some(first) = points.next() {
            let row = Row {
                table,
                point: first,
            };
            rows.push(row);
            row_of.insert(first.name.as_str(), row);
            row_of.extend(points.map(|point| (point.name.as_str(), row)));
        }
    }
    let mut review = Review {
        source: &source,
        file: &table,
        profile: &profile,
        rows,
        row_of,
        found: Vec::new(),
    };
    review.name();
    review.groups();
    review.tables();
    review.points();
    review.scales();
    let mut found = review.found;
    // Those of one line stay in the order of the reviews.
    found.sort_by_key(|advice| advice.line);
    Ok((profile, found))
}

/// A profile under review.
struct Review<'a> {
    source: &'a Source<'a>,
    file: &'a ProfileFile,
    profile: &'a Profile,
    rows: Vec<Row<'a>>,
    /// The rows by the names of their points.
    row_of: BTreeMap<&'a str, Row<'a>>,
    found: Vec<Advice>,
}

/// A row of the file and its point, the first where it repeats.
#[derive(Debug, Clone, Copy)]
struct Row<'a> {
    table: &'a PointTable,
    point: &'a Point,
}

impl Review<'_> {
    fn tell(&mut self, at: &Range<usize>, key: impl Into<String>, matter: Matter) {
        self.found.push(Advice {
            line: self.source.line_of(at.start),
            key: key.into(),
            matter,
        });
    }

    /// What is missing from the file as a whole is told at the name of the meter.
    fn name(&mut self) {
        let at = self.file.name.span();
        let stem = Path::new(self.source.file).file_stem();
        if stem.and_then(|stem| stem.to_str()) != Some(&self.profile.name) {
            let name = self.profile.name.clone();
            self.tell(&at, "name", Matter::FileName { name });
        }
        if self.profile.identification.is_none() {
            self.tell(&at, "identification", Matter::NoIdentification);
        }
    }
}

impl PartialEq for Row<'_> {
    fn eq(&self, other: &Self) -> bool {
        self.place() == other.place()
    }
}

impl Row<'_> {
    /// A key of this row, `current_a.scale`.
    fn key(&self, key: &str) -> String {
        format!("{}.{key}", self.table.name.as_ref())
    }

    /// Where a missing key is told of.
    fn place(&self) -> Range<usize> {
        self.table.name.span()
    }
}
