//! What registers mean, through the points of small profiles.

use meterpoll::profile::load::load;
use meterpoll::profile::{Missing, Point, Scales, Value};

/// The one point of a profile, with these keys after its address.
#[track_caller]
fn point(keys: &str) -> Point {
    let text = format!(
        "name = \"m\"\ntitle = \"Meter\"\nmanual = \"Manual\"\n\
         [[points]]\nname = \"a\"\naddress = 0\n{keys}\n"
    );
    let profile = load("m.toml", &text).unwrap_or_else(|error| panic!("{error}"));
    profile.points.into_iter().next().expect("one point")
}

/// What the registers read as, as it is printed.
#[track_caller]
fn shown(keys: &str, registers: &[u16]) -> String {
    match point(keys).interpret(registers, &Scales::default()) {
        Ok(value) => value.to_string(),
        Err(missing) => panic!("{keys}: {missing:?}"),
    }
}

#[track_caller]
fn missing(keys: &str, registers: &[u16]) -> Missing {
    match point(keys).interpret(registers, &Scales::default()) {
        Ok(value) => panic!("{keys}: {value}"),
        Err(missing) => missing,
    }
}

#[test]
fn the_power_examples_of_the_pqm_manual_come_out_to_the_last_digit() {
    // N333.
    let keys = "type = \"i32\"\nscale = 0.01";
    assert_eq!(shown(keys, &[0x004F, 0x35D1]), "51911.21");
    assert_eq!(shown(keys, &[0xFF3A, 0xEA7B]), "-129161.01");
}

#[test]
fn integers_keep_every_digit_at_the_ends_of_their_types() {
    for (kind, lowest, highest) in [
        ("u16", "0", "65535"),
        ("u32", "0", "4294967295"),
        ("u64", "0", "18446744073709551615"),
    ] {
        let keys = format!("type = \"{kind}\"");
        let count = usize::from(point(&keys).range.count());
        assert_eq!(shown(&keys, &vec![0; count]), lowest);
        assert_eq!(shown(&keys, &vec![0xFFFF; count]), highest);
    }
    assert_eq!(shown("type = \"i16\"", &[0x8000]), "-32768");
    assert_eq!(shown("type = \"i16\"", &[0x7FFF]), "32767");
    assert_eq!(shown("type = \"i32\"", &[0x8000, 0]), "-2147483648");
    assert_eq!(shown("type = \"i32\"", &[0x7FFF, 0xFFFF]), "2147483647");
    assert_eq!(shown("type = \"i32\"", &[0xFFFF, 0xFFFF]), "-1");
    assert_eq!(
        shown("type = \"i64\"", &[0x8000, 0, 0, 0]),
        "-9223372036854775808"
    );
}

#[test]
fn scaled_counters_of_64_bits_keep_every_digit() {
    assert_eq!(
        shown("type = \"u64\"\nscale = 0.001", &[0xFFFF; 4]),
        "18446744073709551.615"
    );
    assert_eq!(
        shown("type = \"i64\"\nscale = 0.001", &[0x8000, 0, 0, 0]),
        "-9223372036854775.808"
    );
}

#[test]
fn a_scaled_value_has_the_decimals_of_its_scale() {
    let keys = "type = \"u16\"\nscale = 0.01";
    assert_eq!(shown(keys, &[100]), "1.00");
    assert_eq!(shown(keys, &[0]), "0.00");
    assert_eq!(shown(keys, &[5]), "0.05");
    assert_eq!(shown("type = \"u16\"\nscale = 0.5", &[2]), "1.0");
    assert_eq!(shown("type = \"u16\"\nscale = 10", &[415]), "4150");
    assert_eq!(shown("type = \"u16\"\nscale = -0.1", &[1]), "-0.1");
}

#[test]
fn a_scale_with_many_digits_does_not_round() {
    assert_eq!(
        shown("type = \"u32\"\nscale = 0.2777777777777778", &[0xFFFF; 2]),
        "1193046470.8333334287770510"
    );
}

