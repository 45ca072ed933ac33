//! What would be sent, and how long it would take.

use std::fmt;
use std::time::Duration;

use crate::codec::{RegisterAddress, RegisterRange, Unit, rtu};
use crate::output::columns::columns;
use crate::profile::plan::{Cost, PlannedRead};
use crate::profile::{Plan, Point};
use crate::transport::LineSettings;

fn frame(unit: Unit, read: &PlannedRead) -> String {
    rtu::encode_request(unit, &read.request()).to_string()
}

/// A plan for people: each request with what it is for and how long it takes, and what that saves.
pub(super) struct ShownPlan<'a> {
    pub(super) units: &'a [Unit],
    /// What is read.
    pub(super) points: &'a [Point],
    /// Those of it that nobody asked for, and that the others depend on.
    pub(super) besides: &'a [Point],
    pub(super) plan: &'a Plan,
    pub(super) settings: LineSettings,
    /// Kept between requests, where t3.5 is not enough.
    pub(super) pause: Duration,
    pub(super) cost: Cost,
}

impl ShownPlan<'_> {
    /// Nothing but the requests as they would go out, one a line.
    pub(super) fn frames(&self) -> String {
        let reads = |unit: &Unit| {
            let unit = *unit;
            let reads = self.plan.reads.iter();
            reads.map(move |read| frame(unit, read) + "\n")
        };
        self.units.iter().flat_map(reads).collect()
    }

    fn requests(&self, unit: Unit) -> String {
        let lines = self.plan.reads.iter().map(|read| {
            vec![
                frame(unit, read),
                registers(read.range),
                read.points.len().to_string(),
                milliseconds(self.cost.of(read.range.count())),
            ]
        });
        columns(&["REQUEST", "REGISTERS", "POINTS", "MS"], &[2, 3], lines)
    }

    fn totals(&self) -> String {
        let singly = self.points.iter().map(|point| point.range.count());
        let singly: Duration = singly.map(|count| self.cost.of(count)).sum();
        let total = |what: &str, requests: usize, time: Duration| {
            let units = u32::try_from(self.units.len()).unwrap_or(u32::MAX);
            vec![
                what.to_owned(),
                (requests * self.units.len()).to_string(),
                milliseconds(time * units),
            ]
        };
        let lines = [
            total("planned", self.plan.reads.len(), self.plan.cost(self.cost)),
            total("one request a point", self.points.len(), singly),
        ];
        columns(&["TOTAL", "REQUESTS", "MS"], &[1, 2], lines)
    }
}

impl fmt::Display for ShownPlan<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for unit in self.units {
            writeln!(f, "unit {unit}\n{}", self.requests(*unit))?;
        }
        let Self {
            settings, pause, ..
        } = self;
        let whole = |time| milliseconds(time).trim_end_matches(".0").to_owned();
        let answer = whole(self.cost.answer());
        writeln!(f, "{}", self.totals())?;
        write!(
            f,
            "at {settings}, if the meter begins to answer after {answer} ms"
        )?;
        if *pause > settings.silence() {
            write!(f, "; {} ms between requests", whole(*pause))?;
        }
        writeln!(f)?;
        if !self.besides.is_empty() {
            let names: Vec<&str> = self.besides.iter().map(|point| &*point.name).collect();
            writeln!(
                f,
                "read besides, for others depend on it: {}",
                names.join(", ")
            )?;
        }
        Ok(())
    }
}

/// First to last, both included.
fn registers(range: RegisterRange) -> String {
    let first = range.start();
    match u16::try_from(range.end() - 1).map(RegisterAddress) {
        Ok(last) if last != first => format!("{first}-{last}"),
        _ => first.to_string(),
    }
}

fn milliseconds(time: Duration) -> String {
    format!("{:.1}", time.as_secs_f64() * 1000.0)
}
