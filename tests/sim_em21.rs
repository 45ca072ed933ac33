//! What the simulated EM21 shows and how it answers.

use jiff::Timestamp;
use meterpoll::profile::{Missing, Profile, builtin};
use meterpoll::sim::{Em2x, Meter, Model};
use proptest::prelude::*;

#[path = "support/frames/em2x.rs"]
#[allow(dead_code, reason = "this file uses its share")]
mod frame;
#[path = "support/simulated.rs"]
mod simulated;

use simulated::{
    answer, at, every_identity_holds, every_point_reads_as_what_the_model_measures, figure, float,
    mean_before, moment_of_2026, raw, read, sealed, seconds, unit, value,
};

fn profile() -> Profile {
    builtin::find("em21").unwrap().profile()
}

fn em21(seed: u64) -> Em2x {
    Em2x::em21(unit(1), seed)
}

/// Unit 1, as the frames want it.
fn meter() -> Meter {
    Meter::em21(unit(1), 1)
}

fn now() -> Timestamp {
    at("2026-05-04T08:00:00.25Z")
}

#[test]
fn every_point_of_the_profile_reads_as_what_the_model_measures() {
    let mut meter = meter();
    assert!(meter.profile().points.len() > 40);
    every_point_reads_as_what_the_model_measures(&mut meter, &em21(1), now());
}

#[test]
fn values_are_those_of_a_shop_behind_current_transformers() {
    let em21 = em21(1);
    let measured = em21.measure(now());
    let shown = |point| {
        value(&profile(), measured.as_ref(), point)
            .unwrap()
            .to_string()
    };
    for (point, text) in [
        ("identification_code", "EM21 AV5"),
        ("phase_sequence", "L1-L2-L3"),
        ("firmware_version_code", "B"),
        ("firmware_revision_code", "2"),
        ("application", "A"),
        ("measuring_system", "3P.n"),
        ("ct_ratio", "20.0"),
        ("vt_ratio", "1.0"),
        ("pulse_weight", "0.10"),
        ("rs485_address", "1"),
    ] {
        assert_eq!(shown(point), text, "{point}");
    }
    let ranges = [
        ("voltage_l1_n", 227.0..233.0),
        ("voltage_l3_l1", 394.0..403.0),
        ("current_l2", 36.0..84.0),
        ("active_power_sys", 26_000.0..53_000.0),
        ("power_factor_l1", 0.9..0.98),
        ("frequency", 49.9..50.1),
        ("energy_active_import_total", 1_500_000.0..3_000_000.0),
    ];
    for (point, range) in ranges {
        let value = figure(&profile(), measured.as_ref(), point);
        assert!(range.contains(&value), "{point} is {value}");
    }
}

#[test]
fn frequency_is_in_tenths_of_a_hertz() {
    assert!((499..=501).contains(&raw(&em21(1), "frequency", now())));
}

#[test]
fn what_must_hold_between_its_points_holds() {
    let em21 = em21(1);
    for hour in 0..48 {
        let measured = em21.measure(now() + seconds(3700 * hour));
        every_identity_holds(&profile(), measured.as_ref());
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(64) })]

    #[test]
    fn power_of_all_phases_is_the_exact_sum(seed: u64, now in moment_of_2026()) {
        let em21 = em21(seed);
        for power in ["active_power", "reactive_power"] {
            let row = |row| raw(&em21, &format!("{power}_{row}"), now);
            prop_assert_eq!(row("sys"), row("l1") + row("l2") + row("l3"));
        }
    }

    #[test]
    fn current_transformers_bring_at_most_6_5_amperes(seed: u64, now in moment_of_2026()) {
        for phase in ["current_l1", "current_l2", "current_l3"] {
            prop_assert!(raw(&em21(seed), phase, now) <= 6500 * 20);
        }
    }
}

