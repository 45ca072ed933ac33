//! Clocks of meters are set to the time on the wall, wherever this computer is.

mod support {
    pub(crate) mod program;
}

use support::program::Program;

/// What is printed instead of being sent: the frame, or the error.
fn set_to(zone: &str, clock: &str) -> (Option<i32>, String) {
    let output = Program::new("broadcast --dry-run --meter pqm")
        .argument(format!("clock={clock}"))
        .variable("TZ", zone)
        .output();
    let printed = [output.stdout, output.stderr].concat();
    let text = String::from_utf8(printed).expect("text");
    (output.status.code(), text)
}

/// The frame that sets a PQM to this hour, minute 27 and 10000 ms, on 22 November 2026 (07EA).
fn frame(hour_day: [u8; 2], crc: &str) -> (Option<i32>, String) {
    let [hour, day] = hour_day;
    let frame = format!("00 10 00 F0 00 04 08 {hour:02X} 1B 27 10 0B {day:02X} 07 EA {crc}\n");
    (Some(0), frame)
}

#[test]
fn a_time_with_an_offset_becomes_local_time() {
    let instant = "2026-11-22T13:27:10Z";
    for (zone, hour_day, crc) in [
        ("UTC", [13, 22], "F9 A8"),
        ("Asia/Tokyo", [22, 22], "B9 17"),
        ("Europe/Vienna", [14, 22], "B9 BD"),
        ("CET-1CEST,M3.5.0,M10.5.0/3", [14, 22], "B9 BD"),
    ] {
        assert_eq!(set_to(zone, instant), frame(hour_day, crc), "{zone}");
    }
    let there = "2026-11-22T13:27:10[Asia/Tokyo]";
    assert_eq!(set_to("Europe/Vienna", there), frame([5, 22], "F8 0E"));
}

#[test]
fn a_time_without_one_is_local_time_already() {
    for clock in ["2026-11-22T13:27:10", "2026-11-22 13:27:10"] {
        for zone in ["UTC", "Asia/Tokyo"] {
            assert_eq!(set_to(zone, clock), frame([13, 22], "F9 A8"), "{zone}");
        }
    }
}

#[test]
fn now_is_the_time_on_the_wall() {
    let hour = |zone| {
        let (code, frame) = set_to(zone, "now");
        assert_eq!(code, Some(0), "{frame}");
        i32::from_str_radix(&frame[21..23], 16).expect("an hour")
    };
    // The hour can end between the two.
    let apart = (hour("Etc/GMT-9") - hour("Etc/GMT+2")).rem_euclid(24);
    assert!(apart == 11 || apart == 10, "{apart}");
}

#[test]
fn a_zone_that_is_not_known_is_no_reason_to_take_another() {
    let (code, text) = set_to("Nowhere/Land", "now");
    assert_eq!(code, Some(2), "{text}");
    assert!(
        text.starts_with("error: this computer's time zone is not known: "),
        "{text}"
    );
    assert!(
        text.ends_with("hint: set the variable TZ, to Europe/Berlin say\n"),
        "{text}"
    );
    let (code, text) = set_to("UTC", "2026-11-22T13:27:10[Nowhere/Land]");
    let problem = "error: '2026-11-22T13:27:10[Nowhere/Land]' is no time to set a clock to\n\
                   hint: give now, or a date and time such as 2026-11-22T13:27:10.015\n";
    assert_eq!((code, text.as_str()), (Some(2), problem));
}
