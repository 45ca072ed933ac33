//! What has been fetched of a set of points so far, and what went wrong.

use super::{Fault, Trouble};
use crate::codec::ExceptionCode;
use crate::profile::Point;
use crate::profile::plan::PlannedRead;

/// The registers of each point, as they come in.
#[derive(Debug)]
pub(super) struct Harvest {
    found: Vec<Option<Result<Vec<u16>, Fault>>>,
    troubles: Vec<Trouble>,
}

impl Harvest {
    /// Nothing of so many points.
    pub(super) fn of(points: usize) -> Self {
        Self {
            found: vec![None; points],
            troubles: Vec::new(),
        }
    }

    /// Takes the registers of an answered read.
    pub(super) fn keep(&mut self, points: &[Point], read: &PlannedRead, registers: &[u16]) {
        let start = read.range.start().get();
        for index in read.points.iter().copied() {
            let own = points.get(index).and_then(|point| {
                let offset = usize::from(point.range.start().get().checked_sub(start)?);
                registers.get(offset..offset + usize::from(point.range.count()))
            });
            self.set(index, own.map(<[u16]>::to_vec).ok_or(Fault::Mismatch));
        }
    }

    /// These points are not to be had.
    pub(super) fn lose(&mut self, points: &[usize], fault: Fault) {
        for index in points {
            self.set(*index, Err(fault));
        }
    }

    /// The meter refused these points. Those that it refuses for one reason are one trouble,
    /// however many.
    pub(super) fn lose_refused(&mut self, lost: &[usize], refusal: ExceptionCode) {
        self.lose(lost, Fault::Exception(refusal));
        let told = self.troubles.iter_mut().find_map(|trouble| match trouble {
            Trouble::Refused { points, code } if *code == refusal => Some(points),
            _ => None,
        });
        match told {
            Some(points) => points.extend(lost),
            None if lost.is_empty() => {}
            None => self.tell(Trouble::Refused {
                points: lost.to_vec(),
                code: refusal,
            }),
        }
    }

    /// Something went wrong.
    pub(super) fn tell(&mut self, trouble: Trouble) {
        self.troubles.push(trouble);
    }

    /// The points of which nothing is known yet.
    pub(super) fn missing(&self) -> Vec<usize> {
        let all = 0..self.found.len();
        all.filter(|index| self.is_missing(*index)).collect()
    }

    /// Those of a read of which nothing is known yet.
    pub(super) fn missing_of(&self, read: &PlannedRead) -> Vec<usize> {
        let points = read.points.iter().copied();
        points.filter(|index| self.is_missing(*index)).collect()
    }

    /// Whether every point of a read is there.
    pub(super) fn has_all(&self, read: &PlannedRead) -> bool {
        let mut points = read.points.iter();
        points.all(|index| matches!(self.found.get(*index), Some(Some(Ok(_)))))
    }

    /// What there is in the end, and what went wrong; points that were never asked for have `fault`.
    pub(super) fn bring_in(self, fault: Fault) -> (Vec<Result<Vec<u16>, Fault>>, Vec<Trouble>) {
        let found = self.found.into_iter();
        let registers = found.map(|found| found.unwrap_or(Err(fault)));
        (registers.collect(), self.troubles)
    }

    fn is_missing(&self, index: usize) -> bool {
        matches!(self.found.get(index), Some(None))
    }

    fn set(&mut self, index: usize, registers: Result<Vec<u16>, Fault>) {
        if let Some(place) = self.found.get_mut(index) {
            *place = Some(registers);
        }
    }
}
