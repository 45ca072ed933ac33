//! What labels stand for: a few of them in a table's column, more below it.

use super::sheet::Sheet;
use super::terms;
use crate::profile::Point;
use crate::profile::point::Labels;

/// The longest list of labels that stands in the column.
const SHORT: usize = 20;

/// The lists that are too long for the column, each once.
#[derive(Debug)]
pub(super) struct Legend<'a>(Vec<Entry<'a>>);

#[derive(Debug)]
struct Entry<'a> {
    /// The name of the table in the profile, or of the first point that has these labels.
    name: &'a str,
    point: &'a Point,
}

impl<'a> Legend<'a> {
    /// Of what these points need.
    pub(super) fn of(points: &'a [Point]) -> Self {
        let mut legend = Self(Vec::new());
        for point in points {
            if !fits(point) && legend.entry(point).is_none() {
                let name = point.label_table.as_deref().unwrap_or(&point.name);
                legend.0.push(Entry { name, point });
            }
        }
        legend
    }

    fn entry(&self, point: &Point) -> Option<&Entry<'a>> {
        self.0.iter().find(|entry| {
            entry.point.label_table == point.label_table && entry.point.labels == point.labels
        })
    }

    /// What stands in the column: the labels, or where to find them.
    pub(super) fn cell(&self, point: &Point) -> String {
        let entry = self.entry(point);
        entry.map_or_else(|| spelled(point).join(", "), |entry| entry.name.to_owned())
    }

    /// What stands below the table.
    pub(super) fn text(&self) -> Option<String> {
        let mut sheet = Sheet::default();
        for Entry { name, point } in &self.0 {
            sheet.list(name, spelled(point));
        }
        (!self.0.is_empty()).then(|| sheet.to_string())
    }
}

fn fits(point: &Point) -> bool {
    point.labels == Labels::None || spelled(point).join(", ").chars().count() <= SHORT
}

fn spelled(point: &Point) -> Vec<String> {
    let labels = terms::labels(point).into_iter();
    labels
        .map(|(number, name)| format!("{number}={name}"))
        .collect()
}
