//! Raw registers as they are typed, and what is said about them when they are none.

use std::str::FromStr;

use meterpoll::codec::value::{ByteOrder, RegisterType};
use meterpoll::codec::{ReadFunction, RegisterRange};
use meterpoll::profile::Point;
use meterpoll::profile::scaling::Scaling;
use meterpoll::profile::selector::{Numbering, Reading, SelectError, select};
use rust_decimal::Decimal;

fn chosen(selector: &str, numbering: Numbering) -> Result<Vec<Point>, SelectError> {
    let reading = Reading {
        numbering,
        ..Reading::default()
    };
    select(&[selector.to_owned()], reading)
}

fn raw(selector: &str, numbering: Numbering) -> Vec<Point> {
    chosen(selector, numbering).unwrap_or_else(|error| panic!("{error}"))
}

fn complaint(selector: &str, numbering: Numbering) -> String {
    match chosen(selector, numbering) {
        Ok(points) => panic!("chosen: {points:?}"),
        Err(error) => error.to_string(),
    }
}

fn raw_complaint(selector: &str) -> String {
    complaint(selector, Numbering::Protocol)
}

fn modicon_complaint(selector: &str) -> String {
    complaint(selector, Numbering::Modicon)
}

fn range(start: u16, count: u16) -> RegisterRange {
    RegisterRange::new(start, count).expect("a range")
}

/// A raw register as nothing but its address, type and order say.
fn plain(start: u16, kind: RegisterType, order: ByteOrder) -> Point {
    Point::raw(range(start, kind.registers()), kind, order)
}

#[test]
fn a_raw_register_is_named_after_its_address_in_hex() {
    for selector in ["0x006B", "0X6b", "107", "00107"] {
        let points = raw(selector, Numbering::Protocol);
        assert_eq!(
            points,
            [plain(0x6B, RegisterType::U16, ByteOrder::Abcd)],
            "{selector}"
        );
        assert_eq!(points[0].name, "0x006B");
    }
}

#[test]
fn a_count_chooses_so_many_registers() {
    let expected = [0x6B, 0x6C, 0x6D].map(|start| plain(start, RegisterType::U16, ByteOrder::Abcd));
    assert_eq!(raw("0x6B+3", Numbering::Protocol), expected);
    assert_eq!(raw("107+0x3", Numbering::Protocol), expected);
}

#[test]
fn a_count_can_be_more_than_one_read_carries() {
    let points = raw("0x0000+1000", Numbering::Protocol);
    assert_eq!(points.len(), 1000);
    assert_eq!(points[999].range, range(999, 1));
}

#[test]
fn type_order_factor_and_unit_are_taken() {
    let expected = Point {
        scaling: Scaling::Times(Decimal::from_str("0.1").expect("a decimal")),
        unit: Some("kWh".to_owned()),
        ..plain(0x11F, RegisterType::U32, ByteOrder::Cdab)
    };
    for selector in ["0x11F:u32/CDAB*0.1=kWh", "287+2:u32/cdab*0.1=kWh"] {
        assert_eq!(
            raw(selector, Numbering::Protocol),
            std::slice::from_ref(&expected),
            "{selector}"
        );
    }
}

#[test]
fn every_type_takes_its_registers() {
    for (name, kind, registers) in [
        ("u16", RegisterType::U16, 1),
        ("i16", RegisterType::I16, 1),
        ("u32", RegisterType::U32, 2),
        ("i32", RegisterType::I32, 2),
        ("u64", RegisterType::U64, 4),
        ("i64", RegisterType::I64, 4),
        ("f32", RegisterType::F32, 2),
        ("f64", RegisterType::F64, 4),
        ("hex", RegisterType::Hex, 1),
        ("bits", RegisterType::Bits, 1),
        ("ascii/7", RegisterType::Ascii(7), 4),
        ("mod10000", RegisterType::Mod10000, 2),
    ] {
        let points = raw(&format!("0x10:{name}"), Numbering::Protocol);
        assert_eq!(points, [plain(0x10, kind, ByteOrder::Abcd)], "{name}");
        assert_eq!(points[0].range, range(0x10, registers), "{name}");
    }
}

