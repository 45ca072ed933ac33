//! What the simulated EM24-DIN shows.

use jiff::{SignedDuration, Timestamp};
use meterpoll::profile::{Missing, Profile, builtin};
use meterpoll::sim::{Em2x, Model};
use proptest::prelude::*;

#[path = "support/simulated.rs"]
mod simulated;

use simulated::{
    at, every_identity_holds, figure, float, mean_before, moment_of_2026, raw, seconds, unit,
    value, words,
};

const COUNTERS: [&str; 19] = [
    "energy_active_import_total",
    "energy_reactive_import_total",
    "energy_active_import_partial",
    "energy_reactive_import_partial",
    "energy_active_import_l1",
    "energy_active_import_l2",
    "energy_active_import_l3",
    "energy_active_import_t1",
    "energy_active_import_t2",
    "energy_active_import_t3",
    "energy_active_import_t4",
    "energy_reactive_import_t1",
    "energy_reactive_import_t2",
    "energy_reactive_import_t3",
    "energy_reactive_import_t4",
    "hour_counter",
    "counter_1",
    "counter_2",
    "counter_3",
];

fn profile() -> Profile {
    builtin::find("em24").unwrap().profile()
}

fn em24(seed: u64) -> Em2x {
    Em2x::em24(unit(1), seed)
}

fn now() -> Timestamp {
    at("2026-05-04T08:00:00.25Z")
}

#[test]
fn values_are_those_of_a_house_on_400_volts() {
    let em24 = em24(1);
    let measured = em24.measure(now());
    let shown = |point| {
        value(&profile(), measured.as_ref(), point)
            .unwrap()
            .to_string()
    };
    for (point, text) in [
        ("identification_code", "EM24-DIN AV9"),
        ("phase_sequence", "L1-L2-L3"),
        ("application", "H"),
        ("measuring_system", "3P.n"),
        ("demand_interval", "15"),
        ("selector_page_position_3", "page 4"),
        ("front_selector_status", "position 1"),
        ("current_tariff", "tariff 1"),
        ("rs485_address", "1"),
        ("rs485_baud_rate", "9600"),
        ("ct_ratio", "1.0"),
        ("digital_input_1_type", "external counter"),
        ("digital_input_2_type", "gas"),
        ("digital_input_3_type", "cold water"),
        ("digital_input_3_prescaler", "1.0"),
        ("energy_active_export_total", "0.0"),
    ] {
        assert_eq!(shown(point), text, "{point}");
    }
    let ranges = [
        ("voltage_l1_n", 227.0..233.0),
        ("voltage_l3_l1", 394.0..403.0),
        ("voltage_ln_sys", 228.0..232.0),
        ("current_l2", 5.0..39.0),
        ("active_power_l3", 1000.0..9000.0),
        ("active_power_sys", 4300.0..25_000.0),
        ("power_factor_sys", 0.9..0.98),
        ("frequency", 49.9..50.1),
        ("demand_active_power_max", 15_000.0..26_000.0),
        ("demand_current_max", 30.0..40.0),
        ("energy_active_import_total", 500_000.0..1_000_000.0),
        ("hour_counter", 55_000.0..56_000.0),
    ];
    for (point, range) in ranges {
        let value = figure(&profile(), measured.as_ref(), point);
        assert!(range.contains(&value), "{point} is {value}");
    }
}

