//! What the strict loader says about each slip in a profile: file, line, key, problem.

use meterpoll::profile::load::load;
use meterpoll::profile::{LoopbackData, Profile};

/// Lines 1 to 3 of every profile here.
const HEAD: &str = "name = \"m\"\ntitle = \"Meter\"\nmanual = \"Manual\"\n";

/// A profile of one u16 point `a`, these lines before it, from line 4.
fn with(lines: &str) -> String {
    format!("{HEAD}{lines}\n[[points]]\nname = \"a\"\naddress = 0x10\ntype = \"u16\"\n")
}

/// A profile of one point `a` of this type, more of its keys from line 8.
fn point(kind: &str, keys: &str) -> String {
    format!("{HEAD}[[points]]\nname = \"a\"\naddress = 0x10\ntype = \"{kind}\"\n{keys}\n")
}

/// A profile of these points, a line each from line 5.
fn points(before: &str, rows: &[&str]) -> String {
    format!("{HEAD}{before}points = [\n  {},\n]\n", rows.join(",\n  "))
}

#[track_caller]
fn good(text: &str) -> Profile {
    load("m.toml", text).unwrap_or_else(|error| panic!("{error}"))
}

#[track_caller]
fn refused(text: &str, message: &str) {
    match load("m.toml", text) {
        Ok(_) => panic!("it loads:\n{text}"),
        Err(error) => assert_eq!(error.to_string(), message),
    }
}

const POINT_KEYS: &str = "name, address, repeat, type, order, scale, span, unit, about, access, range, \
                          labels, no_value, only_with, alone, function, hazard, momentary, moves, step, \
                          allowed, also, write_function, broadcast, writable_with, shown_by, \
                          verified, page";

#[test]
fn a_small_profile_loads() {
    let profile = good(&with(""));
    assert_eq!(profile.points.len(), 1);
    assert_eq!(profile.points[0].range.to_string(), "0x0010+1");
}

#[test]
fn an_unknown_key_is_named_with_the_keys_that_are_known() {
    refused(
        &with("colour = \"red\""),
        "m.toml:4: colour: unknown key, expected name, title, manual, line, limits, \
         identification, labels, factors, groups, points, identities, operations, \
         command_registers, clock, status_bits, distinct",
    );
    let limits = "unknown key, expected highest_unit, functions, interchangeable_reads, \
                  broadcast_functions, broadcast, loopback_data, read_registers, write_registers, \
                  read_holes, table_registers, typical_answer, longest_answer, pause";
    refused(
        &with("[limits]\nread_register = 9"),
        &format!("m.toml:5: limits.read_register: {limits}"),
    );
    refused(
        &with("limits.read_register = 9"),
        &format!("m.toml:4: limits.read_register: {limits}"),
    );
}

#[test]
fn an_unknown_key_of_a_point_is_named_with_the_point() {
    refused(
        &point("u16", "adress = 4"),
        &format!("m.toml:8: a.adress: unknown key, expected {POINT_KEYS}"),
    );
    let rows = [
        "{ name = \"a\", address = 0, type = \"u16\" }",
        "{ name = \"b\", address = 1, type = \"u16\", adress = 3 }",
    ];
    refused(
        &points("", &rows),
        &format!("m.toml:6: b.adress: unknown key, expected {POINT_KEYS}"),
    );
}

#[test]
fn a_missing_key_is_named_with_the_table_it_is_missing_from() {
    refused("", "m.toml:1: name: this key is missing");
    refused(HEAD, "m.toml:1: points: this key is missing");
    let rows = [
        "{ name = \"a\", address = 0, type = \"u16\" }",
        "{ name = \"b\", type = \"u16\" }",
    ];
    refused(
        &points("", &rows),
        "m.toml:6: b.address: this key is missing",
    );
    refused(
        &with("[identification]\npoint = \"a\""),
        "m.toml:4: identification.codes: this key is missing",
    );
    refused(
        &point("u16", "no_value = { raw = 3 }"),
        "m.toml:8: a.no_value.means: this key is missing",
    );
}

