//! What the readings of a meter say of its profile, for people.

use super::columns::columns;
use super::escape;
use super::table::heading;
use crate::profile::Point;
use crate::profile::identity::{Identity, Outcome};
use crate::readings::Row;
use crate::readings::verify::{Verdict, Verification};

/// A verification as text: the identities, the points that are not verified, and what it comes to.
#[derive(Debug)]
pub struct Verified<'a> {
    /// What was found.
    pub verification: &'a Verification<'a>,
    /// The readings it was found on.
    pub row: &'a Row,
    /// The points of the readings.
    pub points: &'a [Point],
    /// Where they come from, `/dev/ttyUSB0 at 9600 8N1`; `None` for the tables alone.
    pub line: Option<&'a str>,
}

impl Verified<'_> {
    /// The whole text.
    pub fn text(&self) -> String {
        let mut parts = vec![self.identities()];
        if !self.verification.points.is_empty() {
            parts.push(self.not_verified());
        }
        if let Some(line) = self.line {
            parts.insert(0, heading(self.row, line));
            parts.push(self.sum());
        }
        parts.join("\n")
    }

    fn identities(&self) -> String {
        let lines = self.verification.tests.iter().map(|(identity, outcome)| {
            let [found, expected, off] = sides(*outcome);
            vec![
                result(*outcome, identity),
                found,
                expected,
                off,
                identity.law.to_string(),
            ]
        });
        columns(
            &["RESULT", "FOUND", "EXPECTED", "OFF", "IDENTITY"],
            &[1, 2, 3],
            lines,
        )
    }

    fn not_verified(&self) -> String {
        let lines = self.verification.points.iter().map(|(point, verdict)| {
            vec![
                said(*verdict).to_owned(),
                self.value(point),
                escape(point.unit.as_deref().unwrap_or_default()),
                point.name.clone(),
            ]
        });
        columns(&["RESULT", "VALUE", "UNIT", "NOT VERIFIED"], &[1], lines)
    }

    fn value(&self, point: &Point) -> String {
        let index = self.points.iter().position(|read| read.name == point.name);
        match index.and_then(|index| self.row.readings.get(index)) {
            Some(Ok(value)) => escape(&value.to_string()),
            Some(Err(fault)) => fault.to_string(),
            None => String::new(),
        }
    }

    fn sum(&self) -> String {
        let Verification {
            tests,
            points,
            untold,
        } = self.verification;
        let tests = |wanted: fn(&Outcome) -> bool| {
            let outcomes = tests.iter().map(|(_, outcome)| outcome);
            outcomes.filter(|outcome| wanted(outcome)).count()
        };
        let points = |wanted| points.iter().filter(|(_, found)| *found == wanted).count();
        format!(
            "identities: {} hold, {} fail, {} could not be tested\n\
             points not verified: {} hold, {} fail, {} are doubtful, {} could not be tested, {} \
             are in no identity\n",
            tests(|outcome| matches!(outcome, Outcome::Holds { .. })),
            tests(|outcome| matches!(outcome, Outcome::Fails { .. })),
            tests(|outcome| matches!(outcome, Outcome::TooSmall | Outcome::NoValue)),
            points(Verdict::Holds),
            points(Verdict::Fails),
            points(Verdict::Doubtful),
            points(Verdict::Untested),
            untold,
        )
    }
}

fn result(outcome: Outcome, identity: &Identity) -> String {
    match outcome {
        Outcome::Holds { .. } => "holds".to_owned(),
        Outcome::Fails { .. } => {
            let allowed = identity.tolerance * rust_decimal::Decimal::ONE_HUNDRED;
            format!("fails (±{} %)", allowed.normalize())
        }
        Outcome::TooSmall => "too small to tell".to_owned(),
        Outcome::NoValue => "no value".to_owned(),
    }
}

const fn said(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Holds => "holds",
        Verdict::Fails => "fails",
        Verdict::Doubtful => "doubtful",
        Verdict::Untested => "not tested",
    }
}

/// Both sides of an identity and how far they are apart.
fn sides(outcome: Outcome) -> [String; 3] {
    let (Outcome::Holds { found, expected } | Outcome::Fails { found, expected }) = outcome else {
        return [const { String::new() }; 3];
    };
    let greater = found.abs().max(expected.abs());
    let off = format!("{:+.1} %", (found - expected) / greater * 100.0);
    // Next to nothing has no sign.
    let off = match off.trim_start_matches(['+', '-']) {
        "0.0 %" => "0.0 %".to_owned(),
        _ => off,
    };
    [digits(found), digits(expected), off]
}

/// About six digits of a number: enough to see by what sides differ.
fn digits(number: f64) -> String {
    match number.abs() {
        size if size >= 10_000.0 => format!("{number:.0}"),
        size if size >= 100.0 => format!("{number:.2}"),
        _ => format!("{number:.4}"),
    }
}
