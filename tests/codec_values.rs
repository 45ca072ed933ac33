//! Registers as values: the examples of the meters' manuals, and what no register can hold.

use jiff::civil::{date, time};
use meterpoll::codec::value::{ByteOrder, Raw, RegisterType, ValueError, decode, encode_integer};

const ORDERS: [ByteOrder; 4] = [
    ByteOrder::Abcd,
    ByteOrder::Cdab,
    ByteOrder::Badc,
    ByteOrder::Dcba,
];

fn plain(kind: RegisterType, registers: &[u16]) -> Result<Raw, ValueError> {
    decode(kind, ByteOrder::Abcd, registers)
}

fn text(characters: u8, registers: &[u16]) -> String {
    match plain(RegisterType::Ascii(characters), registers) {
        Ok(Raw::Text(text)) => text,
        other => panic!("{other:?}"),
    }
}

const fn impossible(part: &'static str, found: u16) -> ValueError {
    ValueError::Impossible { part, found }
}

#[test]
fn a_single_float_is_the_same_number_in_each_of_the_four_orders() {
    // 123456.0 is 47 F1 20 00, bytes A to D.
    let table = [
        (ByteOrder::Abcd, [0x47F1, 0x2000]),
        (ByteOrder::Cdab, [0x2000, 0x47F1]),
        (ByteOrder::Badc, [0xF147, 0x0020]),
        (ByteOrder::Dcba, [0x0020, 0xF147]),
    ];
    for (order, registers) in table {
        let value = decode(RegisterType::F32, order, &registers);
        assert_eq!(value, Ok(Raw::Single(123_456.0)), "{order}");
    }
}

#[test]
fn a_double_float_is_the_same_number_in_each_of_the_four_orders() {
    // 123456.0 is 40 FE 24 00 00 00 00 00; 1 more in the last place shows where the end is.
    let number = f64::from_bits(0x40FE_2400_0000_0001);
    let table = [
        (ByteOrder::Abcd, [0x40FE, 0x2400, 0x0000, 0x0001]),
        (ByteOrder::Cdab, [0x0001, 0x0000, 0x2400, 0x40FE]),
        (ByteOrder::Badc, [0xFE40, 0x0024, 0x0000, 0x0100]),
        (ByteOrder::Dcba, [0x0100, 0x0000, 0x0024, 0xFE40]),
    ];
    for (order, registers) in table {
        let value = decode(RegisterType::F64, order, &registers);
        assert_eq!(value, Ok(Raw::Double(number)), "{order}");
    }
}

#[test]
fn floats_keep_infinities_and_nan() {
    let single = |high| plain(RegisterType::F32, &[high, 0]);
    assert_eq!(single(0x7F80), Ok(Raw::Single(f32::INFINITY)));
    assert_eq!(single(0xFF80), Ok(Raw::Single(f32::NEG_INFINITY)));
    assert!(matches!(single(0x7FC0), Ok(Raw::Single(number)) if number.is_nan()));
    let double = plain(RegisterType::F64, &[0x7FF8, 0, 0, 0]);
    assert!(matches!(double, Ok(Raw::Double(number)) if number.is_nan()));
}

#[test]
fn integers_of_every_width_have_their_sign() {
    let table: [(RegisterType, &[u16], i128); 12] = [
        (RegisterType::U16, &[0xFFFF], 65_535),
        (RegisterType::I16, &[0xFFFF], -1),
        (RegisterType::I16, &[0x8000], -32_768),
        (RegisterType::I16, &[0x7FFF], 32_767),
        (RegisterType::U32, &[0xFFFF, 0xFFFF], 4_294_967_295),
        (RegisterType::I32, &[0xFFFF, 0xFFFF], -1),
        (RegisterType::I32, &[0x8000, 0], -2_147_483_648),
        (RegisterType::U64, &[0xFFFF; 4], 18_446_744_073_709_551_615),
        (RegisterType::I64, &[0xFFFF; 4], -1),
        (
            RegisterType::I64,
            &[0x8000, 0, 0, 0],
            -9_223_372_036_854_775_808,
        ),
        // PQM 02F0, format F4 (3.6x edition, pages 332 and 333): 51911.21 and -129161.01 kW.
        (RegisterType::I32, &[0x004F, 0x35D1], 5_191_121),
        (RegisterType::I32, &[0xFF3A, 0xEA7B], -12_916_101),
    ];
    for (kind, registers, number) in table {
        assert_eq!(plain(kind, registers), Ok(Raw::Integer(number)), "{kind}");
    }
}

