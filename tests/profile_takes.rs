//! Which registers a point takes, and what it says of others.

use meterpoll::profile::load::load;
use meterpoll::profile::{Point, builtin};

/// A point that can be written, with these keys behind its address.
#[track_caller]
fn point(keys: &str) -> Point {
    let text = format!(
        "name = \"m\"\ntitle = \"Meter\"\nmanual = \"Manual\"\nlimits.functions = [3, 16]\n\
         [[points]]\nname = \"a\"\naddress = 0\naccess = \"read-write\"\n{keys}\n"
    );
    let profile = load("m.toml", &text).unwrap_or_else(|error| panic!("{error}"));
    profile.points.into_iter().next().expect("one point")
}

#[track_caller]
fn taken(keys: &str, registers: &[&[u16]]) {
    let point = point(keys);
    for words in registers {
        assert_eq!(point.takes(words), Ok(()), "{keys}: {words:?}");
    }
}

#[track_caller]
fn refused(keys: &str, registers: &[u16], message: &str) {
    let error = point(keys).takes(registers).expect_err("it is refused");
    assert_eq!(error.to_string(), message, "{keys}: {registers:?}");
}

#[test]
fn a_range_is_told_in_the_unit_of_the_point() {
    let keys = "type = \"u16\"\nscale = 0.1\nrange = [10, 35000]";
    taken(keys, &[&[10], &[35000]]);
    refused(keys, &[9], "0.9 is not within 1.0 to 3500.0");
    refused(keys, &[35001], "3500.1 is not within 1.0 to 3500.0");
    let keys = "type = \"i32\"\norder = \"CDAB\"\nrange = [-5, 100000]";
    taken(keys, &[&[0xFFFB, 0xFFFF], &[0x86A0, 1]]);
    refused(keys, &[0xFFFA, 0xFFFF], "-6 is not within -5 to 100000");
}

#[test]
fn what_is_taken_besides_the_range_is_told_with_it() {
    let keys =
        "type = \"u16\"\nrange = [1, 200]\nalso = [65535]\nlabels = { 65535 = \"suppressed\" }";
    taken(keys, &[&[1], &[200], &[65535]]);
    refused(
        keys,
        &[201],
        "201 is not within 1 to 200, nor 65535 (suppressed)",
    );
}

#[test]
fn steps_are_told_with_the_nearest_two() {
    let keys = "type = \"u16\"\nscale = 0.1\nrange = [5, 6000]\nstep = 5\nalso = [8]";
    taken(keys, &[&[5], &[6000], &[8]]);
    refused(
        keys,
        &[7],
        "0.7 is no multiple of 0.5: the nearest are 0.5 and 1.0",
    );
    let keys = "type = \"i16\"\nstep = 10";
    taken(keys, &[&[0xFFF6]]);
    refused(
        keys,
        &[0xFFFF],
        "-1 is no multiple of 10: the nearest are -10 and 0",
    );
}

#[test]
fn allowed_numbers_are_told_with_their_names() {
    let keys = "type = \"u16\"\nallowed = [1, 15, 255]\nlabels = { 255 = \"external\" }";
    taken(keys, &[&[1], &[15], &[255]]);
    refused(keys, &[2], "2 is none of 1, 15, 255 (external)");
}

#[test]
fn registers_of_bits_have_a_range_and_texts_have_none() {
    let keys = "type = \"bits\"\nrange = [0, 255]";
    taken(keys, &[&[255]]);
    refused(keys, &[0x8000], "32768 is not within 0 to 255");
    taken("type = \"ascii/2\"", &[&[0x4142]]);
    taken("type = \"time\"", &[&[0x173B, 59_999]]);
}

#[test]
fn the_built_in_meters_take_what_their_manuals_say() {
    let cases: [(&str, &str, &[u16], &[u16]); 9] = [
        ("pqm", "ct_primary", &[0, 5, 12000], &[1, 12005]),
        ("pqm", "nominal_frequency", &[50, 60], &[55, 40]),
        ("pqm", "display_brightness", &[0, 20, 100], &[10]),
        ("pqm", "undercurrent_delay", &[5, 6000], &[4, 7]),
        ("pqm", "sim_iv_time", &[5, 305], &[6, 310]),
        ("pm290", "pulse_kvarh", &[1, 200, 65535], &[0, 201]),
        ("pm290", "power_demand_period", &[1, 30, 255], &[0, 15, 254]),
        ("pm290", "averaging_buffer_size", &[8, 32], &[16]),
        ("em24", "reset_all_meters", &[1], &[0, 2]),
    ];
    for (meter, name, good, bad) in cases {
        let profile = builtin::find(meter).expect("it is built in").profile();
        let point = profile.point(name).expect("a point");
        for raw in good {
            assert_eq!(point.takes(&[*raw]), Ok(()), "{name} {raw}");
        }
        for raw in bad {
            assert!(point.takes(&[*raw]).is_err(), "{name} {raw}");
        }
    }
}

#[test]
fn the_channels_of_the_pm290_are_distinct_but_for_those_not_assigned() {
    let pm290 = builtin::find("pm290").expect("it is built in").profile();
    let [rule] = pm290.distinct.as_slice() else {
        panic!("{:?}", pm290.distinct);
    };
    assert_eq!(rule.points.len(), 13);
    assert_eq!(rule.except, [65535]);
}
