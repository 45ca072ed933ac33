//! `meters check`: what is said of profiles that do not load, and of those that do.

mod support {
    pub(crate) mod program;
}

use std::fs;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};

use meterpoll::profile::builtin;
use support::program::Program;

/// A profile of which there is nothing to say.
const GOOD: &str = r#"name = "m"
title = "Meter"
manual = "Manual"
identification = { point = "code", codes = [7] }
limits.functions = [3, 4, 6]
labels.relays = { 0 = "none", 1 = "relay 1", 2 = "relay 2" }
factors.step = { product = [0.1, "ct"] }
groups.default = ["*"]
points = [
  { name = "code", address = 0x0000, type = "u16", page = "1" },
  { name = "ct", address = 0x0001, type = "u16", page = "1", access = "read-write", range = [1, 9] },
  { name = "current", address = 0x0002, type = "u16", page = "1", scale = "step", unit = "A" },
  { name = "frequency", address = 0x0003, type = "u16", page = "1", scale = 0.01, unit = "Hz" },
  { name = "state", address = 0x0004, type = "bits", page = "1", labels = "relays" },
  { name = "energy", address = 0x0005, type = "i32", page = "1", unit = "kWh" },
]
"#;

/// A file in a folder of its own.
fn file(name: &str, text: &str) -> PathBuf {
    static COUNT: AtomicUsize = AtomicUsize::new(0);
    let count = COUNT.fetch_add(1, Ordering::Relaxed);
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"))
        .join(format!("check-{}-{count}", std::process::id()));
    fs::create_dir_all(&folder).expect("the folder for tests is writable");
    let path = folder.join(name);
    fs::write(&path, text).expect("the folder for tests is writable");
    path
}

/// Checks the advice about the good profile with one piece of it replaced.
#[track_caller]
fn advised(piece: &str, replacement: &str, advice: &[&str]) {
    assert_eq!(GOOD.matches(piece).count(), 1, "{piece}");
    let path = file("m.toml", &GOOD.replace(piece, replacement));
    let lines = advice
        .iter()
        .map(|advice| format!("{}:{advice}\n", path.display()));
    Program::new("meters check -q")
        .argument(&path)
        .stdout(lines.collect::<String>())
        .run();
}

/// The same with a row of a point put behind the others, in line 16.
#[track_caller]
fn advised_of(row: &str, advice: &[&str]) {
    let energy = "\"i32\", page = \"1\", unit = \"kWh\" },\n";
    advised(energy, &format!("{energy}  {{ {row} }},\n"), advice);
}

#[test]
fn a_profile_that_loads_is_told_in_a_line() {
    let path = file("m.toml", GOOD);
    let shown = path.display();
    Program::new("meters check")
        .argument(&path)
        .stdout(format!(
            "{shown}: m (Meter), 6 points, all verified, 1 group\n"
        ))
        .run();
    Program::new("meters check -q").argument(&path).run();
}

#[test]
fn what_does_not_load_is_an_error_and_the_others_are_checked_all_the_same() {
    let good = file("m.toml", GOOD);
    let wrong = file("m.toml", &GOOD.replace("unit = \"kWh\"", "units = \"kWh\""));
    let unlike = file("other.toml", GOOD);
    let output = Program::new("meters check")
        .argument(&wrong)
        .argument("/nonexistent/m.toml")
        .argument(&good)
        .argument(&unlike)
        .output();
    assert_eq!(output.status.code(), Some(2));
    let line = "m (Meter), 6 points, all verified, 1 group";
    assert_eq!(
        String::from_utf8(output.stdout).expect("text"),
        format!(
            "{}: {line}\n{unlike}: {line}\n{unlike}:1: name: to be found by this name, the file \
             must be m.toml\n",
            good.display(),
            unlike = unlike.display(),
        )
    );
    let stderr = String::from_utf8(output.stderr).expect("text");
    assert!(
        stderr.starts_with(&format!(
            "error: {}:15: energy.units: unknown key, expected name, address, repeat, type, ",
            wrong.display()
        )),
        "{stderr}"
    );
    let unreadable = "\nerror: profile /nonexistent/m.toml cannot be read\n  because: ";
    assert!(stderr.contains(unreadable), "{stderr}");
}

