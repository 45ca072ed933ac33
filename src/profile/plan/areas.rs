//! Stretches of the address line, and quick answers about them.

use crate::codec::RegisterRange;

/// First register and one past the last.
pub(super) type Stretch = (u32, u32);

pub(super) fn stretch(range: RegisterRange) -> Stretch {
    (u32::from(range.start().get()), range.end())
}

/// Stretches, sorted; they may overlap.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Areas {
    starts: Vec<u32>,
    /// How far the stretches up to this one reach.
    reach: Vec<u32>,
}

impl Areas {
    /// The same registers in as few stretches as it takes: neighbours become one.
    pub(super) fn joined(&self) -> Self {
        let mut joined: Vec<Stretch> = Vec::new();
        for (start, reach) in self.starts.iter().zip(&self.reach) {
            match joined.last_mut() {
                Some((_, end)) if start <= end => *end = *reach,
                _ => joined.push((*start, *reach)),
            }
        }
        joined.into_iter().collect()
    }

    /// Whether one of them has a register in common with this stretch. Of an empty stretch, which
    /// is a border between two registers: whether it lies inside one of them.
    pub(super) fn overlap(&self, (start, end): Stretch) -> bool {
        self.reach_of_those_before(end) > start
    }

    /// Whether one of them holds this whole stretch.
    pub(super) fn hold(&self, (start, end): Stretch) -> bool {
        self.reach_of_those_before(start + 1) >= end
    }

    /// Where the first of them begins that begins at `from` or later.
    pub(super) fn next_start(&self, from: u32) -> Option<u32> {
        let before = self.starts.partition_point(|start| *start < from);
        self.starts.get(before).copied()
    }

    /// How far those reach that begin before `limit`.
    fn reach_of_those_before(&self, limit: u32) -> u32 {
        let before = self.starts.partition_point(|start| *start < limit);
        let last = before.checked_sub(1);
        last.and_then(|last| self.reach.get(last).copied())
            .unwrap_or(0)
    }
}

impl FromIterator<Stretch> for Areas {
    fn from_iter<I: IntoIterator<Item = Stretch>>(stretches: I) -> Self {
        let mut stretches: Vec<Stretch> = stretches.into_iter().collect();
        stretches.sort_unstable();
        let reach = stretches.iter().scan(0, |reach, (_, end)| {
            *reach = (*end).max(*reach);
            Some(*reach)
        });
        Self {
            reach: reach.collect(),
            starts: stretches.iter().map(|(start, _)| *start).collect(),
        }
    }
}
