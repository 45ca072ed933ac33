//! What reads must keep to besides limits: points that are kept from others, whether they are
//! asked for or not, and what a unit was found to refuse.

use std::time::Duration;

use meterpoll::codec::{ReadFunction, RegisterRange};
use meterpoll::profile::load::load;
use meterpoll::profile::plan::{Cost, Plan, Rules};
use meterpoll::profile::selector::{Reading, select};
use meterpoll::profile::{Limits, Profile};
use meterpoll::transport::LineSettings;

const HOLDING: ReadFunction = ReadFunction::HoldingRegisters;

fn range(start: u16, count: u16) -> RegisterRange {
    RegisterRange::new(start, count).expect("a range")
}

/// A meter with an identification code in the second word of a voltage, a counter that reading
/// clears, and a command.
fn profile(limits: &str) -> Profile {
    let text = format!(
        r#"
name = "mine"
title = "Mine"
manual = "none"
limits.read_holes = true
{limits}
points = [
  {{ name = "voltage_a", address = 0x0008, type = "i32" }},
  {{ name = "voltage_b", address = 0x000A, type = "i32" }},
  {{ name = "code", address = 0x000B, type = "u16", alone = true }},
  {{ name = "voltage_c", address = 0x000C, type = "i32" }},
  {{ name = "power_a", address = 0x0010, type = "i32" }},
  {{ name = "alarms", address = 0x0013, type = "u16", alone = true }},
  {{ name = "power_b", address = 0x0014, type = "i32" }},
  {{ name = "reset", address = 0x0017, type = "u16", access = "write" }},
  {{ name = "power_c", address = 0x0018, type = "i32" }},
]
"#
    );
    load("mine.toml", &text).unwrap_or_else(|error| panic!("{error}"))
}

/// Start and count of each read of what is selected, at 9600 8N1.
fn reads(profile: &Profile, rules: &Rules, what: &str) -> Vec<(u16, u16)> {
    let selectors: Vec<String> = what.split(' ').flat_map(one_by_one).collect();
    let reading = Reading {
        profile: Some(profile),
        ..Reading::default()
    };
    let points = select(&selectors, reading).unwrap_or_else(|error| panic!("{error}"));
    let cost = Cost::new(LineSettings::default(), Duration::ZERO, Duration::ZERO);
    let reads = Plan::new(&points, HOLDING, rules, cost).reads.into_iter();
    reads
        .map(|read| (read.range.start().get(), read.range.count()))
        .collect()
}

/// Registers in a row as so many selectors: together they would be refused over a point that is read
/// alone.
fn one_by_one(selector: &str) -> Vec<String> {
    let Some((start, count)) = selector.split_once('+') else {
        return vec![selector.to_owned()];
    };
    let start = match start.strip_prefix("0x") {
        Some(hex) => u16::from_str_radix(hex, 16),
        None => start.parse(),
    };
    let start = start.expect("an address");
    let count: u16 = count.parse().expect("a count");
    (start..start + count)
        .map(|address| address.to_string())
        .collect()
}

#[track_caller]
fn assert_reads(what: &str, expected: &[(u16, u16)]) {
    let profile = profile("");
    assert_eq!(
        reads(&profile, &Rules::of(&profile), what),
        expected,
        "{what}"
    );
}

#[test]
fn a_point_that_is_read_alone_is_not_run_over_when_it_is_not_asked_for() {
    assert_reads("power_a power_b", &[(0x10, 2), (0x14, 2)]);
    assert_reads("power_a power_b alarms", &[(0x10, 2), (0x13, 1), (0x14, 2)]);
}

#[test]
fn a_point_that_is_only_written_is_not_run_over() {
    assert_reads("power_b power_c", &[(0x14, 2), (0x18, 2)]);
}

#[test]
fn a_word_that_is_something_else_when_alone_is_run_over_as_part_of_its_point() {
    assert_reads("voltage_?", &[(0x08, 6)]);
    assert_reads("voltage_a voltage_c", &[(0x08, 6)]);
    assert_reads("voltage_b", &[(0x0A, 2)]);
}

#[test]
fn a_word_that_is_something_else_when_alone_is_never_merged() {
    assert_reads("code", &[(0x0B, 1)]);
    assert_reads("voltage_? code", &[(0x08, 6), (0x0B, 1)]);
    assert_reads("voltage_a code voltage_c", &[(0x08, 6), (0x0B, 1)]);
}

#[test]
fn registers_by_address_begin_and_end_no_read_inside_such_a_point() {
    // Each of its two words is read alone, whatever is asked for beside it.
    assert_reads("0x08+6", &[(0x08, 6), (0x0A, 1), (0x0B, 1)]);
    assert_reads("0x0B+3", &[(0x0B, 1), (0x0C, 2)]);
    assert_reads("0x08+2 0x0A:u32 0x0C+2", &[(0x08, 6)]);
}

