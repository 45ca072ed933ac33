//! How the simulated PQM answers: exact frames, exceptions and silence.

use std::sync::{LazyLock, Mutex, MutexGuard};

use jiff::Timestamp;
use meterpoll::codec::rtu::{Hex, check, decode_reply, encode_request};
use meterpoll::codec::value::{encode, encode_integer};
use meterpoll::codec::{ReadFunction, RegisterRange, Reply, Request, Response, Unit, UnitRange};
use meterpoll::profile::{Point, Scales, Value};
use meterpoll::sim::{Content, Meter, Model, Pqm};

/// One meter for all tests: none of them changes it.
fn meter() -> MutexGuard<'static, Meter> {
    static METER: LazyLock<Mutex<Meter>> = LazyLock::new(|| {
        let unit = Unit::new(17, UnitRange::Standard).unwrap();
        Mutex::new(Meter::pqm(unit, 1))
    });
    METER.lock().unwrap()
}

fn now() -> Timestamp {
    "2026-05-04T08:00:00.25Z".parse().unwrap()
}

/// A frame with a right CRC: `body` is the unit and the data unit.
fn sealed(body: &[u8]) -> Vec<u8> {
    [body, &check(body)].concat()
}

/// The answer to a frame, as hex pairs; `None` is silence.
fn answer(frame: &[u8]) -> Option<String> {
    meter()
        .answer(frame, now())
        .map(|answer| answer.to_string())
}

/// The answer to a request to unit 17, CRC left off on both sides.
fn answer_to(data_unit: &[u8]) -> Option<String> {
    let answer = meter().answer(&sealed(&[&[0x11], data_unit].concat()), now())?;
    let (body, crc) = answer.as_bytes().split_last_chunk::<2>().unwrap();
    assert_eq!(check(body), *crc);
    Some(Hex(body).to_string())
}

/// The answer to a read of `count` registers from `start` with function 03.
fn answer_to_read(start: u16, count: u16) -> Option<String> {
    let [[a, b], [c, d]] = [start, count].map(u16::to_be_bytes);
    answer_to(&[0x03, a, b, c, d])
}

/// Reads registers, 1 to 125, that can be read.
fn read(function: ReadFunction, range: RegisterRange) -> Vec<u16> {
    let mut meter = meter();
    let frame = encode_request(meter.unit(), &Request::Read { function, range });
    let answer = meter.answer(frame.as_bytes(), now()).unwrap();
    match decode_reply(answer.as_bytes()) {
        Ok((_, Reply::Normal(Response::Registers { values, .. }))) => values.into_vec(),
        other => panic!("{range} gave {other:?}"),
    }
}

fn value(point: &Point) -> Value {
    let registers = read(ReadFunction::HoldingRegisters, point.range);
    point.interpret(&registers, &Scales::default()).unwrap()
}

#[test]
fn every_point_of_the_profile_reads_as_what_the_model_measures() {
    let (profile, pqm) = (meter().profile().clone(), Pqm::new(1));
    let measured = pqm.measure(now());
    let points = profile.points.iter();
    let readable: Vec<&Point> = points.filter(|point| point.access.readable()).collect();
    assert!(readable.len() > 900);
    for point in readable {
        let registers = read(ReadFunction::HoldingRegisters, point.range);
        let expected = match measured.content(&point.name) {
            Some(Content::Number(number)) => encode_integer(point.kind, point.order, number),
            Some(Content::Other(value)) => encode(point.kind, point.order, &value),
            None => None,
        };
        assert_eq!(Some(&registers), expected.as_ref(), "{}", point.name);
        assert!(
            // What depends on another point is not to be had without it.
            point.only_with.is_some() || point.interpret(&registers, &Scales::default()).is_ok(),
            "{}",
            point.name
        );
    }
}