#[test]
fn what_must_hold_between_its_points_holds() {
    let em24 = em24(1);
    for hour in 0..48 {
        let measured = em24.measure(now() + seconds(3700 * hour));
        every_identity_holds(&profile(), measured.as_ref());
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(64) })]

    #[test]
    fn power_of_all_phases_is_the_exact_sum(seed: u64, now in moment_of_2026()) {
        let em24 = em24(seed);
        for power in ["active_power", "reactive_power"] {
            let row = |row| raw(&em24, &format!("{power}_{row}"), now);
            prop_assert_eq!(row("sys"), row("l1") + row("l2") + row("l3"));
        }
    }

    #[test]
    fn apparent_power_and_power_factor_follow_from_the_others(
        seed: u64,
        now in moment_of_2026(),
    ) {
        let em24 = em24(seed);
        for row in ["l1", "l2", "l3", "sys"] {
            let get = |power: &str| float(raw(&em24, &format!("{power}_{row}"), now));
            let (active, reactive) = (get("active_power"), get("reactive_power"));
            let apparent = get("apparent_power");
            prop_assert!((active.hypot(reactive) - apparent).abs() <= 0.5);
            prop_assert!((1000.0 * active / apparent - get("power_factor")).abs() <= 0.5);
        }
    }

    #[test]
    fn apparent_power_of_a_phase_is_volts_times_amperes(seed: u64, now in moment_of_2026()) {
        let em24 = em24(seed);
        for phase in 1..=3 {
            let volts = float(raw(&em24, &format!("voltage_l{phase}_n"), now)) / 10.0;
            let amperes = float(raw(&em24, &format!("current_l{phase}"), now)) / 1000.0;
            let apparent = float(raw(&em24, &format!("apparent_power_l{phase}"), now)) / 10.0;
            // Half a step of the voltage, of the current and of the powers.
            let resolution = 0.05 * amperes + 0.0005 * volts + 0.2;
            prop_assert!((volts * amperes - apparent).abs() <= resolution);
        }
    }
}

proptest! {
    // Each of these works through a week of every seed.
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(12) })]

    #[test]
    fn energy_is_the_exact_sum_of_its_phases_and_of_its_tariffs(
        seed: u64,
        now in moment_of_2026(),
    ) {
        let em24 = em24(seed);
        let sum = |energy: &str, parts: &[&str]| -> i128 {
            parts.iter().map(|part| raw(&em24, &format!("{energy}_{part}"), now)).sum()
        };
        let total = raw(&em24, "energy_active_import_total", now);
        let tariffs = ["t1", "t2", "t3", "t4"];
        prop_assert_eq!(total, sum("energy_active_import", &["l1", "l2", "l3"]));
        prop_assert_eq!(total, sum("energy_active_import", &tariffs));
        let reactive = raw(&em24, "energy_reactive_import_total", now);
        prop_assert_eq!(reactive, sum("energy_reactive_import", &tariffs));
        prop_assert!(raw(&em24, "energy_active_import_partial", now) < total);
        prop_assert!(raw(&em24, "energy_reactive_import_partial", now) < reactive);
    }

    #[test]
    fn counters_never_fall(seed: u64, now in moment_of_2026(), step in 1_i64..100_000_000) {
        let em24 = em24(seed);
        for counter in COUNTERS {
            let mut before = raw(&em24, counter, now);
            for count in 1..=10 {
                let after = raw(&em24, counter, now + SignedDuration::from_millis(count * step));
                prop_assert!(before <= after, "{counter} fell from {before} to {after}");
                before = after;
            }
        }
    }

    #[test]
    fn demands_are_at_most_the_highest(seed: u64, now in moment_of_2026()) {
        let em24 = em24(seed);
        for hour in 0..12 {
            let now = now + seconds(3700 * hour);
            for what in ["active", "apparent"] {
                let running = raw(&em24, &format!("demand_{what}_power_sys"), now);
                let highest = raw(&em24, &format!("demand_{what}_power_max"), now);
                prop_assert!(running <= highest, "{what}: {running}, {highest}");
            }
        }
    }
}

#[test]
fn energy_rises_by_the_power_of_a_day() {
    let end = at("2026-05-04T08:00:00Z");
    let em24 = em24(2);
    for (energy, power) in [
        ("energy_active_import_total", "active_power_sys"),
        ("energy_active_import_l2", "active_power_l2"),
        ("energy_reactive_import_total", "reactive_power_sys"),
    ] {
        let risen = raw(&em24, energy, end) - raw(&em24, energy, end - seconds(86_400));
        // Tenths of a watt for 24 hours, in tenths of a kilowatt hour.
        let expected = mean_before(&em24, power, end, 86_400) * 24.0 / 1000.0;
        assert!(
            (float(risen) - expected).abs() < 3.0,
            "{energy}: {risen}, {expected}"
        );
    }
}

