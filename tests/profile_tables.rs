//! The Carlo Gavazzi and Satec meters inside the program, row by row against tables typed from their
//! manuals.

use std::collections::BTreeSet;
use std::time::Duration;

use meterpoll::codec::{FunctionCode, UnitRange};
use meterpoll::profile::point::{Access, Labels, Marker};
use meterpoll::profile::scaling::{Operand, Scaling};
use meterpoll::profile::{LoopbackData, Missing, Point, Profile, builtin};
use meterpoll::transport::LineSettings;

const TABLES: [(&str, &str); 3] = [
    ("em21", include_str!("fixtures/em21.csv")),
    ("em24", include_str!("fixtures/em24.csv")),
    ("pm290", include_str!("fixtures/pm290.csv")),
];

fn meter(name: &str) -> Profile {
    builtin::find(name).expect("it is built in").profile()
}

/// A point as a row of its table.
fn row(point: &Point) -> String {
    let cells = [
        point.name.clone(),
        point.range.start().to_string(),
        point.range.count().to_string(),
        point.kind.to_string(),
        point.order.to_string(),
        scale(&point.scaling),
        point.unit.clone().unwrap_or_default(),
        match point.access {
            Access::Read => "read",
            Access::Write => "write",
            Access::ReadWrite => "read-write",
        }
        .to_owned(),
        point
            .limits
            .map(|(lowest, highest)| format!("{lowest}..{highest}"))
            .unwrap_or_default(),
        match point.no_value {
            None => "",
            Some(no_value) => {
                assert_eq!(no_value.marker, Marker::HighWord(0x7FFF), "{}", point.name);
                assert_eq!(no_value.missing, Missing::Overflow, "{}", point.name);
                "overflow"
            }
        }
        .to_owned(),
        if point.alone { "alone" } else { "" }.to_owned(),
        point.only_with.as_ref().map_or_else(String::new, |with| {
            let codes = with.codes.iter().flatten();
            let codes: Vec<String> = codes.map(u16::to_string).collect();
            format!("{}={}", with.point, codes.join(" "))
        }),
        if point.verified { "yes" } else { "no" }.to_owned(),
    ];
    cells.join(",")
}

fn scale(scaling: &Scaling) -> String {
    let operand = |operand: &Operand| match operand {
        Operand::Number(number) => number.to_string(),
        Operand::Named { name, negative } => format!("{}{name}", if *negative { "-" } else { "" }),
    };
    match scaling {
        Scaling::Times(number) => number.to_string(),
        Scaling::TimesFactor(name) => name.clone(),
        Scaling::TimesByRaw(bands) => {
            let bands: Vec<String> = bands
                .iter()
                .map(|band| format!("{}..{}: {}", band.lowest, band.highest, band.factor))
                .collect();
            bands.join("; ")
        }
        Scaling::Span { full, low, high } => {
            format!("{full}: {}..{}", operand(low), operand(high))
        }
    }
}

#[test]
fn each_row_of_a_table_is_a_point_and_each_point_a_row() {
    for (name, table) in TABLES {
        let mut lines = table.lines();
        let head = "name,address,words,type,order,scale,unit,access,range,no_value,alone,only_with,\
                    verified";
        assert_eq!(lines.next(), Some(head));
        let expected: BTreeSet<String> = lines.map(str::to_owned).collect();
        let found: BTreeSet<String> = meter(name).points.iter().map(row).collect();
        let missing: Vec<&String> = expected.difference(&found).collect();
        let extra: Vec<&String> = found.difference(&expected).collect();
        assert_eq!((missing, extra), (Vec::new(), Vec::new()), "{name}");
        assert_eq!(
            expected.len(),
            table.lines().count() - 1,
            "{name}: rows twice"
        );
    }
}

#[test]
fn each_point_says_what_it_is_and_a_verified_one_on_which_page() {
    for (name, _) in TABLES {
        for point in &meter(name).points {
            assert!(!point.about.is_empty(), "{name}: {}", point.name);
            assert!(
                !point.verified || !point.page.is_empty(),
                "{name}: {}",
                point.name
            );
        }
    }
}

#[test]
fn every_point_is_in_a_group_besides_all() {
    for (name, _) in TABLES {
        let meter = meter(name);
        for (index, point) in meter.points.iter().enumerate() {
            let mut groups = meter.groups.iter().filter(|group| group.name != "all");
            assert!(
                groups.any(|group| group.members.contains(&index)),
                "{name}: {}",
                point.name
            );
        }
    }
}

#[test]
fn the_groups_have_these_members() {
    let sizes = |name: &str| {
        let meter = meter(name);
        let sizes: Vec<String> = meter
            .groups
            .iter()
            .map(|group| format!("{} {}", group.name, group.members.len()))
            .collect();
        sizes.join(", ")
    };
    assert_eq!(
        sizes("em21"),
        "all 42, current 3, default 16, energy 2, frequency 1, identity 3, power 16, resets 1, \
         setpoints 7, status 1, voltage 8"
    );
    assert_eq!(
        sizes("em24"),
        "all 96, counter 4, current 3, default 17, demand 2, energy 17, frequency 1, identity 5, \
         minmax 3, power 16, resets 6, setpoints 27, status 4, voltage 8"
    );
    assert_eq!(
        sizes("pm290"),
        "all 66, current 4, default 15, demand 2, energy 4, frequency 1, identity 1, minmax 5, \
         power 16, reserved 2, setpoints 23, status 5, voltage 3"
    );
}

