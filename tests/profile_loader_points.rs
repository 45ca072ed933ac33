//! What the strict loader says about each slip in the keys of a point.

use meterpoll::profile::load::load;
use meterpoll::profile::point::{Labels, Marker};
use meterpoll::profile::{Missing, Point};

/// A profile of one point `a` of this type in lines 4 to 7, more of its keys from line 8.
fn profile(kind: &str, keys: &str) -> String {
    format!(
        "name = \"m\"\ntitle = \"Meter\"\nmanual = \"Manual\"\n\
         [[points]]\nname = \"a\"\naddress = 0x10\ntype = \"{kind}\"\n{keys}\n"
    )
}

#[track_caller]
fn good(kind: &str, keys: &str) -> Point {
    let profile = load("m.toml", &profile(kind, keys)).unwrap_or_else(|error| panic!("{error}"));
    profile.points.into_iter().next().expect("one point")
}

#[track_caller]
fn refused(kind: &str, keys: &str, message: &str) {
    match load("m.toml", &profile(kind, keys)) {
        Ok(_) => panic!("{kind} with {keys} loads"),
        Err(error) => assert_eq!(error.to_string(), message),
    }
}

#[test]
fn a_type_that_does_not_exist_is_named_with_those_that_do() {
    for kind in [
        "u24",
        "U16",
        "",
        "ascii",
        "ascii/0",
        "ascii/251",
        "ascii/-1",
    ] {
        refused(
            kind,
            "",
            &format!(
                "m.toml:7: a.type: unknown type '{kind}', expected u16, i16, u32, i32, u64, i64, \
                 f32, f64, hex, bits, mod10000, letter, time, date or ascii/N with N characters, \
                 1 to 250"
            ),
        );
    }
}

#[test]
fn every_type_loads_and_takes_its_registers() {
    for (kind, registers) in [
        ("u16", 1),
        ("i16", 1),
        ("hex", 1),
        ("bits", 1),
        ("letter", 1),
        ("u32", 2),
        ("i32", 2),
        ("f32", 2),
        ("mod10000", 2),
        ("time", 2),
        ("date", 2),
        ("u64", 4),
        ("i64", 4),
        ("f64", 4),
        ("ascii/1", 1),
        ("ascii/7", 4),
        ("ascii/250", 125),
    ] {
        assert_eq!(good(kind, "").range.count(), registers, "{kind}");
    }
}

#[test]
fn an_order_that_does_not_exist_is_named_with_those_that_do() {
    refused(
        "u32",
        "order = \"little\"",
        "m.toml:8: a.order: unknown byte order 'little', expected ABCD, CDAB, BADC or DCBA",
    );
}

#[test]
fn a_scale_is_a_number_other_than_0() {
    for scale in ["0", "0.0", "inf", "nan", "1e300", "1e-30"] {
        refused(
            "u32",
            &format!("scale = {scale}"),
            &format!(
                "m.toml:8: a.scale: {scale} is not a number other than 0, of at most 28 digits"
            ),
        );
    }
}

#[test]
fn a_scale_has_the_decimals_it_is_written_with() {
    for (scale, kept) in [
        ("0.001", "0.001"),
        ("10", "10"),
        ("1e-3", "0.001"),
        ("-0.1", "-0.1"),
        ("0.000277777777777778", "0.000277777777777778"),
    ] {
        let point = good("u16", &format!("scale = {scale}"));
        assert_eq!(point.constant_scale().expect("a number").to_string(), kept);
    }
}

#[test]
fn a_scale_that_would_round_a_value_of_the_type_is_refused() {
    good("u32", "scale = 0.2777777777777778");
    refused(
        "u64",
        "scale = 0.2777777777777778",
        "m.toml:8: a.scale: 0.2777777777777778 is not a number that every u64 can be multiplied \
         with exactly",
    );
}

#[test]
fn only_a_number_has_a_scale() {
    for kind in ["ascii/4", "hex", "bits", "letter", "time", "date"] {
        refused(
            kind,
            "scale = 0.1",
            "m.toml:8: a.scale: only a number has a scale",
        );
    }
}

#[test]
fn an_access_is_read_write_or_both() {
    refused(
        "u16",
        "access = \"rw\"",
        "m.toml:8: a.access: \"rw\" is not \"read\", \"write\" or \"read-write\"",
    );
}

#[test]
fn a_range_is_two_raw_numbers_that_the_type_holds_the_lower_first() {
    good("u16", "range = [0, 65535]");
    good("i16", "range = [-32768, 32767]");
    for (kind, range, holds) in [
        ("u16", "[0, 65536]", "0 to 65535"),
        ("u16", "[-1, 5]", "0 to 65535"),
        ("u16", "[5, 4]", "0 to 65535"),
        ("u16", "[5]", "0 to 65535"),
        ("u16", "[1, 2, 3]", "0 to 65535"),
        ("i16", "[0, 32768]", "-32768 to 32767"),
        ("mod10000", "[0, 100000000]", "0 to 99999999"),
    ] {
        refused(
            kind,
            &format!("range = {range}"),
            &format!(
                "m.toml:8: a.range: {range} is not [lowest, highest] within {holds}, \
                 what {kind} holds"
            ),
        );
    }
}

#[test]
fn only_an_integer_has_a_range() {
    for kind in ["f32", "f64", "ascii/4", "time", "date"] {
        refused(
            kind,
            "range = [0, 1]",
            "m.toml:8: a.range: only an integer has a range",
        );
    }
}

