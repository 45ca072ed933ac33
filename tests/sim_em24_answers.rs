//! How the simulated EM24-DIN answers.

use jiff::Timestamp;
use meterpoll::sim::{Em2x, Meter};

#[path = "support/frames/em2x.rs"]
#[allow(dead_code, reason = "this file uses its share")]
mod frame;
#[path = "support/simulated.rs"]
mod simulated;

use simulated::{
    answer, at, every_point_reads_as_what_the_model_measures, raw, read, sealed, unit,
};

fn model() -> Em2x {
    Em2x::em24(unit(1), 1)
}

/// Unit 1, as the frames want it.
fn meter() -> Meter {
    Meter::em24(unit(1), 1)
}

fn now() -> Timestamp {
    at("2026-05-04T08:00:00.25Z")
}

/// The words of a raw number of two registers, the lower first.
fn pair(number: i128) -> Vec<u16> {
    let [low, high] = [number, number >> 16].map(|word| u16::try_from(word & 0xFFFF).unwrap());
    vec![low, high]
}

#[test]
fn every_point_of_the_profile_reads_as_what_the_model_measures() {
    let mut meter = meter();
    assert!(meter.profile().points.len() > 90);
    every_point_reads_as_what_the_model_measures(&mut meter, &model(), now());
}

#[test]
fn the_identification_code_is_that_of_an_av9() {
    assert_eq!(
        answer(&mut meter(), frame::IDENTIFICATION_REQUEST, now()),
        Some(sealed(&[0x01, 0x04, 0x02, 0x00, 70]))
    );
}

#[test]
fn one_word_at_000b_is_the_code_and_more_are_the_voltage_l3_l1() {
    let mut meter = meter();
    let voltage = pair(raw(&model(), "voltage_l3_l1", now()));
    assert_eq!(read(&mut meter, 0x000B, 1, now()), Ok(vec![70]));
    assert_eq!(read(&mut meter, 0x000A, 1, now()), Ok(vec![voltage[0]]));
    assert_eq!(read(&mut meter, 0x000A, 2, now()), Ok(voltage.clone()));
    let current = pair(raw(&model(), "current_l1", now()));
    let cut = read(&mut meter, 0x000B, 3, now()).unwrap();
    assert_eq!(cut, [&voltage[1..], &current].concat());
}

#[test]
fn the_first_ten_registers_are_five_voltages_low_word_first() {
    let bytes = answer(&mut meter(), frame::TEN_REGISTERS_REQUEST, now()).unwrap();
    assert_eq!(bytes[..3], [0x01, 0x04, 20]);
    let words = read(&mut meter(), 0x0000, 10, now()).unwrap();
    let voltages = [
        "voltage_l1_n",
        "voltage_l2_n",
        "voltage_l3_n",
        "voltage_l1_l2",
        "voltage_l2_l3",
    ];
    let expected = voltages.map(|voltage| pair(raw(&model(), voltage, now())));
    assert_eq!(words, expected.concat());
    let first = answer(&mut meter(), frame::VOLTAGE_REQUEST, now()).unwrap();
    assert_eq!(first.len(), frame::VOLTAGE_RESPONSE.len());
    assert_eq!(first[3..5], bytes[3..5]);
}

#[test]
fn eleven_registers_are_the_most_it_gives() {
    let mut meter = meter();
    assert_eq!(
        answer(&mut meter, frame::TWELVE_REGISTERS_REQUEST, now()).as_deref(),
        Some(frame::REFUSED_VALUE)
    );
    assert_eq!(read(&mut meter, 0x0000, 11, now()).unwrap().len(), 11);
    // All measurements, none of them cut.
    for (start, count) in [
        (0x0000, 10),
        (0x000A, 10),
        (0x0014, 10),
        (0x001E, 10),
        (0x0028, 10),
        (0x0032, 6),
        (0x0038, 6),
        (0x003E, 10),
        (0x0048, 10),
        (0x0052, 10),
        (0x005C, 10),
        (0x0066, 2),
    ] {
        assert!(
            read(&mut meter, start, count, now()).is_ok(),
            "0x{start:04X}"
        );
    }
    for (start, count) in [
        (0x0067, 2),
        (0x0068, 1),
        (0x110E, 2),
        (0x1136, 1),
        (0xFFFF, 1),
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
    assert_eq!(read(&mut meter, 0x0302, 1, now()), Ok(vec![11]));
    assert_eq!(read(&mut meter, 0x0303, 1, now()), Ok(vec![3]));
    assert_eq!(read(&mut meter, 0x0304, 1, now()), Ok(vec![2]));
    for (start, count) in [(0x0301, 2), (0x0302, 2), (0x0303, 2), (0x0300, 5)] {
        assert_eq!(
            read(&mut meter, start, count, now()),
            Err(2),
            "0x{start:04X}+{count}"
        );
    }
    assert_eq!(read(&mut meter, 0x0300, 2, now()).unwrap().len(), 2);
}

#[test]
fn energies_and_the_serial_number_are_answered_in_their_registers() {
    let mut meter = meter();
    let bytes = answer(&mut meter, frame::EM24_ENERGIES_REQUEST, now()).unwrap();
    assert_eq!(bytes[..3], [0x01, 0x04, 8]);
    let energies = ["energy_active_import_total", "energy_reactive_import_total"];
    let expected = energies.map(|energy| pair(raw(&model(), energy, now())));
    assert_eq!(read(&mut meter, 0x003E, 4, now()), Ok(expected.concat()));
    let bytes = answer(&mut meter, frame::EM24_SERIAL_REQUEST, now()).unwrap();
    assert_eq!(bytes[..5], [0x01, 0x03, 14, b'B', b'X']);
    assert_eq!(bytes[15..17], [b'A', 0]);
}

#[test]
fn resets_cannot_be_read() {
    let mut meter = meter();
    for start in 0x3000..=0x3005 {
        assert_eq!(read(&mut meter, start, 1, now()), Err(2));
    }
}

#[test]
fn it_has_no_function_16_and_loops_any_word_back() {
    let mut meter = meter();
    let many = sealed(&[1, 16, 0x11, 0, 0, 2, 4, 0, 0, 0, 7]);
    assert_eq!(
        answer(&mut meter, &many, now()),
        Some(sealed(&[1, 0x90, 1]))
    );
    for function in [1, 2, 5, 7, 15, 17, 20, 43] {
        let request = sealed(&[1, function, 0, 0, 0, 1]);
        let refusal = sealed(&[1, function | 0x80, 1]);
        assert_eq!(answer(&mut meter, &request, now()), Some(refusal));
    }
    let loopback = answer(&mut meter, frame::LOOPBACK, now());
    assert_eq!(loopback.as_deref(), Some(frame::LOOPBACK));
}
