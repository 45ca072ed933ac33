//! The registers of a meter: which of them a read can have, and what they hold.

use std::ops::RangeInclusive;

use jiff::Timestamp;

use super::Kind;
use super::fixed::Fixed;
use crate::codec::value::{encode, encode_integer};
use crate::codec::{ExceptionCode, ReadFunction, RegisterRange};
use crate::profile::Point;
use crate::sim::model::{Content, Measured};

impl Kind {
    /// The registers of `range`, as they are at `now`.
    pub(super) fn read(
        &self,
        function: ReadFunction,
        range: RegisterRange,
        fixed: &Fixed,
        now: Timestamp,
    ) -> Result<Vec<u16>, ExceptionCode> {
        let points = self
            .points(function, range)
            .ok_or(ExceptionCode::ILLEGAL_DATA_ADDRESS)?;
        let measured = self.model.measure(now);
        let first = u32::from(range.start().get());
        let mut values = vec![0; usize::from(range.count())];
        fixed.lay(range.start().get(), &mut values);
        for point in points {
            let start = u32::from(point.range.start().get());
            for (address, word) in (start..).zip(fixed.registers(point, measured.as_ref())) {
                // Words of the point before or after the range have no place in it.
                if let Some(index) = address.checked_sub(first)
                    && let Some(value) = values.get_mut(index as usize)
                {
                    *value = word;
                }
            }
        }
        Ok(values)
    }

    /// The points that a read of `range` is about; `None` when it cannot be read like that.
    fn points(&self, function: ReadFunction, range: RegisterRange) -> Option<Vec<&Point>> {
        let readable = self.profile.points.iter().filter(|point| {
            point.access.readable()
                && point.function.is_none_or(|only| only == function)
                && point.range.overlaps(range)
        });
        let (alone, ordinary): (Vec<&Point>, Vec<&Point>) = readable.partition(|point| point.alone);
        if let Some(point) = alone.iter().find(|point| point.range == range) {
            return Some(vec![point]);
        }
        // Registers that belong to an ordinary point as well are that point's in a longer read.
        let is_shared = |point: &Point| {
            let mut others = ordinary.iter();
            others.any(|other| other.range.contains(point.range))
        };
        let is_there = self.is_in_one_area(range) || is_covered(range, &ordinary);
        (alone.iter().all(|point| is_shared(point)) && self.is_in_one_table(range) && is_there)
            .then_some(ordinary)
    }

    pub(super) fn is_in_one_area(&self, range: RegisterRange) -> bool {
        let within = |area: &RangeInclusive<u16>| {
            *area.start() <= range.start().get() && range.end() <= u32::from(*area.end()) + 1
        };
        self.model.areas().iter().any(within)
    }

    pub(super) fn is_in_one_table(&self, range: RegisterRange) -> bool {
        let table = |address: u32| {
            let size = self.profile.limits.table_registers?;
            // The loader takes no table of 0 registers.
            address.checked_div(size.into())
        };
        table(range.start().get().into()) == table(range.end() - 1)
    }
}

/// Whether each of these registers belongs to one of the points.
fn is_covered(range: RegisterRange, points: &[&Point]) -> bool {
    (u32::from(range.start().get())..range.end()).all(|address| {
        points.iter().any(|point| {
            u32::from(point.range.start().get()) <= address && address < point.range.end()
        })
    })
}

/// The registers of a point; none when the model has nothing that fits them.
pub(super) fn registers(point: &Point, measured: &dyn Measured) -> Vec<u16> {
    match measured.content(&point.name) {
        Some(Content::Number(number)) => encode_integer(point.kind, point.order, number),
        Some(Content::Other(value)) => encode(point.kind, point.order, &value),
        None => None,
    }
    .unwrap_or_default()
}
