//! What is to be written, checked as far as that can be done before a meter is asked, and then with
//! what it has answered.

use super::CommandError;
use super::asking::numbering;
use super::careful::Hazard;
use crate::cli::{NumberingChoice, WriteFunctionChoice};
use crate::codec::value::ByteOrder;
use crate::profile::assignment::{Assignment, alike, apart, assignments};
use crate::profile::selector::{Purpose, Reading};
use crate::profile::write_plan::{Change, PlannedWrite, WriteRules, in_pieces, plan};
use crate::profile::writing::{Broadcasting, Distinct, Moves, WriteFunction};
use crate::profile::{Point, Profile, Scales, Setup};
use crate::writing::before::{NotNow, allowed, distinct};

/// What is to be written, the same for every unit.
pub(super) struct Job<'a> {
    assignments: Vec<Assignment>,
    profile: Option<&'a Profile>,
    rules: WriteRules,
}

/// The changes and the requests that make them.
pub(super) type Ready = (Vec<Change>, Vec<PlannedWrite>);

impl<'a> Job<'a> {
    /// What was typed, under these rules.
    ///
    /// # Errors
    /// Whatever is wrong with it without looking at a meter.
    pub(super) fn new(
        assignments: Vec<Assignment>,
        profile: Option<&'a Profile>,
        rules: WriteRules,
    ) -> Result<Self, CommandError> {
        let job = Self {
            assignments,
            profile,
            rules,
        };
        apart(&job.assignments)?;
        let mut known = Vec::new();
        for assignment in &job.assignments {
            if job.depends(assignment).is_empty() {
                known.push(assignment.change(&Scales::default())?);
            }
        }
        alike(&known, job.distinct())?;
        if known.len() == job.assignments.len() {
            job.planned(&known)?;
        }
        Ok(job)
    }

    /// The requests that make the changes. What changes how the meter is reached comes last, and in one
    /// of them: whatever comes behind would not reach it.
    fn planned(&self, changes: &[Change]) -> Result<Vec<PlannedWrite>, CommandError> {
        let planned = plan(changes, &self.rules)?;
        let name = |write: &PlannedWrite| {
            let mut members = write.changes.iter().filter_map(|index| changes.get(*index));
            members.next().map(|change| change.point.name.clone())
        };
        if let Some([moving, after, ..]) = planned.get(moving(&planned, changes)..) {
            return Err(CommandError::MovesFirst {
                name: name(moving).unwrap_or_default(),
                after: name(after).unwrap_or_default(),
            });
        }
        Ok(planned)
    }

    /// The same for so many units one by one.
    ///
    /// # Errors
    /// [`CommandError::BroadcastOnly`] for what is only broadcast, [`CommandError::OneAddress`] for an
    /// address of several.
    pub(super) fn one_by_one(self, units: usize) -> Result<Self, CommandError> {
        let only = |point: &&Point| point.writing().broadcast == Broadcasting::Only;
        if let Some(name) = self.points().find(only).map(|point| point.name.clone()) {
            return Err(CommandError::BroadcastOnly { name });
        }
        match self.address() {
            Some(name) if units > 1 => Err(CommandError::OneAddress { name }),
            _ => Ok(self),
        }
    }

    /// The point that is the address of a meter.
    pub(super) fn address(&self) -> Option<String> {
        let is_address = |point: &&Point| point.writing().moves == Some(Moves::Address);
        self.points()
            .find(is_address)
            .map(|point| point.name.clone())
    }

    /// The changes, on a meter that is set up like this, and the requests that make them.
    ///
    /// # Errors
    /// What its setup does not allow.
    pub(super) fn ready(&self, scales: &Scales) -> Result<Ready, CommandError> {
        let changes = self.assignments.iter();
        let changes: Vec<Change> = changes
            .map(|assignment| assignment.change(scales))
            .collect::<Result<_, _>>()?;
        alike(&changes, self.distinct())?;
        let planned = self.planned(&changes)?;
        Ok((changes, planned))
    }

    /// The same without a meter.
    ///
    /// # Errors
    /// [`CommandError::NeedsMeter`] for a value whose registers follow from a meter's setup.
    pub(super) fn ready_unread(&self) -> Result<Ready, CommandError> {
        let mut dependent = self.assignments.iter();
        match dependent.find(|assignment| !self.depends(assignment).is_empty()) {
            Some(assignment) => Err(CommandError::NeedsMeter {
                name: assignment.point.name.clone(),
            }),
            None => self.ready(&Scales::default()),
        }
    }

