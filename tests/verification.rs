//! What the identities of a meter say of points that are not verified.

use std::collections::BTreeMap;

use meterpoll::profile::identity::Outcome;
use meterpoll::profile::load::load;
use meterpoll::profile::{Profile, Value};
use meterpoll::readings::Fault;
use meterpoll::readings::verify::{Measured, Verdict, points, verify};
use rust_decimal::Decimal;

const METER: &str = r#"
name = "m"
title = "Meter"
manual = "Manual"

identities = [
  { sum = "power", of = ["power_a", "power_b"] },
  { power_factor = "factor", real = "power", apparent = "apparent" },
  { near = "frequency", one_of = [50, 60] },
]

points = [
  { name = "power", address = 0, type = "u16" },
  { name = "power_a", address = 1, type = "u16", verified = false },
  { name = "power_b", address = 2, type = "u16", verified = false },
  { name = "factor", address = 3, type = "u16", scale = 0.01, verified = false },
  { name = "apparent", address = 4, type = "u16", verified = false },
  { name = "frequency", address = 5, type = "u16", scale = 0.01, verified = false },
  { name = "counter", address = 6, type = "u16", verified = false },
  { name = "serial", address = 7, type = "u16" },
]
"#;

fn meter() -> Profile {
    load("m.toml", METER).unwrap_or_else(|error| panic!("{error}"))
}

/// Readings in steps of one, but for those in hundredths.
fn readings(values: &[(&str, i64)]) -> BTreeMap<String, Measured> {
    let reading = |(name, raw): &(&str, i64)| {
        let (digits, step) = match *name {
            "factor" | "frequency" => (2, 0.01),
            _ => (0, 1.0),
        };
        let value = Value::Decimal(Decimal::new(*raw, digits));
        ((*name).to_owned(), (Ok(value), step))
    };
    values.iter().map(reading).collect()
}

const GOOD: [(&str, i64); 6] = [
    ("power", 800),
    ("power_a", 500),
    ("power_b", 300),
    ("factor", 80),
    ("apparent", 1000),
    ("frequency", 5002),
];

/// The verdict on each point that is not verified.
fn verdicts(readings: &BTreeMap<String, Measured>) -> Vec<(String, Verdict)> {
    let meter = meter();
    let verification = verify(&meter, readings);
    assert_eq!(verification.untold, 1, "the counter is in no identity");
    let verdict =
        |(point, verdict): (&meterpoll::profile::Point, Verdict)| (point.name.clone(), verdict);
    verification.points.into_iter().map(verdict).collect()
}

fn named(verdicts: [(&str, Verdict); 5]) -> Vec<(String, Verdict)> {
    verdicts
        .into_iter()
        .map(|(name, verdict)| (name.to_owned(), verdict))
        .collect()
}

#[test]
fn only_points_that_an_identity_is_about_are_read() {
    let names: Vec<String> = points(&meter())
        .into_iter()
        .map(|point| point.name)
        .collect();
    let expected = [
        "power",
        "power_a",
        "power_b",
        "factor",
        "apparent",
        "frequency",
    ];
    assert_eq!(names, expected);
}

#[test]
fn points_of_identities_that_hold_hold() {
    let expected = named([
        ("power_a", Verdict::Holds),
        ("power_b", Verdict::Holds),
        ("factor", Verdict::Holds),
        ("apparent", Verdict::Holds),
        ("frequency", Verdict::Holds),
    ]);
    assert_eq!(verdicts(&readings(&GOOD)), expected);
}

#[test]
fn points_of_an_identity_that_does_not_hold_fail() {
    let mut values = GOOD;
    values[2] = ("power_b", 30);
    let expected = named([
        ("power_a", Verdict::Fails),
        ("power_b", Verdict::Fails),
        ("factor", Verdict::Holds),
        ("apparent", Verdict::Holds),
        ("frequency", Verdict::Holds),
    ]);
    assert_eq!(verdicts(&readings(&values)), expected);
}

#[test]
fn a_point_between_an_identity_that_holds_and_one_that_does_not_is_doubtful() {
    let text = METER.replace(
        "identities = [",
        "identities = [\n  { sum = \"apparent\", of = [\"power_a\", \"power_b\"] },",
    );
    let meter = load("m.toml", &text).unwrap_or_else(|error| panic!("{error}"));
    let readings = readings(&GOOD);
    let verification = verify(&meter, &readings);
    let doubtful: Vec<&str> = verification
        .points
        .iter()
        .filter(|(_, verdict)| *verdict == Verdict::Doubtful)
        .map(|(point, _)| point.name.as_str())
        .collect();
    assert_eq!(doubtful, ["power_a", "power_b", "apparent"]);
}

#[test]
fn what_has_no_value_or_too_small_a_one_is_not_tested() {
    let mut values = readings(&GOOD);
    values.insert("frequency".to_owned(), (Err(Fault::Timeout), 0.01));
    for name in ["power", "power_a", "power_b", "factor", "apparent"] {
        values.insert(name.to_owned(), (Ok(Value::Decimal(Decimal::ZERO)), 1.0));
    }
    let meter = meter();
    let verification = verify(&meter, &values);
    let outcomes: Vec<Outcome> = verification
        .tests
        .iter()
        .map(|(_, outcome)| *outcome)
        .collect();
    let expected = [Outcome::TooSmall, Outcome::TooSmall, Outcome::NoValue];
    assert_eq!(outcomes, expected);
    let untested =
        |(_, verdict): &(&meterpoll::profile::Point, Verdict)| *verdict == Verdict::Untested;
    assert!(verification.points.iter().all(untested));
}