#[test]
fn phases_draw_unequal_parts() {
    let risen = |phase| raw(&em24(1), &format!("energy_active_import_l{phase}"), now());
    let parts = [1, 2, 3].map(|phase| float(risen(phase)) / float(risen(1)));
    for (part, expected) in parts.into_iter().zip([1.0, 0.9, 1.1]) {
        assert!((part - expected).abs() < 0.01, "{parts:?}");
    }
}

#[test]
fn the_second_tariff_counts_from_22_to_6_utc_and_the_first_by_day() {
    let em24 = em24(1);
    let risen = |tariff, from, to| {
        let energy = format!("energy_active_import_{tariff}");
        raw(&em24, &energy, at(to)) - raw(&em24, &energy, at(from))
    };
    // The second night and the second day reach over the end of a week.
    for (evening, morning, next) in [
        (
            "2026-05-04T22:00:00Z",
            "2026-05-05T06:00:00Z",
            "2026-05-05T22:00:00Z",
        ),
        (
            "2026-01-06T22:00:00Z",
            "2026-01-07T06:00:00Z",
            "2026-01-07T22:00:00Z",
        ),
    ] {
        assert_eq!(risen("t1", evening, morning), 0);
        assert!(risen("t2", evening, morning) > 200);
        assert_eq!(risen("t2", morning, next), 0);
        assert!(risen("t1", morning, next) > 400);
    }
    for (time, tariff) in [
        ("2026-05-04T05:59:59.999Z", 1),
        ("2026-05-04T06:00:00Z", 0),
        ("2026-05-04T21:59:59Z", 0),
        ("2026-05-04T22:00:00Z", 1),
        ("2026-05-04T00:00:00Z", 1),
    ] {
        assert_eq!(raw(&em24, "current_tariff", at(time)), tariff, "{time}");
    }
}

#[test]
fn partial_counters_begin_on_2024_12_25() {
    let em24 = em24(1);
    for energy in ["energy_active_import", "energy_reactive_import"] {
        let both = |time| {
            ["total", "partial"].map(|what| raw(&em24, &format!("{energy}_{what}"), at(time)))
        };
        let [total, partial] = both("2024-12-24T23:59:59Z");
        assert_eq!(total, partial);
        let [total, partial] = both("2024-12-25T00:00:00Z");
        assert!(total > 100_000);
        assert_eq!(partial, 0);
        let [later, risen] = both("2025-03-01T12:00:00Z");
        assert_eq!(risen, later - total);
    }
}

#[test]
fn counters_start_at_0_in_2020_and_last_for_decades() {
    for counter in COUNTERS {
        for time in ["2019-06-01T00:00:00Z", "2020-01-01T00:00:00Z"] {
            assert_eq!(raw(&em24(1), counter, at(time)), 0, "{counter}");
        }
        // The high word of what is out of range is 7FFF.
        let late = raw(&em24(1), counter, at("2120-01-01T00:00:00Z"));
        assert!(late < 0x7FFF_0000, "{counter} is {late}");
    }
}

#[test]
fn hours_are_counted_in_hundredths() {
    let hours = |time| raw(&em24(1), "hour_counter", at(time));
    assert_eq!(hours("2020-01-01T00:00:35.9Z"), 0);
    assert_eq!(hours("2020-01-01T00:00:36Z"), 1);
    assert_eq!(hours("2020-01-08T00:30:00Z"), 16_850);
}

