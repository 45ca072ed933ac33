//! Puts what a profile says must hold to the test of a meter's own readings.

use std::collections::BTreeMap;

use rust_decimal::prelude::ToPrimitive;

use super::Fault;
use crate::profile::identity::{Figure, Identity, Outcome};
use crate::profile::{Point, Profile, Value};

/// What became of each identity of a meter, and what that says of its points.
#[derive(Debug)]
pub struct Verification<'a> {
    /// The identities and their outcomes, in the profile's order.
    pub tests: Vec<(&'a Identity, Outcome)>,
    /// The points that are not verified and that an identity is about, by address.
    pub points: Vec<(&'a Point, Verdict)>,
    /// How many further points are not verified and in no identity.
    pub untold: usize,
}

/// What the identities say of a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// All that could be tested hold.
    Holds,
    /// Some hold and some do not: one of the points beside it may be the wrong one.
    Doubtful,
    /// None of those that could be tested holds.
    Fails,
    /// None could be tested.
    Untested,
}

/// A reading and the difference that one raw step of it makes.
pub type Measured = (Result<Value, Fault>, f64);

/// The points to read: those that the identities are about.
pub fn points(profile: &Profile) -> Vec<Point> {
    let is_told = |point: &&Point| {
        let mut identities = profile.identities.iter();
        identities.any(|identity| identity.law.points().contains(&&*point.name))
    };
    profile.points.iter().filter(is_told).cloned().collect()
}

/// Tests every identity of a meter on readings by the names of their points.
pub fn verify<'a>(profile: &'a Profile, readings: &BTreeMap<String, Measured>) -> Verification<'a> {
    let figure = |name: &str| {
        let (reading, step) = readings.get(name)?;
        Some(Figure {
            value: number(reading.as_ref().ok()?)?,
            step: *step,
        })
    };
    let tests: Vec<(&Identity, Outcome)> = profile
        .identities
        .iter()
        .map(|identity| (identity, identity.test(figure)))
        .collect();
    let unverified = || profile.points.iter().filter(|point| !point.verified);
    let points: Vec<(&Point, Verdict)> = unverified()
        .filter_map(|point| Some((point, verdict(point, &tests)?)))
        .collect();
    Verification {
        untold: unverified().count() - points.len(),
        tests,
        points,
    }
}

/// What the tests say of a point; `None` when none is about it.
fn verdict(point: &Point, tests: &[(&Identity, Outcome)]) -> Option<Verdict> {
    let about: Vec<&Outcome> = tests
        .iter()
        .filter(|(identity, _)| identity.law.points().contains(&&*point.name))
        .map(|(_, outcome)| outcome)
        .collect();
    if about.is_empty() {
        return None;
    }
    let holds = about
        .iter()
        .any(|outcome| matches!(outcome, Outcome::Holds { .. }));
    let fails = about
        .iter()
        .any(|outcome| matches!(outcome, Outcome::Fails { .. }));
    Some(match (holds, fails) {
        (true, false) => Verdict::Holds,
        (true, true) => Verdict::Doubtful,
        (false, true) => Verdict::Fails,
        (false, false) => Verdict::Untested,
    })
}

fn number(value: &Value) -> Option<f64> {
    match value {
        Value::Decimal(number) => number.to_f64(),
        Value::Single(number) => Some((*number).into()),
        Value::Double(number) => Some(*number),
        Value::Text(_) => None,
    }
}
