//! What is broadcast: points and values, the clock among them, or one operation.

use std::time::Duration;

use jiff::Timestamp;

use super::clock::ClockSetting;
use crate::cli::BroadcastWrite;
use crate::codec::Write;
use crate::commands::CommandError;
use crate::commands::careful::Hazard;
use crate::commands::execute_operation::telling::Telling;
use crate::commands::setpoints::{Job, insisted, typed, warn_of_pieces};
use crate::profile::assignment::Assignment;
use crate::profile::write_plan::{Change, WriteRules};
use crate::profile::writing::Broadcasting;
use crate::profile::{Point, Profile};

/// What is broadcast.
pub(super) struct Message<'a> {
    profile: Option<&'a Profile>,
    rules: WriteRules,
    what: What<'a>,
}

enum What<'a> {
    Operation(Telling<'a>),
    Values(Vec<Part<'a>>),
}

enum Part<'a> {
    Value(Box<Assignment>),
    Clock(ClockSetting<'a>),
}

impl<'a> Message<'a> {
    /// What was typed, if the meter obeys it.
    ///
    /// # Errors
    /// [`CommandError`] for what it does not obey, or does not take at all.
    pub(super) fn new(
        arguments: &BroadcastWrite,
        profile: Option<&'a Profile>,
    ) -> Result<Self, CommandError> {
        let rules = WriteRules::new(profile)
            .broadcasting(profile.map(|profile| &profile.limits))
            .insisting(insisted(arguments.function))
            .apart(arguments.one_by_one);
        let what = what(arguments, profile)?;
        let message = Self {
            profile,
            rules,
            what,
        };
        message.obeyed(arguments.force)?;
        message.writes(Timestamp::UNIX_EPOCH)?;
        Ok(message)
    }

    /// The requests, as they are right at `now`.
    ///
    /// # Errors
    /// [`CommandError`] for values that the meter does not take.
    pub(super) fn writes(&self, now: Timestamp) -> Result<Vec<Write>, CommandError> {
        match &self.what {
            What::Operation(telling) => Ok(vec![telling.write(now)?]),
            What::Values(_) => {
                let (_, planned) = self.job(now, Duration::ZERO)?.ready_unread()?;
                Ok(planned.into_iter().map(|planned| planned.write).collect())
            }
        }
    }

    /// The changes that a meter shows at `now`, so long after they were sent, each with the point that
    /// shows it.
    pub(super) fn changes(
        &self,
        now: Timestamp,
        since: Duration,
    ) -> Result<Vec<(Point, Change)>, CommandError> {
        let What::Values(_) = &self.what else {
            return Ok(Vec::new());
        };
        let (changes, _) = self.job(now, since)?.ready_unread()?;
        let shown = changes
            .into_iter()
            .filter_map(|change| Some((self.showing(&change.point)?, change)));
        Ok(shown.collect())
    }

    /// The points that show what was written.
    pub(super) fn shown(&self) -> Vec<Point> {
        let changes = self
            .changes(Timestamp::UNIX_EPOCH, Duration::ZERO)
            .unwrap_or_default();
        changes.into_iter().map(|(point, _)| point).collect()
    }

    fn showing(&self, point: &Point) -> Option<Point> {
        if point.writing().momentary {
            return None;
        }
        if point.access.readable() {
            return Some(point.clone());
        }
        let name = point.writing().shown_by.as_ref()?;
        self.profile?.point(name).cloned()
    }

    /// What nobody wants to do by accident.
    pub(super) fn hazards(&self) -> Vec<Hazard> {
        match &self.what {
            What::Operation(telling) => {
                let operation = telling.operation;
                let hazard = operation.hazard.clone().map(|what| Hazard {
                    name: operation.name.clone(),
                    what,
                });
                hazard.into_iter().collect()
            }
            What::Values(_) => self
                .job(Timestamp::UNIX_EPOCH, Duration::ZERO)
                .map(|job| job.hazards())
                .unwrap_or_default(),
        }
    }

    /// What will be sent, a line each.
    pub(super) fn shown_first(&self) -> String {
        match &self.what {
            What::Operation(telling) => {
                format!("{}: {}\n", telling.operation.name, telling.operation.about)
            }
            What::Values(parts) => parts.iter().map(Part::shown).collect(),
        }
    }

    /// Tells of points that are not sent at once.
    pub(super) fn warn_of_pieces(&self) {
        let job = self.job(Timestamp::UNIX_EPOCH, Duration::ZERO);
        if let Ok((changes, planned)) = job.and_then(|job| job.ready_unread()) {
            warn_of_pieces(&changes, &planned);
        }
    }

    fn job(&self, now: Timestamp, since: Duration) -> Result<Job<'_>, CommandError> {
        let assignments = match &self.what {
            What::Operation(_) => Vec::new(),
            What::Values(parts) => parts
                .iter()
                .flat_map(|part| part.assignments(now, since))
                .collect(),
        };
        Job::new(assignments, self.profile, self.rules.clone())
    }

    /// Whether the manual says that this may be broadcast.
    fn obeyed(&self, force: bool) -> Result<(), CommandError> {
        let Some(profile) = self.profile else {
            if force {
                return Ok(());
            }
            return Err(CommandError::BroadcastUnknown);
        };
        let refused = |name: &str| CommandError::NotBroadcast {
            meter: profile.name.clone(),
            name: name.to_owned(),
        };
        let limits = &profile.limits;
        if limits.broadcast_functions.is_empty() {
            return Err(CommandError::NoBroadcast {
                meter: profile.name.clone(),
            });
        }
        let is_free = |marked: Broadcasting| {
            force || !limits.broadcasts_marked_only || marked != Broadcasting::Unmarked
        };
        match &self.what {
            What::Operation(telling) => {
                let operation = telling.operation;
                if !limits.broadcast_functions.contains(&telling.function) {
                    return Err(CommandError::BroadcastFunction {
                        meter: profile.name.clone(),
                        code: telling.function.get(),
                    });
                }
                if is_free(operation.broadcast) {
                    Ok(())
                } else {
                    Err(refused(&operation.name))
                }
            }
            What::Values(parts) => {
                let all = parts
                    .iter()
                    .flat_map(|part| part.assignments(Timestamp::UNIX_EPOCH, Duration::ZERO));
                let mut held = all.filter(|one| !is_free(one.writing().broadcast));
                held.next()
                    .map_or(Ok(()), |one| Err(refused(&one.point.name)))
            }
        }
    }
}