#[test]
fn a_file_has_to_be_named() {
    let output = Program::new("meters check").output();
    assert_eq!(output.status.code(), Some(2));
    let stderr = String::from_utf8(output.stderr).expect("text");
    assert!(stderr.contains("<FILE>..."), "{stderr}");
}

#[test]
fn a_meter_that_cannot_be_recognised_is_told() {
    advised(
        "identification = { point = \"code\", codes = [7] }\n",
        "",
        &["1: identification: missing, so nothing tells that a unit is this meter"],
    );
}

#[test]
fn groups_without_points_and_points_without_groups_are_told() {
    advised(
        "groups.default = [\"*\"]",
        "",
        &["1: groups.default: missing, so a read has to name its points"],
    );
    advised(
        "groups.default = [\"*\"]",
        "groups.more = [\"c*\"]\ngroups.default = []",
        &[
            "8: groups: frequency, state, energy are in none",
            "9: groups.default: has no points",
        ],
    );
    advised(
        "groups.default = [\"*\"]",
        "groups.default = [\"e*\"]\n# All others are missing.",
        &["8: groups: code, ct, current, frequency, state are in none"],
    );
    advised(
        "groups.default = [\"*\"]",
        "groups.default = [\"??????*\"]",
        &["8: groups: code, ct, state are in none"],
    );
    advised(
        "groups.default = [\"*\"]",
        "groups.most = [\"c*\", \"f*\", \"e*\"]\ngroups.default = [\"c*\"]",
        &["8: groups: state is in none"],
    );
}

#[test]
fn many_points_in_no_group_are_counted() {
    advised(
        "groups.default = [\"*\"]\npoints = [",
        "groups.default = [\"code\"]\npoints = [\n\
         { name = \"more\", address = 0x0100, type = \"u16\", page = \"1\", repeat = 20 },",
        &["8: groups: ct, current, frequency, state, energy and 20 more are in none"],
    );
}

#[test]
fn a_default_group_that_can_only_be_written_is_told() {
    advised(
        "groups.default = [\"*\"]\npoints = [",
        "groups.default = [\"reset\"]\ngroups.all = [\"*\"]\npoints = [\n\
         { name = \"reset\", address = 0x0100, type = \"u16\", page = \"1\", access = \"write\", \
         range = [1, 1] },",
        &["8: groups.default: has no point that can be read"],
    );
}

#[test]
fn points_on_the_same_registers_are_told_once_where_the_second_one_stands() {
    advised_of(
        "name = \"both\", address = 0x0005, type = \"u16\", page = \"1\", alone = true",
        &["16: both.address: shares registers with energy in line 15"],
    );
    advised_of(
        "name = \"input\", address = 0x0006, type = \"u16\", page = \"1\", function = 4, repeat = 2",
        &["16: input.address: shares registers with energy in line 15"],
    );
}

#[test]
fn tables_that_nobody_uses_are_told() {
    advised(
        "labels.relays = {",
        "labels.lights = { 0 = \"off\" }\nlabels.relays = {",
        &["6: labels.lights: no point has these labels"],
    );
    advised(
        "factors.step = {",
        "factors.old = { product = [\"part\"] }\nfactors.part = { product = [2] }\nfactors.step = {",
        &["7: factors.old: nothing is scaled with it"],
    );
}

