//! Tables of labels and factors: what nobody uses, and names of several bits.

use std::collections::BTreeSet;

use super::{Matter, Review};
use crate::codec::value::RegisterType;
use crate::profile::format::{LabelTable, LabelsKey};
use crate::profile::load::code_number;

impl<'a> Review<'a> {
    pub(super) fn tables(&mut self) {
        self.labels();
        self.factors();
    }

    fn labels(&mut self) {
        let labelled = self.labelled();
        for (name, table) in &self.file.labels {
            let mut users = labelled
                .iter()
                .filter(|used| matches!(used.labels, LabelsKey::Shared(table) if table == name.as_ref()))
                .peekable();
            let key = format!("labels.{}", name.as_ref());
            if users.peek().is_none() {
                self.tell(&name.span(), &key, Matter::UnusedLabels);
            }
            if users.any(|used| used.kind == RegisterType::Bits) {
                self.bits(table, &key);
            }
        }
        for used in labelled
            .iter()
            .filter(|used| used.kind == RegisterType::Bits)
        {
            if let LabelsKey::Own(table) = used.labels {
                self.bits(table, &used.key);
            }
        }
    }

    /// The labels of all points and of the data of all operations.
    fn labelled(&self) -> Vec<Use<'a>> {
        let of_points = self.rows.iter().filter_map(|row| {
            Some(Use {
                labels: row.table.labels.as_ref()?.as_ref(),
                kind: row.point.kind,
                key: row.key("labels"),
            })
        });
        let of_data = self.file.operations.iter().filter_map(|table| {
            let table = table.as_ref();
            let name = table.name.as_ref();
            Some(Use {
                labels: table.data.as_ref()?.as_ref().labels.as_ref()?.as_ref(),
                kind: self.profile.operation(name)?.data()?.kind,
                key: format!("operations.{name}.data.labels"),
            })
        });
        of_points.chain(of_data).collect()
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

/// Labels where they are used.
struct Use<'a> {
    labels: &'a LabelsKey,
    kind: RegisterType,
    key: String,
}
