//! What a person types to choose points, and what is said about it when it chooses nothing.

use meterpoll::codec::RegisterRange;
use meterpoll::codec::value::{ByteOrder, RegisterType};
use meterpoll::profile::load::load;
use meterpoll::profile::selector::{Purpose, Reading, select};
use meterpoll::profile::{Point, Profile};

const BENCH_METER: &str = r#"
name = "bench"
title = "Meter on the bench"
manual = "none"
groups.default = ["voltage", "current_*"]
groups.energy = ["energy_*", "reset"]
points = [
  { name = "voltage", address = 0x0000, type = "u32", scale = 0.1, unit = "V" },
  { name = "current_a", address = 0x0002, type = "u16", unit = "A" },
  { name = "current_b", address = 0x0003, type = "u16", unit = "A" },
  { name = "current_n", address = 0x0004, type = "u16", unit = "A" },
  { name = "energy_in", address = 0x0010, type = "u64", unit = "Wh" },
  { name = "energy_out", address = 0x0014, type = "u64", unit = "Wh" },
  { name = "reset", address = 0x0020, type = "u16", access = "write" },
  { name = "reset_time", address = 0x0021, type = "time" },
]
"#;

/// Selectors name points of this meter.
fn meter(profile: &Profile) -> Reading<'_> {
    Reading {
        profile: Some(profile),
        ..Reading::default()
    }
}

fn bench_meter() -> Profile {
    load("bench.toml", BENCH_METER).expect("the profile loads")
}

fn typed(selectors: &[&str]) -> Vec<String> {
    selectors
        .iter()
        .map(|selector| (*selector).to_owned())
        .collect()
}

/// Names of the points of the bench meter that are chosen.
fn names(selectors: &[&str]) -> Vec<String> {
    select(&typed(selectors), meter(&bench_meter()))
        .unwrap_or_else(|error| panic!("{error}"))
        .into_iter()
        .map(|point| point.name)
        .collect()
}

/// What is said about selectors that choose nothing.
fn complaint(selectors: &[&str], profile: Option<&Profile>) -> String {
    match select(
        &typed(selectors),
        Reading {
            profile,
            ..Reading::default()
        },
    ) {
        Ok(points) => panic!("chosen: {points:?}"),
        Err(error) => error.to_string(),
    }
}

/// A raw register, of which nothing is known but its place and type.
fn register(start: u16, kind: RegisterType) -> Point {
    let range = RegisterRange::new(start, 1).expect("a range");
    Point::raw(range, kind, ByteOrder::Abcd)
}

#[test]
fn a_name_chooses_its_point() {
    let profile = bench_meter();
    let chosen = select(&typed(&["voltage"]), meter(&profile));
    let voltage = profile.point("voltage").expect("it is there");
    assert_eq!(chosen, Ok(vec![voltage.clone()]));
}

#[test]
fn points_come_in_the_order_they_were_named_in() {
    assert_eq!(
        names(&["energy_out", "voltage", "energy_in"]),
        ["energy_out", "voltage", "energy_in"]
    );
}

#[test]
fn a_glob_chooses_all_points_it_matches_in_the_order_of_the_meter() {
    assert_eq!(
        names(&["current_?"]),
        ["current_a", "current_b", "current_n"]
    );
    assert_eq!(names(&["*_n*"]), ["current_n"]);
}

#[test]
fn a_glob_leaves_out_what_can_only_be_written() {
    assert_eq!(names(&["reset*"]), ["reset_time"]);
}

#[test]
fn a_group_chooses_its_readable_members() {
    assert_eq!(names(&["@energy"]), ["energy_in", "energy_out"]);
}

#[test]
fn without_selectors_the_default_group_is_chosen() {
    assert_eq!(
        names(&[]),
        ["voltage", "current_a", "current_b", "current_n"]
    );
}

#[test]
fn a_point_chosen_twice_comes_once() {
    assert_eq!(
        names(&["current_b", "current_*", "@default", "current_b"]),
        ["current_b", "current_a", "current_n", "voltage"]
    );
    let registers = select(&typed(&["0x6B", "107", "0x006b"]), Reading::default());
    assert_eq!(registers, Ok(vec![register(0x6B, RegisterType::U16)]));
}

#[test]
fn one_register_as_two_types_is_two_points() {
    let chosen = select(&typed(&["0x6B:u16", "0x6B:i16"]), Reading::default());
    assert_eq!(
        chosen,
        Ok(vec![
            register(0x6B, RegisterType::U16),
            register(0x6B, RegisterType::I16),
        ])
    );
}

#[test]
fn raw_registers_and_points_can_be_named_together() {
    assert_eq!(
        names(&["voltage", "0x0300+2"]),
        ["voltage", "0x0300", "0x0301"]
    );
}

