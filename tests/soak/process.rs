//! What the process uses: resident memory and descriptors.

use std::fmt;
use std::fs;

/// So much more memory than at the start of the work is growth, and so much more for each line: what a
/// line keeps of its last events and answers fills up in the first minutes. Six bytes kept of each
/// request shows in a million.
const GROWTH_KIB: u64 = 2048;
const GROWTH_KIB_OF_A_LINE: u64 = 64;

/// What is used at one moment; `None` where the system does not say.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Usage {
    resident_kib: Option<u64>,
    descriptors: Option<usize>,
}

impl Usage {
    pub(crate) fn now() -> Self {
        let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
        let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
        let resident = line.and_then(|line| line.trim().strip_suffix("kB"));
        Self {
            resident_kib: resident.and_then(|number| number.trim().parse().ok()),
            descriptors: fs::read_dir("/proc/self/fd").ok().map(Iterator::count),
        }
    }
}

/// How that changes.
#[derive(Debug)]
pub(crate) struct Growth {
    before: Usage,
    lines: u64,
    /// When the work had begun.
    start: Option<Usage>,
    most_kib: Option<u64>,
    last: Usage,
}

impl Growth {
    /// `before` any of so many lines was open.
    pub(crate) const fn since(before: Usage, lines: u64) -> Self {
        Self {
            before,
            lines,
            start: None,
            most_kib: None,
            last: before,
        }
    }

    /// Looks once more, while the lines work.
    pub(crate) fn look(&mut self) {
        self.last = Usage::now();
        self.start.get_or_insert(self.last);
        self.most_kib = self.most_kib.max(self.last.resident_kib);
    }

    /// Resident memory at the last look.
    pub(crate) fn resident_kib(&self) -> u64 {
        self.last.resident_kib.unwrap_or_default()
    }

    /// All lines are closed.
    pub(crate) fn end(mut self) -> Self {
        self.last = Usage::now();
        self.most_kib = self.most_kib.max(self.last.resident_kib);
        self
    }

    /// Whether nothing was kept. A run that was over before it was looked at shows nothing.
    pub(crate) fn is_well(&self) -> bool {
        let start = self.start.and_then(|start| start.resident_kib);
        let grew = match (start, self.most_kib) {
            (Some(start), Some(most)) => most.saturating_sub(start),
            _ => 0,
        };
        grew <= GROWTH_KIB + GROWTH_KIB_OF_A_LINE * self.lines
            && self.last.descriptors == self.before.descriptors
    }
}

impl fmt::Display for Growth {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let or_unknown = |number: Option<u64>| number.map_or("unknown".into(), |n| n.to_string());
        let start = self.start.unwrap_or(self.before);
        writeln!(
            f,
            "memory         {} KiB at the start, {} at the most, {} at the end",
            or_unknown(start.resident_kib),
            or_unknown(self.most_kib),
            or_unknown(self.last.resident_kib),
        )?;
        let count = |usage: Usage| or_unknown(usage.descriptors.map(|count| count as u64));
        write!(
            f,
            "descriptors    {} before the lines were opened, {} after they were closed",
            count(self.before),
            count(self.last),
        )
    }
}
