//! How the simulated PM290 answers.

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
    answer, at, every_point_reads_as_what_the_model_measures, exception, raw, read, sealed, unit,
};

/// The model behind every meter here.
fn model(keypad: Keypad) -> Pm290 {
    Pm290::new(1).with_keypad(keypad)
}

/// Unit 1, as the frames want it.
fn meter(keypad: Keypad) -> Meter {
    Meter::new(unit(1), move || {
        let profile = builtin::find("pm290").unwrap().profile();
        (profile, Box::new(model(keypad)))
    })
}

fn now() -> Timestamp {
    at("2026-05-04T08:00:00.25Z")
}

#[test]
fn every_point_of_the_profile_reads_as_what_the_model_measures() {
    let mut meter = meter(Keypad::Idle);
    assert!(meter.profile().points.len() > 60);
    every_point_reads_as_what_the_model_measures(&mut meter, &model(Keypad::Idle), now());
}

#[test]
fn the_setup_of_the_example_is_answered_byte_for_byte() {
    let mut meter = meter(Keypad::Idle);
    assert_eq!(
        answer(&mut meter, frame::SETUP_REQUEST, now()).as_deref(),
        Some(frame::SETUP_RESPONSE)
    );
}

#[test]
fn energies_are_pairs_of_0_to_9999_low_word_first() {
    let mut meter = meter(Keypad::Idle);
    let bytes = answer(&mut meter, frame::ENERGIES_REQUEST, now()).unwrap();
    assert_eq!(bytes.len(), frame::ENERGIES_RESPONSE.len());
    assert_eq!(bytes[..3], frame::ENERGIES_RESPONSE[..3]);
    let words = read(&mut meter, 0x011F, 8, now()).unwrap();
    assert!(words.iter().all(|word| *word <= 9999), "{words:?}");
    let import = i128::from(words[0]) + 10_000 * i128::from(words[1]);
    assert_eq!(
        import,
        raw(&model(Keypad::Idle), "energy_active_import", now())
    );
    assert!(import > 3_000_000);
    assert_eq!(words[2..4], [0, 0]);
    assert_eq!(words[6..8], [0, 0]);
}

#[test]
fn the_status_is_that_of_a_meter_in_order() {
    let mut meter = meter(Keypad::Idle);
    let bytes = answer(&mut meter, frame::STATUS_REQUEST, now()).unwrap();
    assert_eq!(bytes[..3], [0x01, 0x03, 0x0C]);
    assert_eq!(
        read(&mut meter, 0x0A00, 6, now()),
        Ok(vec![0, 0, 0, 0, 0, 221])
    );
}

#[test]
fn a_meter_with_somebody_at_its_keys_refuses_tables_6_to_11_alone() {
    let mut meter = meter(Keypad::InUse);
    assert_eq!(
        answer(&mut meter, frame::STATUS_REQUEST, now()).as_deref(),
        Some(frame::BUSY_TO_A_READ)
    );
    assert_eq!(
        answer(&mut meter, frame::SET_CT, now()).as_deref(),
        Some(frame::BUSY_TO_A_WRITE)
    );
    for (start, code) in [
        (0x05FF, 2),
        (0x0600, 6),
        (0x0700, 6),
        (0x0A01, 6),
        (0x0BFF, 6),
        (0x0C00, 2),
    ] {
        assert_eq!(
            read(&mut meter, start, 1, now()),
            Err(code),
            "0x{start:04X}"
        );
    }
    // A read that would end in table 6 touches it.
    assert_eq!(read(&mut meter, 0x05FF, 2, now()), Err(6));
    assert!(read(&mut meter, 0x0100, 39, now()).is_ok());
    let block = frame::SET_PT_AND_CT_REQUEST;
    assert_eq!(
        exception(&mut meter, &block[1..block.len() - 2], now()),
        Some(6)
    );
    // What the keys have nothing to do with.
    assert_eq!(exception(&mut meter, &[0x07], now()), Some(1));
    assert_eq!(exception(&mut meter, &[0x08, 0, 0, 1, 2], now()), None);
    assert_eq!(exception(&mut meter, &[0x06, 1, 0x18, 0, 0], now()), None);
}

#[test]
fn on_its_own_it_is_busy_in_the_first_two_seconds_of_every_hour() {
    let mut meter = Meter::pm290(unit(1), 1);
    let mut busy = |time| read(&mut meter, 0x0900, 7, at(time)) == Err(6);
    for time in [
        "2026-05-04T08:00:00Z",
        "2026-05-04T08:00:01.999Z",
        "2026-05-04T09:00:00.5Z",
        "1969-12-31T23:00:01Z",
    ] {
        assert!(busy(time), "{time}");
    }
    for time in [
        "2026-05-04T07:59:59.999Z",
        "2026-05-04T08:00:02Z",
        "2026-05-04T08:30:00Z",
        "1969-12-31T22:59:59Z",
    ] {
        assert!(!busy(time), "{time}");
    }
}

#[test]
fn a_read_stays_inside_a_table_and_its_points() {
    let mut meter = meter(Keypad::Idle);
    assert!(read(&mut meter, 0x0100, 39, now()).is_ok());
    for (start, count) in [
        (0x0100, 40),
        (0x00FF, 1),
        (0x0127, 1),
        (0x0703, 1),
        (0x08FF, 2),
        (0x0907, 1),
        (0x0A06, 1),
        (0x0000, 1),
        (0xFFFF, 1),
    ] {
        assert_eq!(
            read(&mut meter, start, count, now()),
            Err(2),
            "0x{start:04X}+{count}"
        );
    }
    assert_eq!(read(&mut meter, 0x0800, 15, now()).unwrap().len(), 15);
}

#[test]
fn it_has_the_functions_of_its_profile_and_loops_any_word_back() {
    let mut meter = meter(Keypad::Idle);
    let back = answer(&mut meter, &sealed(&[1, 8, 0, 0, 0xA5, 0x37]), now());
    assert_eq!(back, Some(sealed(&[1, 8, 0, 0, 0xA5, 0x37])));
    for refused in [
        frame::FUNCTION_20_REQUEST,
        frame::FUNCTION_21,
        &sealed(&[1, 7]),
        &sealed(&[1, 5, 0, 1, 0xFF, 0]),
    ] {
        assert_eq!(
            answer(&mut meter, refused, now()),
            Some(sealed(&[1, refused[1] | 0x80, 1]))
        );
    }
}