#[test]
fn an_unknown_name_brings_up_the_nearest_ones() {
    let profile = bench_meter();
    assert_eq!(
        complaint(&["curent_a"], Some(&profile)),
        "bench has no point 'curent_a'; did you mean current_a, current_b, current_n?"
    );
    assert_eq!(
        complaint(&["voltage", "volts"], Some(&profile)),
        "bench has no point 'volts'; did you mean voltage?"
    );
    assert_eq!(
        complaint(&["xyzzy"], Some(&profile)),
        "bench has no point 'xyzzy'"
    );
}

#[test]
fn an_unknown_group_brings_up_the_groups_there_are() {
    assert_eq!(
        complaint(&["@power"], Some(&bench_meter())),
        "bench has no group '@power'; its groups are @default, @energy"
    );
}

#[test]
fn a_glob_without_a_match_is_an_error() {
    assert_eq!(
        complaint(&["power_*"], Some(&bench_meter())),
        "no point of bench matches 'power_*'"
    );
}

#[test]
fn a_point_that_can_only_be_written_is_an_error_by_its_name() {
    assert_eq!(
        complaint(&["reset"], Some(&bench_meter())),
        "reset can only be written"
    );
}

#[test]
fn names_need_a_meter() {
    for selector in ["voltage", "@energy", "*"] {
        assert_eq!(
            complaint(&[selector], None),
            format!("'{selector}' is no register, and without a meter there are no points")
        );
    }
}

#[test]
fn nothing_typed_and_nothing_to_fall_back_to_is_an_error() {
    assert_eq!(
        complaint(&[], None),
        "nothing to read: name registers such as 0x0000+10, or a meter with --meter"
    );
    let text = BENCH_METER.replace("groups.default", "groups.other");
    let profile = load("bench.toml", &text).expect("the profile loads");
    assert_eq!(
        complaint(&[], Some(&profile)),
        "nothing to read: bench has no group @default, so name points"
    );
}

#[test]
fn a_point_keeps_the_type_its_meter_gives_it() {
    for selector in ["voltage:u16", "voltage=kV"] {
        let profile = bench_meter();
        let error = select(&typed(&[selector]), meter(&profile)).expect_err("no register");
        assert_eq!(
            error.to_string(),
            format!("'{selector}': voltage has its type and unit from the meter's profile")
        );
    }
}

#[test]
fn a_group_without_a_point_that_can_be_read_is_nothing_to_read() {
    let text = "name = \"m\"\ntitle = \"M\"\nmanual = \"none\"\ngroups.default = [\"reset\"]\n\n\
                [[points]]\nname = \"reset\"\naddress = 0\ntype = \"u16\"\naccess = \"write\"\n";
    let profile = meterpoll::profile::load::load("m.toml", text).expect("it loads");
    let error = select(&[], meter(&profile)).expect_err("nothing");
    assert_eq!(
        error.to_string(),
        "nothing to read: @default has no point that can be read"
    );
}

/// How points are looked up.
fn looked_up(profile: &Profile) -> Reading<'_> {
    Reading {
        purpose: Purpose::LookUp,
        ..meter(profile)
    }
}

#[test]
fn points_that_can_only_be_written_are_looked_up_like_the_others() {
    let profile = bench_meter();
    for (selectors, expected) in [
        (vec!["reset"], vec!["reset"]),
        (vec!["reset*"], vec!["reset", "reset_time"]),
        (vec!["@energy"], vec!["energy_in", "energy_out", "reset"]),
    ] {
        let points = select(&typed(&selectors), looked_up(&profile)).expect("points");
        let names: Vec<&str> = points.iter().map(|point| point.name.as_str()).collect();
        assert_eq!(names, expected, "{selectors:?}");
    }
}

#[test]
fn without_selectors_every_point_is_looked_up() {
    let text = BENCH_METER.replace("groups.default", "groups.other");
    for text in [BENCH_METER, &text] {
        let profile = load("bench.toml", text).expect("the profile loads");
        let found = select(&[], looked_up(&profile));
        assert_eq!(found.as_ref(), Ok(&profile.points));
    }
}

#[test]
fn a_register_by_address_is_no_point_to_look_up() {
    let profile = bench_meter();
    for selector in ["0x0000", "107", "0x11F:u32/CDAB*0.1=kWh", "0x"] {
        let error = select(&typed(&[selector]), looked_up(&profile)).expect_err("no point");
        assert_eq!(
            error.to_string(),
            format!("'{selector}' is no point of bench")
        );
    }
}

#[test]
fn a_group_without_members_is_nothing_to_look_up() {
    let text = BENCH_METER.replace("[\"voltage\", \"current_*\"]", "[]");
    let profile = load("bench.toml", &text).expect("the profile loads");
    let error = select(&typed(&["@default"]), looked_up(&profile)).expect_err("nothing");
    assert_eq!(error.to_string(), "there is no point in @default");
}
