//! Which requests fetch a set of points in the least time on this line.
//!
//! Reading registers nobody asked for costs two characters each; a request of its own costs
//! thirteen, two silences and the meter's time to answer. The plan is the shortest path over the
//! points sorted by address, under what the meter allows.

use std::time::Duration;

use super::model::Limits;
use super::point::Point;
use crate::codec::{ReadFunction, RegisterRange, Request};
use crate::transport::LineSettings;

/// Characters of a read request and of an answer without its registers.
const FIXED_CHARACTERS: usize = 8 + 5;

/// What requests cost on a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cost {
    /// Of one request and its answer, without the registers.
    pub request: Duration,
    /// Of each register.
    pub register: Duration,
}

impl Cost {
    /// The cost on a line with these settings of a meter with these limits: characters, the
    /// silence before request and answer, and the time the meter usually takes.
    pub fn new(settings: LineSettings, limits: &Limits) -> Self {
        let silence = settings.silence();
        Self {
            request: settings.transfer_time(FIXED_CHARACTERS)
                + silence
                + silence.max(limits.pause)
                + limits.typical_answer,
            register: settings.transfer_time(2),
        }
    }

    fn of(self, registers: u32) -> Duration {
        self.request + self.register * registers
    }
}

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
    pub fn new(points: &[Point], function: ReadFunction, limits: &Limits, cost: Cost) -> Self {
        let mut sorted: Vec<Spot> = points
            .iter()
            .enumerate()
            .map(|(index, point)| Spot {
                index,
                function: point.function.unwrap_or(function),
                alone: point.alone,
                range: point.range,
            })
            .collect();
        let rules = Rules {
            limits,
            apart: apart(&sorted),
        };
        for spot in &mut sorted {
            spot.alone |= !rules.allow_company(spot.function, spot.range);
        }
        sorted.sort_by_key(|spot| (spot.function, spot.alone, spot.range, spot.index));
        let mut reads: Vec<PlannedRead> = sorted
            .chunk_by(|a, b| a.function == b.function && a.alone == b.alone)
            .flat_map(|spots| cheapest(spots, &rules, cost))
            .collect();
        reads.sort_by_key(|read| (read.function, read.range));
        Self { reads }
    }
}

/// A point on the address line.
#[derive(Clone, Copy)]
struct Spot {
    index: usize,
    function: ReadFunction,
    alone: bool,
    range: RegisterRange,
}

/// What a read of several points must keep to. A single point is read as it is: the loader has
/// checked it against the limits, and for raw registers the meter has the last word.
struct Rules<'a> {
    limits: &'a Limits,
    /// The points that must be alone and whose registers no read of others runs over.
    apart: Vec<Spot>,
}

/// The points that must be alone, but for those whose registers belong to an ordinary point as
/// well: such registers mean one thing to a read of their own and another in company.
fn apart(spots: &[Spot]) -> Vec<Spot> {
    let is_shared = |alone: &Spot| {
        spots.iter().any(|spot| {
            !spot.alone && spot.function == alone.function && spot.range.contains(alone.range)
        })
    };
    let alone = spots.iter().filter(|spot| spot.alone);
    alone.filter(|spot| !is_shared(spot)).copied().collect()
}

impl Rules<'_> {
    /// Whether these registers may be read for several points at once.
    fn allow_company(&self, function: ReadFunction, range: RegisterRange) -> bool {
        let start = u32::from(range.start().get());
        let table = |address: u32| {
            let size = self.limits.table_registers?;
            Some(address / u32::from(size))
        };
        range.count() <= self.limits.read_registers
            && table(start) == table(range.end() - 1)
            && !self.apart.iter().any(|spot| {
                spot.function == function
                    && u32::from(spot.range.start().get()) < range.end()
                    && start < spot.range.end()
            })
    }
}

/// The shortest path over spots of one function, sorted by address.
fn cheapest(spots: &[Spot], rules: &Rules<'_>, cost: Cost) -> Vec<PlannedRead> {
    // best[n]: the cost of the first n spots, and where the last read of it begins.
    let mut best: Vec<(Duration, usize)> = vec![(Duration::MAX, 0); spots.len() + 1];
    best[0] = (Duration::ZERO, 0);
    for first in 0..spots.len() {
        let (so_far, _) = best[first];
        for (last, range) in reads_from(&spots[first..], rules) {
            let total = so_far + cost.of(u32::from(range.count()));
            let after = &mut best[first + last + 1];
            // Of plans that cost the same, the one that fills its first reads.
            if total <= after.0 {
                *after = (total, first);
            }
        }
    }
    let mut reads = Vec::new();
    let mut end = spots.len();
    while end > 0 {
        let start = best[end].1;
        let taken = &spots[start..end];
        // The path was built from legal reads, so this one is among them.
        let range = reads_from(taken, rules).last().map(|(_, range)| range);
        reads.extend(range.map(|range| PlannedRead {
            function: taken[0].function,
            range,
            points: taken.iter().map(|spot| spot.index).collect(),
        }));
        end = start;
    }
    reads
}

/// Every legal read that begins with the first spot: the last spot it covers, and its registers.
fn reads_from<'a>(
    spots: &'a [Spot],
    rules: &'a Rules<'_>,
) -> impl Iterator<Item = (usize, RegisterRange)> + 'a {
    let start = spots[0].range.start().get();
    let mut end = spots[0].range.end();
    spots.iter().enumerate().map_while(move |(last, spot)| {
        let is_hole = u32::from(spot.range.start().get()) > end;
        if last > 0 && (spot.alone || (is_hole && !rules.limits.read_holes)) {
            return None;
        }
        end = end.max(spot.range.end());
        let count = u16::try_from(end - u32::from(start)).ok()?;
        let range = RegisterRange::new(start, count).ok()?;
        (last == 0 || rules.allow_company(spot.function, range)).then_some((last, range))
    })
}
