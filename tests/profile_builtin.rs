//! The meters inside the program, against tables typed from their manuals.

use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

use meterpoll::codec::value::{ByteOrder, RegisterType};
use meterpoll::codec::{FunctionCode, UnitRange};
use meterpoll::profile::load::load;
use meterpoll::profile::point::{Access, Labels};
use meterpoll::profile::{LoopbackData, Point, Profile, builtin};
use meterpoll::transport::{LineSettings, Parity, StopBits};

/// Every row of the PQM's memory map that is known well enough. `labels` is the manual's format, or
/// the one number with a name; a row of more words than its type takes repeats.
const PQM_TABLE: &str = include_str!("fixtures/pqm.csv");
/// The manual's formats that name codes or bits.
const PQM_LABELS: &str = include_str!("fixtures/pqm_labels.csv");
const PQM_TOML: &str = include_str!("../src/profile/meters/pqm.toml");

fn pqm() -> Profile {
    builtin::find("pqm").expect("the PQM is built in").profile()
}

/// A row of the fixture.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Row {
    name: String,
    address: u16,
    words: u16,
    kind: String,
    scale: String,
    unit: String,
    access: String,
    range: String,
    labels: BTreeMap<u16, String>,
    verified: bool,
}

fn number(text: &str) -> u16 {
    let number = match text.strip_prefix("0x") {
        Some(hex) => u16::from_str_radix(hex, 16),
        None => text.parse(),
    };
    number.unwrap_or_else(|_| panic!("'{text}' is no number"))
}

/// The label tables of the fixture, by format.
fn formats() -> BTreeMap<&'static str, BTreeMap<u16, String>> {
    let mut lines = PQM_LABELS.lines();
    assert_eq!(lines.next(), Some("format,code,name"));
    let mut formats: BTreeMap<_, BTreeMap<_, _>> = BTreeMap::new();
    for line in lines {
        let [format, code, name] = cells(line);
        let first = formats
            .entry(format)
            .or_default()
            .insert(number(code), name.to_owned());
        assert_eq!(first, None, "{line}: twice");
    }
    formats
}

fn cells<const N: usize>(line: &str) -> [&str; N] {
    let cells: Vec<&str> = line.split(',').collect();
    cells
        .try_into()
        .unwrap_or_else(|_| panic!("{line}: not {N} cells"))
}

/// The rows of the fixture, one a point.
fn pqm_rows() -> Vec<Row> {
    let formats = formats();
    let mut lines = PQM_TABLE.lines();
    assert_eq!(
        lines.next(),
        Some("name,address,words,type,scale,unit,access,range,labels,verified")
    );
    let rows = lines.flat_map(|line| {
        let [
            name,
            address,
            words,
            kind,
            scale,
            unit,
            access,
            range,
            labels,
            verified,
        ] = cells(line);
        let labels = match labels.split_once('=') {
            Some((code, name)) => BTreeMap::from([(number(code), name.to_owned())]),
            None if labels.is_empty() => BTreeMap::new(),
            None => formats[labels].clone(),
        };
        let width = kind.parse::<RegisterType>().expect("a type").registers();
        let row = Row {
            name: name.to_owned(),
            address: number(address),
            words: width,
            kind: kind.to_owned(),
            scale: scale.to_owned(),
            unit: unit.to_owned(),
            access: access.to_owned(),
            range: range.to_owned(),
            labels,
            verified: verified == "yes",
        };
        let count = number(words) / width;
        assert_eq!(count * width, number(words), "{line}");
        (0..count).map(move |place| match count {
            1 => row.clone(),
            _ => Row {
                name: format!("{}_{}", row.name, place + 1),
                address: row.address + place * width,
                ..row.clone()
            },
        })
    });
    rows.collect()
}

/// A point as a row of the fixture.
fn row(point: &Point) -> Row {
    let access = match point.access {
        Access::Read => "read",
        Access::Write => "write",
        Access::ReadWrite => "read-write",
    };
    let range = point.limits.map(|(least, most)| format!("{least}..{most}"));
    let labels = match &point.labels {
        Labels::None => BTreeMap::new(),
        Labels::Codes(names) | Labels::Bits(names) => names.as_ref().clone(),
    };
    Row {
        name: point.name.clone(),
        address: point.range.start().get(),
        words: point.range.count(),
        kind: point.kind.to_string(),
        scale: point.constant_scale().expect("a number").to_string(),
        unit: point.unit.clone().unwrap_or_default(),
        access: access.to_owned(),
        range: range.unwrap_or_default(),
        labels,
        verified: point.verified,
    }
}

fn members<'a>(profile: &'a Profile, group: &str) -> Vec<&'a str> {
    let points = profile.group(group).expect("the group exists");
    points.map(|point| point.name.as_str()).collect()
}

