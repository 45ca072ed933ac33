//! `meters show`: what a meter and its points are, for people and for programs.

mod support {
    pub(crate) mod program;
}

use std::fs;
use std::path::PathBuf;

use meterpoll::profile::{Profile, builtin};
use serde_json::Value;
use support::program::Program;

const BENCH: &str = "tests/fixtures/bench.toml";

/// `meters show` of the meter on the bench.
fn bench(arguments: &str) -> Program {
    Program::new(&format!("meters show {BENCH} {arguments}"))
}

#[test]
fn a_meter_is_shown_with_all_that_its_profile_says() {
    bench("")
        .stdout(include_str!("fixtures/bench_page.txt"))
        .run();
}

#[test]
fn points_that_are_named_come_in_their_order_with_the_formulas_they_need() {
    bench("pt_ratio voltage_a? reset voltage_ab")
        .stdout(
            "bench: Meter on the bench\n\n\
             ADDRESS  NAME        TYPE  SCALE              UNIT  ACCESS        PAGE  LABELS\n\
             0x0901   pt_ratio    u16   0.1                      rw 10..65000  24\n\
             0x0102   voltage_ab  u16   0..9999 → 0..vmax  V                   20\n\
             0x0A00   reset       hex                            w 0xFFFF            reset\n\n\
             vmax = 660 for raw pt_ratio 10; else vmax_of_ratio\n\
             vmax_of_ratio = 144 × pt_ratio\n\n\
             reset  0xFFFF=restart the meter, as after a power failure\n",
        )
        .run();
}

#[test]
fn columns_that_would_be_empty_are_left_out() {
    bench("@default")
        .stdout(
            "bench: Meter on the bench\n\n\
             ADDRESS  NAME         TYPE  SCALE              UNIT  PAGE\n\
             0x0100   voltage_a *  u16   0..9999 → 0..vmax  V     20\n\
             0x0101   voltage_b    u16   0..9999 → 0..vmax  V     20\n\
             0x0102   voltage_ab   u16   0..9999 → 0..vmax  V     20\n\
             0x0110   frequency    u16   by raw             Hz    21\n\n\
             vmax = 660 for raw pt_ratio 10; else vmax_of_ratio\n\
             vmax_of_ratio = 144 × pt_ratio\n\n\
             frequency  1 at raw 40..70; 0.1 at raw 400..700\n\n\
             * not verified: address or scale was not read in the maker's manual\n",
        )
        .run();
}

#[test]
fn quietly_there_is_only_the_table() {
    bench("voltage_a inputs_2 -q")
        .stdout(
            "ADDRESS  NAME         TYPE  SCALE              UNIT  PAGE  LABELS\n\
             0x0100   voltage_a *  u16   0..9999 → 0..vmax  V     20\n\
             0x0131   inputs_2     bits                                 inputs_2\n\n\
             inputs_2  0x0001=input 1, 0x0002=input 2\n",
        )
        .run();
    bench("wiring -q")
        .stdout(
            "ADDRESS  NAME    TYPE  SCALE  ACCESS   PAGE  LABELS\n\
             0x0900   wiring  u16   1      rw 0..2  24    wirings\n\n\
             wirings  0=three wires, two elements, 1=four wires, three elements,\n         \
             2=single phase\n",
        )
        .run();
}

#[test]
fn a_single_point_comes_with_everything_there_is_to_say_about_it() {
    bench("voltage_a")
        .stdout(
            "voltage_a: phase voltage L1-N\n\n\
             registers  0x0100+1\n\
             type       u16\n\
             scale      0..9999 → 0..vmax\n           \
             vmax = 660 for raw pt_ratio 10; else vmax_of_ratio\n           \
             vmax_of_ratio = 144 × pt_ratio\n\
             unit       V\n\
             access     read\n\
             only with  wiring = 1, 2\n\
             verified   no: address or scale was not read in the maker's manual\n\
             page       20 of Bench meter, protocol manual\n",
        )
        .run();
    bench("energy")
        .stdout(
            "energy\n\n\
             registers  0x0120+2, read with function 04; device_code lies there as well\n\
             type       i32, order CDAB: low word first\n\
             scale      0.1\n\
             unit       kWh\n\
             access     read\n\
             no value   high word 0x7FFF means overflow\n\
             verified   yes\n\
             page       22 of Bench meter, protocol manual\n",
        )
        .run();
    bench("device_code")
        .stdout(
            "device_code\n\n\
             registers  0x0120+1, read by a request of its own; energy lies there as well\n\
             type       u16\n\
             scale      1\n\
             access     read\n\
             labels     57 = type A\n           \
             58 = type B\n\
             verified   yes\n\
             page       22 of Bench meter, protocol manual\n",
        )
        .run();
    bench("@commands reset -q")
        .stdout(
            "ADDRESS  NAME       TYPE  SCALE  ACCESS    LABELS\n\
             0x0A00   reset      hex          w 0xFFFF  reset\n\
             0x0910   backlight  u16   1      rw        0=off, 1=on\n\n\
             reset  0xFFFF=restart the meter, as after a power failure\n",
        )
        .run();
}

