//! What to ask in place of a read that brought nothing.

use super::{PlannedRead, Spot, read};
use crate::codec::RegisterRange;
use crate::profile::point::Point;

impl PlannedRead {
    /// The holes in it: stretches of registers that none of its points names. `points` is the set
    /// that the read was planned for, here and below.
    pub fn holes(&self, points: &[Point]) -> Vec<RegisterRange> {
        let mut holes = Vec::new();
        let mut reach = self.range.start().get();
        for spot in self.spots(points, &self.points) {
            let start = spot.range.start().get();
            let width = start.saturating_sub(reach);
            // Next to each other they leave none.
            holes.extend(RegisterRange::new(reach, width).ok());
            // Past the last register lies nothing that could follow.
            reach = u16::try_from(spot.range.end()).map_or(reach, |end| reach.max(end));
        }
        holes
    }

    /// Whether there are any.
    pub fn has_holes(&self, points: &[Point]) -> bool {
        runs(&self.spots(points, &self.points)).count() > 1
    }

    /// Those of its points that lie in all of its registers: asking for one of them alone is this
    /// very request.
    pub fn as_wide(&self, points: &[Point]) -> Vec<usize> {
        let spots = self.spots(points, &self.points);
        let wide = spots.iter().filter(|spot| spot.range == self.range);
        wide.map(|spot| spot.index).collect()
    }

    /// The smallest piece of it, its first point alone, and the rest of it.
    pub fn first_and_rest(&self, points: &[Point]) -> Option<(Self, Self)> {
        let spots = self.spots(points, &self.points);
        let first = spots.first()?.range;
        let (first, rest): (Vec<Spot>, Vec<Spot>) =
            spots.iter().partition(|spot| spot.range == first);
        Some((read(&first)?, read(&rest)?))
    }

    /// The reads to try in place of this one for those of its points that are `left`: the stretches
    /// without holes, where it has holes, else the two halves. None of them is this read again,
    /// unless a point that is left is as wide.
    pub fn pieces(&self, points: &[Point], left: &[usize]) -> Vec<Self> {
        let spots = self.spots(points, left);
        if self.has_holes(points) {
            return runs(&spots).filter_map(read).collect();
        }
        let (first, second) = halves(&spots);
        [first, second].into_iter().filter_map(read).collect()
    }

    /// Some of its points, by address.
    fn spots(&self, points: &[Point], chosen: &[usize]) -> Vec<Spot> {
        let spot = |index: &usize| {
            Some(Spot {
                function: self.function,
                range: points.get(*index)?.range,
                alone: false,
                index: *index,
            })
        };
        let mut spots: Vec<Spot> = chosen.iter().filter_map(spot).collect();
        spots.sort_unstable();
        spots
    }
}

/// The stretches of sorted spots between which no spot names a register.
fn runs(spots: &[Spot]) -> impl Iterator<Item = &[Spot]> {
    let mut reach = 0;
    spots.chunk_by(move |spot, next| {
        reach = reach.max(spot.range.end());
        u32::from(next.range.start().get()) <= reach
    })
}

/// Sorted spots, cut nearest to the middle of their registers, without cutting one of them where
/// that can be, and so that the first half is shorter than the whole. The second one then is as
/// well: a cut at the first register is the furthest from the middle, and cuts a spot.
fn halves(spots: &[Spot]) -> (&[Spot], &[Spot]) {
    let start = |spot: &Spot| u32::from(spot.range.start().get());
    let first = spots.first().map_or(0, start);
    let end = spots.iter().map(|spot| spot.range.end()).max().unwrap_or(0);
    let mut reach = 0;
    let cuts = spots.windows(2).enumerate().filter_map(|(index, pair)| {
        let [before, after] = pair else { return None };
        reach = reach.max(before.range.end());
        let cut = start(after);
        let from_middle = (2 * cut).abs_diff(first + end);
        (reach < end).then_some((reach > cut, from_middle, index + 1))
    });
    let (_, _, cut) = cuts.min().unwrap_or((false, 0, spots.len()));
    spots.split_at(cut)
}
