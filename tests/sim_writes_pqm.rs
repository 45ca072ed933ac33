//! The simulated PQM takes setpoints, operations and the time.

use jiff::Timestamp;
use meterpoll::codec::{RegisterAddress, Write};
use meterpoll::sim::{Deed, Meter, Model, Pqm};

#[path = "support/frames/pqm.rs"]
#[allow(dead_code, reason = "this file uses its share")]
mod frame;
#[path = "support/simulated.rs"]
mod simulated;

use simulated::{
    answer, at, every_identity_holds_when_read, exception, many, raw, read, reading, sealed,
    seconds, shown, unit, write, write_many,
};

fn meter() -> Meter {
    Meter::pqm(unit(17), 1)
}

fn now() -> Timestamp {
    at("2026-05-04T08:00:00.25Z")
}

/// Carries out an operation with function 05; the exception code where that is refused.
fn operate(meter: &mut Meter, operation: u16, now: Timestamp) -> Option<u8> {
    let [high, low] = operation.to_be_bytes();
    exception(meter, &[5, high, low, 0xFF, 0], now)
}

/// The same with function 16, with what goes with it.
fn command(meter: &mut Meter, operation: u16, data: &[u16], now: Timestamp) -> Option<u8> {
    let words = [&[5, operation][..], data].concat();
    write_many(meter, 0x0080, &words, now)
}

/// What function 07 answers.
fn status(meter: &mut Meter) -> u8 {
    let answer = answer(meter, frame::STATUS_REQUEST, now()).unwrap();
    assert_eq!(answer.len(), frame::STATUS_RESPONSE.len());
    answer[2]
}

#[test]
fn setpoints_are_held_and_read_back() {
    let mut meter = meter();
    assert_eq!(write(&mut meter, 0x1050, 800, now()), None);
    assert_eq!(read(&mut meter, 0x1050, 1, now()), Ok(vec![800]));
    let name = [0x4D41, 0x494E, 0x2020];
    assert_eq!(write_many(&mut meter, 0x1000, &name, now()), None);
    assert_eq!(shown(&mut meter, "meter_id", now()), "MAIN  OLL SIMULATION");
    assert_eq!(write_many(&mut meter, 0x1260, &[0, 900], now()), None);
    assert_eq!(shown(&mut meter, "log1_interval_set", now()), "900");
    assert_eq!(write(&mut meter, 0x0180, 0x0240, now()), None);
    assert_eq!(read(&mut meter, 0x0180, 2, now()), Ok(vec![0x0240, 0]));
}

#[test]
fn the_printed_examples_are_answered_as_a_meter_with_limits_answers_them() {
    let mut meter = meter();
    for echo in [frame::OPERATION, frame::OPERATION_TO_UNIT_17] {
        assert_eq!(answer(&mut meter, echo, now()).as_deref(), Some(echo));
    }
    assert_eq!(
        answer(&mut meter, frame::COMMAND_REQUEST, now()).as_deref(),
        Some(frame::COMMAND_RESPONSE)
    );
    // 484, 500 and 10000 are no bit rates and no parities.
    for request in [frame::STORE, frame::STORE_01F4, frame::STORE_MANY_REQUEST] {
        assert_eq!(
            answer(&mut meter, request, now()),
            Some(sealed(&[0x11, request[1] | 0x80, 3]))
        );
    }
    for silent in [frame::OPERATION_BROADCAST, frame::CLOCK_BROADCAST] {
        assert_eq!(answer(&mut meter, silent, now()), None);
    }
}

