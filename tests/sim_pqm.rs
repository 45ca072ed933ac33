//! What the simulated PQM shows: quantities that agree, counters that rise, values that move.

use jiff::SignedDuration;
use meterpoll::sim::{Model, Pqm};
use proptest::prelude::*;

#[path = "support/simulated.rs"]
mod simulated;

use simulated::{at, float, mean_before, moment_of_2026, number, raw, seconds, words};

/// The points that have a minimum and a maximum.
const MEASURED: [&str; 32] = [
    "current_a",
    "current_b",
    "current_c",
    "current_avg",
    "current_n",
    "current_unbalance",
    "voltage_an",
    "voltage_bn",
    "voltage_cn",
    "voltage_ln_avg",
    "voltage_ab",
    "voltage_bc",
    "voltage_ca",
    "voltage_ll_avg",
    "voltage_unbalance",
    "real_power_total",
    "reactive_power_total",
    "apparent_power_total",
    "power_factor_total",
    "real_power_a",
    "reactive_power_a",
    "apparent_power_a",
    "power_factor_a",
    "real_power_b",
    "reactive_power_b",
    "apparent_power_b",
    "power_factor_b",
    "real_power_c",
    "reactive_power_c",
    "apparent_power_c",
    "power_factor_c",
    "frequency",
];

const DEMANDS: [&str; 7] = [
    "demand_current_a",
    "demand_current_b",
    "demand_current_c",
    "demand_current_n",
    "demand_real",
    "demand_reactive",
    "demand_apparent",
];

/// What has a distortion, by the end of its point's name.
const DISTORTED: [&str; 10] = [
    "current_a",
    "current_b",
    "current_c",
    "current_n",
    "van",
    "vbn",
    "vcn",
    "vab",
    "vbc",
    "vca",
];

