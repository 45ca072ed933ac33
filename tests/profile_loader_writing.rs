//! What the strict loader says about slips in what a profile says of writing.

use meterpoll::profile::Profile;
use meterpoll::profile::load::load;
use meterpoll::profile::point::OnlyWith;
use meterpoll::profile::writing::{Broadcasting, ClockPoints, WriteFunction, Writing};

/// Lines 1 to 4 of every profile here, which answers functions 3, 6 and 16.
const HEAD: &str =
    "name = \"m\"\ntitle = \"Meter\"\nmanual = \"Manual\"\nlimits.functions = [3, 6, 16]\n";

/// The points behind those that are tested.
const OTHERS: &str = "[[points]]\nname = \"mode\"\naddress = 0x80\ntype = \"u16\"\n\
                      [[points]]\nname = \"now\"\naddress = 0x81\ntype = \"time\"\n\
                      [[points]]\nname = \"wide\"\naddress = 0x84\ntype = \"u32\"\n\
                      [[points]]\nname = \"order\"\naddress = 0x86\ntype = \"u16\"\naccess = \"write\"\n";

/// A profile with a point `a` of this type and access, its other keys from line 10.
fn point(kind: &str, access: &str, keys: &str) -> String {
    format!(
        "{HEAD}[[points]]\nname = \"a\"\naddress = 0x10\ntype = \"{kind}\"\n\
         access = \"{access}\"\n{keys}\n{OTHERS}"
    )
}

/// A profile whose point `a` can be read and written.
fn u16_point(keys: &str) -> String {
    point("u16", "read-write", keys)
}