#[test]
fn every_built_in_meter_unpacks_and_bears_its_name_and_title() {
    for meter in builtin::all() {
        let profile = meter.profile();
        assert_eq!(profile.name, meter.name);
        assert!(!profile.title.is_empty());
        assert!(!profile.points.is_empty(), "{} has points", meter.name);
    }
}

#[test]
fn every_built_in_meter_has_a_default_group() {
    for meter in builtin::all() {
        let profile = meter.profile();
        assert!(
            profile
                .group(Profile::DEFAULT_GROUP)
                .is_some_and(|mut points| points.next().is_some()),
            "{}",
            meter.name
        );
    }
}

#[test]
fn a_name_that_no_meter_has_finds_nothing() {
    assert!(builtin::find("pqm2").is_none());
    assert!(builtin::find("PQM").is_none());
    assert!(builtin::find("").is_none());
}

#[test]
fn what_the_build_packed_is_what_the_file_says() {
    for meter in builtin::all() {
        let file = format!("{}.toml", meter.name);
        assert_eq!(load(&file, meter.text).as_ref(), Ok(&meter.profile()));
    }
}

#[test]
fn the_labels_of_an_operation_s_data_survive_the_packing() {
    let pqm = pqm();
    let data = |name: &str| {
        pqm.operation(name)
            .expect("it is there")
            .data()
            .expect("data")
    };
    assert_eq!(data("simulate_key").label(97), Some("value down"));
    assert_eq!(
        data("simulate_key").label_table.as_deref(),
        Some("simulated_keys")
    );
    match &data("test_relays_and_leds").labels {
        Labels::Bits(names) => assert_eq!(names[&0x0800], "aux 3 LED"),
        other => panic!("{other:?}"),
    }
}

#[test]
fn each_row_of_the_pqm_table_is_a_point_and_each_point_a_row() {
    let pqm = pqm();
    let mut rows = pqm_rows();
    rows.sort_by_key(|row| row.address);
    let names: BTreeSet<&str> = rows.iter().map(|row| row.name.as_str()).collect();
    assert_eq!(names.len(), rows.len(), "names twice");
    for (point, expected) in pqm.points.iter().zip(&rows) {
        assert_eq!(row(point), *expected);
    }
    assert_eq!(pqm.points.len(), rows.len());
    assert_eq!(pqm.points.len(), 979);
}

#[test]
fn the_pqm_names_codes_and_bits_as_its_manual_does() {
    let file: toml::Table = PQM_TOML.parse().expect("it is TOML");
    let tables = file["labels"].as_table().expect("tables of labels");
    let found: BTreeSet<BTreeMap<u16, String>> = tables
        .values()
        .map(|table| {
            let names = table.as_table().expect("a table").iter();
            names
                .map(|(code, name)| (number(code), name.as_str().expect("a name").to_owned()))
                .collect()
        })
        .collect();
    // Formats F102 and F103 name the same lights.
    let expected: BTreeSet<_> = formats().into_values().collect();
    assert_eq!(found, expected);
}

#[test]
fn the_pqm_is_read_high_word_first_and_with_either_function() {
    for point in &pqm().points {
        assert_eq!(point.order, ByteOrder::Abcd, "{}", point.name);
        assert_eq!(point.function, None, "{}", point.name);
        assert_eq!(point.no_value, None, "{}", point.name);
        assert!(!point.alone, "{}", point.name);
    }
}

#[test]
fn pqm_points_can_be_read_and_written_as_the_area_they_lie_in() {
    for point in &pqm().points {
        let expected = match point.range.start().get() {
            // Commands and the clock of all meters at once.
            0x0080..=0x00FF => Access::Write,
            // The user map index and the setpoints.
            0x0180..=0x01FF | 0x1000..=0x131F => Access::ReadWrite,
            _ => Access::Read,
        };
        assert_eq!(point.access, expected, "{}", point.name);
    }
}

#[test]
fn each_pqm_point_says_what_it_is_and_which_page_has_it() {
    for point in &pqm().points {
        assert!(!point.about.is_empty(), "{}", point.name);
        for page in point.page.split(' ') {
            let number = page
                .strip_prefix(['N', 'O'])
                .and_then(|number| number.parse::<u16>().ok());
            assert!(
                number.is_some_and(|page| page <= 348),
                "{}: {page}",
                point.name
            );
        }
    }
}

#[test]
fn the_pqm_leaves_the_factory_at_9600_8n1() {
    let expected = LineSettings {
        baud: 9600,
        parity: Parity::None,
        stop_bits: StopBits::One,
    };
    assert_eq!(pqm().line, expected);
}