const COUNTERS: [&str; 9] = [
    "energy_real_pos",
    "energy_real_neg",
    "energy_reactive_pos",
    "energy_reactive_neg",
    "energy_apparent",
    "energy_cost_total",
    "pulse_input_1",
    "pulse_input_2",
    "pulse_input_total",
];

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(64) })]

    #[test]
    fn three_phase_power_is_the_exact_sum_of_the_phases(seed: u64, now in moment_of_2026()) {
        let pqm = Pqm::new(seed);
        for power in ["real_power", "reactive_power"] {
            let phase = |phase| raw(&pqm, &format!("{power}_{phase}"), now);
            prop_assert_eq!(phase("total"), phase("a") + phase("b") + phase("c"));
        }
    }

    #[test]
    fn apparent_power_and_power_factor_follow_from_kw_and_kvar(
        seed: u64,
        now in moment_of_2026(),
    ) {
        let pqm = Pqm::new(seed);
        for phase in ["a", "b", "c", "total"] {
            let get = |power: &str| float(raw(&pqm, &format!("{power}_{phase}"), now));
            let (kw, kvar, kva) = (get("real_power"), get("reactive_power"), get("apparent_power"));
            prop_assert!((kw.hypot(kvar) - kva).abs() <= 0.5);
            prop_assert!((100.0 * kw / kva - get("power_factor")).abs() <= 0.5);
        }
    }

    #[test]
    fn apparent_power_of_a_phase_is_volts_times_amperes(seed: u64, now in moment_of_2026()) {
        let pqm = Pqm::new(seed);
        for phase in ["a", "b", "c"] {
            let volts = float(raw(&pqm, &format!("voltage_{phase}n"), now));
            let amperes = float(raw(&pqm, &format!("current_{phase}"), now));
            let apparent = 10.0 * float(raw(&pqm, &format!("apparent_power_{phase}"), now));
            // Half a volt, half an ampere, and rounded powers.
            let resolution = volts.midpoint(amperes) + 15.0;
            prop_assert!((volts * amperes - apparent).abs() <= resolution);
        }
    }

    #[test]
    fn averages_lie_at_the_mean_and_line_voltages_at_the_root_of_three(
        seed: u64,
        now in moment_of_2026(),
    ) {
        let pqm = Pqm::new(seed);
        let get = |point: &str| float(raw(&pqm, point, now));
        let mean = |points: [&str; 3]| points.iter().map(|point| get(point)).sum::<f64>() / 3.0;
        let amperes = mean(["current_a", "current_b", "current_c"]);
        let phases = mean(["voltage_an", "voltage_bn", "voltage_cn"]);
        let lines = mean(["voltage_ab", "voltage_bc", "voltage_ca"]);
        prop_assert!((get("current_avg") - amperes).abs() <= 1.0);
        prop_assert!((get("voltage_ln_avg") - phases).abs() <= 1.0);
        prop_assert!((get("voltage_ll_avg") - lines).abs() <= 1.0);
        prop_assert!((phases * 3_f64.sqrt() - lines).abs() <= 2.0);
    }

    #[test]
    fn values_are_those_of_a_600_volt_load(seed: u64, now in moment_of_2026()) {
        let pqm = Pqm::new(seed);
        let ranges = [
            ("voltage_an", 343..=351),
            ("voltage_ab", 594..=607),
            ("voltage_unbalance", 0..=10),
            ("current_a", 300..=450),
            ("current_n", 0..=150),
            ("current_unbalance", 0..=150),
            ("real_power_total", 28_000..=46_000),
            ("power_factor_total", 90..=98),
            ("frequency", 5997..=6003),
        ];
        for (point, range) in ranges {
            let value = raw(&pqm, point, now);
            prop_assert!(range.contains(&value), "{} is {}", point, value);
        }
    }

    #[test]
    fn nothing_jumps_within_a_second(seed: u64, now in moment_of_2026()) {
        let pqm = Pqm::new(seed);
        let (one, other) = (pqm.measure(now), pqm.measure(now + seconds(1)));
        for point in MEASURED {
            let before = float(number(one.as_ref(), point));
            let after = float(number(other.as_ref(), point));
            // Less than 1 %, or one step of the register.
            let most = (before / 100.0).max(1.0);
            prop_assert!((before - after).abs() <= most, "{point}: {before}, then {after}");
        }
    }
}

proptest! {
    // Each of these works through a week of every seed.
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(12) })]

    #[test]
    fn values_lie_between_their_minimum_and_maximum(seed: u64, now in moment_of_2026()) {
        let pqm = Pqm::new(seed);
        for hour in 0..12 {
            let measured = pqm.measure(now + seconds(3700 * hour));
            let raw = |point: &str| number(measured.as_ref(), point);
            for point in MEASURED {
                let value = raw(point);
                let lowest = raw(&format!("{point}_min"));
                let highest = raw(&format!("{point}_max"));
                prop_assert!((lowest..=highest).contains(&value), "{point} is {value}");
                prop_assert!(lowest >= 0, "lowest {point} is {lowest}");
            }
            for point in DEMANDS {
                let value = raw(point);
                let highest = raw(&format!("{point}_max"));
                prop_assert!(value <= highest, "{point} is {value}, highest {highest}");
            }
            for distorted in DISTORTED {
                let value = raw(&format!("thd_{distorted}"));
                let highest = raw(&format!("thd_{distorted}_max"));
                prop_assert!((1..=highest).contains(&value), "THD of {distorted} is {value}");
            }
        }
    }

    #[test]
    fn counters_never_fall(seed: u64, now in moment_of_2026(), step in 1_i64..100_000_000) {
        let pqm = Pqm::new(seed);
        for counter in COUNTERS {
            let mut before = raw(&pqm, counter, now);
            for count in 1..=10 {
                let later = now + SignedDuration::from_millis(count * step);
                let after = raw(&pqm, counter, later);
                prop_assert!(before <= after, "{counter} fell from {before} to {after}");
                before = after;
            }
        }
    }

    #[test]
    fn a_seed_always_gives_the_same_meter(seed: u64, now in moment_of_2026()) {
        let (one, other) = (Pqm::new(seed), Pqm::new(seed));
        let (one, other) = (one.measure(now), other.measure(now));
        for point in MEASURED.iter().chain(&DEMANDS).chain(&COUNTERS) {
            prop_assert_eq!(one.content(point), other.content(point), "{}", point);
        }
    }
}