#[test]
fn values_have_the_units_and_scales_of_the_profile() {
    let profile = meter().profile().clone();
    let shown = |name| value(profile.point(name).unwrap()).to_string();
    assert_eq!(shown("product_code"), "65");
    assert_eq!(shown("hardware_version"), "D");
    assert_eq!(shown("options"), "display|power analysis");
    assert_eq!(shown("manufacture_date"), "2006-03-14");
    assert_eq!(shown("clock_time"), "08:00:00.250");
    assert_eq!(shown("clock_date"), "2026-05-04");
    assert_eq!(shown("switch_inputs"), "switch A|switch B");
    assert_eq!(shown("alarm_active_1"), "none");
    assert_eq!(shown("general_status"), "data log 1 running");
    assert_eq!(shown("meter_id"), "METERPOLL SIMULATION");
    assert_eq!(shown("modbus_address"), "17");
    assert_eq!(shown("com1_baud"), "9600");
    assert_eq!(shown("vt_wiring"), "4-wire wye direct");
    assert_eq!(shown("overfrequency_level"), "70.00");
    assert_eq!(shown("sim_aout_1"), "off");
    assert_eq!(shown("time_alarm_pickup"), "12:00:00.000");
    assert_eq!(shown("user_map_index_120"), "0x0000");
    let serial_number = shown("serial_number");
    assert_eq!(serial_number.len(), 8);
    assert!(serial_number.starts_with('C'));
    let number = |name| shown(name).parse::<f64>().unwrap();
    let ranges = [
        ("current_a", 300.0..450.0),
        ("voltage_an", 343.0..351.0),
        ("voltage_ab", 594.0..607.0),
        ("voltage_unbalance", 0.0..1.0),
        ("real_power_a", 92.0..155.0),
        ("real_power_total", 280.0..460.0),
        ("apparent_power_total", 310.0..475.0),
        ("power_factor_total", 0.9..0.98),
        ("demand_real", 280.0..460.0),
        ("frequency", 59.97..60.03),
        ("energy_real_24h", 8000.0..10_000.0),
    ];
    for (name, range) in ranges {
        assert!(range.contains(&number(name)), "{name} is {}", number(name));
    }
}

#[test]
fn functions_03_and_04_read_the_same_registers() {
    for start in [0x0000, 0x0230, 0x02F0, 0x03D0, 0x1000] {
        let range = RegisterRange::new(start, 24).unwrap();
        let [holding, input] = [ReadFunction::HoldingRegisters, ReadFunction::InputRegisters]
            .map(|function| read(function, range));
        assert_eq!(holding, input);
    }
}

#[test]
fn a_read_cuts_points_at_its_ends() {
    let whole = read(
        ReadFunction::HoldingRegisters,
        RegisterRange::new(0x02F0, 8).unwrap(),
    );
    for first in 0..8 {
        for count in 1..=8 - first {
            let range = RegisterRange::new(0x02F0 + first, count).unwrap();
            let part = read(ReadFunction::HoldingRegisters, range);
            let [first, count] = [first, count].map(usize::from);
            assert_eq!(part, whole[first..first + count], "{range}");
        }
    }
}

#[test]
fn the_request_of_table_7_1_is_answered_with_three_reserved_registers() {
    // The manual's bytes with the CRC they should have.
    let request = [0x11, 0x03, 0x00, 0x6B, 0x00, 0x03, 0x76, 0x87];
    assert_eq!(
        answer(&request).as_deref(),
        Some("11 03 06 00 00 00 00 00 00 EC B5")
    );
}

#[test]
fn the_product_code_is_answered_byte_for_byte() {
    assert_eq!(
        answer(&sealed(&[0x11, 0x04, 0x00, 0x00, 0x00, 0x01])).as_deref(),
        Some("11 04 02 00 41 B8 C3")
    );
}

#[test]
fn reads_end_with_the_areas_of_the_memory_map() {
    let refused = Some("11 83 02".to_owned());
    // First and last register of each area.
    let areas = [(0x0000, 0x007F), (0x0100, 0x0E1F), (0x1000, 0x131F)];
    for (first, last) in areas {
        let value = match first {
            0x0000 => "00 41",
            // The identification begins with ME.
            0x1000 => "4D 45",
            _ => "00 00",
        };
        assert_eq!(answer_to_read(first, 1), Some(format!("11 03 02 {value}")));
        assert_eq!(answer_to_read(last, 1).as_deref(), Some("11 03 02 00 00"));
        assert_eq!(answer_to_read(last, 2), refused, "over 0x{last:04X}");
    }
    // The neighbours of the areas that are in none.
    for outside in [0x0080, 0x00FF, 0x0E20, 0x0FFF, 0x1320] {
        assert_eq!(answer_to_read(outside, 1), refused, "0x{outside:04X}");
        assert_eq!(answer_to_read(outside, 2), refused, "0x{outside:04X}");
    }
    assert_eq!(answer_to_read(0xFFFF, 1), refused);
    assert_eq!(answer_to_read(0xFFFF, 2), refused, "past the last address");
}

