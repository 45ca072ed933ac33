//! Scales that follow from setup registers, by small profiles.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use meterpoll::profile::load::load;
use meterpoll::profile::{Missing, Profile, Setup, Value};

/// Setup registers and factors as on a meter that measures in parts of a full scale.
const METER: &str = r#"
name = "m"
title = "Meter"
manual = "Manual"

[factors]
vmax = { by = "pt_ratio", cases = { 10 = 660 }, otherwise = "vmax_of_ratio" }
vmax_of_ratio = { product = [144, "pt_ratio"] }
imax = { product = [1.2, "ct"] }
phases = { by = "wiring", cases = { 1 = 3 }, otherwise = 2 }
pmax = { product = ["vmax", "imax", "phases"] }
step = { by = "format", cases = { 0 = 0.001, 1 = 0.01, 2 = 0.1 } }

[[points]]
name = "wiring"
address = 0x900
type = "u16"
range = [0, 3]
labels = { 1 = "4-wire" }

[[points]]
name = "pt_ratio"
address = 0x901
type = "u16"
scale = 0.1
range = [1, 65000]

[[points]]
name = "ct"
address = 0x902
type = "u16"
range = [1, 50000]

[[points]]
name = "format"
address = 0x903
type = "u16"

[[points]]
name = "volts"
address = 0x100
type = "u16"
span = { full = 9999, low = 0, high = "vmax" }

[[points]]
name = "amperes"
address = 0x101
type = "u16"
span = { full = 9999, low = 0, high = "imax" }

[[points]]
name = "watts"
address = 0x102
type = "u16"
span = { full = 9999, low = "-pmax", high = "pmax" }
only_with = { point = "wiring", codes = [1, 3] }

[[points]]
name = "hertz"
address = 0x103
type = "u16"
span = { full = 9999, low = 45, high = 65 }

[[points]]
name = "counter"
address = 0x104
type = "i32"
scale = "step"

[[points]]
name = "mains"
address = 0x106
type = "i16"
scale = [{ raw = [0, 0], factor = 1 }, { raw = [40, 70], factor = 1 }, { raw = [400, 700], factor = 0.1 }]
"#;

fn meter() -> &'static Profile {
    static LOADED: LazyLock<Profile> =
        LazyLock::new(|| load("m.toml", METER).unwrap_or_else(|error| panic!("{error}")));
    &LOADED
}

/// What these registers of a point read as with this setup.
fn read(point: &str, registers: &[u16], setup: &[(&str, u16)]) -> Result<String, Missing> {
    let meter = meter();
    let point = meter.point(point).expect("a point");
    let needed = Setup::of(std::slice::from_ref(point), Some(meter));
    let held: BTreeMap<String, Vec<u16>> = setup
        .iter()
        .map(|(name, word)| ((*name).to_owned(), vec![*word]))
        .collect();
    point
        .interpret(registers, &needed.scales(&held))
        .map(|value: Value| value.to_string())
}

/// Four wires, ratio 1.0, 200 A.
const SETUP: [(&str, u16); 3] = [("wiring", 1), ("pt_ratio", 10), ("ct", 200)];

#[test]
fn a_point_names_the_setup_registers_that_its_scale_follows_from() {
    let meter = meter();
    let needs = |name: &str| {
        let point = meter.point(name).expect("a point").clone();
        let setup = Setup::of(&[point], Some(meter));
        let names: Vec<String> = setup
            .points()
            .iter()
            .map(|point| point.name.clone())
            .collect();
        names.join(" ")
    };
    assert_eq!(needs("volts"), "pt_ratio");
    assert_eq!(needs("amperes"), "ct");
    assert_eq!(needs("watts"), "ct pt_ratio wiring");
    assert_eq!(needs("counter"), "format");
    assert_eq!(needs("hertz"), "");
    assert_eq!(needs("ct"), "");
}