#[test]
fn names_of_more_than_one_bit_are_told() {
    advised(
        "2 = \"relay 2\" }",
        "2 = \"relay 2\", 0x3 = \"both\" }",
        &["6: labels.relays: 0x0003 is more than one bit; the name shows when all of them are set"],
    );
    advised_of(
        "name = \"lamps\", address = 0x10, type = \"bits\", page = \"1\", labels = { 12 = \"all\" }",
        &["16: lamps.labels: 0x000C is more than one bit; the name shows when all of them are set"],
    );
    // What is no set of bits may have any code.
    advised_of(
        "name = \"lamp\", address = 0x10, type = \"u16\", page = \"1\", labels = { 12 = \"red\" }",
        &[],
    );
}

#[test]
fn what_may_be_written_without_bounds_is_told() {
    advised(
        ", range = [1, 9] }",
        " }",
        &["11: ct.range: missing, so whatever the type holds may be written"],
    );
    // Text has no bounds.
    advised_of(
        "name = \"label\", address = 0x10, type = \"ascii/8\", page = \"1\", access = \"write\"",
        &[],
    );
}

#[test]
fn points_that_no_function_writes_are_told_once() {
    advised(
        "limits.functions = [3, 4, 6]",
        "",
        &["11: ct.access: can be written, and limits.functions has neither 6 nor 16"],
    );
    advised(
        "limits.functions = [3, 4, 6]",
        "limits.functions = [3, 16]",
        &[],
    );
}

#[test]
fn a_missing_page_is_told_of_each_point_unless_all_lack_it() {
    advised(
        "type = \"i32\", page = \"1\"",
        "type = \"i32\"",
        &["15: energy.page: missing; a point not read in the manual has verified = false"],
    );
    advised(
        "type = \"i32\", page = \"1\"",
        "type = \"i32\", verified = false",
        &[],
    );
    let path = file("m.toml", &GOOD.replace("page = \"1\"", "about = \"\""));
    let shown = path.display();
    Program::new("meters check -q")
        .argument(&path)
        .stdout(format!(
            "{shown}:10: points: no point has the page of the manual it was read on\n"
        ))
        .run();
}

#[test]
fn a_scaled_number_without_a_unit_is_told_unless_it_can_have_none() {
    let missing = "missing, and the number is scaled; \"\" says that it has none";
    advised(
        "scale = \"step\", unit = \"A\"",
        "scale = \"step\"",
        &[&format!("12: current.unit: {missing}")],
    );
    advised_of(
        "name = \"x\", address = 0x10, type = \"u16\", page = \"1\", \
         span = { full = 9999, low = 0, high = 5 }",
        &[&format!("16: x.unit: {missing}")],
    );
    for row in [
        "name = \"x\", scale = 0.1, unit = \"\"",
        "name = \"power_factor_a\", scale = 0.01",
        "name = \"pf\", scale = 0.01",
        "name = \"vt_ratio\", scale = 0.1",
        "name = \"level\", scale = 0.1, labels = { 0 = \"off\" }",
        "name = \"x\"",
    ] {
        let row = format!("{row}, address = 0x10, type = \"u16\", page = \"1\"");
        advised_of(&row, &[]);
    }
}

#[test]
fn factors_that_are_no_power_of_ten_are_told() {
    for (scale, is_odd) in [
        ("0.3", true),
        ("2", true),
        ("-0.1", true),
        ("0.001", false),
        ("100", false),
    ] {
        let advice = format!(
            "16: x.scale: {scale} is no power of ten; a ratio that is set in the meter belongs in \
             [factors]"
        );
        let advice = [advice.as_str()];
        advised_of(
            &format!(
                "name = \"x\", address = 0x10, type = \"u16\", page = \"1\", unit = \"V\", \
                 scale = {scale}"
            ),
            if is_odd { &advice } else { &[] },
        );
    }
}

#[test]
fn a_scaled_float_is_told() {
    advised_of(
        "name = \"x\", address = 0x10, type = \"f32\", page = \"1\", unit = \"kW\", scale = 0.001",
        &["16: x.scale: a float mostly is in its unit already"],
    );
    advised_of(
        "name = \"x\", address = 0x10, type = \"f32\", page = \"1\"",
        &[],
    );
}