#[test]
fn a_read_of_no_or_too_many_registers_is_an_illegal_value() {
    let refused = Some("11 83 03".to_owned());
    for count in [0, 126, 127, 0x0100, 0xFFFF] {
        assert_eq!(answer_to_read(0x0200, count), refused, "{count}");
        assert_eq!(
            answer_to_read(0xFFFF, count),
            refused,
            "{count}: before the address"
        );
    }
    assert_eq!(
        answer_to_read(0x0200, 125).unwrap().len(),
        3 * (3 + 250) - 1
    );
}

#[test]
fn functions_the_pqm_does_not_have_are_illegal() {
    assert_eq!(
        answer(&sealed(&[0x11, 0x01, 0x00, 0x00, 0x00, 0x01])).as_deref(),
        Some("11 81 01 80 55")
    );
    for function in (0..0x80).filter(|function| ![3, 4, 5, 6, 7, 8, 16].contains(function)) {
        let expected = Some(format!("11 {:02X} 01", function | 0x80));
        assert_eq!(answer_to(&[function]), expected);
        assert_eq!(answer_to(&[function, 0, 0, 0, 1]), expected);
    }
}

#[test]
fn the_device_status_has_no_alarm() {
    assert_eq!(
        answer(&[0x11, 0x07, 0x4C, 0x22]).as_deref(),
        Some("11 07 00 23 F5")
    );
}

#[test]
fn loopback_echoes_zeros_and_refuses_all_else() {
    let request = [0x11, 0x08, 0x00, 0x00, 0x00, 0x00, 0xE2, 0x9B];
    assert_eq!(answer(&request), Some(Hex(&request).to_string()));
    let refused = Some("11 88 03".to_owned());
    assert_eq!(answer_to(&[0x08, 0x00, 0x00, 0x00, 0x01]), refused);
    assert_eq!(answer_to(&[0x08, 0x00, 0x00, 0xA5, 0x37]), refused);
    assert_eq!(answer_to(&[0x08, 0x00, 0x01, 0x00, 0x00]), refused);
}

#[test]
fn other_units_and_reads_of_all_units_are_met_with_silence() {
    for unit in (0..=255).filter(|unit| *unit != 0x11) {
        assert_eq!(answer(&sealed(&[unit, 0x03, 0x02, 0x40, 0x00, 0x01])), None);
        assert_eq!(answer(&sealed(&[unit, 0x01, 0x00, 0x00, 0x00, 0x01])), None);
    }
}

#[test]
fn a_damaged_request_is_met_with_silence() {
    let request = sealed(&[0x11, 0x03, 0x02, 0x40, 0x00, 0x05]);
    assert!(answer(&request).is_some());
    for bit in 0..8 * request.len() {
        let mut damaged = request.clone();
        damaged[bit / 8] ^= 1 << (bit % 8);
        assert_eq!(answer(&damaged), None, "bit {bit}");
    }
    for length in 0..request.len() {
        assert_eq!(answer(&request[..length]), None, "{length} bytes");
    }
    assert_eq!(answer(&[&request[..], &[0x00]].concat()), None);
}

#[test]
fn a_request_of_the_wrong_length_is_met_with_silence_although_its_crc_is_right() {
    for function in [3, 4, 5, 6, 8] {
        assert_eq!(
            answer_to(&[function, 0x00, 0x00, 0x00]),
            None,
            "{function:02} is cut"
        );
    }
    assert_eq!(answer_to(&[0x03, 0x02, 0x40, 0x00, 0x01, 0x00]), None);
    assert_eq!(answer_to(&[0x07, 0x00]), None);
    assert_eq!(
        answer_to(&[0x10, 0x10, 0x28, 0x00, 0x02, 0x04, 0x01, 0xF4]),
        None
    );
}

#[test]
fn somebody_elses_exception_response_is_met_with_silence() {
    assert_eq!(answer_to(&[0x83, 0x02]), None);
}