fn what<'a>(
    arguments: &BroadcastWrite,
    profile: Option<&'a Profile>,
) -> Result<What<'a>, CommandError> {
    if let ([name], Some(profile)) = (arguments.what.as_slice(), profile)
        && !name.contains('=')
    {
        if profile.operation(name).is_none() && profile.point(name).is_some() {
            return Err(CommandError::BroadcastRead { name: name.clone() });
        }
        return Ok(What::Operation(Telling::new(profile, name, None, None)?));
    }
    if let Some(name) = arguments.what.iter().find(|what| !what.contains('=')) {
        return Err(CommandError::BroadcastRead { name: name.clone() });
    }
    let mut parts = Vec::new();
    for one in &arguments.what {
        if let Some(clock) = ClockSetting::parse(one, profile)? {
            parts.push(Part::Clock(clock));
            continue;
        }
        let assignments = typed(std::slice::from_ref(one), arguments.numbering, profile)?;
        let assignments = assignments.into_iter().map(Box::new);
        parts.extend(assignments.map(Part::Value));
    }
    Ok(What::Values(parts))
}

impl Part<'_> {
    fn assignments(&self, now: Timestamp, since: Duration) -> Vec<Assignment> {
        match self {
            Self::Value(assignment) => vec![assignment.as_ref().clone()],
            Self::Clock(clock) => clock.assignments(now, since),
        }
    }

    fn shown(&self) -> String {
        match self {
            Self::Value(assignment) => {
                let point = &assignment.point;
                let unit = point.unit.as_ref().map(|unit| format!(" {unit}"));
                let unit = unit.unwrap_or_default();
                format!("{}: {}{unit}\n", point.name, assignment.value)
            }
            Self::Clock(clock) => format!("clock: {clock}\n"),
        }
    }
}