#[test]
fn a_write_is_done_as_a_whole_or_not_at_all() {
    let mut meter = meter();
    let before = read(&mut meter, 0x1018, 9, now());
    // The third is a bit rate.
    assert_eq!(write_many(&mut meter, 0x101F, &[0, 0, 9], now()), Some(2));
    assert_eq!(write_many(&mut meter, 0x1028, &[4, 2, 0], now()), Some(2));
    assert_eq!(write_many(&mut meter, 0x1028, &[4, 3], now()), Some(3));
    assert_eq!(read(&mut meter, 0x1018, 9, now()), before);
    assert_eq!(write_many(&mut meter, 0x1260, &[1, 0x5181], now()), Some(3));
    assert_eq!(write_many(&mut meter, 0x1260, &[1, 0x5180], now()), None);
    // One word of a setpoint of two is stored as it is.
    assert_eq!(write(&mut meter, 0x1260, 0xFFFF, now()), None);
    assert_eq!(read(&mut meter, 0x1260, 2, now()), Ok(vec![0xFFFF, 0x5180]));
    // 25 o'clock.
    assert_eq!(write_many(&mut meter, 0x11E5, &[0x1900, 0], now()), Some(3));
    assert_eq!(write_many(&mut meter, 0x11E5, &[0x1700, 0], now()), None);
    assert_eq!(
        shown(&mut meter, "time_alarm_pickup", now()),
        "23:00:00.000"
    );
}

#[test]
fn what_is_no_setpoint_cannot_be_written() {
    let mut meter = meter();
    for address in [0x0000, 0x0100, 0x0240, 0x0E1F, 0x1320, 0xFFFF] {
        assert_eq!(
            write(&mut meter, address, 0, now()),
            Some(2),
            "0x{address:04X}"
        );
    }
}

#[test]
fn a_write_of_more_than_60_registers_is_an_illegal_value() {
    let mut meter = meter();
    for (count, code) in [(1, None), (60, None), (61, Some(3)), (120, Some(3))] {
        let zeros = vec![0; count];
        assert_eq!(
            write_many(&mut meter, 0x0180, &zeros, now()),
            code,
            "{count}"
        );
    }
}

#[test]
fn relays_follow_operations_and_function_07_tells() {
    let mut meter = meter();
    assert_eq!(status(&mut meter), 0);
    for (on, off, bit, relay, light) in [
        (2, 3, 0b0000_0100, "alarm", 0x0040),
        (4, 5, 0b0000_1000, "aux 1", 0x0001),
        (6, 7, 0b0001_0000, "aux 2", 0x0002),
        (8, 9, 0b0010_0000, "aux 3", 0x0004),
    ] {
        assert_eq!(operate(&mut meter, on, now()), None);
        assert_eq!(status(&mut meter), bit);
        assert_eq!(shown(&mut meter, "output_relays", now()), relay);
        assert_eq!(read(&mut meter, 0x0201, 1, now()), Ok(vec![light]));
        assert_eq!(command(&mut meter, off, &[], now()), None);
        assert_eq!(status(&mut meter), 0);
    }
    for on in [2, 4, 8] {
        assert_eq!(operate(&mut meter, on, now()), None);
    }
    // As printed in table 7-5.
    assert_eq!(
        answer(&mut meter, frame::STATUS_REQUEST, now()).as_deref(),
        Some(frame::STATUS_RESPONSE)
    );
}

#[test]
fn there_are_35_operations() {
    let mut meter = meter();
    let need_more = [10, 11, 13, 24];
    for operation in (0..=40).chain([0xFFFF]) {
        let code = match operation {
            1..=35 if !need_more.contains(&operation) => None,
            _ => Some(3),
        };
        assert_eq!(operate(&mut meter, operation, now()), code, "{operation}");
        assert_eq!(
            command(&mut meter, operation, &[], now()),
            code,
            "{operation}"
        );
    }
    for value in [[0, 0], [0x12, 0x34]] {
        let [high, low] = value;
        assert_eq!(exception(&mut meter, &[5, 0, 1, high, low], now()), Some(3));
    }
}