#[test]
fn an_em21_power_has_its_low_word_first() {
    // -1500.0 W in steps of 0.1 W.
    let value = decode(RegisterType::I32, ByteOrder::Cdab, &[0xC568, 0xFFFF]);
    assert_eq!(value, Ok(Raw::Integer(-15_000)));
}

#[test]
fn a_64_bit_integer_has_its_words_and_bytes_where_the_order_says() {
    let table = [
        (ByteOrder::Abcd, [0x0102, 0x0304, 0x0506, 0x0708]),
        (ByteOrder::Cdab, [0x0708, 0x0506, 0x0304, 0x0102]),
        (ByteOrder::Badc, [0x0201, 0x0403, 0x0605, 0x0807]),
        (ByteOrder::Dcba, [0x0807, 0x0605, 0x0403, 0x0201]),
    ];
    for (order, registers) in table {
        let number = 0x0102_0304_0506_0708;
        let value = decode(RegisterType::U64, order, &registers);
        assert_eq!(value, Ok(Raw::Integer(number)), "{order}");
        let encoded = encode_integer(RegisterType::U64, order, number);
        assert_eq!(encoded, Some(registers.to_vec()), "{order}");
    }
}

#[test]
fn one_register_swaps_its_bytes_only_where_the_order_says() {
    for (order, number) in [
        (ByteOrder::Abcd, 0x0102),
        (ByteOrder::Cdab, 0x0102),
        (ByteOrder::Badc, 0x0201),
        (ByteOrder::Dcba, 0x0201),
    ] {
        let hex = decode(RegisterType::Hex, order, &[0x0102]);
        assert_eq!(hex, Ok(Raw::Word(number)), "{order}");
        let bits = decode(RegisterType::Bits, order, &[0x0102]);
        assert_eq!(bits, Ok(Raw::Word(number)), "{order}");
        let unsigned = decode(RegisterType::U16, order, &[0x0102]);
        assert_eq!(unsigned, Ok(Raw::Integer(i128::from(number))), "{order}");
    }
}

#[test]
fn a_mod10000_pair_is_four_decimal_digits_a_word() {
    // PM290 energies: low word first.
    let pair = |low, high| decode(RegisterType::Mod10000, ByteOrder::Cdab, &[low, high]);
    assert_eq!(pair(4321, 3), Ok(Raw::Integer(34_321)));
    assert_eq!(pair(0, 0), Ok(Raw::Integer(0)));
    assert_eq!(pair(9999, 9999), Ok(Raw::Integer(99_999_999)));
    let high_first = plain(RegisterType::Mod10000, &[3, 4321]);
    assert_eq!(high_first, Ok(Raw::Integer(34_321)));
}

#[test]
fn a_mod10000_word_of_10000_or_more_is_an_error_in_either_place() {
    let pair = |low, high| decode(RegisterType::Mod10000, ByteOrder::Cdab, &[low, high]);
    assert_eq!(pair(10_000, 3), Err(impossible("low word", 10_000)));
    assert_eq!(pair(3, 10_000), Err(impossible("high word", 10_000)));
    assert_eq!(pair(0xFFFF, 0), Err(impossible("low word", 0xFFFF)));
    assert_eq!(
        impossible("low word", 10_000).to_string(),
        "low word is 10000"
    );
}

#[test]
fn a_letter_is_1_for_a_to_26_for_z() {
    for (number, letter) in (1..=26).zip('A'..='Z') {
        let value = plain(RegisterType::Letter, &[number]);
        assert_eq!(value, Ok(Raw::Text(letter.to_string())));
    }
    for number in [0, 27, 0x0100, 0x0101, 0xFFFF] {
        let value = plain(RegisterType::Letter, &[number]);
        assert_eq!(value, Err(impossible("letter", number)));
    }
}

#[test]
fn a_date_is_month_and_day_then_year() {
    let read = |month_day, year| plain(RegisterType::Date, &[month_day, year]);
    // PQM table 7-9 (3.6x edition, page 194).
    assert_eq!(read(0x0A1D, 0x07CD), Ok(Raw::Date(date(1997, 10, 29))));
    assert_eq!(read(0x021D, 2024), Ok(Raw::Date(date(2024, 2, 29))));
    assert_eq!(read(0x0C1F, 9999), Ok(Raw::Date(date(9999, 12, 31))));
    assert_eq!(read(0x0101, 1), Ok(Raw::Date(date(1, 1, 1))));
}