#[test]
fn text_takes_a_length_and_an_order() {
    assert_eq!(
        raw("0x10:ascii/8", Numbering::Protocol),
        [plain(0x10, RegisterType::Ascii(8), ByteOrder::Abcd)]
    );
    assert_eq!(
        raw("0x10:ascii/8/BADC", Numbering::Protocol),
        [plain(0x10, RegisterType::Ascii(8), ByteOrder::Badc)]
    );
}

#[test]
fn a_count_of_registers_is_cut_into_values_of_the_type() {
    let starts: Vec<u16> = raw("0x0000+10:u32", Numbering::Protocol)
        .iter()
        .map(|point| point.range.start().get())
        .collect();
    assert_eq!(starts, [0, 2, 4, 6, 8]);
    assert_eq!(
        raw_complaint("0x0+3:u32"),
        "'0x0+3:u32': 3 registers are no whole number of u32 values, 2 registers each"
    );
    assert_eq!(
        raw_complaint("0x0+0"),
        "'0x0+0': 0 registers are nothing to read"
    );
}

#[test]
fn the_last_address_is_the_end() {
    assert_eq!(
        raw("0xFFFF", Numbering::Protocol),
        [plain(0xFFFF, RegisterType::U16, ByteOrder::Abcd)]
    );
    assert_eq!(
        raw_complaint("0xFFFF+2"),
        "'0xFFFF+2': 2 registers from 0xFFFF run past 0xFFFF, the last address"
    );
    assert_eq!(
        raw_complaint("0xFFFE:u64"),
        "'0xFFFE:u64': 4 registers from 0xFFFE run past 0xFFFF, the last address"
    );
}

#[test]
fn what_is_no_number_is_named() {
    for (selector, number) in [
        ("65536", "65536"),
        ("0x10000", "0x10000"),
        ("0x", "0x"),
        ("0x6G", "0x6G"),
        ("107a", "107a"),
        ("107+", ""),
        ("107++3", "+3"),
        ("107+0x+3", "0x+3"),
        ("107+three", "three"),
        ("107+65536", "65536"),
        ("1 07", "1 07"),
    ] {
        let whole = if selector == number {
            String::new()
        } else {
            format!("'{selector}': ")
        };
        assert_eq!(
            raw_complaint(selector),
            format!("{whole}'{number}' is no number from 0 to 65535, or 0x0 to 0xFFFF")
        );
    }
}

#[test]
fn an_unknown_type_or_order_brings_up_the_known_ones() {
    const TYPES: &str = "u16, i16, u32, i32, u64, i64, f32, f64, hex, bits, mod10000, letter, \
                         time, date or ascii/N with N characters, 1 to 250";
    for (selector, found) in [
        ("0x0:u8", "u8"),
        ("0x0:U16", "U16"),
        ("0x0:", ""),
        ("0x0:ascii", "ascii"),
        ("0x0:ascii/0", "ascii/0"),
        ("0x0:ascii/251", "ascii/251"),
        ("0x0:ascii/BADC", "ascii/BADC"),
        ("0x0:u8/CDAB", "u8"),
    ] {
        assert_eq!(
            raw_complaint(selector),
            format!("'{selector}': unknown type '{found}', expected {TYPES}")
        );
    }
    for (selector, found) in [("0x0:u32/ABDC", "ABDC"), ("0x0:u32/", "")] {
        assert_eq!(
            raw_complaint(selector),
            format!(
                "'{selector}': unknown byte order '{found}', expected ABCD, CDAB, BADC or DCBA"
            )
        );
    }
}

#[test]
fn a_factor_is_a_number_other_than_0_on_a_number() {
    for (selector, factor) in [
        ("0x0*0", "0"),
        ("0x0*", ""),
        ("0x0*tenth", "tenth"),
        ("0x0*0.1:u32", "0.1:u32"),
    ] {
        assert_eq!(
            raw_complaint(selector),
            format!("'{selector}': '{factor}' is no factor, such as 0.1")
        );
    }
    for kind in ["ascii/8", "hex", "bits", "time"] {
        let selector = format!("0x0:{kind}*0.1");
        assert_eq!(
            raw_complaint(&selector),
            format!("'{selector}': type {kind} takes no factor")
        );
    }
    let negative = raw("0x0:i16*-0.001", Numbering::Protocol);
    assert_eq!(negative[0].constant_scale(), Some(Decimal::new(-1, 3)));
}