#[test]
fn a_command_is_all_in_one_write_from_its_first_register() {
    let mut meter = meter();
    for (start, values, code) in [
        (0x0080, &[5, 2][..], None),
        (0x0080, &[5], Some(3)),
        (0x0080, &[4, 2], Some(3)),
        (0x0081, &[2], Some(2)),
        (0x0082, &[0], Some(2)),
        // A message of 40 characters.
        (
            0x0080,
            &[
                5, 12, 0x4142, 0x4142, 0x4142, 0x4142, 0x4142, 0x4142, 0x4142, 0x4142, 0x4142,
                0x4142, 0x4142, 0x4142, 0x4142, 0x4142, 0x4142, 0x4142, 0x4142, 0x4142, 0x4142,
                0x4142,
            ],
            None,
        ),
        (0x007F, &[0, 5, 2], Some(2)),
        (0x00F1, &[0], Some(2)),
        (0x00F0, &[0x0D1B], Some(2)),
        (0x00F4, &[0, 0], Some(2)),
    ] {
        assert_eq!(
            write_many(&mut meter, start, values, now()),
            code,
            "{start:04X}"
        );
    }
    for address in [0x0080, 0x0081, 0x008C, 0x00F0, 0x00F3] {
        assert_eq!(write(&mut meter, address, 5, now()), Some(2));
    }
    assert_eq!(read(&mut meter, 0x0080, 2, now()), Err(2));
}

#[test]
fn the_clock_is_set_by_a_broadcast_and_goes_on_from_there() {
    let mut meter = meter();
    assert_eq!(answer(&mut meter, frame::CLOCK_BROADCAST, now()), None);
    let clock =
        |meter: &mut Meter, now| ["clock_date", "clock_time"].map(|point| shown(meter, point, now));
    assert_eq!(clock(&mut meter, now()), ["1997-10-29", "13:27:10.015"]);
    let later = now() + seconds(24 * 3600 + 5);
    assert_eq!(clock(&mut meter, later), ["1997-10-30", "13:27:15.015"]);
}

#[test]
fn time_and_date_are_set_together_or_each_for_itself() {
    let mut meter = meter();
    let clock =
        |meter: &mut Meter| ["clock_date", "clock_time"].map(|point| shown(meter, point, now()));
    assert_eq!(
        write_many(&mut meter, 0x00F0, &[0x0D1B, 0x271F], now()),
        None
    );
    assert_eq!(clock(&mut meter), ["2026-05-04", "13:27:10.015"]);
    assert_eq!(
        write_many(&mut meter, 0x00F2, &[0x0A1D, 0x07CD], now()),
        None
    );
    assert_eq!(clock(&mut meter), ["1997-10-29", "13:27:10.015"]);
    assert_eq!(command(&mut meter, 10, &[0x0000, 59_999], now()), None);
    assert_eq!(command(&mut meter, 11, &[0x021D, 2028], now()), None);
    assert_eq!(clock(&mut meter), ["2028-02-29", "00:00:59.999"]);
    for (start, bad) in [
        (0x00F0, &[0x183C, 0][..]),
        (0x00F0, &[0x0000, 60_000]),
        (0x00F2, &[0x021E, 2028]),
        (0x00F0, &[0x0D1B, 0x271F, 0x0D01, 2028]),
    ] {
        assert_eq!(write_many(&mut meter, start, bad, now()), Some(3));
    }
    assert_eq!(clock(&mut meter), ["2028-02-29", "00:00:59.999"]);
}

#[test]
fn energy_counts_from_zero_when_it_is_cleared() {
    let clears: [fn(&mut Meter) -> Option<u8>; 3] = [
        |meter| operate(meter, 14, now()),
        |meter| command(meter, 14, &[], now()),
        |meter| write(meter, 0x1038, 1, now()),
    ];
    let points = [
        "energy_real_pos",
        "energy_reactive_pos",
        "energy_apparent",
        "energy_real_24h",
    ];
    for clear in clears {
        let mut meter = meter();
        assert!(reading(&mut meter, "energy_real_pos", now()) > 1000.0);
        assert_eq!(clear(&mut meter), None);
        for point in points
            .iter()
            .chain(&["energy_cost_total", "energy_cost_per_day"])
        {
            assert!(reading(&mut meter, point, now()).abs() < 1e-9, "{point}");
        }
        let power = reading(&mut meter, "real_power_total", now());
        let hour = now() + seconds(3600);
        let counted = reading(&mut meter, "energy_real_pos", hour);
        assert!((counted / power - 1.0).abs() < 0.2, "{counted} by {power}");
        assert!((reading(&mut meter, "energy_real_24h", hour) - counted).abs() < 1e-9);
        let two_days = now() + seconds(48 * 3600);
        let day = reading(&mut meter, "energy_real_24h", two_days);
        assert!(day < reading(&mut meter, "energy_real_pos", two_days) * 0.7);
    }
}

