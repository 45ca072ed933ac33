//! Values back into registers: the inverse of what registers mean.

mod support {
    pub(crate) mod simulated;
}

use std::collections::BTreeMap;

use meterpoll::profile::load::load;
use meterpoll::profile::{Point, Profile, Scales, Setup, builtin};
use meterpoll::sim::{Em2x, Model, Pm290, Pqm};
use proptest::prelude::*;

use support::simulated::{at, registers, unit};

/// A profile of points with these lines behind its head.
#[track_caller]
fn profile(lines: &str) -> Profile {
    let text = format!("name = \"m\"\ntitle = \"Meter\"\nmanual = \"Manual\"\n{lines}\n");
    load("m.toml", &text).unwrap_or_else(|error| panic!("{error}"))
}

/// The one point of a profile, with these keys after its address.
#[track_caller]
fn point(keys: &str) -> Point {
    let lines = format!("[[points]]\nname = \"a\"\naddress = 0\n{keys}");
    let profile = profile(&lines);
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
fn numbers_go_back_to_the_last_digit() {
    // N333 of the PQM manual.
    let power = "type = \"i32\"\nscale = 0.01";
    holds(power, "51911.21", &[0x004F, 0x35D1]);
    holds(power, "-129161.01", &[0xFF3A, 0xEA7B]);
    holds(power, "-0.01", &[0xFFFF, 0xFFFF]);
    holds("type = \"u16\"", "415", &[415]);
    holds("type = \"u16\"", " 415.00 ", &[415]);
    holds("type = \"u16\"\nscale = 10", "4150", &[415]);
    holds("type = \"u16\"\nscale = -0.1", "-41.5", &[415]);
    holds(
        "type = \"i32\"\norder = \"CDAB\"",
        "-1500",
        &[0xFA24, 0xFFFF],
    );
    holds("type = \"mod10000\"", "12345678", &[1234, 5678]);
    let most = u64::MAX.to_string();
    holds("type = \"u64\"", &most, &[0xFFFF; 4]);
}

#[test]
fn a_number_between_two_steps_is_refused_with_its_neighbours() {
    for (keys, value, expected) in [
        (
            "type = \"u16\"",
            "1.5",
            "1.5 is between two steps: the nearest are 1 and 2",
        ),
        (
            "type = \"i16\"\nscale = 0.1",
            "-0.25",
            "-0.25 is between two steps: the nearest are -0.3 and -0.2",
        ),
        (
            "type = \"u16\"\nscale = -0.1",
            "-0.25",
            "-0.25 is between two steps: the nearest are -0.3 and -0.2",
        ),
        (
            "type = \"u16\"\nspan = { full = 9999, low = 45, high = 65 }",
            "50",
            "50 is between two steps: the nearest are 49.9985 and 50.0005",
        ),
    ] {
        refused(keys, value, expected);
    }
}

#[test]
fn a_number_beyond_the_registers_is_refused_with_their_ends() {
    for (keys, value, expected) in [
        ("type = \"u16\"", "65536", "65536 is not within 0 to 65535"),
        ("type = \"u16\"", "-1", "-1 is not within 0 to 65535"),
        (
            "type = \"i16\"\nscale = 0.1",
            "3276.8",
            "3276.8 is not within -3276.8 to 3276.7",
        ),
        (
            "type = \"u16\"\nscale = -1",
            "1",
            "1 is not within -65535 to 0",
        ),
        (
            "type = \"mod10000\"",
            "100000000",
            "100000000 is not within 0 to 99999999",
        ),
        (
            "type = \"u16\"\nspan = { full = 9999, low = 45, high = 65 }",
            "44.9",
            "44.9 is not within 45 to 65",
        ),
    ] {
        refused(keys, value, expected);
    }
}

#[test]
fn what_is_no_number_is_refused_with_what_could_be_given() {
    refused("type = \"u16\"", "much", "'much' is not a number");
    refused("type = \"u16\"", "", "'' is not a number");
    refused("type = \"u16\"", "1e3", "'1e3' is not a number");
    refused(
        "type = \"u16\"\nlabels = { 0 = \"off\", 1 = \"on\" }",
        "maybe",
        "'maybe' is not a number, or one of off, on",
    );
    refused(
        "type = \"bits\"\nlabels = { 0x1 = \"up\", 0x2 = \"down\" }",
        "up|left",
        "'up|left' is not a register such as 0x00FF, 0b101 or 255, or any of up, down with '|' \
         between",
    );
    refused(
        "type = \"ascii/4\"",
        "METER",
        "'METER' is not text of at most 4 characters, all of them ASCII",
    );
    refused(
        "type = \"letter\"",
        "AB",
        "'AB' is not a letter from A to Z",
    );
    refused(
        "type = \"time\"",
        "noon",
        "'noon' is not a time of day such as 23:59:59.999",
    );
    refused(
        "type = \"date\"",
        "2026-02-30",
        "'2026-02-30' is not a date such as 2026-11-22",
    );
    refused("type = \"f32\"", "inf", "'inf' is not a number");
    refused("type = \"f32\"", "1e39", "'1e39' is not a number");
}

#[test]
fn labels_and_bits_go_back_by_name_or_by_number() {
    let switch = "type = \"u16\"\nlabels = { 0 = \"off\", 1 = \"on\" }";
    holds(switch, "on", &[1]);
    holds(switch, "1", &[1]);
    holds(switch, "2", &[2]);
    holds(
        "type = \"i16\"\nlabels = { 65535 = \"lag\" }",
        "lag",
        &[0xFFFF],
    );
    let keys = "type = \"bits\"\nlabels = { 0x1 = \"up\", 0x2 = \"down\" }";
    holds(keys, "up", &[1]);
    holds(keys, "up|down", &[3]);
    holds(keys, "down|0x0040", &[0x42]);
    holds(keys, "none", &[0]);
    holds(keys, "0b101", &[5]);
    holds(keys, "7", &[7]);
    holds("type = \"hex\"", "0x00ff", &[0xFF]);
}

#[test]
fn text_times_dates_and_floats_go_back() {
    holds("type = \"ascii/5\"", "PQM", &[0x5051, 0x4D20, 0x2000]);
    holds("type = \"ascii/4\"", "\\xE9A", &[0xE941, 0x2020]);
    holds("type = \"letter\"", "D", &[4]);
    holds("type = \"time\"", "23:59:59.999", &[0x173B, 59_999]);
    holds("type = \"date\"", "2006-03-14", &[0x030E, 2006]);
    holds("type = \"f32\"", "123456.0", &[0x47F1, 0x2000]);
    holds(
        "type = \"f32\"\norder = \"CDAB\"",
        "123456",
        &[0x2000, 0x47F1],
    );
    holds(
        "type = \"f32\"\nscale = 0.001",
        "123.456",
        &[0x47F1, 0x2000],
    );
    holds("type = \"f64\"", "1", &[0x3FF0, 0, 0, 0]);
}

#[test]
fn the_mark_of_no_value_is_no_value() {
    refused(
        "type = \"u16\"\nno_value = { raw = 65535, means = \"absent\" }",
        "65535",
        "'65535' would read as no value",
    );
    refused(
        "type = \"i32\"\nno_value = { high_word = 0x7FFF, means = \"overflow\" }",
        "2147483647",
        "'2147483647' would read as out of range",
    );
}

#[test]
fn of_two_bands_that_give_one_figure_the_one_that_shows_as_it_is_typed_is_meant() {
    let keys = "type = \"u16\"\n\
        scale = [{ raw = [40, 70], factor = 1 }, { raw = [400, 700], factor = 0.1 }]";
    holds(keys, "50", &[50]);
    holds(keys, "50.0", &[500]);
    holds(keys, "50.1", &[501]);
    refused(
        keys,
        "71",
        "71 is on no step of 1 at raw 40..70; 0.1 at raw 400..700",
    );
}

/// The scales of the profile below with these setup registers.
fn scales(profile: &Profile, setup: &[(&str, u16)]) -> Scales {
    let read = setup
        .iter()
        .map(|(name, word)| ((*name).to_owned(), vec![*word]));
    Setup::of(&profile.points, Some(profile)).scales(&read.collect())
}

#[test]
fn a_scale_that_follows_from_the_setup_takes_it_from_there() {
    let profile = profile(
        "[factors]\nfull = { product = [1.2, \"ct\"] }\n\
         [[points]]\nname = \"a\"\naddress = 0\ntype = \"u16\"\n\
         span = { full = 9999, low = 0, high = \"full\" }\n\
         only_with = { point = \"wiring\", codes = [1] }\n\
         [[points]]\nname = \"b\"\naddress = 3\ntype = \"u16\"\nscale = \"full\"\n\
         [[points]]\nname = \"ct\"\naddress = 1\ntype = \"u16\"\nrange = [1, 5000]\n\
         access = \"read-write\"\n\
         [[points]]\nname = \"wiring\"\naddress = 2\ntype = \"u16\"\n",
    );
    let encode = |point: &str, value: &str, setup: &[(&str, u16)]| {
        let scales = scales(&profile, setup);
        let point = profile.point(point).unwrap();
        point
            .encode(value, &scales)
            .map_err(|error| error.to_string())
    };
    let set_up = [("ct", 200), ("wiring", 1)];
    assert_eq!(encode("a", "240", &set_up), Ok(vec![9999]));
    assert_eq!(encode("a", "0", &set_up), Ok(vec![0]));
    assert_eq!(encode("a", "0.024", &set_up), Ok(vec![1]));
    assert_eq!(encode("b", "2400", &set_up), Ok(vec![10]));
    let refused = |text: &str| Err(text.to_owned());
    assert_eq!(
        encode("a", "0.03", &set_up),
        refused("0.03 is between two steps: the nearest are 0.024 and 0.048")
    );
    assert_eq!(
        encode("a", "240", &[("ct", 0), ("wiring", 1)]),
        refused("there is no full to scale it by with this setup")
    );
    assert_eq!(
        encode("b", "240", &[("ct", 0), ("wiring", 1)]),
        refused("there is no full to scale it by with this setup")
    );
    assert_eq!(
        encode("a", "240", &[("ct", 200), ("wiring", 2)]),
        refused("it means nothing while wiring holds what it does")
    );
}

/// The model of a built-in meter.
fn model(meter: &str) -> Box<dyn Model> {
    match meter {
        "pqm" => Box::new(Pqm::new(1)),
        "pm290" => Box::new(Pm290::new(1)),
        "em21" => Box::new(Em2x::em21(unit(3), 1)),
        _ => Box::new(Em2x::em24(unit(1), 1)),
    }
}

/// The setup of a simulated meter, for all its points.
fn set_up(profile: &Profile, meter: &str) -> Scales {
    let model = model(meter);
    let measured = model.measure(at("2026-01-15T12:30:00Z"));
    let setup = Setup::of(&profile.points, Some(profile));
    let read: BTreeMap<String, Vec<u16>> = setup
        .points()
        .iter()
        .map(|point| (point.name.clone(), registers(point, measured.as_ref())))
        .collect();
    setup.scales(&read)
}

#[test]
fn whatever_registers_of_any_point_read_as_goes_back_and_reads_the_same() {
    let words = proptest::collection::vec(prop_oneof![any::<u16>(), 0_u16..1000], 125);
    let meters: Vec<(Profile, Scales)> = builtin::all()
        .iter()
        .map(|meter| {
            let profile = meter.profile();
            let scales = set_up(&profile, meter.name);
            (profile, scales)
        })
        .collect();
    let mut runner = proptest::test_runner::TestRunner::new(ProptestConfig::with_cases(40));
    let result = runner.run(&words, |words| {
        for (profile, scales) in &meters {
            for point in &profile.points {
                let registers = &words[..usize::from(point.range.count())];
                let Ok(value) = point.interpret(registers, scales) else {
                    continue;
                };
                let shown = value.to_string();
                let encoded = point.encode(&shown, scales);
                let encoded = encoded
                    .map_err(|error| TestCaseError::fail(format!("{}: {error}", point.name)))?;
                let again = point
                    .interpret(&encoded, scales)
                    .map(|value| value.to_string());
                prop_assert_eq!(again, Ok(shown), "{}", point.name);
            }
        }
        Ok(())
    });
    result.unwrap_or_else(|error| panic!("{error}"));
}

proptest! {
    #[test]
    fn floats_go_back_bit_by_bit(single: f32, double: f64) {
        for (keys, shown, bits) in [
            ("type = \"f32\"", single.to_string(), u64::from(single.to_bits())),
            ("type = \"f64\"", double.to_string(), double.to_bits()),
        ] {
            let point = point(keys);
            prop_assume!(single.is_finite() && double.is_finite());
            let registers = point.encode(&shown, &Scales::default()).unwrap();
            let found = registers.iter().fold(0, |bits, word| bits << 16 | u64::from(*word));
            prop_assert_eq!(found, bits);
        }
    }

    #[test]
    fn no_text_stops_the_way_back(text: String) {
        for keys in [
            "type = \"u16\"",
            "type = \"i64\"\nscale = 0.0000001",
            "type = \"bits\"",
            "type = \"ascii/9\"",
            "type = \"time\"",
            "type = \"date\"",
            "type = \"f64\"\nscale = 0.001",
            "type = \"u16\"\nspan = { full = 9999, low = -1, high = 1 }",
        ] {
            let _ = point(keys).encode(&text, &Scales::default());
        }
    }
}