#[test]
fn energy_rises_at_the_rate_of_the_power() {
    let end = at("2026-05-04T08:00:00Z");
    let pairs = [
        ("energy_real_pos", "real_power_total"),
        ("energy_reactive_pos", "reactive_power_total"),
        ("energy_apparent", "apparent_power_total"),
    ];
    for seed in [1, 2, 3] {
        let pqm = Pqm::new(seed);
        for (energy, power) in pairs {
            let risen = raw(&pqm, energy, end) - raw(&pqm, energy, end - seconds(86_400));
            // Powers count tens of watts.
            let expected = mean_before(&pqm, power, end, 86_400) / 100.0 * 24.0;
            let error = float(risen) / expected - 1.0;
            assert!(error.abs() < 0.001, "{energy} of seed {seed}: {error}");
        }
    }
}

#[test]
fn the_last_days_energy_and_its_cost_follow_from_the_counter() {
    let pqm = Pqm::new(1);
    let now = at("2026-05-04T08:00:00Z");
    let total = raw(&pqm, "energy_real_pos", now);
    let day = raw(&pqm, "energy_real_24h", now);
    assert!((total - raw(&pqm, "energy_real_pos", now - seconds(86_400)) - day).abs() <= 1);
    // 10 cents a kilowatt hour, of which only whole ones show in the counter.
    assert!((0..10).contains(&(raw(&pqm, "energy_cost_total", now) - 10 * total)));
    assert!((0..10).contains(&(raw(&pqm, "energy_cost_per_day", now) - 10 * day)));
}

#[test]
fn demand_is_the_mean_of_the_last_quarter_of_an_hour() {
    let pairs = [
        ("demand_real", "real_power_total"),
        ("demand_reactive", "reactive_power_total"),
        ("demand_apparent", "apparent_power_total"),
        ("demand_current_a", "current_a"),
        ("demand_current_b", "current_b"),
        ("demand_current_c", "current_c"),
        ("demand_current_n", "current_n"),
    ];
    // The second one's window reaches into the week before.
    for now in ["2026-05-04T08:07:31.5Z", "2026-01-07T00:03:00Z"].map(at) {
        for (demand, quantity) in pairs {
            let pqm = Pqm::new(4);
            let expected = mean_before(&pqm, quantity, now, 900);
            let found = float(raw(&pqm, demand, now));
            assert!(
                (found - expected).abs() <= 1.0 + expected / 1000.0,
                "{demand} {now}"
            );
        }
    }
}

#[test]
fn counters_start_at_0_in_2020_and_last_for_decades() {
    let pqm = Pqm::new(1);
    for counter in COUNTERS {
        assert_eq!(
            raw(&pqm, counter, at("2019-06-01T00:00:00Z")),
            0,
            "{counter}"
        );
        assert_eq!(
            raw(&pqm, counter, at("2020-01-01T00:00:00Z")),
            0,
            "{counter}"
        );
        let late = raw(&pqm, counter, at("2120-01-01T00:00:00Z"));
        assert!(late < i128::from(u32::MAX), "{counter} is {late}");
    }
}

