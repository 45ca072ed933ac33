//! What the simulated PM290 shows, whatever it is set up for.

use jiff::Timestamp;
use meterpoll::profile::{Missing, Profile, builtin};
use meterpoll::sim::pm290::{Keypad, Setup, Wiring};
use meterpoll::sim::{Model, Pm290};
use proptest::prelude::*;

#[path = "support/simulated.rs"]
mod simulated;

use simulated::{
    at, every_identity_holds, figure, float, mean_before, moment_of_2026, raw, seconds, value,
};

const PHASES: [&str; 3] = ["a", "b", "c"];
const ROWS: [&str; 4] = ["a", "b", "c", "total"];

/// The raw number of the far end of every scale.
const FULL: f64 = 9999.0;

fn profile() -> Profile {
    builtin::find("pm290").unwrap().profile()
}

/// Nobody is at its keys.
fn idle(seed: u64) -> Pm290 {
    Pm290::new(seed).with_keypad(Keypad::Idle)
}

fn now() -> Timestamp {
    at("2026-05-04T08:00:00.25Z")
}

/// Setups of every wiring, with and without voltage transformers, that overrange nothing.
fn setups() -> Vec<Setup> {
    use Wiring::{FourWireLineToLine, FourWireLineToNeutral, ThreeWireDirect, ThreeWireOpenDelta};

    let wirings = [
        ThreeWireDirect,
        FourWireLineToNeutral,
        ThreeWireOpenDelta,
        FourWireLineToLine,
    ];
    let transformers = [(10, 200), (10, 600), (45, 160), (60, 1000)];
    let with = |wiring| {
        transformers.map(|(pt_ratio, ct_primary)| Setup {
            wiring,
            pt_ratio,
            ct_primary,
        })
    };
    wirings.into_iter().flat_map(with).collect()
}

/// Watts from one raw number to the next.
fn power_step(setup: Setup) -> f64 {
    let voltage = match setup.pt_ratio {
        10 => 660.0,
        tenths => 14.4 * f64::from(tenths),
    };
    let phases = match setup.wiring {
        Wiring::FourWireLineToNeutral => 3.0,
        _ => 2.0,
    };
    2.0 * phases * voltage * 1.2 * f64::from(setup.ct_primary) / FULL
}

#[test]
fn values_are_those_of_a_workshop_on_400_volts() {
    let pm290 = idle(1);
    let measured = pm290.measure(now());
    let shown = |point| value(&profile(), measured.as_ref(), point);
    for (point, text) in [
        ("wiring_configuration", "4-wire line-to-neutral"),
        ("pt_ratio", "1.0"),
        ("ct_primary_current", "200"),
        ("power_demand_period", "20"),
        ("ampere_demand_period", "900"),
        ("averaging_buffer_size", "normal"),
        ("reset_mode", "resets allowed"),
        ("pulse_kwh_import", "suppressed"),
        ("analog_channel_voltage_a", "not assigned"),
        ("energy_active_export", "0"),
        ("state_flags", "0b0000000000000000"),
        ("relay_status", "none"),
    ] {
        assert_eq!(shown(point).unwrap().to_string(), text, "{point}");
    }
    let ranges = [
        ("voltage_a", 227.0..233.0),
        ("current_a", 55.0..165.0),
        ("active_power_b", 12_000.0..37_000.0),
        ("active_power_total", 42_000.0..105_000.0),
        ("power_factor_total", 0.9..0.98),
        ("unbalanced_current", 0.0..60.0),
        ("frequency", 49.96..50.04),
        ("max_active_demand", 75_000.0..105_000.0),
        ("max_current_demand_c", 110.0..165.0),
    ];
    for (point, range) in ranges {
        let value = figure(&profile(), measured.as_ref(), point);
        assert!(range.contains(&value), "{point} is {value}");
    }
}

#[test]
fn a_raw_step_of_power_is_95_watts_as_in_the_guide() {
    // RG 19: from -475200 to 475200 W in 9999 steps.
    assert_eq!(format!("{:.2}", power_step(Setup::default())), "95.05");
}

#[test]
fn what_must_hold_between_its_points_holds() {
    let pm290 = idle(1);
    for hour in 0..48 {
        let measured = pm290.measure(now() + seconds(3700 * hour));
        every_identity_holds(&profile(), measured.as_ref());
    }
}