#[test]
fn setpoints_that_clear_read_no_again_at_once() {
    let mut meter = meter();
    for register in 0x1038..=0x1041 {
        assert_eq!(write(&mut meter, register, 1, now()), None);
        assert_eq!(write(&mut meter, register, 0, now()), None);
        assert_eq!(write(&mut meter, register, 2, now()), Some(3));
    }
    assert_eq!(read(&mut meter, 0x1038, 10, now()), Ok(vec![0; 10]));
    // "no" clears nothing.
    let mut meter = self::meter();
    let before = shown(&mut meter, "energy_real_pos", now());
    assert_eq!(write_many(&mut meter, 0x1038, &[0; 10], now()), None);
    assert_eq!(shown(&mut meter, "energy_real_pos", now()), before);
}

#[test]
fn minima_and_maxima_begin_with_what_is_measured_when_they_are_cleared() {
    for (operation, register, points) in [
        (
            16,
            0x103A,
            &["current_a", "current_n", "current_unbalance"][..],
        ),
        (35, 0x1041, &["frequency"]),
    ] {
        for by_operation in [true, false] {
            let mut meter = meter();
            let code = if by_operation {
                operate(&mut meter, operation, now())
            } else {
                write(&mut meter, register, 1, now())
            };
            assert_eq!(code, None);
            for point in points {
                let value = shown(&mut meter, point, now());
                for end in ["min", "max"] {
                    assert_eq!(shown(&mut meter, &format!("{point}_{end}"), now()), value);
                    let date = shown(&mut meter, &format!("{point}_{end}_date"), now());
                    let time = shown(&mut meter, &format!("{point}_{end}_time"), now());
                    assert_eq!(format!("{date} {time}"), "2026-05-04 08:00:00.250");
                }
                let later = now() + seconds(2000);
                let [value, min, max] = ["", "_min", "_max"]
                    .map(|end| reading(&mut meter, &format!("{point}{end}"), later));
                assert!(min <= value && value <= max && min < max, "{point}");
            }
        }
    }
}

/// Where these lie is not known well enough for the profile; the model has them all the same.
#[test]
fn voltages_and_powers_are_cleared_as_well() {
    for (operation, points) in [
        (17, ["voltage_bc", "voltage_unbalance"]),
        (18, ["real_power_total", "power_factor_c"]),
    ] {
        let mut pqm = Pqm::new(1);
        let write = Write::Coil {
            address: RegisterAddress(operation),
            on: true,
        };
        assert_eq!(pqm.command(&write, now()), Some(Ok(Deed::Done)));
        for point in points {
            for end in ["min", "max"] {
                let found = raw(&pqm, &format!("{point}_{end}"), now());
                assert_eq!(found, raw(&pqm, point, now()), "{point}_{end}");
            }
        }
    }
}

#[test]
fn clearing_one_thing_leaves_the_others() {
    let kept = [
        "current_a_max",
        "current_b_min",
        "demand_real_max",
        "thd_van_max",
        "frequency_max",
    ];
    let mut meter = meter();
    let before = kept.map(|point| shown(&mut meter, point, now()));
    assert_eq!(operate(&mut meter, 14, now()), None);
    assert_eq!(operate(&mut meter, 18, now()), None);
    assert_eq!(kept.map(|point| shown(&mut meter, point, now())), before);
    assert_eq!(operate(&mut meter, 19, now()), None);
    let distortion = shown(&mut meter, "thd_van", now());
    assert_eq!(shown(&mut meter, "thd_van_max", now()), distortion);
    assert_eq!(shown(&mut meter, "current_a_max", now()), before[0]);
}