#[test]
fn a_frequency_that_cannot_be_the_mains_is_told() {
    let no = ["16: hz.scale: no raw number gives 50 or 60 Hz"];
    let span = ["16: hz.span: no raw number gives 50 or 60 Hz"];
    for (keys, advice) in [
        ("type = \"u16\", scale = 0.0001", &no[..]),
        ("type = \"u16\", scale = 100", &no),
        ("type = \"i16\", scale = 0.001", &no),
        ("type = \"u16\", scale = 0.001", &[]),
        ("type = \"u16\", scale = 10", &[]),
        ("type = \"u16\"", &[]),
        (
            "type = \"u16\", span = { full = 9999, low = 0, high = 10 }",
            &span,
        ),
        (
            "type = \"u16\", span = { full = 9999, low = 45, high = 65 }",
            &[],
        ),
        (
            "type = \"u16\", scale = [{ raw = [0, 30], factor = 1 }]",
            &no,
        ),
        (
            "type = \"u16\", scale = [{ raw = [0, 30], factor = 1 }, { raw = [400, 700], factor = 0.1 }]",
            &[],
        ),
        ("type = \"u16\", scale = \"step\"", &[]),
        // A setpoint may be a difference.
        (
            "type = \"u16\", scale = 0.01, access = \"read-write\", range = [0, 100]",
            &[],
        ),
    ] {
        let row = format!("name = \"hz\", address = 0x10, page = \"1\", unit = \"Hz\", {keys}");
        advised_of(&row, advice);
    }
}

#[test]
fn a_power_factor_or_percentage_in_coarse_steps_is_told() {
    let whole = "a power factor in whole numbers can only be -1, 0 or 1";
    advised_of(
        "name = \"power_factor_a\", address = 0x10, type = \"i16\", page = \"1\"",
        &[&format!("16: power_factor_a.scale: {whole}")],
    );
    let energy = "\"i32\", page = \"1\", unit = \"kWh\" },\n";
    advised(
        &format!("{energy}]\n"),
        &format!(
            "{energy}{{ name = \"lambda\", address = 0x10, type = \"i16\", page = \"1\" }},\n]\n\
             identities = [{{ power_factor = \"lambda\", real = \"energy\", apparent = \"ct\" }}]\n"
        ),
        &[&format!("16: lambda.scale: {whole}")],
    );
    advised_of(
        "name = \"x\", address = 0x10, type = \"u16\", page = \"1\", unit = \"%\", scale = 10",
        &["16: x.scale: a percentage in steps of 10"],
    );
}

#[test]
fn a_signed_counter_of_16_bits_is_told() {
    for unit in ["kWh", "Mvarh", "VAh"] {
        advised_of(
            &format!(
                "name = \"x\", address = 0x10, type = \"i16\", page = \"1\", unit = \"{unit}\""
            ),
            &["16: x.type: a counter of energy that turns over at 32767, into the negative"],
        );
    }
}

/// What is said of the meters inside the program, without the lines. All of it is true: these
/// things the manuals do not say, or mean so.
const KNOWN: &str = include_str!("fixtures/advice.txt");

#[test]
fn the_advice_about_the_built_in_meters_is_known() {
    let mut found = String::new();
    for meter in builtin::all() {
        let path = file(&format!("{}.toml", meter.name), meter.text);
        let output = Program::new("meters check -q").argument(&path).output();
        assert_eq!(output.status.code(), Some(0), "{}", meter.name);
        assert_eq!(output.stderr, b"", "{}", meter.name);
        let text = String::from_utf8(output.stdout).expect("text");
        for line in text.lines() {
            let line = line.strip_prefix(&format!("{}:", path.display()));
            let (_, advice) = line.and_then(|line| line.split_once(": ")).expect(&text);
            let advice = advice.split(" in line ").next().unwrap_or_default();
            found.extend([meter.name, ": ", advice, "\n"]);
        }
    }
    assert_eq!(found, KNOWN);
}
