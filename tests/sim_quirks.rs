//! What simulated meters do that only some real ones do, on a meter made for it.

use std::ops::RangeInclusive;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use jiff::Timestamp;
use meterpoll::codec::rtu::{Hex, check};
use meterpoll::codec::{RegisterRange, Unit, UnitRange};
use meterpoll::profile::load::load;
use meterpoll::sim::{Content, Measured, Meter, Model};

const PROFILE: &str = r#"
name = "quirks"
title = "A meter of quirks"
manual = "none"
limits = { functions = [3, 4, 6, 8], read_registers = 11, table_registers = 32 }
points = [
  { name = "first", address = 0x0008, type = "i32", order = "CDAB" },
  { name = "second", address = 0x000A, type = "i32", order = "CDAB" },
  { name = "code", address = 0x000B, type = "u16", alone = true },
  { name = "third", address = 0x000C, type = "i32", order = "CDAB" },
  { name = "input", address = 0x0010, type = "u16", function = 4 },
  { name = "version", address = 0x0018, type = "u32", alone = true },
  { name = "revision", address = 0x001A, type = "u16", alone = true },
  { name = "last", address = 0x001F, type = "u16" },
  { name = "next", address = 0x0020, type = "u16" },
  { name = "reset", address = 0x0021, type = "u16", access = "write" },
]
"#;

/// Registers 0030 to 0033 can be read although no point names them; it is busy in the last of them.
struct Quirks;

impl Model for Quirks {
    fn areas(&self) -> &[RangeInclusive<u16>] {
        &[0x0030..=0x0033]
    }

    fn is_busy(&self, range: RegisterRange, now: Timestamp) -> bool {
        range.end() == 0x0034 && now.as_second() % 2 == 1
    }

    fn measure(&self, _now: Timestamp) -> Box<dyn Measured + '_> {
        Box::new(Quirks)
    }
}

impl Measured for Quirks {
    fn content(&self, point: &str) -> Option<Content> {
        Some(Content::Number(match point {
            "first" => 0x0001_0002,
            "second" => 0x0003_0004,
            "third" => 0x0005_0006,
            "code" => 57,
            "input" => 7,
            "version" => 0x0008_0009,
            "revision" => 10,
            "last" => 11,
            "next" => 12,
            _ => return None,
        }))
    }
}

fn unit() -> Unit {
    Unit::new(1, UnitRange::Standard).unwrap()
}

fn quirks() -> Meter {
    Meter::new(unit(), || {
        let profile = load("quirks.toml", PROFILE).unwrap();
        (profile, Box::new(Quirks))
    })
}

/// A frame with a right CRC: `body` is the unit and the data unit.
fn sealed(body: &[u8]) -> Vec<u8> {
    [body, &check(body)].concat()
}

/// The answer to a data unit in an even second of the day, without unit and CRC.
fn answer_to(data_unit: &[u8]) -> String {
    answer_at(Timestamp::UNIX_EPOCH, data_unit)
}

fn answer_at(now: Timestamp, data_unit: &[u8]) -> String {
    let request = sealed(&[&[1], data_unit].concat());
    let answer = quirks().answer(&request, now).unwrap();
    let bytes = answer.as_bytes();
    Hex(&bytes[1..bytes.len() - 2]).to_string()
}

/// The answer to a read with function 03.
fn read(start: u16, count: u16) -> String {
    let [[a, b], [c, d]] = [start, count].map(u16::to_be_bytes);
    answer_to(&[0x03, a, b, c, d])
}

#[test]
fn a_read_of_a_point_that_is_alone_gives_that_point() {
    assert_eq!(read(0x000B, 1), "03 02 00 39");
    assert_eq!(read(0x0018, 2), "03 04 00 08 00 09");
    assert_eq!(read(0x001A, 1), "03 02 00 0A");
}

#[test]
fn registers_that_a_point_shares_with_one_that_is_alone_are_its_own_in_longer_reads() {
    assert_eq!(read(0x000A, 2), "03 04 00 04 00 03");
    assert_eq!(read(0x0008, 4), "03 08 00 02 00 01 00 04 00 03");
    assert_eq!(read(0x000A, 4), "03 08 00 04 00 03 00 06 00 05");
    // Also where the block begins between its two words.
    assert_eq!(read(0x000B, 3), "03 06 00 03 00 06 00 05");
    assert_eq!(read(0x000A, 1), "03 02 00 04");
}