#[test]
fn each_byte_order_finds_the_same_number() {
    for (order, two, four) in [
        ("ABCD", [0x0102, 0x0304], [0x0102, 0x0304, 0x0506, 0x0708]),
        ("CDAB", [0x0304, 0x0102], [0x0708, 0x0506, 0x0304, 0x0102]),
        ("BADC", [0x0201, 0x0403], [0x0201, 0x0403, 0x0605, 0x0807]),
        ("DCBA", [0x0403, 0x0201], [0x0807, 0x0605, 0x0403, 0x0201]),
    ] {
        let keys = |kind: &str| format!("type = \"{kind}\"\norder = \"{order}\"");
        assert_eq!(shown(&keys("u32"), &two), 0x0102_0304_u32.to_string());
        assert_eq!(
            shown(&keys("u64"), &four),
            0x0102_0304_0506_0708_u64.to_string()
        );
    }
    assert_eq!(shown("type = \"u16\"\norder = \"BADC\"", &[0x0201]), "258");
    assert_eq!(shown("type = \"u16\"\norder = \"CDAB\"", &[0x0102]), "258");
    assert_eq!(
        shown("type = \"f32\"\norder = \"CDAB\"", &[0xCCCD, 0x3DCC]),
        "0.1"
    );
}

#[test]
fn a_code_with_a_label_reads_as_the_label_and_any_other_as_its_number() {
    let keys = "type = \"u16\"\nlabels = { 0 = \"off\", 1 = \"on\" }";
    assert_eq!(shown(keys, &[0]), "off");
    assert_eq!(shown(keys, &[1]), "on");
    assert_eq!(shown(keys, &[7]), "7");
    let keys = "type = \"hex\"\nlabels = { 0xFE01 = \"store\" }";
    assert_eq!(shown(keys, &[0xFE01]), "store");
    assert_eq!(shown(keys, &[0x00FD]), "0x00FD");
}

#[test]
fn bits_read_as_the_names_of_those_that_are_set() {
    let keys = "type = \"bits\"\nlabels = { 0x8 = \"control\", 0x1 = \"display\", 0x2 = \"T20\" }";
    assert_eq!(shown(keys, &[0x0001]), "display");
    assert_eq!(shown(keys, &[0x000B]), "display|T20|control");
    assert_eq!(shown(keys, &[0x0000]), "none");
}

#[test]
fn bits_without_a_name_are_not_lost() {
    let keys = "type = \"bits\"\nlabels = { 0x1 = \"display\" }";
    assert_eq!(shown(keys, &[0x8003]), "display|0x8002");
    assert_eq!(shown(keys, &[0x8000]), "0x8000");
    assert_eq!(shown("type = \"bits\"", &[0x8003]), "0b1000000000000011");
}

#[test]
fn a_name_for_no_bit_at_all_is_shown_only_then() {
    let keys = "type = \"bits\"\nlabels = { 0 = \"basic\", 1 = \"display\" }";
    assert_eq!(shown(keys, &[0]), "basic");
    assert_eq!(shown(keys, &[1]), "display");
}

#[test]
fn a_field_of_several_bits_is_named_when_all_are_set() {
    let keys = "type = \"bits\"\nlabels = { 0x3 = \"both\" }";
    assert_eq!(shown(keys, &[0x3]), "both");
    assert_eq!(shown(keys, &[0x1]), "0x0001");
}

#[test]
fn hex_reads_as_four_digits() {
    assert_eq!(shown("type = \"hex\"", &[0x00AB]), "0x00AB");
}

#[test]
fn text_ends_at_its_last_visible_character() {
    let keys = "type = \"ascii/8\"";
    assert_eq!(shown(keys, &[0x5051, 0x4D31, 0x3233, 0x3435]), "PQM12345");
    assert_eq!(shown(keys, &[0x4120, 0x4220, 0x2020, 0x0000]), "A B");
    assert_eq!(shown(keys, &[0; 4]), "");
    assert_eq!(shown("type = \"ascii/3\"", &[0x4142, 0x4344]), "ABC");
}

#[test]
fn text_runs_in_the_order_of_addresses_and_only_its_bytes_can_be_swapped() {
    let registers = [0x4142, 0x4344];
    for (order, text) in [
        ("ABCD", "ABCD"),
        ("CDAB", "ABCD"),
        ("BADC", "BADC"),
        ("DCBA", "BADC"),
    ] {
        let keys = format!("type = \"ascii/4\"\norder = \"{order}\"");
        assert_eq!(shown(&keys, &registers), text);
    }
}

#[test]
fn bytes_of_text_that_are_not_ascii_read_as_hex() {
    assert_eq!(shown("type = \"ascii/2\"", &[0xB041]), "\\xB0A");
}

#[test]
fn a_letter_is_a_number_from_1_to_26() {
    assert_eq!(shown("type = \"letter\"", &[1]), "A");
    assert_eq!(shown("type = \"letter\"", &[26]), "Z");
    for number in [0, 27, 0x0101, 0xFFFF] {
        assert_eq!(missing("type = \"letter\"", &[number]), Missing::Mismatch);
    }
}

