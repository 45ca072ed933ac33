//! The simulated EM21 and EM24-DIN take settings and resets, word by word, with function 06 alone.

use jiff::Timestamp;
use meterpoll::sim::Meter;

#[path = "support/frames/em2x.rs"]
#[allow(dead_code, reason = "this file uses its share")]
mod frame;
#[path = "support/simulated.rs"]
mod simulated;

use simulated::{answer, at, many, read, reading, sealed, seconds, shown, unit, write};

fn em21() -> Meter {
    Meter::em21(unit(1), 1)
}

fn em24() -> Meter {
    Meter::em24(unit(1), 1)
}

fn now() -> Timestamp {
    at("2026-05-04T08:00:00Z")
}

#[test]
fn a_ratio_is_written_word_by_word_low_word_first_and_held() {
    let mut meter = em21();
    assert_eq!(shown(&mut meter, "ct_ratio", now()), "20.0");
    let voltage = shown(&mut meter, "voltage_l1_n", now());
    let current = shown(&mut meter, "current_l1", now());
    for echo in [frame::EM21_CT_LOW, frame::EM21_CT_HIGH] {
        assert_eq!(answer(&mut meter, echo, now()).as_deref(), Some(echo));
    }
    assert_eq!(read(&mut meter, 0x1003, 2, now()), Ok(vec![400, 0]));
    assert_eq!(shown(&mut meter, "ct_ratio", now()), "40.0");
    assert_eq!(shown(&mut meter, "voltage_l1_n", now()), voltage);
    assert_eq!(shown(&mut meter, "current_l1", now()), current);
    // The half that comes first makes a ratio of its own with the old other half.
    assert_eq!(write(&mut meter, 0x1004, 1, now()), None);
    assert_eq!(shown(&mut meter, "ct_ratio", now()), "6593.6");
}

#[test]
fn an_em21_takes_what_it_is_given_and_an_em24_does_not() {
    let mut meter = em21();
    assert_eq!(write(&mut meter, 0x1000, 1000, now()), None);
    assert_eq!(write(&mut meter, 0x1002, 77, now()), None);
    assert_eq!(read(&mut meter, 0x1000, 3, now()), Ok(vec![1000, 0, 77]));
    let mut meter = em24();
    assert_eq!(write(&mut meter, 0x1102, 77, now()), Some(3));
    assert_eq!(write(&mut meter, 0x1103, 0, now()), Some(3));
    assert_eq!(write(&mut meter, 0x1103, 30, now()), None);
    assert_eq!(read(&mut meter, 0x1102, 2, now()), Ok(vec![0, 30]));
}

#[test]
fn for_some_settings_an_em24_echoes_what_is_out_of_range_and_holds_another_value() {
    let mut meter = em24();
    for (address, good, bad, instead) in [
        (0x1100, 9999, 10_000, 0),
        (0x1104, 30, 31, 0),
        (0x1107, 7, 0xFFFF, 0),
        (0x1121, 7, 8, 0),
        (0x1123, 5, 6, 0),
        (0x1124, 9999, 0, 1),
    ] {
        assert_eq!(write(&mut meter, address, good, now()), None);
        assert_eq!(read(&mut meter, address, 1, now()), Ok(vec![good]));
        let [[a, b], [c, d]] = [address, bad].map(u16::to_be_bytes);
        let request = sealed(&[1, 6, a, b, c, d]);
        assert_eq!(answer(&mut meter, &request, now()), Some(request.clone()));
        assert_eq!(read(&mut meter, address, 1, now()), Ok(vec![instead]));
    }
}

#[test]
fn the_application_of_the_frames_is_set() {
    let mut meter = em24();
    assert_eq!(write(&mut meter, 0x1101, 0, now()), None);
    let set = frame::EM24_APPLICATION_H;
    assert_eq!(answer(&mut meter, set, now()).as_deref(), Some(set));
    assert_eq!(shown(&mut meter, "application", now()), "H");
}

#[test]
fn what_is_no_setting_cannot_be_written() {
    for mut meter in [em21(), em24()] {
        for address in [0x0000, 0x000B, 0x0302, 0x0FFF, 0x1009, 0x2000, 0xFFFF] {
            let refused = if meter.profile().name == "em24" && address == 0x1009 {
                continue;
            } else {
                write(&mut meter, address, 1, now())
            };
            assert_eq!(refused, Some(2), "0x{address:04X}");
        }
        let block = [&[1][..], &many(0x1000, &[1])].concat();
        let refusal = Some(sealed(&[1, 0x90, 1]));
        assert_eq!(answer(&mut meter, &sealed(&block), now()), refusal);
    }
}

#[test]
fn another_address_holds_from_the_next_request_on() {
    for (mut meter, register) in [(em21(), 0x1008), (em24(), 0x110A)] {
        let [high, low] = u16::to_be_bytes(register);
        let move_to_9 = sealed(&[1, 6, high, low, 0, 9]);
        let echo = answer(&mut meter, &move_to_9, now());
        assert_eq!(echo, Some(move_to_9.clone()));
        assert_eq!(answer(&mut meter, &move_to_9, now()), None);
        assert_eq!(meter.unit(), unit(9));
        assert_eq!(read(&mut meter, register, 1, now()), Ok(vec![9]));
    }
    // An EM21 holds a number that is no address and stays where it is.
    let mut meter = em21();
    assert_eq!(write(&mut meter, 0x1008, 300, now()), None);
    assert_eq!(read(&mut meter, 0x1008, 1, now()), Ok(vec![300]));
    assert_eq!(write(&mut meter, 0x1008, 9, now()), None);
    assert_eq!(meter.unit(), unit(9));
}