#[test]
fn time_stamps_of_extremes_are_fixed_and_past() {
    let pqm = Pqm::new(1);
    let (now, later) = (at("2026-05-04T08:00:00Z"), at("2031-01-01T01:02:03Z"));
    let extremes = MEASURED
        .iter()
        .flat_map(|point| [format!("{point}_min"), format!("{point}_max")]);
    let demands = DEMANDS.iter().map(|point| format!("{point}_max"));
    let distortions = DISTORTED.iter().map(|end| format!("thd_{end}_max"));
    for extreme in extremes.chain(demands).chain(distortions) {
        for part in ["time", "date"] {
            let point = format!("{extreme}_{part}");
            assert_eq!(
                words(&pqm, &point, now),
                words(&pqm, &point, later),
                "{point}"
            );
        }
        let date = words(&pqm, &format!("{extreme}_date"), now);
        assert_eq!(date[1], 2020, "{extreme}");
        assert!(
            (0x0101..=0x0108).contains(&date[0]),
            "{extreme}: {date:04X?}"
        );
        let time = words(&pqm, &format!("{extreme}_time"), now);
        assert_eq!(time[1], 0, "{extreme}: samples lie on whole minutes");
    }
}

#[test]
fn the_clock_shows_utc_in_the_meters_own_words() {
    let pqm = Pqm::new(1);
    // Table 7-9 of the manual: 13:27, 10.015 s, October 29, 1997.
    let now = at("1997-10-29T13:27:10.015Z");
    assert_eq!(words(&pqm, "clock_time", now), [0x0D1B, 0x271F]);
    assert_eq!(words(&pqm, "clock_date", now), [0x0A1D, 0x07CD]);
}

#[test]
fn product_information_is_that_of_a_pqm() {
    let pqm = Pqm::new(1);
    let now = at("2026-05-04T08:00:00Z");
    assert_eq!(raw(&pqm, "product_code", now), 65);
    assert_eq!(raw(&pqm, "hardware_version", now), 4);
    assert_eq!(words(&pqm, "serial_number", now).len(), 4);
    // March 21, 2006.
    assert_eq!(words(&pqm, "calibration_date", now), [0x0315, 0x07D6]);
}

#[test]
fn a_seed_and_a_moment_give_the_numbers_they_have_always_given() {
    let now = at("2026-05-04T08:00:00.25Z");
    for (point, value) in [
        ("current_a", 381),
        ("current_n", 45),
        ("voltage_an", 344),
        ("voltage_ab", 597),
        ("voltage_unbalance", 4),
        ("real_power_b", 12_025),
        ("real_power_total", 35_758),
        ("reactive_power_total", 13_508),
        ("apparent_power_total", 38_224),
        ("power_factor_total", 94),
        ("frequency", 6001),
        ("demand_real", 35_977),
        ("demand_current_c", 361),
        ("demand_real_max", 42_771),
        ("current_a_max", 454),
        ("energy_real_pos", 20_393_775),
        ("energy_reactive_pos", 7_323_706),
        ("energy_apparent", 21_674_835),
        ("energy_real_24h", 8820),
        ("energy_cost_total", 203_937_750),
    ] {
        assert_eq!(raw(&Pqm::new(17), point, now), value, "{point}");
    }
}

#[test]
fn other_seeds_give_other_meters() {
    let now = at("2026-05-04T08:00:00Z");
    for seed in 0..50 {
        let (one, other) = (Pqm::new(seed), Pqm::new(seed + 1));
        let serial_number = |pqm| words(pqm, "serial_number", now);
        assert_ne!(serial_number(&one), serial_number(&other), "seed {seed}");
        for point in ["real_power_total", "energy_real_pos"] {
            assert_ne!(
                raw(&one, point, now),
                raw(&other, point, now),
                "{point}, seed {seed}"
            );
        }
    }
}

#[test]
fn a_point_the_meter_does_not_have_holds_nothing() {
    let now = at("2026-05-04T08:00:00Z");
    for point in [
        "",
        "_min",
        "current",
        "current_a_minimum",
        "clock_time_min",
        "demand",
        "thd_",
        "thd_vax",
        "thdf_d",
        "event_",
        "log1_",
    ] {
        assert_eq!(Pqm::new(1).measure(now).content(point), None, "{point}");
    }
}