#[test]
fn labels_name_a_table_that_exists() {
    refused(
        "u16",
        "labels = \"on_off\"",
        "m.toml:8: a.labels: there is no label table 'on_off'",
    );
    let point = good(
        "u16",
        "labels = \"on_off\"\n[labels]\non_off = { 0 = \"off\", 1 = \"on\" }",
    );
    let own = good("u16", "labels = { 0x0 = \"off\", 0x01 = \"on\" }");
    assert_eq!(point.labels, own.labels);
    assert!(matches!(own.labels, Labels::Codes(names) if names[&1] == "on"));
}

#[test]
fn one_code_written_in_two_ways_is_named_twice() {
    refused(
        "u16",
        "labels = { 1 = \"on\", 0x1 = \"off\" }",
        "m.toml:8: a.labels: 0x1 is named twice, 'on' and 'off'",
    );
    refused(
        "u16",
        "[labels.on_off]\n0x1 = \"on\"\n0 = \"off\"\n1 = \"closed\"",
        "m.toml:11: labels.on_off: 1 is named twice, 'on' and 'closed'",
    );
}

#[test]
fn a_label_is_of_a_code_that_one_register_holds() {
    for code in ["65536", "0x10000", "on", "-1", "0X1"] {
        refused(
            "u16",
            &format!("labels = {{ {code} = \"on\" }}"),
            &format!("m.toml:8: a.labels: {code} is not a code: 0 to 65535, or 0x0 to 0xFFFF"),
        );
    }
}

#[test]
fn only_one_register_has_labels() {
    for kind in ["u32", "u64", "f32", "ascii/2", "date", "letter"] {
        refused(
            kind,
            "labels = { 1 = \"on\" }",
            "m.toml:8: a.labels: only u16, i16, hex and bits have labels",
        );
    }
}

#[test]
fn no_value_has_one_marker() {
    for marker in ["", "high_word = 0x7FFF, raw = 1, "] {
        refused(
            "u32",
            &format!("no_value = {{ {marker}means = \"absent\" }}"),
            "m.toml:8: a.no_value: give either high_word or raw",
        );
    }
    let point = good(
        "u32",
        "no_value = { high_word = 0x7FFF, means = \"overflow\" }",
    );
    let no_value = point.no_value.expect("there is one");
    assert_eq!(no_value.marker, Marker::HighWord(0x7FFF));
    assert_eq!(no_value.missing, Missing::Overflow);
}

#[test]
fn no_value_means_overflow_or_absent() {
    refused(
        "u32",
        "no_value = { raw = 1, means = \"none\" }",
        "m.toml:8: a.no_value.means: \"none\" is not \"overflow\" or \"absent\"",
    );
}

#[test]
fn a_raw_marker_is_a_number_that_the_type_holds() {
    good("i16", "no_value = { raw = -1, means = \"absent\" }");
    refused(
        "i16",
        "no_value = { raw = 65535, means = \"absent\" }",
        "m.toml:8: a.no_value.raw: 65535 is not within -32768 to 32767, what i16 holds",
    );
    for kind in ["f32", "letter", "date", "ascii/2"] {
        refused(
            kind,
            "no_value = { raw = 1, means = \"absent\" }",
            "m.toml:8: a.no_value.raw: only an integer has a raw marker; use high_word",
        );
    }
}

#[test]
fn a_function_reads_and_is_one_that_the_meter_has() {
    refused(
        "u16",
        "function = 5",
        "m.toml:8: a.function: 5 is not 3 or 4",
    );
    refused(
        "u16",
        "function = 4\n[limits]\nfunctions = [3]",
        "m.toml:8: a.function: 4 is not one of limits.functions",
    );
}

#[test]
fn a_point_is_read_only_verified_and_unscaled_unless_said_otherwise() {
    let found = good("u16", "");
    let expected = Point {
        name: "a".to_owned(),
        ..Point::raw(found.range, found.kind, found.order)
    };
    assert_eq!(found, expected);
}

#[test]
fn a_row_that_repeats_is_as_many_points_one_behind_the_other() {
    let loaded = load("m.toml", &profile("u32", "repeat = 3"));
    let points = loaded.unwrap_or_else(|error| panic!("{error}")).points;
    let places: Vec<String> = points
        .iter()
        .map(|point| format!("{} {}", point.name, point.range))
        .collect();
    assert_eq!(places, ["a_1 0x0010+2", "a_2 0x0012+2", "a_3 0x0014+2"]);
}

#[test]
fn a_row_repeats_twice_at_least_and_within_the_registers_there_are() {
    for count in [0, 1, 0x7FF9] {
        refused(
            "u32",
            &format!("repeat = {count}"),
            &format!(
                "m.toml:8: a.repeat: {count} is not 2 or more, of which 32760 lie within 0xFFFF"
            ),
        );
    }
    refused(
        "u32",
        "repeat = 9\n[limits]\ntable_registers = 25",
        "m.toml:6: a.address: 2 registers from 0x0018 run past the end of its table of 25",
    );
}

#[test]
fn an_empty_unit_is_none() {
    assert_eq!(good("u16", "unit = \"V\"").unit.as_deref(), Some("V"));
    assert_eq!(good("u16", "unit = \"\"").unit, None);
}