#[test]
fn another_setup_changes_raw_numbers_and_no_value() {
    let setup = Setup::default();
    let expected = idle(3);
    let expected = expected.measure(now());
    let profile = profile();
    for other in setups() {
        let pm290 = idle(3).with_setup(other);
        let measured = pm290.measure(now());
        let power = 2.0 * (power_step(setup) + power_step(other));
        let current = 1.2 * (200.0 + f64::from(other.ct_primary)) / FULL;
        for (point, most) in [
            ("current_a", current),
            ("current_c", current),
            ("frequency", 0.0),
            ("active_power_total", power),
            ("reactive_power_total", power),
            ("apparent_power_total", power),
            ("max_active_demand", power),
            ("accumulated_apparent_demand", power),
            ("max_current_demand_b", current),
            ("energy_active_import", 0.0),
        ] {
            let [before, after] =
                [&expected, &measured].map(|measured| figure(&profile, measured.as_ref(), point));
            assert!(
                (before - after).abs() <= most,
                "{other:?} {point}: {before}, {after}"
            );
        }
        if other.ct_primary != setup.ct_primary {
            assert_ne!(
                raw(&pm290, "current_a", now()),
                raw(&idle(3), "current_a", now())
            );
        }
    }
}

#[test]
fn voltages_are_those_that_the_wiring_measures() {
    for setup in setups() {
        let pm290 = idle(1).with_setup(setup);
        let volts = figure(&profile(), pm290.measure(now()).as_ref(), "voltage_b");
        let range = match setup.wiring {
            Wiring::FourWireLineToNeutral => 227.0..233.0,
            _ => 394.0..403.0,
        };
        assert!(range.contains(&volts), "{setup:?}: {volts}");
    }
}

#[test]
fn with_three_wires_the_powers_of_a_phase_mean_nothing() {
    for wiring in [Wiring::ThreeWireDirect, Wiring::ThreeWireOpenDelta] {
        let pm290 = idle(1).with_setup(Setup {
            wiring,
            ..Setup::default()
        });
        let measured = pm290.measure(now());
        for what in [
            "active_power",
            "reactive_power",
            "apparent_power",
            "power_factor",
        ] {
            for phase in PHASES {
                let point = format!("{what}_{phase}");
                assert_eq!(raw(&pm290, &point, now()), 5000, "{point}");
                let value = value(&profile(), measured.as_ref(), &point);
                assert_eq!(value, Err(Missing::Absent), "{point}");
            }
            assert_ne!(raw(&pm290, &format!("{what}_total"), now()), 5000, "{what}");
        }
        assert_eq!(raw(&pm290, "unbalanced_current", now()), 0);
    }
}

