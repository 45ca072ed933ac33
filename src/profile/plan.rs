//! Which requests fetch a set of points in the least time on this line.
//!
//! Reading registers nobody asked for costs two characters each; a request of its own costs
//! thirteen, two silences and the meter's time to answer ([`Cost`]). The plan is the shortest path
//! over the points sorted by address, under what the meter allows ([`Rules`]).

mod areas;
mod cost;
mod fence;
mod path;
mod rules;
mod split;

use std::time::Duration;

use areas::{Areas, Stretch, stretch};
pub use cost::Cost;
pub use rules::Rules;

use super::point::Point;
use crate::codec::{ReadFunction, RegisterRange, Request};

/// One read of the plan.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PlannedRead {
    /// The function to read with.
    pub function: ReadFunction,
    /// The registers to read.
    pub range: RegisterRange,
    /// Which of the points it fetches, as indices into the set.
    pub points: Vec<usize>,
}

impl PlannedRead {
    /// The request to send.
    pub const fn request(&self) -> Request {
        Request::Read {
            function: self.function,
            range: self.range,
        }
    }
}

/// Requests that together fetch every point of a set, by address.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Plan {
    /// The reads, in the order they are sent.
    pub reads: Vec<PlannedRead>,
}

impl Plan {
    /// The cheapest legal plan for `points`. Points without a function of their own are read with
    /// `function`.
    pub fn new(points: &[Point], function: ReadFunction, rules: &Rules, cost: Cost) -> Self {
        Self::of_some(points, 0..points.len(), function, rules, cost)
    }

    /// The cheapest legal plan for those of `points` that are chosen, by index.
    pub fn of_some(
        points: &[Point],
        chosen: impl IntoIterator<Item = usize>,
        function: ReadFunction,
        rules: &Rules,
        cost: Cost,
    ) -> Self {
        let spot = |index| {
            let point: &Point = points.get(index)?;
            Some(Spot {
                function: point.function.unwrap_or(function),
                range: point.range,
                alone: point.alone,
                index,
            })
        };
        let mut spots: Vec<Spot> = chosen.into_iter().filter_map(spot).collect();
        spots.sort_unstable();
        let mut reads: Vec<PlannedRead> = spots
            .chunk_by(|a, b| a.function == b.function)
            .flat_map(|spots| of_one_function(spots, rules, cost))
            .collect();
        reads.sort_by_key(|read| (read.function, read.range));
        Self { reads }
    }

    /// How long it takes on this line.
    pub fn cost(&self, cost: Cost) -> Duration {
        let reads = self.reads.iter();
        reads.map(|read| cost.of(read.range.count())).sum()
    }
}

/// A point on the address line, sorted by it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Spot {
    function: ReadFunction,
    range: RegisterRange,
    alone: bool,
    index: usize,
}

/// The reads of points of one function, which are sorted.
fn of_one_function(spots: &[Spot], rules: &Rules, cost: Cost) -> Vec<PlannedRead> {
    let Some(Spot { function, .. }) = spots.first().copied() else {
        return Vec::new();
    };
    // Registers that belong to an ordinary point as well mean that in company.
    let ordinary: Areas = spots
        .iter()
        .filter(|spot| !spot.alone)
        .map(|spot| stretch(spot.range))
        .collect();
    let apart = spots
        .iter()
        .filter(|spot| spot.alone && !ordinary.hold(stretch(spot.range)))
        .map(|spot| spot.range);
    let fence = rules.fence(function, apart);
    let (alone, together): (Vec<Spot>, Vec<Spot>) = spots
        .iter()
        .partition(|spot| spot.alone || !fence.allows(spot.range));

    let stretches: Vec<Stretch> = together.iter().map(|spot| stretch(spot.range)).collect();
    let together = path::cheapest(&stretches, &fence, cost)
        .into_iter()
        .filter_map(|read| together.get(read));
    // One request serves all that want the very same registers.
    let alone = alone.chunk_by(|a, b| a.range == b.range);
    together.chain(alone).filter_map(read).collect()
}

/// The one read of points of one function.
fn read(spots: &[Spot]) -> Option<PlannedRead> {
    let start = spots.first()?.range.start().get();
    let end = spots.iter().map(|spot| spot.range.end()).max()?;
    let count = u16::try_from(end - u32::from(start)).ok()?;
    Some(PlannedRead {
        function: spots.first()?.function,
        // The planner makes no read that is longer.
        range: RegisterRange::new(start, count).ok()?,
        points: spots.iter().map(|spot| spot.index).collect(),
    })
}
