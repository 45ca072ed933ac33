//! What is broadcast: points and values, the clock among them, or one operation.

use std::time::Duration;

use jiff::Timestamp;

use super::clock::ClockSetting;
use crate::cli::{BroadcastWrite, OperationFunctionChoice, WriteFunctionChoice};
use crate::codec::Write;
use crate::commands::CommandError;
use crate::commands::careful::Hazard;
use crate::commands::execute_operation::telling::Telling;
use crate::commands::setpoints::{Job, insisted, piecemeal, typed};
use crate::profile::assignment::Assignment;
use crate::profile::point::OnlyWith;
use crate::profile::write_plan::{Change, WriteRules};
use crate::profile::writing::Broadcasting;
use crate::profile::{Point, Profile};

/// A time at which requests can be made to look at them.
const LONG_AGO: Timestamp = Timestamp::UNIX_EPOCH;

/// What is broadcast.
pub(super) struct Message<'a> {
    profile: Option<&'a Profile>,
    rules: WriteRules,
    what: What<'a>,
    /// The requests as they would have been long ago: their number and their kind are the same always.
    requests: Vec<Write>,
    /// What nobody wants to do by accident.
    pub(super) hazards: Vec<Hazard>,
    /// The points that show what was written.
    pub(super) shown: Vec<Point>,
    /// The names of the points that they show.
    written: Vec<String>,
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
        let rules = match (arguments.force, arguments.function) {
            (true, Some(_)) => WriteRules::new(profile),
            _ => WriteRules::new(profile).broadcasting(profile.map(|profile| &profile.limits)),
        };
        let rules = rules
            .insisting(insisted(arguments.function))
            .apart(arguments.one_by_one);
        let what = what(arguments, profile)?;
        let mut message = Self {
            profile,
            rules,
            what,
            requests: Vec::new(),
            hazards: Vec::new(),
            shown: Vec::new(),
            written: Vec::new(),
        };
        message.obeyed(arguments.force)?;
        message.requests = message.writes(LONG_AGO)?;
        message.hazards = match &message.what {
            What::Operation(telling) => telling.hazard().into_iter().collect(),
            What::Values(_) => {
                let job = message.job(LONG_AGO, Duration::ZERO)?;
                if let Some(name) = job.address() {
                    return Err(CommandError::OneAddress { name });
                }
                job.hazards()
            }
        };
        let changes = message.changes(LONG_AGO, Duration::ZERO)?;
        for (point, change) in changes {
            message.shown.push(point);
            message.written.push(change.point.name);
        }
        Ok(message)
    }

    /// How many requests it takes.
    pub(super) const fn requests(&self) -> usize {
        self.requests.len()
    }

    /// The name of the point that one of [`Self::shown`] shows.
    pub(super) fn written(&self, index: usize) -> &str {
        self.written.get(index).map_or("", String::as_str)
    }

    /// One of the requests, as it is right at `now`.
    ///
    /// # Panics
    /// Never: `index` is below [`Self::requests`].
    pub(super) fn write(&self, index: usize, now: Timestamp) -> Write {
        let writes = self.writes(now).ok();
        let write = writes.and_then(|writes| writes.into_iter().nth(index));
        // What could be made once can be made always.
        write.unwrap_or_else(|| self.requests[index].clone())
    }

    /// What nobody can look at on every meter before it is sent.
    pub(super) fn warnings(&self) -> Vec<String> {
        let warning = |name: &str, with: Option<&OnlyWith>| {
            let point = &with?.point;
            Some(format!(
                "{name} is taken only while {point} allows it, which is not looked at on every meter"
            ))
        };
        match &self.what {
            What::Operation(telling) => {
                let operation = telling.operation;
                let warning = warning(&operation.name, operation.only_with.as_ref());
                warning.into_iter().collect()
            }
            What::Values(parts) => {
                let all = parts
                    .iter()
                    .flat_map(|part| part.assignments(LONG_AGO, Duration::ZERO));
                let rules = all
                    .filter_map(|one| warning(&one.point.name, one.writing().only_with.as_ref()));
                let ready = self
                    .job(LONG_AGO, Duration::ZERO)
                    .and_then(|job| job.ready_unread());
                let pieces = ready.map(|(changes, planned)| piecemeal(&changes, &planned));
                rules.chain(pieces.unwrap_or_default()).collect()
            }
        }
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

    fn showing(&self, point: &Point) -> Option<Point> {
        let writing = point.writing();
        if writing.momentary || writing.moves.is_some() {
            return None;
        }
        if point.access.readable() {
            return Some(point.clone());
        }
        let name = point.writing().shown_by.as_ref()?;
        self.profile?.point(name).cloned()
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
                if !force && !limits.broadcast_functions.contains(&telling.function) {
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
                    .flat_map(|part| part.assignments(LONG_AGO, Duration::ZERO));
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
        let function = match arguments.function {
            None => None,
            Some(WriteFunctionChoice::MultipleRegisters) => {
                Some(OperationFunctionChoice::MultipleRegisters)
            }
            Some(WriteFunctionChoice::SingleRegister) => {
                return Err(CommandError::NoEffect {
                    option: "--function 6",
                    what: "points and registers",
                });
            }
        };
        let telling = Telling::new(profile, name, None, function)?;
        return Ok(What::Operation(telling));
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