#[test]
fn what_is_beyond_the_scale_shows_as_its_end() {
    let small = idle(1).with_setup(Setup {
        ct_primary: 10,
        pt_ratio: 11,
        ..Setup::default()
    });
    for point in [
        "voltage_a",
        "current_a",
        "active_power_a",
        "active_power_total",
        "apparent_power_total",
        "max_active_demand",
        "max_current_demand_a",
    ] {
        assert_eq!(raw(&small, point, now()), 9999, "{point}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(48) })]

    #[test]
    fn total_power_is_the_exact_sum_of_the_phases(
        seed: u64,
        now in moment_of_2026(),
        setup in prop::sample::select(setups()),
    ) {
        prop_assume!(setup.wiring == Wiring::FourWireLineToNeutral
            || setup.wiring == Wiring::FourWireLineToLine);
        let pm290 = idle(seed).with_setup(setup);
        for power in ["active_power", "reactive_power"] {
            let row = |row| 2 * raw(&pm290, &format!("{power}_{row}"), now) - 9999;
            prop_assert_eq!(row("total"), row("a") + row("b") + row("c"));
        }
    }

    #[test]
    fn apparent_power_and_power_factor_follow_from_the_others_within_a_step(
        seed: u64,
        now in moment_of_2026(),
        ct_primary in 130_u16..800,
    ) {
        let pm290 = idle(seed).with_setup(Setup { ct_primary, ..Setup::default() });
        for row in ROWS {
            let get = |what: &str| 2.0 * float(raw(&pm290, &format!("{what}_{row}"), now)) - FULL;
            let (active, reactive) = (get("active_power"), get("reactive_power"));
            let apparent = get("apparent_power");
            // A step is two halves.
            prop_assert!((active.hypot(reactive) - apparent).abs() <= 1.0);
            prop_assert!((active / apparent * FULL - get("power_factor")).abs() <= 1.0);
        }
    }

    #[test]
    fn apparent_power_of_a_phase_is_volts_times_amperes(seed: u64, now in moment_of_2026()) {
        let pm290 = idle(seed);
        let measured = pm290.measure(now);
        let profile = profile();
        for phase in PHASES {
            let get = |what| figure(&profile, measured.as_ref(), &format!("{what}_{phase}"));
            let error = get("voltage") * get("current") - get("apparent_power");
            // A step of power, and one of a voltage or a current.
            prop_assert!(error.abs() <= 2.0 * power_step(Setup::default()), "{error}");
        }
    }

    #[test]
    fn counters_never_fall(seed: u64, now in moment_of_2026(), step in 1_i64..100_000) {
        let pm290 = idle(seed);
        for counter in ["energy_active_import", "energy_reactive_positive"] {
            let mut before = raw(&pm290, counter, now);
            for count in 1..=5 {
                let after = raw(&pm290, counter, now + seconds(count * step));
                prop_assert!(before <= after, "{counter} fell from {before} to {after}");
                before = after;
            }
        }
    }

    #[test]
    fn running_demands_are_at_most_the_highest(seed: u64, now in moment_of_2026()) {
        let pm290 = idle(seed);
        for what in ["active", "apparent"] {
            let running = raw(&pm290, &format!("accumulated_{what}_demand"), now);
            let highest = raw(&pm290, &format!("max_{what}_demand"), now);
            prop_assert!(running <= highest, "{what}: {running}, {highest}");
        }
    }
}

#[test]
fn energy_rises_by_the_power_of_a_day() {
    let end = at("2026-05-04T08:00:00Z");
    let pm290 = idle(2);
    for (energy, power) in [
        ("energy_active_import", "active_power_total"),
        ("energy_reactive_positive", "reactive_power_total"),
    ] {
        let risen = raw(&pm290, energy, end) - raw(&pm290, energy, end - seconds(86_400));
        let raw_mean = mean_before(&pm290, power, end, 86_400);
        let watts = (raw_mean - FULL / 2.0) * power_step(Setup::default());
        let error = float(risen) - watts * 24.0 / 1000.0;
        assert!(error.abs() < 2.0, "{energy}: {error}");
    }
}

#[test]
fn running_demands_are_means_of_the_last_20_minutes() {
    let pm290 = idle(4);
    // The second one's period reaches into the week before.
    for now in ["2026-05-04T08:07:31.5Z", "2026-01-07T00:03:00Z"].map(at) {
        for (demand, power) in [
            ("accumulated_active_demand", "active_power_total"),
            ("accumulated_apparent_demand", "apparent_power_total"),
        ] {
            let expected = mean_before(&pm290, power, now, 1200);
            let found = float(raw(&pm290, demand, now));
            assert!(
                (found - expected).abs() <= 1.0,
                "{demand} {now}: {found}, {expected}"
            );
        }
    }
}

#[test]
fn counters_start_at_0_in_2020_and_begin_again_behind_8_digits() {
    let pm290 = idle(1);
    for counter in ["energy_active_import", "energy_reactive_positive"] {
        for time in ["2019-06-01T00:00:00Z", "2020-01-01T00:00:00Z"] {
            assert_eq!(raw(&pm290, counter, at(time)), 0, "{counter}");
        }
    }
    let century = raw(&pm290, "energy_active_import", at("2120-01-01T00:00:00Z"));
    assert!((30_000_000..100_000_000).contains(&century), "{century}");
    let late = raw(&pm290, "energy_active_import", at("2300-01-01T00:00:00Z"));
    assert!((0..100_000_000).contains(&late), "{late}");
}

#[test]
fn a_point_the_meter_does_not_have_holds_nothing() {
    for point in [
        "",
        "voltage",
        "voltage_total",
        "active_power",
        "analog",
        "analog_reserved",
    ] {
        assert_eq!(idle(1).measure(now()).content(point), None, "{point}");
    }
}