#[test]
fn energy_rises_day_by_day_with_the_power() {
    let em21 = em21(2);
    for (energy, power) in [
        ("energy_active_import_total", "active_power_sys"),
        ("energy_reactive_import_total", "reactive_power_sys"),
    ] {
        let start = at("2026-05-04T08:00:00Z");
        for day in 0..10 {
            let (begin, end) = (
                start + seconds(86_400 * day),
                start + seconds(86_400 * (day + 1)),
            );
            let risen = raw(&em21, energy, end) - raw(&em21, energy, begin);
            // Tenths of a watt for 24 hours, in tenths of a kilowatt hour.
            let expected = mean_before(&em21, power, end, 86_400) * 24.0 / 1000.0;
            assert!(
                (float(risen) - expected).abs() < 4.0,
                "{energy}: {risen}, {expected}"
            );
        }
    }
}

#[test]
fn what_is_out_of_range_has_7fff_in_its_high_word_and_takes_nothing_along() {
    let profile = profile();
    for point in [
        "voltage_l1_n",
        "current_l3",
        "active_power_sys",
        "power_factor_l1",
        "frequency",
    ] {
        let em21 = em21(1).with_overflow(point);
        let measured = em21.measure(now());
        for other in profile
            .points
            .iter()
            .filter(|point| point.access.readable())
        {
            let value = value(&profile, measured.as_ref(), &other.name);
            if other.name == point {
                assert_eq!(value, Err(Missing::Overflow), "{point}");
            } else {
                assert!(value.is_ok(), "{point}: {}", other.name);
            }
        }
        assert_ne!(raw(&em21, "power_factor_l1", now()), 0, "{point}");
    }
}

#[test]
fn the_identification_is_answered_byte_for_byte_and_only_alone() {
    let mut meter = meter();
    assert_eq!(
        answer(&mut meter, frame::IDENTIFICATION_REQUEST, now()).as_deref(),
        Some(frame::IDENTIFICATION_EM21)
    );
    let voltage = raw(&em21(1), "voltage_l3_l1", now());
    let words = read(&mut meter, 0x000A, 2, now()).unwrap();
    assert_eq!([i128::from(words[0]), i128::from(words[1])], [voltage, 0]);
}

#[test]
fn eleven_registers_are_the_most_it_gives() {
    let mut meter = meter();
    let bytes = answer(&mut meter, frame::ELEVEN_REGISTERS_REQUEST, now()).unwrap();
    assert_eq!(bytes[..3], [0x01, 0x04, 22]);
    assert_eq!(
        answer(&mut meter, frame::TWELVE_REGISTERS_REQUEST, now()).as_deref(),
        Some(frame::REFUSED_VALUE)
    );
    let energies = answer(&mut meter, frame::EM21_ENERGIES_REQUEST, now()).unwrap();
    assert_eq!(energies.len(), frame::EM21_ENERGIES_RESPONSE.len());
    // All measurements, none of them cut.
    for (start, count) in [
        (0, 10),
        (0x0A, 10),
        (0x14, 10),
        (0x1E, 10),
        (0x28, 11),
        (0x33, 5),
    ] {
        assert!(
            read(&mut meter, start, count, now()).is_ok(),
            "0x{start:04X}"
        );
    }
    // What an EM24 would have there.
    for (start, count) in [
        (0x0037, 2),
        (0x0038, 2),
        (0x0300, 1),
        (0x1100, 1),
        (0x1300, 7),
    ] {
        assert_eq!(
            read(&mut meter, start, count, now()),
            Err(2),
            "0x{start:04X}"
        );
    }
}

#[test]
fn firmware_is_read_one_word_a_request() {
    let mut meter = meter();
    assert_eq!(read(&mut meter, 0x0302, 1, now()), Ok(vec![1]));
    assert_eq!(read(&mut meter, 0x0303, 1, now()), Ok(vec![2]));
    assert_eq!(read(&mut meter, 0x0302, 2, now()), Err(2));
}

#[test]
fn resets_cannot_be_read_and_there_is_no_function_16() {
    let mut meter = meter();
    assert_eq!(read(&mut meter, 0x3000, 1, now()), Err(2));
    let many = sealed(&[1, 16, 0x10, 3, 0, 2, 4, 0, 0, 0, 7]);
    assert_eq!(
        answer(&mut meter, &many, now()),
        Some(sealed(&[1, 0x90, 1]))
    );
    let loopback = answer(&mut meter, frame::LOOPBACK, now());
    assert_eq!(loopback.as_deref(), Some(frame::LOOPBACK));
}
