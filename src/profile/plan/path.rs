//! The shortest path over points sorted by address.

use std::ops::Range;

use super::areas::Stretch;
use super::cost::Cost;
use super::fence::Fence;

/// How to cut `spots`, sorted and none of them in need of a read of its own, into reads, so that
/// their cost is the least.
///
/// A read is a run of neighbours in this order, and none that is not could be cheaper: of two reads
/// that begin one after the other, every point that begins in the later one can be fetched by the
/// one that ends last, and the other only shrinks by it.
pub(super) fn cheapest(spots: &[Stretch], fence: &Fence<'_>, cost: Cost) -> Vec<Range<usize>> {
    // best[n]: the cost of the first n spots, and where the last read of it begins.
    let mut best: Vec<(u64, usize)> = vec![(u64::MAX, 0); spots.len() + 1];
    best[0] = (0, 0);
    for (first, (start, _)) in spots.iter().enumerate() {
        let (so_far, _) = best[first];
        let furthest = fence.furthest(*start);
        let mut end = *start;
        for ((spot_start, spot_end), after) in spots[first..].iter().zip(&mut best[first + 1..]) {
            let stops = *spot_start > end && !fence.allows_hole((end, *spot_start));
            end = end.max(*spot_end);
            // What lies beyond a border stays beyond it, however many points follow.
            if end > furthest || stops {
                break;
            }
            let total = so_far.saturating_add(cost.nanoseconds(u64::from(end - start)));
            // Of plans that cost the same, the one that fills its first reads.
            if total <= after.0 {
                *after = (total, first);
            }
        }
    }
    let mut reads = Vec::new();
    let mut end = spots.len();
    while end > 0 {
        let (_, start) = best[end];
        reads.push(start..end);
        end = start;
    }
    reads.reverse();
    reads
}