#[test]
fn a_value_of_the_wrong_kind_is_shown_with_what_is_expected() {
    refused(
        &with("[limits]\nread_holes = \"yes\""),
        "m.toml:5: limits.read_holes: \"yes\" is not true or false",
    );
    refused(
        &with("[limits]\nfunctions = 3"),
        "m.toml:5: limits.functions: 3 is not a list in [ ]",
    );
    refused(&with("limits = 3"), "m.toml:4: limits: 3 is not a table");
    refused(
        &point("u16", "unit = 5"),
        "m.toml:8: a.unit: 5 is not text in quotes",
    );
    refused(
        &point("u16", "scale = \"0.1\""),
        "m.toml:8: a.scale: \"0.1\" is not a number, without quotes, or a name",
    );
    refused(
        &point("u16", "labels = 3"),
        "m.toml:8: a.labels: 3 is not a table of names, or the name of one in [labels]",
    );
    refused(
        &point("u16", "labels = { 1 = 3 }"),
        "m.toml:8: a.labels.1: 3 is not text in quotes",
    );
}

#[test]
fn a_long_value_of_the_wrong_kind_is_not_shown_whole() {
    refused(
        &with("[limits]\nread_holes = [\n  1,\n]"),
        "m.toml:5: limits.read_holes: this list is not true or false",
    );
    refused(
        &with("[limits]\nread_holes = \"only where the page of the manual shows none\""),
        "m.toml:5: limits.read_holes: this text is not true or false",
    );
    refused(
        &with("[limits.read_holes]\n"),
        "m.toml:4: limits.read_holes: [limits.read_holes] is not true or false",
    );
}

#[test]
fn an_address_is_a_number_from_0_to_65535() {
    for address in ["\"0x10\"", "-1", "65536", "1.5"] {
        refused(
            &with("").replace("0x10", address),
            &format!("m.toml:7: a.address: {address} is not a whole number from 0 to 65535"),
        );
    }
}

#[test]
fn text_that_is_not_toml_is_called_so() {
    refused(
        "this is not TOML",
        "m.toml:1: not TOML: key with no value, expected `=`",
    );
    refused(
        &with("[limits\npause = \"1s\""),
        "m.toml:4: not TOML: unclosed table, expected `]`",
    );
    refused(
        &with("limits.read_registers = 070"),
        "m.toml:4: not TOML: unexpected leading zero, expected nothing",
    );
}

#[test]
fn a_key_that_stands_twice_is_named_with_its_second_line() {
    refused(
        &with("name = \"n\""),
        "m.toml:4: name: this key stands here twice",
    );
}

#[test]
fn a_name_used_twice_names_both_lines() {
    let rows = [
        "{ name = \"a\", address = 0, type = \"u16\" }",
        "{ name = \"a\", address = 1, type = \"u16\" }",
    ];
    refused(
        &points("", &rows),
        "m.toml:6: a.name: there is a point of this name in line 5 already",
    );
}

#[test]
fn a_name_is_small_letters_digits_and_underscores_a_letter_first() {
    for name in ["Current A", "1x", "", "_a", "ü", "a-b", "0x0010"] {
        let why = "is no name: small letters, digits and '_', a letter first";
        refused(
            &with("").replace("\"a\"", &format!("\"{name}\"")),
            &format!("m.toml:6: points.name: '{name}' {why}"),
        );
        refused(
            &with("").replace("\"m\"", &format!("\"{name}\"")),
            &format!("m.toml:1: name: '{name}' {why}"),
        );
        refused(
            &with(&format!("[groups]\n\"{name}\" = [\"a\"]")),
            &format!("m.toml:5: groups.{name}: '{name}' {why}"),
        );
    }
}

#[test]
fn points_on_the_same_registers_name_both_and_the_way_out() {
    let rows = [
        "{ name = \"a\", address = 0x10, type = \"u32\" }",
        "{ name = \"b\", address = 0x11, type = \"u16\" }",
    ];
    refused(
        &points("", &rows),
        "m.toml:6: b.address: 0x0011+1 overlaps a in line 5; \
         if both are meant, set alone = true on one",
    );
}

#[test]
fn an_overlap_is_found_behind_a_point_that_lies_between() {
    let rows = [
        "{ name = \"c\", address = 0x13, type = \"u16\" }",
        "{ name = \"a\", address = 0x10, type = \"u64\" }",
        "{ name = \"b\", address = 0x11, type = \"u16\", alone = true }",
    ];
    refused(
        &points("", &rows),
        "m.toml:5: c.address: 0x0013+1 overlaps a in line 6; \
         if both are meant, set alone = true on one",
    );
}