#[test]
fn a_setpoint_comes_with_what_may_be_written_raw_and_scaled() {
    bench("pt_ratio")
        .stdout(
            "pt_ratio\n\n\
             registers  0x0901+1\n\
             type       u16\n\
             scale      0.1\n\
             access     read-write\n\
             range      10 to 65000 raw, 1.0 to 6500.0\n\
             verified   yes\n\
             page       24 of Bench meter, protocol manual\n",
        )
        .run();
    bench("reset")
        .stdout(
            "reset\n\n\
             registers  0x0A00+1\n\
             type       hex\n\
             access     write\n\
             range      0xFFFF only\n\
             labels     0xFFFF = restart the meter, as after a power failure\n\
             verified   yes\n",
        )
        .run();
}

#[test]
fn csv_has_a_row_for_each_point_and_always_the_same_header() {
    let csv = include_str!("fixtures/bench.csv");
    bench("-f csv").stdout(csv).run();
    let lines: Vec<&str> = csv.lines().collect();
    bench("energy -f csv")
        .stdout(format!("{}\n{}\n", lines[0], lines[6]))
        .run();
}

#[test]
fn json_is_the_whole_profile_in_one_object() {
    bench("-f json")
        .stdout(include_str!("fixtures/bench.json"))
        .run();
}

#[test]
fn json_of_some_points_is_the_same_object_without_the_others() {
    let json = |arguments: &str| -> Value {
        let output = bench(arguments).output();
        serde_json::from_slice(&output.stdout).expect("JSON")
    };
    let mut whole = json("-f json");
    let some = json("-f json wiring reset");
    let points = whole["points"].as_array().expect("an array");
    whole["points"] = vec![points[8].clone(), points[11].clone()].into();
    assert_eq!(whole, some);
}

#[test]
fn what_chooses_no_point_is_refused_as_it_is_for_a_read() {
    for (what, error) in [
        (
            "0x0100",
            "error: '0x0100' is no point of bench\n\
             hint: points are named (current_a), matched (current_*) or grouped (@energy)\n",
        ),
        (
            "power_*",
            "error: no point of bench matches 'power_*'\n\
             hint: groups are @commands, @default; '*' is every point\n",
        ),
        (
            "@power",
            "error: bench has no group '@power'; its groups are @commands, @default\n",
        ),
        (
            "voltage_c",
            "error: bench has no point 'voltage_c'; did you mean voltage_a, voltage_b, \
             voltage_ab?\n",
        ),
    ] {
        bench(what).code(2).stderr(error).run();
    }
    let read = Program::new(&format!(
        "read-registers -p sim: -a 1 --meter {BENCH} power_*"
    ))
    .output();
    let shown = bench("power_*").output();
    assert_eq!(shown.stderr, read.stderr);
}

#[test]
fn control_characters_of_a_profile_do_not_reach_the_terminal() {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("escapes.toml");
    let text = "name = \"m\"\ntitle = \"a\\u001B[2J\"\nmanual = \"b\\nc\"\n\n[[points]]\n\
                name = \"p\"\naddress = 0\ntype = \"u16\"\nunit = \"\\u0007\"\nabout = \"\\u009B\"\n\
                labels = { 1 = \"\\u001Bc, and a long name besides\" }\n";
    fs::write(&path, text).expect("the folder for tests is writable");
    for what in ["", "p", "p -q"] {
        let output = Program::new("meters show")
            .argument(&path)
            .arguments(what)
            .output();
        let text = String::from_utf8(output.stdout).expect("text");
        let is_clean = |c: char| c == '\n' || !c.is_control();
        assert!(text.chars().all(is_clean), "{text:?}");
    }
}

/// The lines of a page above its table.
fn head(page: &str) -> impl Iterator<Item = &str> {
    page.lines().take_while(|line| !line.starts_with("ADDRESS"))
}

#[test]
fn every_built_in_meter_is_shown_in_every_format() {
    for meter in builtin::all() {
        let Profile { name, points, .. } = meter.profile();
        let shown = |format: &str| {
            let output = Program::new(&format!("meters show {name} -f {format}")).output();
            assert_eq!(output.status.code(), Some(0), "{name} {format}");
            assert_eq!(output.stderr, b"", "{name} {format}");
            String::from_utf8(output.stdout).expect("text")
        };
        let page = shown("table");
        let rows = page.lines().filter(|line| line.starts_with("0x"));
        assert_eq!(rows.count(), points.len(), "{name}");
        for line in head(&page) {
            assert!(line.chars().count() <= 80, "{line}");
        }
        assert_eq!(shown("csv").lines().count(), points.len() + 1, "{name}");
        let json: Value = serde_json::from_str(&shown("json")).expect("JSON");
        let found: Vec<&str> = json["points"]
            .as_array()
            .expect("an array")
            .iter()
            .filter_map(|point| point["name"].as_str())
            .collect();
        let names: Vec<&str> = points.iter().map(|point| point.name.as_str()).collect();
        assert_eq!(found, names);
    }
}

#[test]
fn what_a_meter_sends_back_is_shown_where_it_is_not_everything() {
    let shown = |arguments: &str| {
        let output = Program::new(&format!("meters show {arguments}")).output();
        String::from_utf8(output.stdout).expect("text")
    };
    assert!(shown("pqm").contains("\nloop-back    sends back 0000 alone\n"));
    assert!(!shown("em24").contains("loop-back"));
    assert!(shown("pqm -f json").contains("\"loopback_data\":\"zero\""));
    assert!(shown("em24 -f json").contains("\"loopback_data\":\"any\""));
}