#[test]
fn both_ends_and_the_middle_of_a_span_are_exact() {
    // Vmax 660 V, Imax 240 A, Pmax 660 * 240 * 3 = 475200 W.
    for (point, raw, figure) in [
        ("volts", 0, "0.000"),
        ("volts", 9999, "660.000"),
        ("volts", 3333, "220.000"),
        ("amperes", 9999, "240.000"),
        ("amperes", 1, "0.024"),
        ("watts", 0, "-475200.00"),
        ("watts", 9999, "475200.00"),
        ("watts", 4999, "-47.52"),
        ("watts", 5000, "47.52"),
        // 6000 / 9999 * 950400 - 475200.
        ("watts", 6000, "95097.03"),
        ("hertz", 0, "45.0000"),
        ("hertz", 2500, "50.0005"),
        ("hertz", 9999, "65.0000"),
    ] {
        assert_eq!(
            read(point, &[raw], &SETUP).as_deref(),
            Ok(figure),
            "{point} {raw}"
        );
    }
}

#[test]
fn no_two_raw_numbers_of_a_span_look_the_same() {
    let meter = meter();
    for name in ["volts", "amperes", "watts", "hertz"] {
        let point = meter.point(name).expect("a point");
        let needed = Setup::of(std::slice::from_ref(point), Some(meter));
        for setup in [SETUP, [("wiring", 3), ("pt_ratio", 65000), ("ct", 50000)]] {
            let held = setup.map(|(name, word)| (name.to_owned(), vec![word]));
            let scales = needed.scales(&held.into());
            let figures = (0..=9999).map(|raw| {
                let value = point.interpret(&[raw], &scales);
                value.expect("a figure").to_string()
            });
            let mut apart: Vec<String> = figures.collect();
            apart.dedup();
            assert_eq!(apart.len(), 10000, "{name}");
        }
    }
}

#[test]
fn a_raw_number_past_the_full_scale_is_no_figure() {
    for raw in [10000, 0x7FFF, 0xFFFF] {
        assert_eq!(read("volts", &[raw], &SETUP), Err(Missing::Mismatch));
        assert_eq!(read("watts", &[raw], &SETUP), Err(Missing::Mismatch));
    }
}

#[test]
fn the_same_raw_number_is_another_figure_on_a_meter_that_is_set_up_otherwise() {
    let with = |wiring, ratio, ct| {
        let setup = [("wiring", wiring), ("pt_ratio", ratio), ("ct", ct)];
        read("watts", &[9999], &setup)
    };
    // 144 V times 35 times 120 A, times 3 and times 2.
    assert_eq!(with(1, 350, 100).as_deref(), Ok("1814400.00"));
    assert_eq!(with(3, 350, 100).as_deref(), Ok("1209600.00"));
    // A ratio of 1.1 is not 1.0.
    assert_eq!(with(1, 11, 100).as_deref(), Ok("57024.00"));
}

#[test]
fn a_point_that_means_nothing_with_the_wiring_is_absent() {
    for wiring in [0, 2] {
        let setup = [("wiring", wiring), ("pt_ratio", 10), ("ct", 200)];
        assert_eq!(read("watts", &[6000], &setup), Err(Missing::Absent));
        assert_eq!(read("volts", &[3333], &setup).as_deref(), Ok("220.000"));
    }
}

#[test]
fn setup_out_of_its_range_gives_no_figures() {
    for setup in [
        [("wiring", 1), ("pt_ratio", 0), ("ct", 200)],
        [("wiring", 1), ("pt_ratio", 65001), ("ct", 200)],
        [("wiring", 1), ("pt_ratio", 10), ("ct", 0)],
        [("wiring", 4), ("pt_ratio", 10), ("ct", 200)],
    ] {
        assert_eq!(
            read("watts", &[6000], &setup),
            Err(Missing::Mismatch),
            "{setup:?}"
        );
    }
}

#[test]
fn setup_that_was_not_read_gives_no_figures() {
    assert_eq!(read("watts", &[6000], &SETUP[..2]), Err(Missing::Mismatch));
    assert_eq!(read("volts", &[6000], &[]), Err(Missing::Mismatch));
}

#[test]
fn decimals_that_another_register_gives_keep_every_digit() {
    let counter = |format| read("counter", &[0x7FFF, 0xFFFF], &[("format", format)]);
    assert_eq!(counter(0).as_deref(), Ok("2147483.647"));
    assert_eq!(counter(1).as_deref(), Ok("21474836.47"));
    assert_eq!(counter(2).as_deref(), Ok("214748364.7"));
    let negative = read("counter", &[0x8000, 0], &[("format", 0)]);
    assert_eq!(negative.as_deref(), Ok("-2147483.648"));
}