/// A profile of these lines, from line 4 on, and two channels.
fn whole(lines: &str) -> String {
    format!(
        "name = \"m\"\ntitle = \"Meter\"\nmanual = \"Manual\"\n{lines}\n\
         [[points]]\nname = \"c\"\naddress = 0x10\ntype = \"u16\"\naccess = \"read-write\"\nrepeat = 2\n\
         [[points]]\nname = \"t\"\naddress = 0x20\ntype = \"time\"\naccess = \"write\"\n\
         [[points]]\nname = \"d\"\naddress = 0x22\ntype = \"date\"\naccess = \"write\"\n{OTHERS}"
    )
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

#[test]
fn a_point_says_all_there_is_to_know_before_it_is_written() {
    let keys = "limits.broadcast_functions = [16]\n[[points]]\nname = \"a\"\naddress = 0x10\n\
                type = \"time\"\naccess = \"write\"\nhazard = \"sets the clock\"\nmomentary = true\n\
                write_function = 16\nbroadcast = \"only\"\n\
                writable_with = { point = \"mode\", codes = [0, 2] }\nshown_by = \"now\"\n";
    let profile = good(&format!("{HEAD}{keys}{OTHERS}"));
    let expected = Writing {
        hazard: Some("sets the clock".to_owned()),
        momentary: true,
        function: Some(WriteFunction::MultipleRegisters),
        broadcast: Broadcasting::Only,
        only_with: Some(OnlyWith {
            point: "mode".to_owned(),
            codes: Some(vec![0, 2]),
        }),
        shown_by: Some("now".to_owned()),
        ..Writing::default()
    };
    assert_eq!(profile.points[0].writing(), &expected);
    let profile = good(&u16_point("range = [0, 100]\nstep = 5\nalso = [7, 65535]"));
    let expected = Writing {
        step: 5,
        also: vec![7, 65535],
        ..Writing::default()
    };
    assert_eq!(profile.points[0].writing(), &expected);
    let profile = good(&u16_point("allowed = [1, 5, 65535]"));
    assert_eq!(profile.points[0].writing().allowed, [1, 5, 65535]);
}

#[test]
fn a_point_that_says_nothing_of_writing_keeps_nothing() {
    let profile = good(&u16_point("range = [0, 100]\nmomentary = false"));
    assert_eq!(profile.points[0].writing, None);
    assert_eq!(profile.points[0].writing(), &Writing::default());
}

#[test]
fn what_is_only_read_has_none_of_the_keys_for_writing() {
    let keys = [
        "hazard = \"x\"",
        "momentary = true",
        "step = 5",
        "allowed = [1]",
        "also = [1]",
        "write_function = 6",
        "broadcast = \"allowed\"",
        "writable_with = { point = \"mode\", codes = [0] }",
        "shown_by = \"mode\"",
    ];
    for line in keys {
        let (key, _) = line.split_once(' ').expect("a key");
        refused(
            &point("u16", "read", &format!("unit = \"A\"\n{line}")),
            &format!("m.toml:11: a.{key}: only a point that can be written has this"),
        );
    }
    refused(
        &point("u16", "read", "step = 5\nhazard = \"x\""),
        "m.toml:10: a.step: only a point that can be written has this",
    );
}

#[test]
fn a_hazard_is_in_words() {
    refused(
        &u16_point("hazard = \" \""),
        "m.toml:10: a.hazard: \" \" is not a few words that complete \"this ...\"",
    );
    refused(
        &u16_point("hazard = true"),
        "m.toml:10: a.hazard: true is not text in quotes",
    );
}

#[test]
fn steps_and_lists_are_of_integers() {
    refused(
        &point("f32", "read-write", "step = 5"),
        "m.toml:10: a.step: only an integer or a time has a step",
    );
    refused(
        &point("ascii/4", "write", "allowed = [5]"),
        "m.toml:10: a.allowed: only an integer has a list of numbers",
    );
    for step in ["0", "1"] {
        refused(
            &u16_point(&format!("step = {step}")),
            &format!("m.toml:10: a.step: {step} is not 2 or more"),
        );
    }
    refused(
        &u16_point("step = 70000"),
        "m.toml:10: a.step: 70000 is not a whole number from 0 to 65535",
    );
}

#[test]
fn allowed_numbers_are_within_type_and_range_each_of_them_once() {
    refused(
        &u16_point("allowed = []"),
        "m.toml:10: a.allowed: [] is not a list of numbers",
    );
    refused(
        &u16_point("allowed = [1,\n 65536]"),
        "m.toml:11: a.allowed: 65536 is not within 0 to 65535, what u16 holds",
    );
    refused(
        &u16_point("range = [1, 9]\nallowed = [1, 10]"),
        "m.toml:11: a.allowed: 10 is not within range",
    );
    refused(
        &u16_point("allowed = [1, 2, 1]"),
        "m.toml:10: a.allowed: this number is in the list twice",
    );
    refused(
        &u16_point("allowed = [10, 20]\nstep = 10"),
        "m.toml:10: a.allowed: give either allowed or step",
    );
}

#[test]
fn what_is_taken_besides_is_beyond_range_and_step() {
    let message = "m.toml:10: a.also: give it with a range: allowed names every number itself";
    refused(&u16_point("also = [1]"), message);
    refused(
        &u16_point("also = [9]\nrange = [1, 5]\nallowed = [1, 5]"),
        message,
    );
    refused(
        &u16_point("range = [0, 9]\nalso = [7]"),
        "m.toml:11: a.also: 7 is not beyond range and step",
    );
    refused(
        &u16_point("range = [0, 9]\nalso = [-1]"),
        "m.toml:11: a.also: -1 is not within 0 to 65535, what u16 holds",
    );
}

#[test]
fn the_function_that_writes_is_one_the_meter_has_and_fits_the_point() {
    refused(
        &u16_point("write_function = 5"),
        "m.toml:10: a.write_function: 5 is not 6 or 16",
    );
    refused(
        &point("u32", "read-write", "write_function = 6"),
        "m.toml:10: a.write_function: 6 is not 16: function 6 writes one register, u32 takes more",
    );
    let text = u16_point("write_function = 16").replace("[3, 6, 16]", "[3, 6]");
    refused(
        &text,
        "m.toml:10: a.write_function: 16 is not one of limits.functions",
    );
}

#[test]
fn a_broadcast_is_marked_where_the_meter_obeys_it() {
    refused(
        &u16_point("broadcast = \"yes\""),
        "m.toml:10: a.broadcast: \"yes\" is not \"allowed\" or \"only\"",
    );
    refused(
        &u16_point("broadcast = \"allowed\""),
        "m.toml:10: a.broadcast: \"allowed\" is not of use without 6 or 16 in \
         limits.broadcast_functions",
    );
    let text = u16_point("write_function = 16\nbroadcast = \"allowed\"")
        .replace("[3, 6, 16]", "[3, 6, 16]\nlimits.broadcast_functions = [6]");
    refused(
        &text,
        "m.toml:12: a.broadcast: \"allowed\" is not of use without 16 in \
         limits.broadcast_functions",
    );
}

#[test]
fn what_a_write_depends_on_is_a_code_that_can_be_read() {
    refused(
        &u16_point("writable_with = { point = \"mood\", codes = [0] }"),
        "m.toml:10: a.writable_with.point: there is no point 'mood'",
    );
    refused(
        &u16_point("writable_with = { point = \"order\", codes = [0] }"),
        "m.toml:10: a.writable_with.point: \"order\" is not an integer that can be read and whose \
         scale is a number",
    );
    refused(
        &u16_point("writable_with = { point = \"wide\", codes = [0] }"),
        "m.toml:10: a.writable_with.point: \"wide\" is not a point of one register",
    );
    refused(
        &u16_point("writable_with = { point = \"mode\", codes = [] }"),
        "m.toml:10: a.writable_with.codes: [] is not a list of codes",
    );
}

#[test]
fn what_cannot_be_read_is_shown_by_a_point_of_its_type() {
    refused(
        &u16_point("shown_by = \"mode\""),
        "m.toml:10: a.shown_by: only a point that cannot be read is shown by another",
    );
    refused(
        &point("u16", "write", "shown_by = \"mood\""),
        "m.toml:10: a.shown_by: there is no point 'mood'",
    );
    for other in ["order", "now", "wide"] {
        refused(
            &point("u16", "write", &format!("shown_by = \"{other}\"")),
            &format!(
                "m.toml:10: a.shown_by: \"{other}\" is not a point of type u16 that can be read"
            ),
        );
    }
}

#[test]
fn broadcasts_are_of_anything_unless_the_limits_say_marked() {
    let limits = |lines: &str| good(&whole(lines)).limits.broadcasts_marked_only;
    let functions = "limits.functions = [3, 6]\nlimits.broadcast_functions = [6]";
    assert!(!limits(functions));
    assert!(!limits(&format!("{functions}\nlimits.broadcast = \"any\"")));
    assert!(limits(&format!(
        "{functions}\nlimits.broadcast = \"marked\""
    )));
    refused(
        &whole("limits.broadcast = \"all\""),
        "m.toml:4: limits.broadcast: \"all\" is not \"any\" or \"marked\"",
    );
    refused(
        &whole("limits.broadcast = \"marked\""),
        "m.toml:4: limits.broadcast: \"marked\" is not of use without limits.broadcast_functions",
    );
}

#[test]
fn status_bits_are_single_bits_of_a_meter_with_function_07() {
    let bits = "limits.functions = [3, 7]\n";
    let found = good(&whole(&format!(
        "{bits}status_bits = {{ 0x80 = \"b\", 1 = \"a\" }}"
    )));
    let found: Vec<(u8, &str)> = found
        .status_bits
        .iter()
        .map(|(mask, name)| (*mask, name.as_str()))
        .collect();
    assert_eq!(found, [(1, "a"), (0x80, "b")]);
    refused(
        &whole("status_bits = { 1 = \"a\" }"),
        "m.toml:4: status_bits: of no use without 7 in limits.functions",
    );
    for mask in ["0", "3", "0x100", "a"] {
        refused(
            &whole(&format!("{bits}status_bits = {{ {mask} = \"a\" }}")),
            &format!(
                "m.toml:5: status_bits: {mask} is not one bit of eight: 0x01, 0x02, 0x04 to 0x80"
            ),
        );
    }
    refused(
        &whole(&format!("{bits}status_bits = {{ 1 = \"a\", 0x1 = \"b\" }}")),
        "m.toml:5: status_bits: 0x1 is named twice, 'a' and 'b'",
    );
}

#[test]
fn the_clock_is_two_points_next_to_each_other() {
    let found = good(&whole("clock = { time = \"t\", date = \"d\" }")).clock;
    let expected = ClockPoints {
        time: "t".to_owned(),
        date: "d".to_owned(),
    };
    assert_eq!(found, Some(expected));
    refused(
        &whole("clock = { time = \"x\", date = \"d\" }"),
        "m.toml:4: clock.time: there is no point 'x'",
    );
    refused(
        &whole("clock = { time = \"d\", date = \"t\" }"),
        "m.toml:4: clock.time: \"d\" is not a point of type time that can be written",
    );
    refused(
        &whole("clock = { time = \"now\", date = \"d\" }"),
        "m.toml:4: clock.time: \"now\" is not a point of type time that can be written",
    );
    refused(
        &whole("clock = { time = \"t\", date = \"d\" }").replace("0x22", "0x24"),
        "m.toml:4: clock.date: \"d\" is not right behind t: both are set by one write",
    );
    refused(
        &whole("clock = { time = \"t\" }"),
        "m.toml:4: clock.date: this key is missing",
    );
}

#[test]
fn distinct_points_are_two_or_more_settings_of_one_register() {
    let rule = |of: &str| {
        whole(&format!(
            "distinct = [{{ of = [{of}], except = [65535], about = \"why\" }}]"
        ))
    };
    let profile = good(&rule("\"c_2\", \"c_*\""));
    assert_eq!(profile.distinct[0].points, ["c_1", "c_2"]);
    assert_eq!(profile.distinct[0].except, [65535]);
    assert_eq!(profile.distinct[0].about, "why");
    refused(
        &rule("\"e_*\""),
        "m.toml:4: distinct.of: there is no point 'e_*'",
    );
    refused(
        &rule("\"c_1\""),
        "m.toml:4: distinct.of: [\"c_1\"] is not a list of two points or more",
    );
    for other in ["mode", "wide", "order", "t"] {
        refused(
            &rule(&format!("\"c_*\", \"{other}\"")),
            &format!(
                "m.toml:4: distinct.of: \"{other}\" is not integers of one register that can be \
                 read and written"
            ),
        );
    }
}