#[test]
fn pulse_counters_have_the_decimals_of_their_inputs() {
    let em24 = em24(1);
    let shown = |time, counter: &str| {
        let measured = em24.measure(at(time));
        value(&profile(), measured.as_ref(), counter)
            .unwrap()
            .to_string()
    };
    // Two hours: 12 pulses of 0.1, 24 of 0.1, 60 of 1.0.
    for (counter, text) in [
        ("counter_1", "1.200"),
        ("counter_2", "2.40"),
        ("counter_3", "60.0"),
    ] {
        assert_eq!(shown("2020-01-01T02:00:00Z", counter), text, "{counter}");
    }
    // A pulse closes its input for a second.
    for (time, inputs) in [
        ("2020-01-01T02:00:00Z", "all closed"),
        (
            "2020-01-01T02:00:01Z",
            "input 1 open|input 2 open|input 3 open",
        ),
        ("2020-01-01T02:02:00.9Z", "input 1 open|input 2 open"),
        ("2020-01-01T02:05:00Z", "input 1 open|input 3 open"),
    ] {
        assert_eq!(shown(time, "digital_input_status"), inputs, "{time}");
    }
}

#[test]
fn demand_is_the_mean_of_the_last_quarter_of_an_hour() {
    // The second one's window reaches into the week before.
    for now in ["2026-05-04T08:07:31.5Z", "2026-01-07T00:03:00Z"].map(at) {
        for what in ["active", "apparent"] {
            let em24 = em24(4);
            let expected = mean_before(&em24, &format!("{what}_power_sys"), now, 900);
            let found = float(raw(&em24, &format!("demand_{what}_power_sys"), now));
            let error = (found - expected).abs();
            assert!(error <= 1.0 + expected / 500.0, "{what} {now}: {error}");
        }
    }
}

#[test]
fn a_phase_out_of_range_takes_its_power_factor_and_the_value_of_all_phases_along() {
    let profile = profile();
    for (point, system) in [
        ("voltage_l2_n", Some("voltage_ln_sys")),
        ("voltage_l1_l2", Some("voltage_ll_sys")),
        ("current_l2", None),
        ("active_power_l2", Some("active_power_sys")),
        ("apparent_power_l2", Some("apparent_power_sys")),
        ("reactive_power_l2", Some("reactive_power_sys")),
    ] {
        let em24 = em24(1).with_overflow(point);
        let measured = em24.measure(now());
        for measurement in profile
            .points
            .iter()
            .filter(|point| point.range.start().get() <= 0x35)
        {
            let name = measurement.name.as_str();
            let value = value(&profile, measured.as_ref(), name);
            if name == point || Some(name) == system {
                assert_eq!(value, Err(Missing::Overflow), "{point}: {name}");
            } else {
                assert!(value.is_ok(), "{point}: {name}");
            }
        }
        assert_eq!(raw(&em24, "power_factor_l2", now()), 0, "{point}");
        assert!(raw(&em24, "power_factor_l3", now()) > 900, "{point}");
    }
    let em24 = em24(1).with_overflow("power_factor_l1");
    assert_eq!(raw(&em24, "power_factor_l1", now()), 0x7FFF);
    assert_eq!(raw(&em24, "power_factor_sys", now()), 0x7FFF);
}

#[test]
fn its_serial_number_has_13_characters_and_comes_from_the_seed() {
    let serial_number = |seed| words(&em24(seed), "serial_number", now());
    let first = serial_number(1);
    assert_eq!(first.len(), 7);
    // The last character stands in the high byte.
    assert_eq!(first[6], u16::from_be_bytes([b'A', 0]));
    assert_ne!(first, serial_number(2));
    assert_eq!(first, serial_number(1));
}

#[test]
fn a_point_the_meter_does_not_have_holds_nothing() {
    for point in [
        "",
        "voltage",
        "counter_",
        "counter_4",
        "digital_input_1",
        "digital_input_4_type",
        "digital_input_1_name",
        "pulse_weight",
    ] {
        assert_eq!(em24(1).measure(now()).content(point), None, "{point}");
    }
}
