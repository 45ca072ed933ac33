//! A profile as bytes inside the program: label tables once, however many points share them.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::model::Profile;
use super::point::{Labels, Names};

/// A profile whose labels lie beside it.
#[derive(Debug, Serialize, Deserialize)]
pub struct Packed {
    profile: Profile,
    tables: Vec<Names>,
    labels: Vec<PackedLabels>,
}

/// The labels of one point, by indices.
#[derive(Debug, Serialize, Deserialize)]
struct PackedLabels {
    point: usize,
    table: usize,
    are_bits: bool,
}

impl Packed {
    /// Takes the labels out of a profile.
    pub fn pack(profile: Profile) -> Self {
        let mut tables: Vec<Names> = Vec::new();
        let mut labels = Vec::new();
        for (point, found) in profile.points.iter().enumerate() {
            let (names, are_bits) = match &found.labels {
                Labels::None => continue,
                Labels::Codes(names) => (names, false),
                Labels::Bits(names) => (names, true),
            };
            let known = tables.iter().position(|table| table == names.as_ref());
            let table = known.unwrap_or_else(|| {
                tables.push(names.as_ref().clone());
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
        let tables: Vec<Arc<Names>> = tables.into_iter().map(Arc::new).collect();
        for label in labels {
            if let (Some(point), Some(table)) =
                (profile.points.get_mut(label.point), tables.get(label.table))
            {
                point.labels = if label.are_bits {
                    Labels::Bits(Arc::clone(table))
                } else {
                    Labels::Codes(Arc::clone(table))
                };
            }
        }
        profile
    }
}