    /// Whether the meter takes these changes as it is now.
    ///
    /// # Errors
    /// [`NotNow`] when it does not, or when that is not known.
    pub(super) fn allowed(&self, changes: &[Change], scales: &Scales) -> Result<(), NotNow> {
        let Some(profile) = self.profile else {
            return Ok(());
        };
        for change in changes {
            let (name, writing) = (&change.point.name, change.point.writing());
            allowed(name, "written", writing.only_with.as_ref(), scales, profile)?;
        }
        distinct(changes, self.distinct(), scales)
    }

    /// What nobody wants to do by accident.
    pub(super) fn hazards(&self) -> Vec<Hazard> {
        let hazards = self.assignments.iter().filter_map(|assignment| {
            Some(Hazard {
                name: assignment.point.name.clone(),
                what: assignment.writing().hazard.clone()?,
            })
        });
        hazards.collect()
    }

    /// The meter, where it is known.
    pub(super) const fn profile(&self) -> Option<&'a Profile> {
        self.profile
    }

    /// The points to be written.
    pub(super) fn points(&self) -> impl Iterator<Item = &Point> {
        self.assignments.iter().map(|assignment| &assignment.point)
    }

    /// Those of them that can be read.
    pub(super) fn readable(&self) -> Vec<Point> {
        let readable = self.points().filter(|point| point.access.readable());
        readable.cloned().collect()
    }

    /// What has to be read beside them: what they are scaled by, and what rules ask for.
    pub(super) fn setup(&self) -> Setup {
        let points: Vec<Point> = self.points().cloned().collect();
        let Some(profile) = self.profile else {
            return Setup::default();
        };
        let with = self.assignments.iter();
        let with = with.filter_map(|assignment| assignment.writing().only_with.as_ref());
        let with = with.map(|with| with.point.as_str());
        let ruled = self.distinct().iter().filter(|rule| {
            let mut names = self.assignments.iter().map(Assignment::known_as);
            names.any(|name| rule.points.iter().any(|ruled| ruled == name))
        });
        let ruled = ruled.flat_map(|rule| rule.points.iter().map(String::as_str));
        let besides = with.chain(ruled).filter_map(|name| profile.point(name));
        Setup::of(&points, Some(profile)).with(besides.cloned())
    }

    fn depends(&self, assignment: &Assignment) -> Vec<Point> {
        let point = std::slice::from_ref(&assignment.point);
        Setup::of(point, self.profile).points().to_vec()
    }

    fn distinct(&self) -> &[Distinct] {
        self.profile.map_or(&[], |profile| &profile.distinct)
    }
}

/// Where the requests begin that change how the meter is reached; behind all of them where none does.
pub(super) fn moving(planned: &[PlannedWrite], changes: &[Change]) -> usize {
    let moves = |index: &usize| {
        let change = changes.get(*index);
        change.is_some_and(|change| change.point.writing().moves.is_some())
    };
    let moving = |planned: &PlannedWrite| planned.changes.iter().any(moves);
    planned.iter().position(moving).unwrap_or(planned.len())
}

/// That points are not written at once, one sentence each.
pub(super) fn piecemeal(changes: &[Change], planned: &[PlannedWrite]) -> Vec<String> {
    let pieces = in_pieces(planned, changes.len());
    let warnings = pieces.into_iter().filter_map(|index| {
        let change = changes.get(index)?;
        let order = match change.point.order {
            ByteOrder::Cdab | ByteOrder::Dcba => "low word first",
            ByteOrder::Abcd | ByteOrder::Badc => "high word first",
        };
        Some(format!(
            "{} goes in {} requests, {order}, for function 6 writes one register at a time: in \
             between the meter holds half of it",
            change.point.name,
            change.registers.len()
        ))
    });
    warnings.collect()
}

/// What was typed, as far as it can be checked without a meter.
pub(super) fn typed(
    what: &[String],
    numbered: NumberingChoice,
    profile: Option<&Profile>,
) -> Result<Vec<Assignment>, CommandError> {
    let reading = Reading {
        numbering: numbering(numbered),
        profile,
        purpose: Purpose::Write,
        ..Reading::default()
    };
    Ok(assignments(what, reading)?)
}

/// The function that was typed.
pub(super) fn insisted(function: Option<WriteFunctionChoice>) -> Option<WriteFunction> {
    function.map(|function| match function {
        WriteFunctionChoice::SingleRegister => WriteFunction::SingleRegister,
        WriteFunctionChoice::MultipleRegisters => WriteFunction::MultipleRegisters,
    })
}