#[test]
fn points_that_touch_do_not_overlap() {
    let rows = [
        "{ name = \"a\", address = 0x10, type = \"u32\" }",
        "{ name = \"b\", address = 0x12, type = \"u16\" }",
    ];
    assert_eq!(good(&points("", &rows)).points.len(), 2);
}

#[test]
fn a_point_that_is_read_alone_can_overlap() {
    for rows in [
        [
            "{ name = \"a\", address = 0x10, type = \"u32\", alone = true }",
            "{ name = \"b\", address = 0x11, type = \"u16\" }",
        ],
        [
            "{ name = \"a\", address = 0x10, type = \"u32\" }",
            "{ name = \"b\", address = 0x10, type = \"u16\", alone = true }",
        ],
    ] {
        assert_eq!(good(&points("", &rows)).points.len(), 2);
    }
}

#[test]
fn points_of_different_functions_can_have_one_address() {
    let rows = [
        "{ name = \"a\", address = 0x10, type = \"u16\", function = 3 }",
        "{ name = \"b\", address = 0x10, type = \"u16\", function = 4 }",
    ];
    assert_eq!(good(&points("", &rows)).points.len(), 2);
}

#[test]
fn a_point_without_a_function_overlaps_one_of_the_function_it_is_read_with() {
    let rows = [
        "{ name = \"a\", address = 0x10, type = \"u16\" }",
        "{ name = \"b\", address = 0x10, type = \"u16\", function = 3 }",
    ];
    refused(
        &points("", &rows),
        "m.toml:6: b.address: 0x0010+1 overlaps a in line 5; \
         if both are meant, set alone = true on one",
    );
}

#[test]
fn interchangeable_functions_read_the_same_registers_so_points_overlap() {
    let rows = [
        "{ name = \"a\", address = 0x10, type = \"u16\", function = 3 }",
        "{ name = \"b\", address = 0x10, type = \"u16\", function = 4 }",
    ];
    refused(
        &points("limits.interchangeable_reads = true\n", &rows),
        "m.toml:7: b.address: 0x0010+1 overlaps a in line 6; \
         if both are meant, set alone = true on one",
    );
}

#[test]
fn a_point_ends_at_the_last_address_and_not_past_it() {
    good(&point("u16", "").replace("0x10", "0xFFFF"));
    good(&point("u32", "").replace("0x10", "0xFFFE"));
    refused(
        &point("u32", "").replace("0x10", "0xFFFF"),
        "m.toml:6: a.address: 2 registers from 0xFFFF run past 0xFFFF, the last address",
    );
}

#[test]
fn a_point_does_not_cross_the_end_of_a_table() {
    let rows = ["{ name = \"a\", address = 0xFE, type = \"u32\" }"];
    good(&points("limits.table_registers = 256\n", &rows));
    let rows = ["{ name = \"a\", address = 0xFF, type = \"u32\" }"];
    refused(
        &points("limits.table_registers = 256\n", &rows),
        "m.toml:6: a.address: 2 registers from 0x00FF run past the end of its table of 256",
    );
    let rows = ["{ name = \"a\", address = 0xFFFF, type = \"u32\" }"];
    refused(
        &points("limits.table_registers = 256\n", &rows),
        "m.toml:6: a.address: 2 registers from 0xFFFF run past 0xFFFF, the last address",
    );
}

#[test]
fn a_point_takes_no_more_registers_than_one_read_gives() {
    let rows = ["{ name = \"a\", address = 0, type = \"u64\" }"];
    good(&points("limits.read_registers = 4\n", &rows));
    refused(
        &points("limits.read_registers = 3\n", &rows),
        "m.toml:6: a.type: takes 4 registers, and the meter gives 3 in one read",
    );
}

#[test]
fn a_line_that_cannot_be_set_is_refused() {
    refused(
        &with("[line]\nbaud = 0"),
        "m.toml:5: line.baud: 0 is not above 0",
    );
    refused(
        &with("[line]\nparity = \"mark\""),
        "m.toml:5: line.parity: \"mark\" is not \"none\", \"even\" or \"odd\"",
    );
    refused(
        &with("[line]\nstop_bits = 3"),
        "m.toml:5: line.stop_bits: 3 is not 1 or 2",
    );
}