#[test]
fn a_day_that_does_not_exist_is_an_error() {
    for (month_day, year) in [
        (0x021E, 2024), // February 30
        (0x021D, 2023), // February 29 of a common year
        (0x041F, 2024), // April 31
        (0x0D01, 2024), // month 13
        (0x0001, 2024), // month 0
        (0x0100, 2024), // day 0
        (0x0120, 2024), // January 32
        (0xFFFF, 2024), // bytes above 127
        (0x0000, 2024), // no month and no day in a year
    ] {
        let value = plain(RegisterType::Date, &[month_day, year]);
        assert_eq!(value, Err(impossible("month and day", month_day)));
    }
}

#[test]
fn a_year_of_0_or_of_more_than_four_digits_is_named_as_the_error() {
    for year in [0, 10_000, 0x7FFF, 0x8000, 0xFFFF] {
        let value = plain(RegisterType::Date, &[0x0A1D, year]);
        assert_eq!(value, Err(impossible("year", year)));
    }
}

#[test]
fn a_date_of_zeros_is_unset_in_every_order() {
    for order in ORDERS {
        let value = decode(RegisterType::Date, order, &[0, 0]);
        assert_eq!(value, Err(ValueError::Unset), "{order}");
    }
    assert_eq!(ValueError::Unset.to_string(), "never set");
}

#[test]
fn a_time_is_hour_and_minute_then_milliseconds_in_the_minute() {
    let read = |hour_minute, ms| plain(RegisterType::Time, &[hour_minute, ms]);
    // PQM table 7-9 (3.6x edition, page 194).
    let printed = time(13, 27, 10, 15_000_000);
    assert_eq!(read(0x0D1B, 0x271F), Ok(Raw::Time(printed)));
    let last = time(23, 59, 59, 999_000_000);
    assert_eq!(read(0x173B, 59_999), Ok(Raw::Time(last)));
    assert_eq!(read(0, 0), Ok(Raw::Time(time(0, 0, 0, 0))));
}

#[test]
fn a_time_that_no_clock_shows_is_an_error() {
    let read = |hour_minute, ms| plain(RegisterType::Time, &[hour_minute, ms]);
    assert_eq!(
        read(0, 60_000),
        Err(impossible("milliseconds in the minute", 60_000))
    );
    assert_eq!(read(0x1800, 0), Err(impossible("hour", 24)));
    assert_eq!(read(0x003C, 0), Err(impossible("minute", 60)));
    assert_eq!(read(0xFF00, 0), Err(impossible("hour", 255)));
}

#[test]
fn text_is_two_characters_a_register_high_byte_first() {
    assert_eq!(text(4, &[0x5051, 0x4D32]), "PQM2");
    // EM24 serial number: 13 characters, the last low byte is no part of it.
    let serial = [0x4142, 0x4344, 0x4546, 0x4748, 0x494A, 0x4B4C, 0x4D21];
    assert_eq!(text(13, &serial), "ABCDEFGHIJKLM");
}

#[test]
fn text_runs_in_address_order_and_only_its_bytes_swap() {
    let read = |order| decode(RegisterType::Ascii(3), order, &[0x4142, 0x4344]);
    let straight = Ok(Raw::Text("ABC".to_owned()));
    let swapped = Ok(Raw::Text("BAD".to_owned()));
    assert_eq!(read(ByteOrder::Abcd), straight);
    assert_eq!(read(ByteOrder::Cdab), straight);
    assert_eq!(read(ByteOrder::Badc), swapped);
    assert_eq!(read(ByteOrder::Dcba), swapped);
}

#[test]
fn text_loses_trailing_spaces_and_nuls_and_no_others() {
    assert_eq!(text(4, &[0x4120, 0x2020]), "A");
    assert_eq!(text(4, &[0x4100, 0x0000]), "A");
    assert_eq!(text(4, &[0x4100, 0x2000]), "A");
    assert_eq!(text(4, &[0x2041, 0x2042]), " A B");
    assert_eq!(text(4, &[0x4100, 0x4220]), "A\0B");
    assert_eq!(text(4, &[0, 0]), "");
    assert_eq!(text(4, &[0x2020, 0x2020]), "");
}