#[test]
fn registers_of_a_point_that_is_alone_and_shares_none_are_in_no_other_read() {
    for (start, count) in [(0x0018, 1), (0x0019, 1), (0x0019, 2), (0x0018, 3)] {
        assert_eq!(read(start, count), "83 02", "0x{start:04X}+{count}");
    }
}

#[test]
fn registers_that_no_point_names_cannot_be_read_outside_of_the_areas() {
    for (start, count) in [
        (0x0007, 1),
        (0x0007, 2),
        (0x000D, 2),
        (0x000E, 1),
        (0x0032, 3),
        (0xFFFF, 1),
    ] {
        assert_eq!(read(start, count), "83 02", "0x{start:04X}+{count}");
    }
    assert_eq!(read(0x0030, 3), "03 06 00 00 00 00 00 00");
    assert_eq!(read(0x0032, 2), "03 04 00 00 00 00");
}

#[test]
fn registers_that_are_written_only_cannot_be_read() {
    assert_eq!(read(0x0020, 1), "03 02 00 0C");
    assert_eq!(read(0x0021, 1), "83 02");
    assert_eq!(read(0x0020, 2), "83 02");
}

#[test]
fn a_read_does_not_cross_the_border_of_a_table() {
    assert_eq!(read(0x001F, 1), "03 02 00 0B");
    assert_eq!(read(0x0020, 1), "03 02 00 0C");
    assert_eq!(read(0x001F, 2), "83 02");
}

#[test]
fn a_point_of_one_function_is_not_there_for_the_other() {
    assert_eq!(answer_to(&[0x04, 0x00, 0x10, 0x00, 0x01]), "04 02 00 07");
    assert_eq!(answer_to(&[0x03, 0x00, 0x10, 0x00, 0x01]), "83 02");
}

#[test]
fn too_many_registers_are_an_illegal_value_wherever_they_are() {
    assert_eq!(read(0x0000, 12), "83 03");
    assert_eq!(read(0xFF00, 125), "83 03");
    assert_eq!(read(0x0000, 11), "83 02");
}

#[test]
fn functions_that_the_profile_does_not_list_are_illegal() {
    assert_eq!(answer_to(&[0x07]), "87 01");
    assert_eq!(answer_to(&[0x10, 0, 8, 0, 1, 2, 0, 0]), "90 01");
    assert_eq!(answer_to(&[0x06, 0, 8, 0, 1]), "86 02");
    assert_eq!(answer_to(&[0x14, 0, 8, 0, 1]), "94 01");
}

#[test]
fn loopback_returns_any_word_but_knows_no_other_sub_function() {
    assert_eq!(answer_to(&[0x08, 0, 0, 0xA5, 0x37]), "08 00 00 A5 37");
    assert_eq!(answer_to(&[0x08, 0, 1, 0xA5, 0x37]), "88 03");
}

#[test]
fn a_busy_meter_says_so_to_reads_and_writes_of_the_registers_it_is_busy_with() {
    let now = Timestamp::from_second(1).unwrap();
    assert_eq!(answer_at(now, &[0x03, 0x00, 0x33, 0x00, 0x01]), "83 06");
    assert_eq!(answer_at(now, &[0x04, 0x00, 0x30, 0x00, 0x04]), "84 06");
    assert_eq!(answer_at(now, &[0x06, 0x00, 0x33, 0x00, 0x01]), "86 06");
    assert_eq!(
        answer_at(now, &[0x03, 0x00, 0x30, 0x00, 0x01]),
        "03 02 00 00"
    );
    assert_eq!(read(0x0033, 1), "03 02 00 00");
    // A request that it would never take is told of all the same.
    assert_eq!(answer_at(now, &[0x03, 0x00, 0x28, 0x00, 0x0C]), "83 03");
}

#[test]
fn a_meter_is_made_when_it_is_first_asked() {
    let is_made = Arc::new(AtomicBool::new(false));
    let making = Arc::clone(&is_made);
    let mut meter = Meter::new(unit(), move || {
        making.store(true, Ordering::SeqCst);
        (load("quirks.toml", PROFILE).unwrap(), Box::new(Quirks))
    });
    let loopback = [0x08, 0x00, 0x00, 0x00, 0x00];
    for other in [0, 2] {
        let request = sealed(&[&[other], &loopback[..]].concat());
        assert!(meter.answer(&request, Timestamp::UNIX_EPOCH).is_none());
    }
    assert!(!is_made.load(Ordering::SeqCst));
    let request = sealed(&[&[1], &loopback[..]].concat());
    assert!(meter.answer(&request, Timestamp::UNIX_EPOCH).is_some());
    assert!(is_made.load(Ordering::SeqCst));
}
