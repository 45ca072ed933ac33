//! Raw numbers, given in hex, into registers.

use meterpoll::profile::load::load;
use meterpoll::profile::{Point, Scales, builtin};

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

#[track_caller]
fn holds(keys: &str, value: &str, expected: &[u16]) {
    let registers = point(keys).encode(value, &Scales::default());
    assert_eq!(registers, Ok(expected.to_vec()), "{keys}: {value}");
}

#[track_caller]
fn refused(keys: &str, value: &str, expected: &str) {
    match point(keys).encode(value, &Scales::default()) {
        Ok(registers) => panic!("{keys}: {value} is {registers:04X?}"),
        Err(error) => assert_eq!(error.to_string(), expected, "{keys}: {value}"),
    }
}

#[test]
fn a_number_in_hex_is_the_raw_one_whatever_the_scale() {
    let pqm = builtin::find("pqm").expect("built in").profile();
    let ct = pqm.point("ct_primary").expect("a point");
    assert_eq!(ct.encode("0x00C8", &Scales::default()), Ok(vec![200]));
    holds("type = \"u16\"\nscale = 0.1", "0x00C8", &[200]);
    holds("type = \"u16\"\nscale = 0.1", "200", &[2000]);
    holds("type = \"u16\"\nscale = -10", " 0Xc8 ", &[200]);
    holds(
        "type = \"u16\"\nlabels = { 200 = \"much\" }",
        "0xC8",
        &[200],
    );
}

#[test]
fn raw_numbers_are_as_wide_as_their_type_and_in_its_order() {
    holds("type = \"u32\"", "0x12345678", &[0x1234, 0x5678]);
    holds(
        "type = \"u32\"\norder = \"CDAB\"\nscale = 0.1",
        "0x12345678",
        &[0x5678, 0x1234],
    );
    holds("type = \"u64\"", "0xFFFFFFFFFFFFFFFF", &[0xFFFF; 4]);
    holds(
        "type = \"mod10000\"\norder = \"CDAB\"",
        "0x8611",
        &[4321, 3],
    );
    holds("type = \"mod10000\"", "0x5F5E0FF", &[9999, 9999]);
}

#[test]
fn a_negative_raw_number_is_given_by_its_bits() {
    holds("type = \"i16\"\nscale = 0.001", "0xFFFF", &[0xFFFF]);
    holds("type = \"i16\"", "0x7FFF", &[0x7FFF]);
    holds("type = \"i32\"", "0xFFFF", &[0, 0xFFFF]);
    holds("type = \"i32\"", "0x80000000", &[0x8000, 0]);
    holds(
        "type = \"i64\"",
        "0xFFFFFFFFFFFFFFFE",
        &[0xFFFF, 0xFFFF, 0xFFFF, 0xFFFE],
    );
}

#[test]
fn a_raw_number_beyond_the_registers_is_refused_with_the_highest() {
    refused(
        "type = \"u16\"\nscale = 0.1",
        "0x10000",
        "0x10000 is not within 0x0 to 0xFFFF, as raw numbers",
    );
    refused(
        "type = \"i16\"",
        "0x10000",
        "0x10000 is not within 0x0 to 0xFFFF, as raw numbers",
    );
    refused(
        "type = \"mod10000\"",
        "0x5F5E100",
        "0x5F5E100 is not within 0x0 to 0x5F5E0FF, as raw numbers",
    );
    let long = format!("0x{}", "F".repeat(40));
    refused(
        "type = \"u64\"",
        &long,
        &format!("{long} is not within 0x0 to 0xFFFFFFFFFFFFFFFF, as raw numbers"),
    );
}

#[test]
fn what_has_no_digits_of_hex_is_no_raw_number() {
    for value in ["0x", "0xG", "0x-1", "0x+1", "-0x1", "0x1.5", "x1"] {
        refused(
            "type = \"u16\"",
            value,
            &format!("'{value}' is not a number"),
        );
    }
}

#[test]
fn a_raw_number_needs_no_scale_but_is_no_marker_of_no_value() {
    let pm290 = builtin::find("pm290").expect("built in").profile();
    let demand = pm290.point("max_active_demand").expect("a point");
    // No setup is known, so a figure has no raw number.
    assert!(demand.encode("0", &Scales::default()).is_err());
    assert_eq!(demand.encode("0x0", &Scales::default()), Ok(vec![0]));
    refused(
        "type = \"u16\"\nno_value = { raw = 65535, means = \"absent\" }",
        "0xFFFF",
        "'0xFFFF' would read as no value",
    );
}