#[test]
fn modicon_numbers_are_addresses_and_functions() {
    let input = Some(ReadFunction::InputRegisters);
    let holding = Some(ReadFunction::HoldingRegisters);
    for (selector, address, function) in [
        ("30001", 0, input),
        ("39999", 9998, input),
        ("300001", 0, input),
        ("365536", 65_535, input),
        ("40001", 0, holding),
        ("49999", 9998, holding),
        ("400001", 0, holding),
        ("465536", 65_535, holding),
        // What is in hex stays an address.
        ("0x006B", 107, None),
    ] {
        let expected = Point {
            function,
            ..plain(address, RegisterType::U16, ByteOrder::Abcd)
        };
        assert_eq!(raw(selector, Numbering::Modicon), [expected], "{selector}");
    }
}

#[test]
fn a_modicon_number_takes_count_and_type() {
    let points = raw("40108+4:u32/CDAB", Numbering::Modicon);
    let places: Vec<_> = points
        .iter()
        .map(|point| (point.range, point.function))
        .collect();
    let function = Some(ReadFunction::HoldingRegisters);
    assert_eq!(
        places,
        [(range(107, 2), function), (range(109, 2), function)]
    );
}

#[test]
fn what_is_no_modicon_number_is_told_what_is() {
    for number in [
        "107", "40000", "30000", "400000", "465537", "365537", "00001", "10001", "50001",
        "4000001", "4x001",
    ] {
        assert_eq!(
            modicon_complaint(number),
            format!(
                "'{number}' is no register in Modicon numbering: 30001 to 39999 or \
                 300001 to 365536 for input registers, 40001 to 49999 or 400001 to 465536 for \
                 holding registers"
            )
        );
    }
    assert_eq!(
        modicon_complaint("465536+2"),
        "'465536+2': 2 registers from 0xFFFF run past 0xFFFF, the last address"
    );
}

#[test]
fn without_modicon_numbering_40001_is_an_address() {
    let points = raw("40001", Numbering::Protocol);
    assert_eq!(points, [plain(0x9C41, RegisterType::U16, ByteOrder::Abcd)]);
    assert_eq!(points[0].function, None);
}

#[test]
fn a_modicon_number_and_the_other_function_contradict_each_other() {
    let reading = Reading {
        numbering: Numbering::Modicon,
        function: Some(ReadFunction::HoldingRegisters),
        profile: None,
        ..Reading::default()
    };
    let error = select(&["30577".to_owned()], reading).expect_err("a contradiction");
    assert_eq!(
        error.to_string(),
        "'30577' is read with function 04, and function 03 was asked for"
    );
}

#[test]
fn a_factor_that_would_be_rounded_is_none() {
    let factor = "0.00000000000000000000000000019999";
    assert_eq!(
        raw_complaint(&format!("0x10*{factor}")),
        format!("'0x10*{factor}': '{factor}' is no factor, such as 0.1")
    );
}

#[test]
fn a_run_of_registers_over_one_that_is_read_alone_is_refused() {
    let em24 = meterpoll::profile::builtin::find("em24")
        .expect("it is built in")
        .profile();
    let reading = Reading {
        profile: Some(&em24),
        ..Reading::default()
    };
    let selected = |selector: &str| select(&[selector.to_owned()], reading);
    for (selector, name) in [
        ("0x000A+3", "identification_code"),
        ("0x302+2", "firmware_version_code"),
    ] {
        let error = selected(selector).expect_err("it is not clear what is meant");
        let message = format!(
            "'{selector}': the meter's {name} lies there, which is read by a request of its own"
        );
        assert_eq!(error.to_string(), message);
    }
    for clear in ["0x000B", "0x000A:i32/CDAB", "0+10", "0x000A"] {
        assert!(selected(clear).is_ok(), "{clear}");
    }
}
