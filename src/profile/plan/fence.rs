//! Where reads of one function have to end.

use super::areas::{Areas, Stretch, stretch};
use super::rules::Holes;
use crate::codec::RegisterRange;

/// What stands in the way of reads of several points, made ready for very many questions.
#[derive(Debug)]
pub(super) struct Fence<'a> {
    /// The most registers in one read.
    most: u16,
    /// A read must not cross a multiple of this.
    table_registers: Option<u16>,
    /// What a read may cover besides the registers of its points.
    holes: Holes,
    /// The registers of ordinary points.
    known: &'a Areas,
    /// What no read may touch.
    barriers: Areas,
    /// What no read may begin or end inside of.
    whole: &'a Areas,
    /// What no read may cover: where it begins, and the least end of all that begin there or later.
    refused: Vec<Stretch>,
}

impl<'a> Fence<'a> {
    pub(super) fn new(
        (most, table_registers): (u16, Option<u16>),
        (holes, known): (Holes, &'a Areas),
        barriers: Areas,
        whole: &'a Areas,
        mut refused: Vec<Stretch>,
    ) -> Self {
        refused.sort_unstable();
        let mut least = u32::MAX;
        for (_, end) in refused.iter_mut().rev() {
            least = least.min(*end);
            *end = least;
        }
        Self {
            most,
            table_registers,
            holes,
            known,
            barriers,
            whole,
            refused,
        }
    }

    /// One past the last register of the longest read that may begin at this register, which is no
    /// part of a barrier.
    pub(super) fn furthest(&self, start: u32) -> u32 {
        let mut furthest = start + u32::from(self.most);
        if let Some(size) = self.table_registers.map(u32::from).filter(|size| *size > 0) {
            furthest = furthest.min((start / size + 1) * size);
        }
        if let Some(barrier) = self.barriers.next_start(start) {
            furthest = furthest.min(barrier);
        }
        let later = self.refused.partition_point(|(first, _)| *first < start);
        if let Some((_, end)) = self.refused.get(later) {
            furthest = furthest.min(end - 1);
        }
        furthest
    }

    /// Whether a read may go on across registers that none of its points names.
    pub(super) fn allows_hole(&self, hole: Stretch) -> bool {
        match self.holes {
            Holes::Any => true,
            Holes::Known => self.known.hold(hole),
        }
    }

    /// Whether a read of several points may be one of just these registers.
    pub(super) fn allows(&self, range: RegisterRange) -> bool {
        let (start, end) = stretch(range);
        end <= self.furthest(start)
            && !self.barriers.overlap((start, end))
            && !cuts(self.whole, (start, end))
    }
}

/// Whether a stretch begins or ends inside one of these areas.
pub(super) fn cuts(areas: &Areas, (start, end): Stretch) -> bool {
    areas.overlap((start, start)) || areas.overlap((end, end))
}