#[test]
fn registers_by_address_keep_off_points_that_must_be_alone() {
    assert_reads("0x12+3", &[(0x12, 1), (0x13, 1), (0x14, 1)]);
    // The same registers, asked for by name and by address, are read once.
    assert_reads("alarms 0x13", &[(0x13, 1)]);
}

#[test]
fn a_barrier_holds_for_both_functions_only_where_they_are_one() {
    let apart = "0x12 0x14";
    for (limits, expected) in [
        ("", vec![(0x12, 3)]),
        (
            "limits.interchangeable_reads = true",
            vec![(0x12, 1), (0x14, 1)],
        ),
    ] {
        let profile = profile(limits);
        let reading = Reading {
            profile: Some(&profile),
            function: Some(ReadFunction::InputRegisters),
            ..Reading::default()
        };
        let selectors: Vec<String> = apart.split(' ').map(str::to_owned).collect();
        let points = select(&selectors, reading).expect("registers");
        let cost = Cost::new(LineSettings::default(), Duration::ZERO, Duration::ZERO);
        let plan = Plan::new(&points, HOLDING, &Rules::of(&profile), cost);
        let found: Vec<_> = plan
            .reads
            .iter()
            .map(|read| (read.range.start().get(), read.range.count()))
            .collect();
        assert_eq!(found, expected, "{limits}");
    }
}

/// Reads of registers 0 to 19 after a lesson.
fn after(lesson: impl FnOnce(&mut Rules)) -> Vec<(u16, u16)> {
    let profile = profile("");
    let mut rules = Rules::new(&Limits::default());
    lesson(&mut rules);
    reads(&profile, &rules, "0+20")
}

#[test]
fn without_a_lesson_all_is_read_at_once() {
    assert_eq!(after(|_| {}), [(0, 20)]);
}

#[test]
fn a_learned_limit_only_ever_falls() {
    let lesson = |rules: &mut Rules| {
        rules.limit(8);
        rules.limit(11);
    };
    assert_eq!(after(lesson), [(0, 8), (8, 8), (16, 4)]);
}

#[test]
fn registers_that_were_refused_together_are_read_in_two_requests() {
    // Any cut between 4 and 12 does; the first read is filled.
    assert_eq!(
        after(|rules| rules.refuse(HOLDING, range(4, 8))),
        [(0, 11), (11, 9)]
    );
}

#[test]
fn a_register_that_was_refused_alone_is_asked_for_alone() {
    assert_eq!(
        after(|rules| rules.refuse(HOLDING, range(7, 1))),
        [(0, 7), (7, 1), (8, 12)]
    );
}

#[test]
fn a_refusal_of_one_function_is_none_of_the_other() {
    assert_eq!(
        after(|rules| rules.refuse(ReadFunction::InputRegisters, range(7, 1))),
        [(0, 20)]
    );
}

#[test]
fn a_word_refused_alone_is_still_read_in_company() {
    let profile = profile("");
    let mut rules = Rules::of(&profile);
    rules.refuse(HOLDING, range(0x0B, 1));
    assert_eq!(reads(&profile, &rules, "voltage_?"), [(0x08, 6)]);
    rules.refuse(HOLDING, range(0x0A, 2));
    assert_eq!(
        reads(&profile, &rules, "voltage_?"),
        [(0x08, 2), (0x0A, 2), (0x0C, 2)]
    );
}

#[test]
fn holes_are_crossed_until_they_are_forbidden() {
    let profile = profile("");
    let mut rules = Rules::of(&profile);
    assert_eq!(reads(&profile, &rules, "voltage_c power_a"), [(0x0C, 6)]);
    rules.forbid_holes();
    assert_eq!(
        reads(&profile, &rules, "voltage_c power_a"),
        [(0x0C, 2), (0x10, 2)]
    );
    // What is known is no hole.
    assert_eq!(reads(&profile, &rules, "voltage_a voltage_c"), [(8, 6)]);
}

#[test]
fn registers_of_other_points_are_no_hole() {
    let profile = profile("");
    let strict = Profile {
        limits: Limits {
            read_holes: false,
            ..profile.limits.clone()
        },
        ..profile
    };
    let rules = Rules::of(&strict);
    // voltage_b lies between the two; between voltage_c and power_a lies nothing that is known.
    assert_eq!(reads(&strict, &rules, "voltage_a voltage_c"), [(8, 6)]);
    assert_eq!(
        reads(&strict, &rules, "voltage_c power_a"),
        [(0x0C, 2), (0x10, 2)]
    );
    // Nor is one crossed that harms or refuses.
    assert_eq!(
        reads(&strict, &rules, "power_a power_b"),
        [(0x10, 2), (0x14, 2)]
    );
}
