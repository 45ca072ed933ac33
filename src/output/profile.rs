//! A meter as people and programs want it: what its profile says, and its points.

mod card;
mod csv;
mod head;
mod json;
mod legend;
mod listing;
mod operations;
mod sheet;
mod terms;

use std::io;

use legend::Legend;

use super::escape;
use crate::profile::{Point, Profile};
use crate::words::counted;

/// A meter and those of its points that are shown.
#[derive(Debug, Clone, Copy)]
pub struct Shown<'a> {
    /// The meter.
    pub profile: &'a Profile,
    /// The points, in the order they are shown.
    pub points: &'a [Point],
}

/// How much of it people see.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extent {
    /// The meter with its line, limits, groups and formulas, a table of the points that are only
    /// read and one of the others.
    Whole,
    /// The points: one with all there is to say about it, more in a table.
    Points,
    /// The points in a table, without heading and footnotes.
    Bare,
}

impl Shown<'_> {
    /// For people.
    pub fn text(&self, extent: Extent) -> String {
        let Self { profile, points } = *self;
        let legend = Legend::of(points);
        let mut parts = Vec::new();
        match (extent, points) {
            (Extent::Whole, _) => {
                parts.push(head::head(profile));
                parts.extend(listing::tables(points, &legend));
            }
            (Extent::Points, [point]) => return card::card(profile, point),
            (Extent::Points, _) => {
                let title = escape(&profile.title);
                parts.push(format!("{}: {title}\n", profile.name));
                parts.push(listing::table(points, &legend));
                parts.extend(listing::formulas(profile, points));
            }
            (Extent::Bare, _) => parts.push(listing::table(points, &legend)),
        }
        parts.extend(listing::scales(points));
        parts.extend(legend.text());
        if extent != Extent::Bare {
            parts.extend(operations::hazards_of_points(points));
        }
        let operations = match extent {
            Extent::Whole => profile.operations.as_slice(),
            Extent::Points | Extent::Bare => &[],
        };
        parts.extend(operations::table(operations));
        parts.extend(operations::hazards(operations));
        if extent != Extent::Bare {
            let is_marked = operations.iter().any(|operation| !operation.verified);
            parts.extend(listing::footnote(points, is_marked));
        }
        parts.join("\n")
    }

    /// CSV: a header that is always the same, a row a point. On a terminal control characters are
    /// shown, not sent.
    ///
    /// # Errors
    /// None that a write to memory does not have.
    pub fn csv(&self, terminal: bool) -> io::Result<Vec<u8>> {
        csv::csv(self.points, terminal)
    }

    /// One JSON object, its keys those of a profile's file; of the points those that are shown.
    ///
    /// # Errors
    /// None that a write to memory does not have.
    pub fn json(&self) -> io::Result<String> {
        json::json(self.profile, self.points)
    }
}

/// How many points there are, and how many of them are not verified.
pub fn count(points: &[Point]) -> String {
    let all = counted(points.len(), "point", "points");
    match points.iter().filter(|point| !point.verified).count() {
        0 => format!("{all}, all verified"),
        unverified => format!("{all}, {unverified} not verified"),
    }
}