#[test]
fn the_highest_demand_is_cleared_alone_or_with_the_running_one() {
    let mut meter = meter();
    let demand = shown(&mut meter, "demand_real", now());
    assert_eq!(operate(&mut meter, 15, now()), None);
    assert_eq!(shown(&mut meter, "demand_real", now()), demand);
    assert_eq!(shown(&mut meter, "demand_real_max", now()), demand);
    // Table 7-3.
    assert_eq!(answer(&mut meter, frame::OPERATION_BROADCAST, now()), None);
    for point in [
        "demand_real",
        "demand_real_max",
        "demand_current_a",
        "demand_current_a_max",
    ] {
        assert!(reading(&mut meter, point, now()).abs() < 1e-9, "{point}");
    }
    let later = now() + seconds(900);
    let (running, highest) = (
        reading(&mut meter, "demand_real", later),
        reading(&mut meter, "demand_real_max", later),
    );
    assert!(running > 100.0 && highest >= running);
}

#[test]
fn pulses_and_events_are_counted_since_they_were_cleared() {
    let mut meter = meter();
    assert_eq!(operate(&mut meter, 20, now()), None);
    assert_eq!(operate(&mut meter, 31, now()), None);
    assert_eq!(shown(&mut meter, "pulse_input_total", now()), "0");
    assert_eq!(shown(&mut meter, "event_count", now()), "0");
    assert_eq!(shown(&mut meter, "event_cleared_date", now()), "2026-05-04");
    let later = now() + seconds(600);
    assert_eq!(shown(&mut meter, "pulse_input_1", later), "30");
    assert_eq!(
        shown(&mut meter, "pulse_count_cleared_time", later),
        "08:00:00.250"
    );
}

#[test]
fn everything_cleared_the_laws_of_the_meter_still_hold() {
    let mut meter = meter();
    for operation in (14..=20).chain([31, 34, 35]) {
        assert_eq!(operate(&mut meter, operation, now()), None);
    }
    every_identity_holds_when_read(&mut meter, now());
    every_identity_holds_when_read(&mut meter, now() + seconds(5000));
}

#[test]
fn factory_settings_come_back_in_two_steps_and_what_was_written_is_gone() {
    let mut meter = meter();
    let before = read(&mut meter, 0x1000, 125, now());
    assert_eq!(write(&mut meter, 0x1050, 800, now()), None);
    assert_eq!(
        write_many(&mut meter, 0x1000, &[0x4142, 0x4344], now()),
        None
    );
    let written = read(&mut meter, 0x1000, 125, now());
    assert_ne!(written, before);
    // The second step alone, and with something in between.
    assert_eq!(operate(&mut meter, 24, now()), Some(3));
    assert_eq!(operate(&mut meter, 25, now()), None);
    assert_eq!(operate(&mut meter, 1, now()), None);
    assert_eq!(operate(&mut meter, 24, now()), Some(3));
    assert_eq!(read(&mut meter, 0x1000, 125, now()), written);
    assert_eq!(operate(&mut meter, 25, now()), None);
    assert_eq!(operate(&mut meter, 24, now()), None);
    assert_eq!(read(&mut meter, 0x1000, 125, now()), before);
}

#[test]
fn another_address_holds_from_the_next_request_on() {
    let mut meter = meter();
    let request = sealed(&[&[17][..], &many(0x1018, &[200])].concat());
    let reply = sealed(&[17, 16, 0x10, 0x18, 0, 1]);
    assert_eq!(answer(&mut meter, &request, now()), Some(reply));
    assert_eq!(answer(&mut meter, &request, now()), None);
    assert_eq!(meter.unit().get(), 200);
    assert_eq!(shown(&mut meter, "modbus_address", now()), "200");
    assert_eq!(write(&mut meter, 0x1018, 0, now()), Some(3));
    assert_eq!(write(&mut meter, 0x1018, 256, now()), Some(3));
}

#[test]
fn a_broadcast_of_a_function_that_it_obeys_for_itself_alone_changes_nothing() {
    let mut meter = meter();
    // Function 06 is not among those of the manual.
    assert_eq!(
        answer(&mut meter, &sealed(&[0, 6, 0x10, 0x50, 3, 0x20]), now()),
        None
    );
    assert_eq!(shown(&mut meter, "ct_primary", now()), "600");
    let store = sealed(&[&[0][..], &many(0x1050, &[800])].concat());
    assert_eq!(answer(&mut meter, &store, now()), None);
    assert_eq!(shown(&mut meter, "ct_primary", now()), "800");
}
