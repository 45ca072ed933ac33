//! One set of points of one meter, read over and over.

use std::time::Duration;

use super::schedule::Every;
use crate::client::{Patience, QueryData, Ways};
use crate::codec::{FunctionCode, ReadFunction, Unit};
use crate::profile::plan::{Cost, Rules};
use crate::profile::{Limits, LoopbackData, Plan, Point, Profile, Setup};
use crate::readings::{Inquiry, Memory};
use crate::transport::LineSettings;

/// How a meter is to be treated, where that is not left to its profile.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Manners {
    /// How long an answer may take to begin; the meter's longest answer time when left out.
    pub timeout: Option<Duration>,
    /// How many times a request is repeated when the line fails.
    pub retries: u32,
    /// Least time before each request; what the meter wants when left out.
    pub pause: Option<Duration>,
}

impl Manners {
    /// How patient that is with a meter of these limits.
    pub fn patience(self, limits: &Limits) -> Patience {
        Patience {
            timeout: self.timeout.unwrap_or(limits.longest_answer),
            longest_answer: limits.longest_answer,
            retries: self.retries,
            pause: self.pause.unwrap_or(limits.pause),
            ways: Ways {
                interchangeable_reads: limits.interchangeable_reads,
                loopback: limits
                    .functions
                    .contains(&FunctionCode::Diagnostics)
                    .then_some(match limits.loopback_data {
                        LoopbackData::Any => QueryData::Any,
                        LoopbackData::Zero => QueryData::Zero,
                    }),
            },
        }
    }
}

/// Which meter is read: its name, its place and how to treat it.
#[derive(Debug, Clone)]
pub struct Subject {
    /// Its name in rows; empty for a meter of which nothing is known.
    pub name: String,
    /// What stands for it in the names of files.
    pub file_name: String,
    /// Its line, as an index into [`Site::lines`](super::Site::lines).
    pub line: usize,
    /// Its unit.
    pub unit: Unit,
    /// How to treat it.
    pub manners: Manners,
}

/// One set of points of one meter, and when and how it is read.
#[derive(Debug, Clone)]
pub struct Job {
    /// The meter.
    pub subject: Subject,
    /// Which meter of the site it is: those of one number share what was learned of it.
    pub meter: usize,
    /// What is read.
    pub points: Vec<Point>,
    /// What it depends on.
    pub setup: Setup,
    /// The function for points that have none of their own.
    pub function: ReadFunction,
    /// What the meter allows.
    pub rules: Rules,
    /// What reads cost on its line.
    pub cost: Cost,
    /// How patient to be.
    pub patience: Patience,
    /// How often it is read; `None` for a single run, which may have no interval.
    pub every: Option<Every>,
    /// Where the rows go, as an index into [`Site::outputs`](super::Site::outputs).
    pub output: usize,
}

impl Job {
    /// A job that reads `points` of a meter on a line with these settings. Its number as a meter is
    /// 0, it has no interval, and its rows go to the first output.
    pub fn new(
        subject: Subject,
        profile: Option<&Profile>,
        points: Vec<Point>,
        settings: LineSettings,
    ) -> Self {
        let unknown = Limits::default();
        let limits = profile.map_or(&unknown, |profile| &profile.limits);
        let patience = subject.manners.patience(limits);
        Self {
            subject,
            meter: 0,
            setup: Setup::of(&points, profile),
            points,
            function: limits.read_function(),
            rules: profile.map_or_else(|| Rules::new(limits), Rules::of),
            cost: Cost::new(settings, patience.pause, limits.typical_answer),
            patience,
            every: None,
            output: 0,
        }
    }

    /// What is asked of the unit, with as much patience.
    pub fn inquiry(&self, patience: Patience) -> Inquiry<'_, '_> {
        Inquiry {
            unit: self.subject.unit,
            meter: &self.subject.name,
            points: &self.points,
            setup: &self.setup,
            function: self.function,
            cost: self.cost,
            patience,
        }
    }

    /// A memory in which nothing has been learned of the meter yet.
    pub fn memory(&self) -> Memory {
        Memory::new(self.rules.clone())
    }

    /// The points, and behind them those that are read besides because they depend on them.
    pub fn all_points(&self) -> Vec<Point> {
        let besides = self.setup.besides(&self.points).cloned();
        self.points.iter().cloned().chain(besides).collect()
    }

    /// The cheapest requests, as far as they are known before the meter was asked.
    pub fn plan(&self) -> Plan {
        Plan::new(&self.all_points(), self.function, &self.rules, self.cost)
    }

    /// How long these take when nothing goes wrong.
    pub fn predicted(&self) -> Duration {
        self.plan().cost(self.cost)
    }
}

/// `main, unit 17`, or `unit 17` where it has no name.
impl std::fmt::Display for Subject {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if !self.name.is_empty() {
            write!(f, "{}, ", self.name)?;
        }
        write!(f, "unit {}", self.unit)
    }
}
