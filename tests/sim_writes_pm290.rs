//! The simulated PM290 takes settings, clears and restarts.

use jiff::Timestamp;
use meterpoll::profile::builtin;
use meterpoll::sim::pm290::Keypad;
use meterpoll::sim::{Meter, Pm290};

#[path = "support/frames/pm290.rs"]
#[allow(dead_code, reason = "this file uses its share")]
mod frame;
#[path = "support/simulated.rs"]
mod simulated;

use simulated::{
    answer, at, every_identity_holds_when_read, read, reading, seconds, shown, unit, write,
    write_many,
};

/// Unit 1, as the frames want it, with nobody at its keys.
fn meter() -> Meter {
    Meter::new(unit(1), || {
        let profile = builtin::find("pm290").unwrap().profile();
        let model = Pm290::new(1).with_keypad(Keypad::Idle);
        (profile, Box::new(model))
    })
}

fn now() -> Timestamp {
    at("2026-05-04T08:00:00.25Z")
}

#[test]
fn settings_are_written_one_by_one_and_together() {
    let mut meter = meter();
    assert_eq!(write(&mut meter, 0x0902, 1, now()), None);
    let set = frame::SET_CT;
    assert_eq!(answer(&mut meter, set, now()).as_deref(), Some(set));
    assert_eq!(read(&mut meter, 0x0902, 1, now()), Ok(vec![200]));
    assert_eq!(write_many(&mut meter, 0x0901, &[20, 400], now()), None);
    assert_eq!(
        answer(&mut meter, frame::SET_PT_AND_CT_REQUEST, now()).as_deref(),
        Some(frame::SET_PT_AND_CT_RESPONSE)
    );
    assert_eq!(read(&mut meter, 0x0901, 2, now()), Ok(vec![10, 200]));
    let setup = [2, 5, 50_000, 255, 1800, 32, 1];
    assert_eq!(write_many(&mut meter, 0x0900, &setup, now()), None);
    assert_eq!(read(&mut meter, 0x0900, 7, now()), Ok(setup.to_vec()));
    assert_eq!(write(&mut meter, 0x0700, 200, now()), None);
    assert_eq!(
        read(&mut meter, 0x0700, 3, now()),
        Ok(vec![200, 65535, 65535])
    );
}

#[test]
fn a_write_is_done_as_a_whole_or_not_at_all() {
    let mut meter = meter();
    let before = read(&mut meter, 0x0900, 7, now());
    for (values, code) in [
        (&[4][..], 3),
        (&[1, 0], 3),
        (&[1, 10, 50_001], 3),
        (&[1, 20, 400, 20, 900, 16, 2], 3),
        // The last of eight is no register of table 9.
        (&[1, 20, 400, 20, 900, 16, 0, 0], 2),
    ] {
        assert_eq!(write_many(&mut meter, 0x0900, values, now()), Some(code));
        assert_eq!(read(&mut meter, 0x0900, 7, now()), before);
    }
}

#[test]
fn a_write_stays_inside_a_table_and_what_can_be_written() {
    let mut meter = meter();
    for (start, values) in [
        (0x0100, &[0][..]),
        (0x0117, &[0, 0]),
        (0x0126, &[0, 0]),
        (0x07FF, &[1, 1]),
        (0x08FF, &[1, 1]),
        (0x0A05, &[0]),
        (0x0C00, &[0]),
        (0xFFFF, &[0]),
    ] {
        let refused = write_many(&mut meter, start, values, now());
        assert_eq!(refused, Some(2), "0x{start:04X}");
    }
}

#[test]
fn the_same_load_is_measured_on_the_scales_of_the_new_setup() {
    let mut meter = meter();
    let points = [
        "voltage_a",
        "current_b",
        "active_power_total",
        "apparent_power_c",
    ];
    let before = points.map(|point| reading(&mut meter, point, now()));
    let raw = read(&mut meter, 0x0103, 1, now());
    // 500 A, and voltage transformers with a full scale of 576 V.
    assert_eq!(write_many(&mut meter, 0x0901, &[40, 500], now()), None);
    assert_ne!(read(&mut meter, 0x0103, 1, now()), raw);
    for (point, before) in points.iter().zip(before) {
        let after = reading(&mut meter, point, now());
        assert!(
            (after / before - 1.0).abs() < 0.02,
            "{point}: {before}, {after}"
        );
    }
    every_identity_holds_when_read(&mut meter, now());
    // Now voltages are those between two phases.
    assert_eq!(write(&mut meter, 0x0900, 3, now()), None);
    let voltage = reading(&mut meter, "voltage_a", now());
    assert!(
        (voltage / before[0] - 3_f64.sqrt()).abs() < 0.02,
        "{voltage}"
    );
}

#[test]
fn what_lies_above_the_new_full_scale_reads_as_that() {
    let mut meter = meter();
    assert_eq!(write(&mut meter, 0x0902, 10, now()), None);
    assert_eq!(read(&mut meter, 0x0103, 3, now()), Ok(vec![9999; 3]));
}