#[test]
fn the_pqm_has_the_limits_of_its_manual() {
    let limits = pqm().limits;
    let function = |code: u8| FunctionCode::try_from(code).unwrap();
    assert_eq!(limits.units, UnitRange::Extended);
    assert_eq!(limits.functions, [3, 4, 5, 6, 7, 8, 16].map(function));
    assert!(limits.interchangeable_reads);
    assert_eq!(limits.broadcast_functions, [5, 16].map(function));
    assert_eq!(limits.loopback_data, LoopbackData::Zero);
    assert_eq!(limits.read_registers, 125);
    assert_eq!(limits.write_registers, 60);
    assert!(limits.read_holes);
    assert_eq!(limits.table_registers, None);
    assert_eq!(limits.typical_answer, Duration::ZERO);
    assert_eq!(limits.longest_answer, Duration::from_secs(1));
    assert_eq!(limits.pause, Duration::ZERO);
}

#[test]
fn a_pqm_is_known_by_product_code_65() {
    let identification = pqm().identification.expect("there is one");
    assert_eq!(identification.point, "product_code");
    assert_eq!(identification.codes, [65]);
}

#[test]
fn the_pqm_shows_these_points_when_none_is_named() {
    let expected = [
        "current_a",
        "current_b",
        "current_c",
        "current_avg",
        "current_n",
        "voltage_an",
        "voltage_bn",
        "voltage_cn",
        "voltage_ln_avg",
        "voltage_ab",
        "voltage_bc",
        "voltage_ca",
        "voltage_ll_avg",
        "voltage_unbalance",
        "real_power_total",
        "reactive_power_total",
        "apparent_power_total",
        "power_factor_total",
        "energy_real_pos",
        "energy_real_neg",
        "energy_reactive_pos",
        "energy_reactive_neg",
        "energy_apparent",
        "frequency",
    ];
    assert_eq!(members(&pqm(), "default"), expected);
}

#[test]
fn the_pqm_has_these_groups() {
    let pqm = pqm();
    let sizes: Vec<(&str, usize)> = pqm
        .groups
        .iter()
        .map(|group| (group.name.as_str(), group.members.len()))
        .collect();
    let expected = [
        ("alarm", 102),
        ("all", 979),
        ("analog", 44),
        ("clear", 10),
        ("clock", 4),
        ("command", 13),
        ("current", 6),
        ("datalog", 114),
        ("default", 24),
        ("demand", 7),
        ("diagnosis", 7),
        ("display", 6),
        ("energy", 8),
        ("event", 62),
        ("frequency", 1),
        ("harmonics", 18),
        ("identity", 15),
        ("minmax", 151),
        ("port", 12),
        ("power", 16),
        ("pulse", 13),
        ("pulse_output", 12),
        ("relay", 9),
        ("setpoints", 337),
        ("simulation", 25),
        ("status", 30),
        ("switch", 17),
        ("system", 14),
        ("tariff", 7),
        ("trace", 19),
        ("usermap", 240),
        ("voltage", 9),
    ];
    assert_eq!(sizes, expected);
}

#[test]
fn setpoints_are_all_that_is_set_but_for_the_user_map() {
    let pqm = pqm();
    let mut found = members(&pqm, "setpoints");
    let mut expected: Vec<&str> = pqm
        .points
        .iter()
        .filter(|point| point.range.start().get() >= 0x1000)
        .map(|point| point.name.as_str())
        .collect();
    found.sort_unstable();
    expected.sort_unstable();
    assert_eq!(found, expected);
}

fn is_extreme(name: &str) -> bool {
    ["_min", "_max", "_time", "_date"]
        .iter()
        .any(|end| name.ends_with(end))
}

#[test]
fn the_groups_of_live_pqm_values_hold_nothing_else() {
    let pqm = pqm();
    for group in [
        "default",
        "current",
        "voltage",
        "power",
        "energy",
        "demand",
        "frequency",
        "harmonics",
    ] {
        let extremes: Vec<&str> = members(&pqm, group)
            .into_iter()
            .filter(|name| is_extreme(name))
            .collect();
        assert!(extremes.is_empty(), "@{group}: {extremes:?}");
    }
}

#[test]
fn minmax_holds_every_lowest_and_highest_pqm_value_with_its_time_stamp() {
    let pqm = pqm();
    let mut found = members(&pqm, "minmax");
    let position = |name| found.iter().position(|found| *found == name);
    let value = position("current_b_min").expect("it is there");
    assert_eq!(position("current_b_min_time"), Some(value + 1));
    assert_eq!(position("current_b_min_date"), Some(value + 2));
    let mut expected: Vec<&str> = pqm
        .points
        .iter()
        .filter(|point| point.access == Access::Read)
        .map(|point| point.name.as_str())
        .filter(|name| name.contains("_min") || name.contains("_max"))
        .collect();
    found.sort_unstable();
    expected.sort_unstable();
    assert_eq!(found, expected);
}

#[test]
fn every_pqm_point_is_in_a_group_besides_all() {
    let pqm = pqm();
    for (index, point) in pqm.points.iter().enumerate() {
        let mut groups = pqm.groups.iter().filter(|group| group.name != "all");
        assert!(
            groups.any(|group| group.members.contains(&index)),
            "{}",
            point.name
        );
    }
}