#[test]
fn the_limits_are_those_of_the_manuals() {
    let function = |code: u8| FunctionCode::try_from(code).expect("a function");
    for name in ["em21", "em24"] {
        let limits = meter(name).limits;
        assert_eq!(limits.units, UnitRange::Standard);
        assert_eq!(limits.functions, [3, 4, 6, 8].map(function));
        assert!(limits.interchangeable_reads);
        assert_eq!(limits.broadcast_functions, [6].map(function));
        assert_eq!(limits.loopback_data, LoopbackData::Any);
        assert_eq!((limits.read_registers, limits.write_registers), (11, 1));
        assert_eq!(limits.table_registers, None);
        assert_eq!(limits.typical_answer, Duration::from_millis(40));
        assert_eq!(limits.longest_answer, Duration::from_millis(500));
    }
    let limits = meter("pm290").limits;
    assert_eq!(limits.units, UnitRange::Standard);
    assert_eq!(limits.functions, [3, 4, 6, 8, 16].map(function));
    assert!(limits.interchangeable_reads);
    assert_eq!(limits.broadcast_functions, [6, 16].map(function));
    assert_eq!(limits.loopback_data, LoopbackData::Any);
    assert_eq!((limits.read_registers, limits.write_registers), (125, 123));
    assert_eq!(limits.table_registers, Some(256));
    assert_eq!(limits.longest_answer, Duration::from_secs(1));
}

#[test]
fn all_of_them_leave_the_factory_without_parity() {
    let line = |baud| LineSettings {
        baud,
        ..LineSettings::default()
    };
    assert_eq!(meter("em21").line, line(19200));
    assert_eq!(meter("em24").line, line(9600));
    assert_eq!(meter("pm290").line, line(9600));
}

#[test]
fn the_identification_codes_tell_the_models() {
    let codes = |name: &str| meter(name).identification.map(|known| known.codes);
    assert_eq!(codes("em21"), Some(vec![57, 58]));
    assert_eq!(codes("em24"), Some(vec![70, 71, 72, 73]));
    assert_eq!(codes("pm290"), None);
}

/// The names of a point's codes or bits.
fn labels(meter: &Profile, point: &str) -> Vec<(u16, String)> {
    match &meter.point(point).expect("a point").labels {
        Labels::None => Vec::new(),
        Labels::Codes(names) | Labels::Bits(names) => names
            .iter()
            .map(|(code, name)| (*code, name.clone()))
            .collect(),
    }
}

#[test]
fn codes_and_bits_have_the_names_of_the_manuals() {
    let check = |name: &str, point: &str, expected: &[(u16, &str)]| {
        let expected: Vec<(u16, String)> = expected
            .iter()
            .map(|(code, name)| (*code, (*name).to_owned()))
            .collect();
        assert_eq!(labels(&meter(name), point), expected, "{name}: {point}");
    };
    let sequence = [(0, "L1-L2-L3"), (0xFFFF, "L1-L3-L2")];
    let systems = [(0, "3P.n"), (1, "3P.1"), (2, "2P"), (3, "1P"), (4, "3P")];
    for name in ["em21", "em24"] {
        check(name, "phase_sequence", &sequence);
        check(name, "measuring_system", &systems);
    }
    check(
        "em21",
        "identification_code",
        &[(57, "EM21 AV5"), (58, "EM21 AV6")],
    );
    check("em21", "application", &[(0, "A"), (1, "B"), (2, "C")]);
    check(
        "em24",
        "identification_code",
        &[
            (70, "EM24-DIN AV9"),
            (71, "EM24-DIN AV2"),
            (72, "EM24-DIN AV5"),
            (73, "EM24-DIN AV6"),
        ],
    );
    check(
        "em24",
        "digital_input_status",
        &[
            (0, "all closed"),
            (1, "input 1 open"),
            (2, "input 2 open"),
            (4, "input 3 open"),
        ],
    );
    check(
        "em24",
        "front_selector_status",
        &[
            (0, "kvarh"),
            (1, "position 2"),
            (2, "position 1"),
            (3, "locked"),
        ],
    );
    check("em24", "rs485_baud_rate", &[(0, "4800"), (1, "9600")]);
    check(
        "pm290",
        "wiring_configuration",
        &[
            (0, "3-wire direct"),
            (1, "4-wire line-to-neutral"),
            (2, "3-wire open delta"),
            (3, "4-wire line-to-line"),
        ],
    );
    check(
        "pm290",
        "relay_status",
        &[
            (1, "relay 4"),
            (2, "relay 3"),
            (4, "relay 2"),
            (8, "relay 1"),
        ],
    );
    check(
        "pm290",
        "reset_mode",
        &[(0, "resets allowed"), (1, "resets forbidden")],
    );
    check("pm290", "pulse_kvarh", &[(0xFFFF, "suppressed")]);
}

#[test]
fn the_inputs_of_the_em24_have_codes_of_their_own() {
    let em24 = meter("em24");
    let names = |point: &str| -> Vec<String> {
        labels(&em24, point)
            .into_iter()
            .map(|(_, name)| name)
            .collect()
    };
    let of_two = [
        "synchronisation",
        "tariff",
        "gas",
        "cold water",
        "hot water",
        "hot water kWh",
        "external counter",
        "remote status",
    ];
    assert_eq!(names("digital_input_1_type"), of_two);
    assert_eq!(names("digital_input_2_type"), of_two);
    assert_eq!(names("digital_input_3_type"), of_two[2..]);
    let pages: Vec<String> = (1..=31).map(|page| format!("page {page}")).collect();
    assert_eq!(names("selector_page_position_0"), pages);
}
