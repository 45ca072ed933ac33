//! What is to be written, checked as far as that can be done before a meter is asked, and then with
//! what it has answered.

use super::CommandError;
use super::careful::Hazard;
use super::report;
use crate::cli::{NumberingChoice, WriteFunctionChoice};
use crate::profile::assignment::{Assignment, alike, apart, assignments};
use crate::profile::selector::{Numbering, Purpose, Reading};
use crate::profile::write_plan::{Change, PlannedWrite, WriteRules, in_pieces, plan};
use crate::profile::writing::{Broadcasting, Distinct, WriteFunction};
use crate::profile::{Point, Profile, Scales, Setup};
use crate::writing::before::{allowed, distinct};

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
        let moves = |assignment: &&Assignment| assignment.writing().moves;
        let mut rest = job.assignments.iter().skip_while(|one| !moves(one));
        if let Some(moving) = rest.next()
            && let Some(after) = rest.find(|one| !moves(one))
        {
            return Err(CommandError::MovesFirst {
                name: moving.point.name.clone(),
                after: after.point.name.clone(),
            });
        }
        let mut known = Vec::new();
        for assignment in &job.assignments {
            if job.depends(assignment).is_empty() {
                known.push(assignment.change(&Scales::default())?);
            }
        }
        alike(&known, job.distinct())?;
        if known.len() == job.assignments.len() {
            plan(&known, &job.rules)?;
        }
        Ok(job)
    }

    /// The same for units one by one.
    ///
    /// # Errors
    /// [`CommandError::BroadcastOnly`] for what is only broadcast.
    pub(super) fn one_by_one(self) -> Result<Self, CommandError> {
        let only = |point: &&Point| point.writing().broadcast == Broadcasting::Only;
        let found = self.points().find(only).map(|point| point.name.clone());
        match found {
            Some(name) => Err(CommandError::BroadcastOnly { name }),
            None => Ok(self),
        }
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
        let planned = plan(&changes, &self.rules)?;
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
    /// [`CommandError::NotNow`] when it does not, or when that is not known.
    pub(super) fn allowed(&self, changes: &[Change], scales: &Scales) -> Result<(), CommandError> {
        let Some(profile) = self.profile else {
            return Ok(());
        };
        alike(changes, self.distinct())?;
        for change in changes {
            let (name, writing) = (&change.point.name, change.point.writing());
            allowed(name, "written", writing.only_with.as_ref(), scales, profile)?;
        }
        Ok(distinct(changes, self.distinct(), scales)?)
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
            let mut points = self.points();
            points.any(|point| rule.points.contains(&point.name))
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

/// What was typed, as far as it can be checked without a meter.
pub(super) fn typed(
    what: &[String],
    numbering: NumberingChoice,
    profile: Option<&Profile>,
) -> Result<Vec<Assignment>, CommandError> {
    let reading = Reading {
        numbering: match numbering {
            NumberingChoice::Protocol => Numbering::Protocol,
            NumberingChoice::Modicon => Numbering::Modicon,
        },
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

/// Tells of points that are not written at once.
pub(super) fn warn_of_pieces(changes: &[Change], planned: &[PlannedWrite]) {
    for index in in_pieces(planned, changes.len()) {
        if let Some(change) = changes.get(index) {
            report::warning(&format!(
                "{} goes in {} requests, low word first, for the meter writes one register at a time: \
                 in between it holds half of it",
                change.point.name,
                change.registers.len()
            ));
        }
    }
}