#[test]
fn a_time_is_shown_to_the_millisecond() {
    // N194: 13:27, 10015 ms into the minute.
    let keys = "type = \"time\"";
    assert_eq!(shown(keys, &[0x0D1B, 0x271F]), "13:27:10.015");
    assert_eq!(shown(keys, &[0x173B, 59_999]), "23:59:59.999");
    assert_eq!(shown(keys, &[0, 0]), "00:00:00.000");
}

#[test]
fn an_hour_or_minute_that_no_clock_shows_is_no_time() {
    for registers in [[0x1800, 0], [0x003C, 0], [0, 60_000], [0xFFFF, 0xFFFF]] {
        assert_eq!(missing("type = \"time\"", &registers), Missing::Mismatch);
    }
}

#[test]
fn a_date_is_shown_year_first() {
    // N194: October 29, 1997.
    let keys = "type = \"date\"";
    assert_eq!(shown(keys, &[0x0A1D, 0x07CD]), "1997-10-29");
    assert_eq!(shown(keys, &[0x021D, 2024]), "2024-02-29");
}

#[test]
fn a_date_of_zeros_was_never_set() {
    assert_eq!(missing("type = \"date\"", &[0, 0]), Missing::Absent);
}

#[test]
fn a_day_that_no_calendar_has_is_no_date() {
    for registers in [
        [0x021D, 2023],
        [0x0D01, 2024],
        [0x0001, 2024],
        [0x0100, 2024],
        [0xFFFF, 0xFFFF],
        [0x0101, 10_000],
    ] {
        assert_eq!(missing("type = \"date\"", &registers), Missing::Mismatch);
    }
}

#[test]
fn mod10000_is_four_digits_a_register() {
    let keys = "type = \"mod10000\"\norder = \"CDAB\"";
    assert_eq!(shown(keys, &[5678, 1234]), "12345678");
    assert_eq!(shown(keys, &[1, 0]), "1");
    assert_eq!(shown("type = \"mod10000\"", &[9999, 9999]), "99999999");
    let keys = "type = \"mod10000\"\norder = \"CDAB\"\nscale = 0.1";
    assert_eq!(shown(keys, &[5678, 1234]), "1234567.8");
    assert_eq!(missing(keys, &[10_000, 0]), Missing::Mismatch);
    assert_eq!(missing(keys, &[0, 10_000]), Missing::Mismatch);
}

#[test]
fn a_high_word_marker_holds_whatever_the_low_word_is() {
    let keys = "type = \"i32\"\norder = \"CDAB\"\nscale = 0.1\n\
                no_value = { high_word = 0x7FFF, means = \"overflow\" }";
    for low in [0, 1, 0x7FFF, 0x8000, 0xFFFF] {
        assert_eq!(missing(keys, &[low, 0x7FFF]), Missing::Overflow);
    }
    assert_eq!(shown(keys, &[0x7FFF, 0]), "3276.7");
    assert_eq!(shown(keys, &[0xFFFF, 0x7FFE]), "214741811.1");
}

#[test]
fn a_high_word_marker_holds_where_the_type_could_not_be_read() {
    let keys = "type = \"mod10000\"\nno_value = { high_word = 0xFFFF, means = \"absent\" }";
    assert_eq!(missing(keys, &[0xFFFF, 0xFFFF]), Missing::Absent);
    let keys = "type = \"letter\"\nno_value = { high_word = 0, means = \"absent\" }";
    assert_eq!(missing(keys, &[0]), Missing::Absent);
}

#[test]
fn a_raw_marker_is_compared_before_scale_and_labels() {
    let keys = "type = \"u16\"\nscale = 0.1\nno_value = { raw = 65535, means = \"absent\" }";
    assert_eq!(missing(keys, &[0xFFFF]), Missing::Absent);
    assert_eq!(shown(keys, &[0xFFFE]), "6553.4");
    let keys = "type = \"i32\"\norder = \"CDAB\"\nno_value = { raw = -1, means = \"absent\" }";
    assert_eq!(missing(keys, &[0xFFFF, 0xFFFF]), Missing::Absent);
    assert_eq!(shown(keys, &[0xFFFF, 0]), "65535");
    let keys =
        "type = \"hex\"\nlabels = { 9 = \"nine\" }\nno_value = { raw = 9, means = \"absent\" }";
    assert_eq!(missing(keys, &[9]), Missing::Absent);
}

fn words(bits: u64) -> [u16; 4] {
    [48, 32, 16, 0].map(|shift| u16::try_from(bits >> shift & 0xFFFF).expect("16 bits"))
}

