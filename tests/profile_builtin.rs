//! The meters inside the program, against tables typed from their manuals.

use std::collections::BTreeMap;
use std::time::Duration;

use meterpoll::codec::value::ByteOrder;
use meterpoll::codec::{FunctionCode, UnitRange};
use meterpoll::profile::load::load;
use meterpoll::profile::point::{Access, Labels};
use meterpoll::profile::{Point, Profile, builtin};
use meterpoll::transport::{LineSettings, Parity, StopBits};

const PQM_TABLE: &str = include_str!("fixtures/pqm.csv");
const PQM_TOML: &str = include_str!("../src/profile/meters/pqm.toml");

fn pqm() -> Profile {
    builtin::find("pqm").expect("the PQM is built in").profile()
}

/// A point as a row of the fixture.
fn row(point: &Point) -> String {
    format!(
        "{},{},{},{},{},{},{}",
        point.name,
        point.range.start(),
        point.range.count(),
        point.kind,
        point.constant_scale().expect("a number"),
        point.unit.as_deref().unwrap_or_default(),
        if point.verified { "yes" } else { "no" },
    )
}

fn name_of(row: &str) -> &str {
    row.split(',').next().unwrap_or_default()
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
    assert_eq!(load("pqm.toml", PQM_TOML).as_ref(), Ok(&pqm()));
}

#[test]
fn each_row_of_the_pqm_table_is_a_point_and_each_point_a_row() {
    let pqm = pqm();
    let mut lines = PQM_TABLE.lines();
    assert_eq!(
        lines.next(),
        Some("name,address,words,type,scale,unit,verified")
    );
    let table: BTreeMap<&str, &str> = lines.map(|line| (name_of(line), line)).collect();
    assert_eq!(table.len(), PQM_TABLE.lines().count() - 1, "names twice");
    for point in &pqm.points {
        let found = row(point);
        assert_eq!(table.get(point.name.as_str()), Some(&found.as_str()));
    }
    for (name, line) in &table {
        assert!(pqm.point(name).is_some(), "no point for {line}");
    }
    assert_eq!(pqm.points.len(), 184);
}

#[test]
fn the_pqm_is_read_high_word_first_and_none_of_its_points_is_written() {
    for point in &pqm().points {
        assert_eq!(point.order, ByteOrder::Abcd, "{}", point.name);
        assert_eq!(point.access, Access::Read, "{}", point.name);
        assert_eq!(point.function, None, "{}", point.name);
        assert_eq!(point.no_value, None, "{}", point.name);
        assert!(!point.alone, "{}", point.name);
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
fn the_pqm_names_the_options_it_is_fitted_with() {
    let pqm = pqm();
    let Some(Labels::Bits(names)) = pqm.point("options").map(|point| &point.labels) else {
        panic!("options are bits");
    };
    let names: Vec<(u16, &str)> = names.iter().map(|(bit, name)| (*bit, &**name)).collect();
    let expected = [
        (0x0001, "display"),
        (0x0002, "T20"),
        (0x0004, "T1"),
        (0x0008, "control"),
        (0x0010, "power analysis"),
    ];
    assert_eq!(names, expected);
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
    assert_eq!(limits.read_registers, 125);
    assert_eq!(limits.write_registers, 60);
    assert!(!limits.read_holes);
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
        ("all", 184),
        ("clock", 2),
        ("current", 6),
        ("default", 24),
        ("demand", 7),
        ("energy", 8),
        ("frequency", 1),
        ("identity", 14),
        ("minmax", 121),
        ("power", 16),
        ("voltage", 9),
    ];
    assert_eq!(sizes, expected);
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