#[test]
fn limits_beyond_the_standard_are_refused() {
    for (limit, expected) in [
        ("highest_unit = 300", "300 is not 247 or 255"),
        ("read_registers = 0", "0 is not 1 to 125"),
        ("read_registers = 126", "126 is not 1 to 125"),
        ("write_registers = 124", "124 is not 1 to 123"),
        ("table_registers = 0", "0 is not 1 to 32768"),
    ] {
        let (key, _) = limit.split_once(' ').expect("key = value");
        refused(
            &with(&format!("[limits]\n{limit}")),
            &format!("m.toml:5: limits.{key}: {expected}"),
        );
    }
}

#[test]
fn a_function_that_is_not_known_or_not_fit_is_refused() {
    for (limit, expected) in [
        (
            "functions = [3, 99]",
            "functions: 99 is not 3, 4, 5, 6, 7, 8 or 16",
        ),
        (
            "functions = [3, 300]",
            "functions: 300 is not a whole number from 0 to 255",
        ),
        (
            "functions = [\n  6,\n  16,\n]",
            "functions: [ 6, 16, ] is not a list with 3 or 4 in it, to read with",
        ),
        (
            "broadcast_functions = [6]",
            "broadcast_functions: 6 is not one of limits.functions",
        ),
        (
            "loopback_data = \"none\"\nfunctions = [3, 8]",
            "loopback_data: \"none\" is not \"any\" or \"zero\"",
        ),
        (
            "loopback_data = \"zero\"",
            "loopback_data: \"zero\" is not of use without 8 in limits.functions",
        ),
        (
            "broadcast_functions = [3]",
            "broadcast_functions: 3 is not 5, 6 or 16, a function that writes",
        ),
    ] {
        refused(
            &with(&format!("[limits]\n{limit}")),
            &format!("m.toml:5: limits.{expected}"),
        );
    }
}

#[test]
fn function_8_sends_back_anything_unless_the_profile_says_otherwise() {
    for (limits, data) in [
        ("functions = [3, 8]", LoopbackData::Any),
        (
            "functions = [3, 8]\nloopback_data = \"any\"",
            LoopbackData::Any,
        ),
        (
            "functions = [3, 8]\nloopback_data = \"zero\"",
            LoopbackData::Zero,
        ),
    ] {
        let profile = good(&with(&format!("[limits]\n{limits}")));
        assert_eq!(profile.limits.loopback_data, data, "{limits}");
    }
}

#[test]
fn a_duration_needs_a_unit() {
    for key in ["typical_answer", "longest_answer", "pause"] {
        refused(
            &with(&format!("[limits]\n{key} = \"500\"")),
            &format!(
                "m.toml:5: limits.{key}: \"500\" is not a duration with its unit, such as \"500ms\", at most 24h"
            ),
        );
        refused(
            &with(&format!("[limits]\n{key} = 5")),
            &format!("m.toml:5: limits.{key}: 5 is not text in quotes"),
        );
    }
}

#[test]
fn a_group_of_a_point_that_does_not_exist_is_refused() {
    refused(
        &with("[groups]\ndefault = [\"a\", \"b\"]"),
        "m.toml:5: groups.default: there is no point 'b'",
    );
    refused(
        &with("[groups]\ndefault = [\n  \"a*\",\n  \"b_*\",\n]"),
        "m.toml:7: groups.default: there is no point 'b_*'",
    );
}

#[test]
fn an_identification_that_cannot_work_is_refused() {
    for (table, message) in [
        (
            "point = \"b\"\ncodes = [1]",
            "5: identification.point: there is no point 'b'",
        ),
        (
            "point = \"a\"\ncodes = []",
            "6: identification.codes: [] is not a list of codes",
        ),
        (
            "point = \"a\"\ncodes = [65536]",
            "6: identification.codes: 65536 is not a whole number from 0 to 65535",
        ),
    ] {
        refused(
            &with(&format!("[identification]\n{table}")),
            &format!("m.toml:{message}"),
        );
    }
    let rows = ["{ name = \"a\", address = 0, type = \"u32\" }"];
    refused(
        &points("identification = { point = \"a\", codes = [1] }\n", &rows),
        "m.toml:4: identification.point: \"a\" is not a point of one register that can be read",
    );
}

#[test]
fn the_longest_answer_takes_some_time() {
    refused(
        &with("[limits]\nlongest_answer = \"0s\""),
        "m.toml:5: limits.longest_answer: \"0s\" is not a time above 0s",
    );
}
