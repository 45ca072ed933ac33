//! Tables of labels and factors: what nobody uses, and names of several bits.

use std::collections::BTreeSet;

use super::{Matter, Review, Row};
use crate::codec::value::RegisterType;
use crate::profile::format::{LabelTable, LabelsKey};
use crate::profile::load::code_number;

impl Review<'_> {
    pub(super) fn tables(&mut self) {
        self.labels();
        self.factors();
    }

    fn labels(&mut self) {
        let rows = self.rows.clone();
        for (name, table) in &self.file.labels {
            let users: Vec<&Row<'_>> = rows
                .iter()
                .filter(|row| matches!(labels(row), Some(LabelsKey::Shared(used)) if used == name.as_ref()))
                .collect();
            let key = format!("labels.{}", name.as_ref());
            if users.is_empty() {
                self.tell(&name.span(), &key, Matter::UnusedLabels);
            }
            if users.into_iter().any(are_bits) {
                self.bits(table, &key);
            }
        }
        for row in rows.iter().filter(|row| are_bits(row)) {
            if let Some(LabelsKey::Own(table)) = labels(row) {
                self.bits(table, &row.key("labels"));
            }
        }
    }

    /// Names for more than one bit; 0 is that of none at all.
    fn bits(&mut self, table: &LabelTable, key: &str) {
        for code in table.keys() {
            let mask = code_number(code.as_ref());
            if let Some(mask) = mask.filter(|mask| mask.count_ones() > 1) {
                self.tell(&code.span(), key, Matter::ManyBits { mask });
            }
        }
    }

    fn factors(&mut self) {
        let scales = self
            .profile
            .points
            .iter()
            .map(|point| point.scaling.names());
        let others = self.profile.factors.iter().map(|factor| factor.names());
        let used: BTreeSet<&str> = scales.chain(others).flatten().collect();
        for name in self.file.factors.keys() {
            if !used.contains(name.as_ref().as_str()) {
                let key = format!("factors.{}", name.as_ref());
                self.tell(&name.span(), key, Matter::UnusedFactor);
            }
        }
    }
}

fn labels<'a>(row: &Row<'a>) -> Option<&'a LabelsKey> {
    row.table.labels.as_ref().map(toml::Spanned::as_ref)
}

fn are_bits(row: &Row<'_>) -> bool {
    row.point.kind == RegisterType::Bits
}
