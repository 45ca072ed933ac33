//! Physical laws on figures.

use meterpoll::profile::identity::{Figure, Identity, Law, Outcome};
use rust_decimal::Decimal;

fn name(name: &str) -> String {
    name.to_owned()
}

fn names(list: &[&str]) -> Vec<String> {
    list.iter().copied().map(name).collect()
}

/// Tests a law on these values, whose registers have this step.
fn test(law: Law, step: f64, values: &[(&str, f64)]) -> Outcome {
    let identity = Identity {
        law,
        tolerance: Identity::TOLERANCE,
    };
    identity.test(|name| {
        let (_, value) = values.iter().find(|(known, _)| *known == name)?;
        Some(Figure {
            value: *value,
            step,
        })
    })
}

fn sum() -> Law {
    Law::Sum {
        whole: name("total"),
        parts: names(&["a", "b", "c"]),
    }
}

fn holds(outcome: Outcome) -> bool {
    matches!(outcome, Outcome::Holds { .. })
}

fn fails(outcome: Outcome) -> bool {
    matches!(outcome, Outcome::Fails { .. })
}

#[test]
fn the_total_is_the_sum_of_the_phases_within_two_percent() {
    let test = |total| {
        test(
            sum(),
            0.01,
            &[("a", 40.0), ("b", 30.0), ("c", 30.0), ("total", total)],
        )
    };
    let exact = Outcome::Holds {
        found: 100.0,
        expected: 100.0,
    };
    assert_eq!(test(100.0), exact);
    assert!(holds(test(101.9)));
    assert!(holds(test(98.1)));
    assert!(fails(test(103.0)));
    assert!(fails(test(-100.0)));
    assert!(fails(test(1000.0)));
}

#[test]
fn a_total_may_be_off_by_the_steps_of_its_registers() {
    let values = [("a", 40.0), ("b", 30.0), ("c", 30.0), ("total", 105.0)];
    assert!(fails(test(sum(), 0.1, &values)));
    assert!(holds(test(sum(), 1.0, &values)));
}

#[test]
fn a_load_of_a_few_steps_proves_nothing() {
    let nothing = [("a", 0.0), ("b", 0.0), ("c", 0.0), ("total", 0.0)];
    assert_eq!(test(sum(), 0.01, &nothing), Outcome::TooSmall);
    // Floats have no steps.
    assert_eq!(test(sum(), 0.0, &nothing), Outcome::TooSmall);
    let little = [("a", 0.1), ("b", 0.1), ("c", 0.1), ("total", 0.3)];
    assert_eq!(test(sum(), 0.01, &little), Outcome::TooSmall);
}

#[test]
fn a_missing_value_leaves_the_law_open() {
    let values = [("a", 40.0), ("b", 30.0), ("total", 100.0)];
    assert_eq!(test(sum(), 0.01, &values), Outcome::NoValue);
}

#[test]
fn the_mean_is_that_of_the_phases() {
    let mean = || Law::Mean {
        mean: name("mean"),
        parts: names(&["a", "b", "c"]),
    };
    let values = |mean| [("a", 346.0), ("b", 347.0), ("c", 348.0), ("mean", mean)];
    assert!(holds(test(mean(), 1.0, &values(347.0))));
    assert!(fails(test(mean(), 1.0, &values(600.0))));
}

#[test]
fn apparent_power_is_the_hypotenuse_whatever_the_signs() {
    let law = || Law::Apparent {
        apparent: name("s"),
        real: name("p"),
        reactive: name("q"),
    };
    assert!(holds(test(
        law(),
        0.01,
        &[("s", 50.0), ("p", -40.0), ("q", 30.0)]
    )));
    assert!(holds(test(
        law(),
        0.01,
        &[("s", 50.0), ("p", 40.0), ("q", -30.0)]
    )));
    assert!(fails(test(
        law(),
        0.01,
        &[("s", 70.0), ("p", 40.0), ("q", 30.0)]
    )));
}

#[test]
fn the_power_factor_is_real_by_apparent_power_signs_aside() {
    let law = || Law::PowerFactor {
        power_factor: name("pf"),
        real: name("p"),
        apparent: name("s"),
    };
    for factor in [0.8, -0.8, 0.81] {
        assert!(holds(test(
            law(),
            0.01,
            &[("pf", factor), ("p", 40.0), ("s", 50.0)]
        )));
    }
    assert!(fails(test(
        law(),
        0.01,
        &[("pf", 0.6), ("p", 40.0), ("s", 50.0)]
    )));
    let idle = [("pf", 0.0), ("p", 0.0), ("s", 0.0)];
    assert_eq!(test(law(), 0.01, &idle), Outcome::TooSmall);
}

#[test]
fn a_line_voltage_follows_from_its_two_phases() {
    let law = || Law::LineVoltage {
        line: name("ab"),
        phases: [name("a"), name("b")],
    };
    assert!(holds(test(
        law(),
        1.0,
        &[("ab", 400.0), ("a", 230.0), ("b", 232.0)]
    )));
    assert!(fails(test(
        law(),
        1.0,
        &[("ab", 230.0), ("a", 230.0), ("b", 232.0)]
    )));
}

#[test]
fn the_frequency_is_near_one_of_two() {
    let law = || Law::Near {
        point: name("f"),
        targets: vec![Decimal::from(50), Decimal::from(60)],
    };
    assert!(holds(test(law(), 0.01, &[("f", 50.3)])));
    assert!(holds(test(law(), 0.01, &[("f", 59.4)])));
    assert!(fails(test(law(), 0.01, &[("f", 55.0)])));
    assert!(fails(test(law(), 0.01, &[("f", 5.0)])));
    assert_eq!(test(law(), 0.01, &[("f", 0.0)]), Outcome::TooSmall);
}

#[test]
fn a_law_prints_as_a_formula() {
    let law = Law::PowerFactor {
        power_factor: name("pf"),
        real: name("p"),
        apparent: name("s"),
    };
    assert_eq!(sum().to_string(), "total = a + b + c");
    assert_eq!(law.to_string(), "|pf| = |p| / s");
    let law = Law::LineVoltage {
        line: name("ab"),
        phases: [name("a"), name("b")],
    };
    assert_eq!(law.to_string(), "ab = √(a² + b² + a × b)");
    let law = Law::Mean {
        mean: name("m"),
        parts: vec![name("a"), name("b")],
    };
    assert_eq!(law.to_string(), "m = (a + b) / 2");
}
