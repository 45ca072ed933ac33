//! A profile as bytes inside the program: label tables once, however many points share them.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::model::Profile;
use super::point::{Labels, Names, Point};
use super::writing::{Action, Operation};

/// A profile whose labels lie beside it.
#[derive(Debug, Serialize, Deserialize)]
pub struct Packed {
    profile: Profile,
    tables: Vec<PackedTable>,
    labels: Vec<PackedLabels>,
}

/// Names, and what their table is called where points share it.
#[derive(Debug, PartialEq, Eq, Serialize, Deserialize)]
struct PackedTable {
    name: Option<String>,
    names: Names,
}

/// The labels of one point, by indices. Behind the points of the profile come those that hold the
/// data of its operations, an index each operation whether it has data or not.
#[derive(Debug, Serialize, Deserialize)]
struct PackedLabels {
    point: usize,
    table: usize,
    are_bits: bool,
}

impl Packed {
    /// Takes the labels out of a profile.
    pub fn pack(profile: Profile) -> Self {
        let mut tables: Vec<PackedTable> = Vec::new();
        let mut labels = Vec::new();
        let points = profile.points.iter().map(Some);
        let data = profile.operations.iter().map(Operation::data);
        for (point, found) in points.chain(data).enumerate() {
            let Some(found) = found else {
                continue;
            };
            let (names, are_bits) = match &found.labels {
                Labels::None => continue,
                Labels::Codes(names) => (names, false),
                Labels::Bits(names) => (names, true),
            };
            let found = PackedTable {
                name: found.label_table.as_deref().map(str::to_owned),
                names: names.as_ref().clone(),
            };
            let known = tables.iter().position(|table| *table == found);
            let table = known.unwrap_or_else(|| {
                tables.push(found);
                tables.len() - 1
            });
            labels.push(PackedLabels {
                point,
                table,
                are_bits,
            });
        }
        Self {
            profile,
            tables,
            labels,
        }
    }

    /// Puts them back.
    pub fn unpack(self) -> Profile {
        let Self {
            mut profile,
            tables,
            labels,
        } = self;
        let tables: Vec<(Option<Arc<str>>, Arc<Names>)> = tables
            .into_iter()
            .map(|table| (table.name.map(Arc::from), Arc::new(table.names)))
            .collect();
        for label in labels {
            let place = point_mut(&mut profile, label.point);
            if let (Some(point), Some((name, names))) = (place, tables.get(label.table)) {
                point.label_table.clone_from(name);
                point.labels = if label.are_bits {
                    Labels::Bits(Arc::clone(names))
                } else {
                    Labels::Codes(Arc::clone(names))
                };
            }
        }
        profile
    }
}

/// The point of an index in [`PackedLabels`].
fn point_mut(profile: &mut Profile, index: usize) -> Option<&mut Point> {
    let Some(behind) = index.checked_sub(profile.points.len()) else {
        return profile.points.get_mut(index);
    };
    match &mut profile.operations.get_mut(behind)?.action {
        Action::Number { data, .. } => data.as_deref_mut(),
        Action::Register { .. } => None,
    }
}