#[test]
fn text_shows_bytes_that_are_not_ascii_in_hex() {
    assert_eq!(text(4, &[0x41E9, 0xFF42]), "A\\xE9\\xFFB");
    assert_eq!(text(2, &[0x7F80]), "\u{7F}\\x80");
}

#[test]
fn a_wrong_number_of_registers_is_an_error_for_every_type() {
    // Type, registers it takes.
    let table = [
        (RegisterType::U16, 1),
        (RegisterType::I16, 1),
        (RegisterType::U32, 2),
        (RegisterType::I32, 2),
        (RegisterType::U64, 4),
        (RegisterType::I64, 4),
        (RegisterType::F32, 2),
        (RegisterType::F64, 4),
        (RegisterType::Hex, 1),
        (RegisterType::Bits, 1),
        (RegisterType::Ascii(1), 1),
        (RegisterType::Ascii(2), 1),
        (RegisterType::Ascii(3), 2),
        (RegisterType::Ascii(250), 125),
        (RegisterType::Mod10000, 2),
        (RegisterType::Letter, 1),
        (RegisterType::Time, 2),
        (RegisterType::Date, 2),
    ];
    for (kind, expected) in table {
        assert_eq!(kind.registers(), expected, "{kind}");
        for found in (0..=126).filter(|found| *found != usize::from(expected)) {
            let value = plain(kind, &vec![0x0101; found]);
            let error = ValueError::Length { found, expected };
            assert_eq!(value, Err(error), "{kind}");
        }
    }
}

#[test]
fn numbers_outside_a_type_are_not_encoded() {
    // Type, lowest, highest.
    let table = [
        (RegisterType::U16, 0, 65_535),
        (RegisterType::I16, -32_768, 32_767),
        (RegisterType::U32, 0, 4_294_967_295),
        (RegisterType::I32, -2_147_483_648, 2_147_483_647),
        (RegisterType::U64, 0, 18_446_744_073_709_551_615),
        (
            RegisterType::I64,
            -9_223_372_036_854_775_808,
            9_223_372_036_854_775_807,
        ),
        (RegisterType::Hex, 0, 65_535),
        (RegisterType::Bits, 0, 65_535),
        (RegisterType::Mod10000, 0, 99_999_999),
        (RegisterType::Letter, 1, 26),
    ];
    for (kind, lowest, highest) in table {
        for order in ORDERS {
            assert!(encode_integer(kind, order, lowest).is_some(), "{kind}");
            assert!(encode_integer(kind, order, highest).is_some(), "{kind}");
            for number in [lowest - 1, highest + 1, i128::MIN, i128::MAX] {
                assert_eq!(encode_integer(kind, order, number), None, "{kind} {number}");
            }
        }
    }
    for kind in [
        RegisterType::F32,
        RegisterType::F64,
        RegisterType::Ascii(2),
        RegisterType::Time,
        RegisterType::Date,
    ] {
        assert_eq!(encode_integer(kind, ByteOrder::Abcd, 1), None, "{kind}");
    }
}

#[test]
fn types_and_orders_read_back_from_their_names() {
    let names = "u16 i16 u32 i32 u64 i64 f32 f64 hex bits mod10000 letter time date \
                 ascii/1 ascii/13 ascii/250";
    for name in names.split(' ') {
        let kind: RegisterType = name.parse().unwrap();
        assert_eq!(kind.to_string(), name);
    }
    for name in ["ABCD", "CDAB", "BADC", "DCBA"] {
        let order: ByteOrder = name.parse().unwrap();
        assert_eq!(order.to_string(), name);
        assert_eq!(name.to_lowercase().parse(), Ok(order));
    }
}

#[test]
fn names_of_no_type_and_no_order_are_rejected() {
    for name in [
        "",
        "u8",
        "U16",
        "ascii",
        "ascii/0",
        "ascii/251",
        "ascii/-1",
        "ascii/256",
    ] {
        assert!(name.parse::<RegisterType>().is_err(), "{name}");
    }
    let error = "ACBD".parse::<ByteOrder>().unwrap_err();
    assert_eq!(
        error.to_string(),
        "unknown byte order 'ACBD', expected ABCD, CDAB, BADC or DCBA"
    );
}