#[test]
fn an_em21_counts_from_zero_after_its_reset() {
    let mut meter = em21();
    assert!(reading(&mut meter, "energy_active_import_total", now()) > 1000.0);
    let reset = frame::EM21_RESET;
    assert_eq!(answer(&mut meter, reset, now()).as_deref(), Some(reset));
    for kind in ["active", "reactive"] {
        let point = format!("energy_{kind}_import_total");
        assert_eq!(shown(&mut meter, &point, now()), "0.0");
    }
    let power = reading(&mut meter, "active_power_sys", now()) / 1000.0;
    let hour = now() + seconds(3600);
    let active = reading(&mut meter, "energy_active_import_total", hour);
    assert!((active / power - 1.0).abs() < 0.5, "{active} by {power}");
}

#[test]
fn other_numbers_than_1_are_answered_and_reset_nothing() {
    for mut meter in [em21(), em24()] {
        let before = shown(&mut meter, "energy_active_import_total", now());
        for value in [0, 2, 0x0100, 0xFFFF] {
            assert_eq!(write(&mut meter, 0x3000, value, now()), None);
        }
        let after = shown(&mut meter, "energy_active_import_total", now());
        assert_eq!(after, before);
    }
}

/// Counters of an EM24 by the reset that they belong to.
const TOTAL: [&str; 4] = [
    "energy_active_import_total",
    "energy_reactive_import_total",
    "energy_active_import_l2",
    "energy_active_import_t2",
];
const PARTIAL: [&str; 2] = [
    "energy_active_import_partial",
    "energy_reactive_import_partial",
];
const HOURS: [&str; 1] = ["hour_counter"];
const COUNTERS: [&str; 3] = ["counter_1", "counter_2", "counter_3"];

#[test]
fn each_reset_of_an_em24_sets_to_zero_what_it_is_for_and_nothing_else() {
    let all = [&TOTAL[..], &PARTIAL, &HOURS, &COUNTERS].concat();
    for (register, cleared) in [
        (0x3000, [&TOTAL[..], &PARTIAL].concat()),
        (0x3001, TOTAL.to_vec()),
        (0x3002, PARTIAL.to_vec()),
        (0x3003, HOURS.to_vec()),
        (0x3004, COUNTERS.to_vec()),
        (0x3005, Vec::new()),
    ] {
        let mut meter = em24();
        let before = all.iter().map(|point| reading(&mut meter, point, now()));
        let before: Vec<f64> = before.collect();
        assert_eq!(write(&mut meter, register, 1, now()), None);
        for (point, before) in all.iter().zip(before) {
            assert!(before > 0.0, "{point}");
            let expected = if cleared.contains(point) { 0.0 } else { before };
            let after = reading(&mut meter, point, now());
            assert!(
                (after - expected).abs() < 1e-9,
                "0x{register:04X}, {point}: {after}"
            );
        }
    }
}

#[test]
fn after_a_reset_phases_and_tariffs_still_add_up() {
    let mut meter = em24();
    assert_eq!(write(&mut meter, 0x3000, 1, now()), None);
    for hours in [0, 1, 13, 23, 500] {
        let then = now() + seconds(3600 * hours);
        let mut sum = |points: &[&str]| -> f64 {
            let values = points.iter().map(|point| reading(&mut meter, point, then));
            values.sum()
        };
        let total = sum(&["energy_active_import_total"]);
        let phases = [
            "energy_active_import_l1",
            "energy_active_import_l2",
            "energy_active_import_l3",
        ];
        let tariffs = ["energy_active_import_t1", "energy_active_import_t2"];
        assert!((total - sum(&phases)).abs() < 1e-6, "after {hours} h");
        assert!((total - sum(&tariffs)).abs() < 1e-6, "after {hours} h");
        assert!((total - sum(&["energy_active_import_partial"])).abs() < 1e-6);
        assert!((total > 0.0) == (hours > 0));
    }
}

#[test]
fn the_highest_demand_is_that_since_its_reset() {
    let mut meter = em24();
    let before = reading(&mut meter, "demand_active_power_max", now());
    let reset = frame::EM24_RESET_DEMANDS;
    assert_eq!(answer(&mut meter, reset, now()).as_deref(), Some(reset));
    let demand = shown(&mut meter, "demand_active_power_sys", now());
    assert_eq!(shown(&mut meter, "demand_active_power_max", now()), demand);
    let mut last = 0.0;
    for quarter in 0..40 {
        let then = now() + seconds(900 * quarter);
        let demand = reading(&mut meter, "demand_active_power_sys", then);
        let highest = reading(&mut meter, "demand_active_power_max", then);
        assert!(highest >= demand && highest >= last && highest <= before);
        last = highest;
    }
}