#[test]
fn a_float_prints_the_shortest_digits_that_read_back_the_same() {
    assert_eq!(shown("type = \"f32\"", &[0x3DCC, 0xCCCD]), "0.1");
    assert_eq!(shown("type = \"f32\"", &[0x4366, 0x0000]), "230");
    assert_eq!(shown("type = \"f64\"", &words(0.1_f64.to_bits())), "0.1");
    assert_eq!(
        shown("type = \"f64\"", &words((1.0_f64 / 3.0).to_bits())),
        "0.3333333333333333"
    );
}

#[test]
fn a_float_is_scaled_from_the_digits_it_prints() {
    let keys = "type = \"f32\"\nscale = 0.001";
    assert_eq!(shown(keys, &[0x3DCC, 0xCCCD]), "0.0001");
    let keys = "type = \"f64\"\nscale = 0.1";
    assert_eq!(shown(keys, &words(0.1_f64.to_bits())), "0.01");
    assert_eq!(shown(keys, &words(0.3_f64.to_bits())), "0.03");
}

#[test]
fn a_float_beyond_what_decimals_hold_is_scaled_all_the_same() {
    let keys = "type = \"f64\"\nscale = 0.5";
    let value = point(keys).interpret(&words(1e300_f64.to_bits()), &Scales::default());
    assert_eq!(value, Ok(Value::Double(5e299)));
    let value = point(keys).interpret(&words(1e-300_f64.to_bits()), &Scales::default());
    assert_eq!(value, Ok(Value::Double(5e-301)));
    let keys = "type = \"f64\"\nscale = 1e-15";
    let value = point(keys).interpret(&words(1e-20_f64.to_bits()), &Scales::default());
    assert_eq!(value, Ok(Value::Double(1e-20 * 1e-15)));
}

#[test]
fn a_float_that_is_not_a_number_is_absent_and_an_infinite_one_overflows() {
    assert_eq!(missing("type = \"f32\"", &[0x7FC0, 0]), Missing::Absent);
    assert_eq!(missing("type = \"f32\"", &[0x7F80, 0]), Missing::Overflow);
    assert_eq!(missing("type = \"f32\"", &[0xFF80, 0]), Missing::Overflow);
    let keys = "type = \"f32\"\nscale = 0.1";
    assert_eq!(missing(keys, &[0x7FC0, 0]), Missing::Absent);
    assert_eq!(missing(keys, &[0x7F80, 0]), Missing::Overflow);
    let keys = "type = \"f64\"\nscale = 10";
    let nan = words(f64::NAN.to_bits());
    assert_eq!(missing(keys, &nan), Missing::Absent);
    assert_eq!(missing(keys, &words(f64::MAX.to_bits())), Missing::Overflow);
}

#[test]
fn too_few_or_too_many_registers_are_no_value() {
    for registers in [&[][..], &[1], &[1, 2, 3]] {
        assert_eq!(missing("type = \"u32\"", registers), Missing::Mismatch);
        assert_eq!(missing("type = \"ascii/4\"", registers), Missing::Mismatch);
    }
}

#[test]
fn only_numbers_say_that_they_are() {
    let is_number = |keys, registers: &[u16]| {
        let value = point(keys).interpret(registers, &Scales::default());
        value.is_ok_and(|value| value.is_number())
    };
    assert!(is_number("type = \"u16\"", &[1]));
    assert!(is_number("type = \"f32\"", &[0, 0]));
    assert!(is_number("type = \"f64\"", &[0; 4]));
    assert!(!is_number("type = \"hex\"", &[1]));
    assert!(!is_number("type = \"ascii/2\"", &[0x3132]));
    assert!(!is_number("type = \"time\"", &[0, 0]));
    assert!(!is_number("type = \"u16\"\nlabels = { 1 = \"on\" }", &[1]));
}

#[test]
fn a_code_with_a_name_shows_as_it_and_any_other_as_the_scaled_number() {
    let keys = "type = \"u16\"\nscale = 0.1\nlabels = { 1201 = \"off\" }";
    assert_eq!(shown(keys, &[1201]), "off");
    assert_eq!(shown(keys, &[1200]), "120.0");
}

#[test]
fn names_of_signed_codes_go_by_the_register() {
    let keys = "type = \"i16\"\nlabels = { 0 = \"L1-L2-L3\", 0xFFFF = \"L1-L3-L2\" }";
    assert_eq!(shown(keys, &[0]), "L1-L2-L3");
    assert_eq!(shown(keys, &[0xFFFF]), "L1-L3-L2");
    assert_eq!(shown(keys, &[0xFFFE]), "-2");
}