#[test]
fn any_value_in_any_demand_clears_all_seven() {
    for (register, value) in [(0x0118, 0), (0x0119, 7), (0x011E, 0xFFFF)] {
        let mut meter = meter();
        let before = read(&mut meter, 0x0118, 7, now()).unwrap();
        let import = shown(&mut meter, "energy_active_import", now());
        assert_eq!(write(&mut meter, register, value, now()), None);
        // 0 W and 0 VA lie in the middle of their scales.
        let zero = vec![5000, 5000, 5000, 5000, 0, 0, 0];
        assert_eq!(read(&mut meter, 0x0118, 7, now()), Ok(zero));
        assert_eq!(shown(&mut meter, "energy_active_import", now()), import);
        // After the longest of the periods they are demands of whole periods again.
        let then = now() + seconds(20 * 60);
        let after = read(&mut meter, 0x0118, 7, then).unwrap();
        assert_eq!(after[0], after[1]);
        assert!(
            (after[1].abs_diff(before[1])) < 500,
            "{before:?}, {after:?}"
        );
    }
}

#[test]
fn a_highest_demand_never_falls_and_is_never_below_the_running_one() {
    let mut meter = meter();
    let reset = frame::RESET_DEMANDS;
    assert_eq!(answer(&mut meter, reset, now()).as_deref(), Some(reset));
    let mut last = 0;
    for step in 0..40 {
        let then = now() + seconds(300 * step);
        let demands = read(&mut meter, 0x0118, 4, then).unwrap();
        assert!(demands[0] >= demands[1] && demands[0] >= last);
        last = demands[0];
    }
}

#[test]
fn energy_counts_from_zero_when_a_zero_is_written_to_either_register_of_a_pair() {
    for (register, import, reactive) in [
        (0x011F, true, false),
        (0x0120, true, false),
        (0x0121, false, false),
        (0x0122, false, false),
        (0x0123, false, true),
        (0x0126, false, true),
    ] {
        let mut meter = meter();
        let points = ["energy_active_import", "energy_reactive_positive"];
        let before = points.map(|point| shown(&mut meter, point, now()));
        assert_eq!(write(&mut meter, register, 1, now()), Some(3));
        assert_eq!(write(&mut meter, register, 0, now()), None);
        let after = points.map(|point| shown(&mut meter, point, now()));
        let [first, second] = before;
        let expected = [(import, first), (reactive, second)]
            .map(|(is_cleared, before)| if is_cleared { "0".to_owned() } else { before });
        assert_eq!(after, expected, "0x{register:04X}");
        let power = reading(&mut meter, "active_power_total", now()) / 1000.0;
        let hour = now() + seconds(3600);
        let counted = reading(&mut meter, points[0], hour) - after[0].parse::<f64>().unwrap();
        assert!((counted / power - 1.0).abs() < 0.3, "{counted} by {power}");
    }
}

#[test]
fn clearing_is_refused_while_it_is_forbidden() {
    let mut meter = meter();
    assert_eq!(write(&mut meter, 0x0906, 1, now()), None);
    let before = read(&mut meter, 0x0118, 15, now());
    for register in 0x0118..=0x0126 {
        assert_eq!(write(&mut meter, register, 0, now()), Some(3));
    }
    assert_eq!(read(&mut meter, 0x0118, 15, now()), before);
    assert_eq!(write(&mut meter, 0x0906, 0, now()), None);
    assert_eq!(write(&mut meter, 0x0118, 0, now()), None);
    assert_ne!(read(&mut meter, 0x0118, 15, now()), before);
}

#[test]
fn a_restart_is_a_second_of_silence_in_which_nothing_is_lost() {
    let mut meter = meter();
    assert_eq!(write(&mut meter, 0x0902, 400, now()), None);
    let before = read(&mut meter, 0x0A00, 6, now());
    let restart = frame::RESTART;
    assert_eq!(answer(&mut meter, restart, now()).as_deref(), Some(restart));
    let soon = now() + seconds(1) - jiff::SignedDuration::from_millis(1);
    assert_eq!(answer(&mut meter, frame::STATUS_REQUEST, soon), None);
    assert_eq!(answer(&mut meter, frame::SET_CT, soon), None);
    let later = now() + seconds(1);
    // The register takes nothing else.
    assert_eq!(write(&mut meter, 0x0A00, 0, later), Some(2));
    assert_eq!(write_many(&mut meter, 0x0A00, &[0xFFFF, 0], later), Some(2));
    assert_eq!(read(&mut meter, 0x0A00, 6, later), before);
    assert_eq!(read(&mut meter, 0x0902, 1, later), Ok(vec![400]));
}

#[test]
fn a_broadcast_is_obeyed_and_not_answered() {
    let mut meter = meter();
    assert_eq!(
        answer(&mut meter, frame::RESET_CONSUMPTION_BROADCAST, now()),
        None
    );
    assert_eq!(shown(&mut meter, "energy_active_import", now()), "0");
    let many = simulated::many(0x0901, &[20, 400]);
    let frame = simulated::sealed(&[&[0][..], &many].concat());
    assert_eq!(answer(&mut meter, &frame, now()), None);
    assert_eq!(read(&mut meter, 0x0901, 2, now()), Ok(vec![20, 400]));
}

#[test]
fn a_meter_with_somebody_at_its_keys_obeys_no_broadcast_to_its_tables() {
    let mut meter = Meter::pm290(unit(1), 1);
    let (busy, idle) = (at("2026-05-04T08:00:01Z"), at("2026-05-04T08:00:02Z"));
    let frame = simulated::sealed(&[0, 6, 9, 2, 1, 0x90]);
    assert_eq!(answer(&mut meter, &frame, busy), None);
    assert_eq!(read(&mut meter, 0x0902, 1, idle), Ok(vec![200]));
}
