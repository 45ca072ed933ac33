//! What is known of a unit for as long as the program runs.

use std::collections::BTreeSet;

use super::lesson::Lesson;
use crate::codec::{ReadFunction, RegisterRange};
use crate::profile::plan::Rules;

/// What one unit has answered and what it has not: the rules that reads of it keep to.
///
/// What it refused is a rule for good. What it met with silence is one until it has been read
/// through: the answer may have been lost on the line, so the next time it is asked again, and only
/// what meets silence that time as well is a rule for good.
#[derive(Debug, Clone)]
pub struct Memory {
    /// For good.
    lasting: Rules,
    /// While the unit is read this time.
    rules: Rules,
    /// What silence said this time.
    suspected_now: Vec<Lesson>,
    /// What it said before.
    suspected: Vec<Lesson>,
    /// The most registers it gave at once.
    largest: u16,
    /// The reads with holes it answered.
    crossed: BTreeSet<(ReadFunction, RegisterRange)>,
}

/// So many registers every meter gives at once, where nothing else stands in the way.
const SMALL: u16 = 8;

/// The most reads with holes that are remembered as answered.
const MOST_CROSSED: usize = 1000;

/// Why a unit did not give registers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Cause {
    /// It said that it does not.
    Exception,
    /// It did not answer.
    Silence,
}

/// A read as far as memory goes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shape {
    pub(super) function: ReadFunction,
    pub(super) range: RegisterRange,
    /// Whether it covers registers that none of its points names.
    pub(super) has_holes: bool,
}

impl Memory {
    /// The memory of a unit of which its profile's rules are all that is known.
    pub fn new(rules: Rules) -> Self {
        Self {
            lasting: rules.clone(),
            rules,
            suspected_now: Vec::new(),
            suspected: Vec::new(),
            largest: 0,
            crossed: BTreeSet::new(),
        }
    }

    /// The rules that hold while the unit is read this time.
    pub(super) const fn rules(&self) -> &Rules {
        &self.rules
    }

    /// The unit is about to be read through once more.
    pub(super) fn begin(&mut self) {
        for lesson in std::mem::take(&mut self.suspected_now) {
            self.suspected.retain(|before| !before.is_like(lesson));
            self.suspected.push(lesson);
        }
        self.rules = self.lasting.clone();
    }

    /// Whether the rules let this be read for several points at once, with these holes between them.
    pub(super) fn allows(&self, read: Shape, holes: &[RegisterRange]) -> bool {
        self.rules.allow(read.function, read.range, holes)
    }

    /// Whether the unit has shown that it answers such a read: as many registers at once, and of
    /// one with holes this very one.
    pub(super) fn has_answered(&self, read: Shape) -> bool {
        if read.has_holes {
            self.crossed.contains(&(read.function, read.range))
        } else {
            read.range.count() <= self.largest
        }
    }

    /// The unit has answered this read.
    pub(super) fn answered(&mut self, read: Shape) {
        self.largest = self.largest.max(read.range.count());
        if read.has_holes {
            // Plans move with the measured answer time; over years there could be very many.
            if self.crossed.len() >= MOST_CROSSED {
                self.crossed.clear();
            }
            self.crossed.insert((read.function, read.range));
        }
        self.suspected
            .retain(|lesson| !lesson.is_refuted_by(read.function, read.range, read.has_holes));
    }

    /// The unit did not give this read, which has these holes, and then every part of it: what that
    /// teaches.
    pub(super) fn learn_from_parts(
        &mut self,
        read: Shape,
        holes: &[RegisterRange],
        cause: Cause,
    ) -> Vec<Lesson> {
        let Shape {
            function, range, ..
        } = read;
        let are_known = holes.iter().all(|hole| self.rules.knows(function, *hole));
        let is_small = range.count() <= SMALL;
        let lessons = if holes.is_empty() && (is_small || range.count() <= self.largest) {
            // So it is not the number of registers.
            vec![Lesson::Border(function, range)]
        } else if holes.is_empty() {
            vec![Lesson::Limit(self.largest)]
        } else if are_known {
            // Other meters of this profile have these registers; that says nothing of further ones.
            let gone = holes.iter().map(|hole| Lesson::Refused(function, *hole));
            gone.collect()
        } else {
            vec![Lesson::NoHoles]
        };
        for lesson in &lessons {
            self.learn(*lesson, cause);
        }
        lessons
    }

    /// The unit does not give these registers, which are one point's.
    pub(super) fn learn_of_one(&mut self, read: Shape, cause: Cause) -> Vec<Lesson> {
        let lesson = Lesson::Refused(read.function, read.range);
        self.learn(lesson, cause);
        vec![lesson]
    }

    fn learn(&mut self, lesson: Lesson, cause: Cause) {
        lesson.apply(&mut self.rules);
        let is_sure =
            cause == Cause::Exception || self.suspected.iter().any(|before| before.is_like(lesson));
        if is_sure {
            lesson.apply(&mut self.lasting);
        } else {
            self.suspected_now.push(lesson);
        }
    }
}