#[test]
fn a_code_without_a_case_gives_no_figure() {
    assert_eq!(
        read("counter", &[0, 1], &[("format", 3)]),
        Err(Missing::Mismatch)
    );
}

#[test]
fn a_scale_can_go_by_the_raw_number_itself() {
    for (raw, figure) in [
        (0, "0"),
        (50, "50"),
        (60, "60"),
        (500, "50.0"),
        (600, "60.0"),
    ] {
        assert_eq!(read("mains", &[raw], &[]).as_deref(), Ok(figure));
    }
    for raw in [1, 39, 71, 399, 701, 5000, 0xFFFF] {
        assert_eq!(read("mains", &[raw], &[]), Err(Missing::Mismatch), "{raw}");
    }
}

#[test]
fn factors_and_scales_print_as_formulas() {
    let factors = meter().factors.iter().map(ToString::to_string);
    let factors: Vec<String> = factors.collect();
    assert_eq!(
        factors,
        [
            "imax = 1.2 × ct",
            "phases = 3 for raw wiring 1; else 2",
            "pmax = vmax × imax × phases",
            "step = 0.001 for raw format 0; 0.01 for raw format 1; 0.1 for raw format 2",
            "vmax = 660 for raw pt_ratio 10; else vmax_of_ratio",
            "vmax_of_ratio = 144 × pt_ratio",
        ]
    );
    for (point, expected) in [
        ("ct", "1"),
        ("pt_ratio", "0.1"),
        ("counter", "step"),
        ("watts", "0..9999 → -pmax..pmax"),
        ("hertz", "0..9999 → 45..65"),
        ("mains", "1 at raw 0, 40..70; 0.1 at raw 400..700"),
    ] {
        let point = meter().point(point).expect("a point");
        assert_eq!(point.scaling.to_string(), expected, "{}", point.name);
    }
}

/// A meter whose transformer register says when it is not set, and may hold 0.
const LOOSE: &str = r#"
name = "m"
title = "Meter"
manual = "Manual"
factors.step = { product = [0.1, "ct"] }
points = [
  { name = "ct", address = 0, type = "u16", no_value = { raw = 65535, means = "absent" } },
  { name = "ct_wide", address = 1, type = "i32", no_value = { high_word = 0x7FFF, means = "overflow" } },
  { name = "by_factor", address = 3, type = "u16", scale = "step" },
  { name = "by_point", address = 4, type = "u16", scale = "ct" },
  { name = "by_wide", address = 5, type = "u16", scale = "ct_wide" },
]
"#;

fn loose(point: &str, setup: &[(&str, &[u16])]) -> Result<String, Missing> {
    let meter = load("m.toml", LOOSE).unwrap_or_else(|error| panic!("{error}"));
    let point = meter.point(point).expect("a point");
    let needed = Setup::of(std::slice::from_ref(point), Some(&meter));
    let held = setup
        .iter()
        .map(|(name, words)| ((*name).to_owned(), words.to_vec()))
        .collect();
    let value = point.interpret(&[100], &needed.scales(&held));
    value.map(|value| value.to_string())
}

#[test]
fn setup_that_the_meter_marks_as_not_there_scales_nothing() {
    assert_eq!(loose("by_point", &[("ct", &[40])]).as_deref(), Ok("4000"));
    assert_eq!(loose("by_point", &[("ct", &[65535])]), Err(Missing::Absent));
    assert_eq!(
        loose("by_factor", &[("ct", &[65535])]),
        Err(Missing::Absent)
    );
    let wide = |high| loose("by_wide", &[("ct_wide", &[high, 5])]);
    assert_eq!(wide(0).as_deref(), Ok("500"));
    assert_eq!(wide(0x7FFF), Err(Missing::Overflow));
}

#[test]
fn nothing_is_measured_in_steps_of_0() {
    assert_eq!(loose("by_point", &[("ct", &[0])]), Err(Missing::Mismatch));
    assert_eq!(loose("by_factor", &[("ct", &[0])]), Err(Missing::Mismatch));
}
