//! The read plan, case by case.

use std::time::Duration;

use meterpoll::codec::value::{ByteOrder, RegisterType};
use meterpoll::codec::{ReadFunction, RegisterRange, Request};
use meterpoll::profile::plan::{Cost, Plan, PlannedRead, Rules};
use meterpoll::profile::{Limits, Point};
use meterpoll::transport::{LineSettings, Parity};

const HOLDING: ReadFunction = ReadFunction::HoldingRegisters;

fn range(start: u16, count: u16) -> RegisterRange {
    RegisterRange::new(start, count).expect("a range")
}

/// A point of any width; the planner looks at its place alone.
fn point(start: u16, count: u16) -> Point {
    Point::raw(range(start, count), RegisterType::U16, ByteOrder::Abcd)
}

fn points(places: &[(u16, u16)]) -> Vec<Point> {
    places
        .iter()
        .map(|(start, count)| point(*start, *count))
        .collect()
}

fn alone(start: u16) -> Point {
    Point {
        alone: true,
        ..point(start, 1)
    }
}

fn with_holes() -> Limits {
    Limits {
        read_holes: true,
        ..Limits::default()
    }
}

/// On a line at 9600 8N1.
fn cost(limits: &Limits) -> Cost {
    Cost::new(LineSettings::default(), limits.pause, limits.typical_answer)
}

fn plan(points: &[Point], limits: &Limits) -> Plan {
    Plan::new(points, HOLDING, &Rules::new(limits), cost(limits))
}

/// Start and count of each read.
fn reads(points: &[Point], limits: &Limits) -> Vec<(u16, u16)> {
    plan(points, limits)
        .reads
        .iter()
        .map(|read| (read.range.start().get(), read.range.count()))
        .collect()
}

#[test]
fn nothing_to_read_is_no_read() {
    assert_eq!(plan(&[], &Limits::default()), Plan::default());
}

#[test]
fn neighbours_are_read_together() {
    let points = points(&[(2, 1), (0, 2), (3, 4)]);
    assert_eq!(
        plan(&points, &Limits::default()).reads,
        [PlannedRead {
            function: HOLDING,
            range: range(0, 7),
            points: vec![1, 0, 2],
        }]
    );
}

#[test]
fn a_read_asks_for_its_registers_with_its_function() {
    let reads = plan(&points(&[(0x6B, 3)]), &Limits::default()).reads;
    assert_eq!(
        reads[0].request(),
        Request::Read {
            function: HOLDING,
            range: range(0x6B, 3),
        }
    );
}

#[test]
fn points_that_share_registers_are_read_once() {
    assert_eq!(
        reads(
            &points(&[(0, 4), (2, 1), (0, 4), (3, 3)]),
            &Limits::default()
        ),
        [(0, 6)]
    );
}

#[test]
fn more_than_125_registers_become_several_reads() {
    let full: Vec<Point> = (0..125).map(|start| point(start, 1)).collect();
    assert_eq!(reads(&full, &Limits::default()), [(0, 125)]);
    let over: Vec<Point> = (0..251).map(|start| point(start, 1)).collect();
    let counts: Vec<u16> = reads(&over, &Limits::default())
        .into_iter()
        .map(|(_, count)| count)
        .collect();
    assert_eq!(counts.len(), 3);
    assert_eq!(counts.iter().sum::<u16>(), 251);
}

#[test]
fn a_meter_of_11_registers_is_read_11_at_a_time() {
    let limits = Limits {
        read_registers: 11,
        ..with_holes()
    };
    let pairs: Vec<Point> = (0..11).map(|index| point(2 * index, 2)).collect();
    let reads = reads(&pairs, &limits);
    assert_eq!(reads.len(), 3);
    assert!(
        reads
            .iter()
            .all(|(start, count)| start % 2 == 0 && *count <= 10)
    );
}

#[test]
fn a_point_is_never_cut() {
    let wide = points(&[(0, 100), (100, 50)]);
    assert_eq!(reads(&wide, &Limits::default()), [(0, 100), (100, 50)]);
}

#[test]
fn a_hole_is_crossed_only_where_the_meter_allows_it() {
    let apart = points(&[(0, 1), (2, 1)]);
    assert_eq!(reads(&apart, &Limits::default()), [(0, 1), (2, 1)]);
    assert_eq!(reads(&apart, &with_holes()), [(0, 3)]);
}

/// The widest hole that is read through rather than around, if one read can hold it.
fn widest_hole(settings: LineSettings, answer: Duration) -> Option<u16> {
    let rules = Rules::new(&with_holes());
    let cost = Cost::new(settings, Duration::ZERO, answer);
    let merges = |gap| {
        Plan::new(&points(&[(0, 1), (1 + gap, 1)]), HOLDING, &rules, cost)
            .reads
            .len()
            == 1
    };
    let widest = (1..=123)
        .rev()
        .find(|gap| merges(*gap))
        .expect("a gap of 1 is read through");
    assert!(
        (1..=widest).all(merges),
        "every narrower hole is read through"
    );
    (widest < 123).then_some(widest)
}

/// Milliseconds until the meter answers, parity, and the widest hole worth reading at 1200 to
/// 115200 baud; `None` where it is wider than one read.
type BreakEven = (u64, Parity, [Option<u16>; 8]);

const BAUDS: [u32; 8] = [1200, 2400, 4800, 9600, 19_200, 38_400, 57_600, 115_200];

const fn all(gaps: [u16; 8]) -> [Option<u16>; 8] {
    let mut some = [None; 8];
    let mut index = 0;
    while index < gaps.len() {
        if gaps[index] <= 123 {
            some[index] = Some(gaps[index]);
        }
        index += 1;
    }
    some
}

/// More than any read can hold.
const ANY: u16 = 124;

const BREAK_EVEN: [BreakEven; 11] = [
    (0, Parity::None, all([10, 10, 10, 10, 10, 13, 16, 26])),
    (5, Parity::None, all([10, 10, 11, 12, 14, 22, 30, 55])),
    (10, Parity::None, all([10, 11, 12, 14, 19, 32, 45, 84])),
    (16, Parity::None, all([10, 11, 13, 17, 25, 43, 62, 118])),
    (20, Parity::None, all([11, 12, 14, 19, 29, 51, 74, ANY])),
    (40, Parity::None, all([12, 14, 19, 29, 48, 90, ANY, ANY])),
    (100, Parity::None, all([16, 22, 34, 58, 106, ANY, ANY, ANY])),
    (
        200,
        Parity::None,
        all([22, 34, 58, 106, ANY, ANY, ANY, ANY]),
    ),
    (0, Parity::Even, all([10, 10, 10, 10, 10, 12, 15, 24])),
    (10, Parity::Even, all([10, 11, 12, 14, 18, 30, 41, 77])),
    (40, Parity::Even, all([12, 14, 18, 27, 44, 82, 120, ANY])),
];

#[test]
fn holes_are_crossed_up_to_the_break_even_of_the_line() {
    for (milliseconds, parity, row) in BREAK_EVEN {
        for (baud, table) in BAUDS.into_iter().zip(row) {
            let settings = LineSettings {
                baud,
                parity,
                ..LineSettings::default()
            };
            let found = widest_hole(settings, Duration::from_millis(milliseconds));
            assert_eq!(found, table, "{settings}, {milliseconds} ms to answer");
        }
    }
}

#[test]
fn a_pause_makes_a_request_of_its_own_dearer() {
    // 100 ms in place of one t3.5: 8.25 + 100 / (2 c) registers at 9600 baud.
    let limits = Limits {
        pause: Duration::from_millis(100),
        ..with_holes()
    };
    assert_eq!(reads(&points(&[(0, 1), (57, 1)]), &limits), [(0, 58)]);
    assert_eq!(
        reads(&points(&[(0, 1), (58, 1)]), &limits),
        [(0, 1), (58, 1)]
    );
}

#[test]
fn a_border_between_tables_is_never_crossed() {
    let limits = Limits {
        table_registers: Some(0x100),
        ..with_holes()
    };
    assert_eq!(
        reads(
            &points(&[(0xFE, 1), (0xFF, 1), (0x100, 1), (0x103, 1)]),
            &limits
        ),
        [(0xFE, 2), (0x100, 4)]
    );
}

#[test]
fn a_point_that_must_be_alone_is_alone() {
    let neighbours = [point(0, 1), alone(1), alone(2), point(3, 1), point(4, 1)];
    assert_eq!(
        reads(&neighbours, &with_holes()),
        [(0, 1), (1, 1), (2, 1), (3, 2)]
    );
}

#[test]
fn a_read_does_not_run_over_a_point_that_must_be_alone() {
    let around = [point(0, 1), alone(5), point(9, 1)];
    assert_eq!(reads(&around, &with_holes()), [(0, 1), (5, 1), (9, 1)]);
    // The same address read with the other function is another register.
    let other = Point {
        function: Some(ReadFunction::InputRegisters),
        ..alone(5)
    };
    let around = [point(0, 1), other, point(9, 1)];
    assert_eq!(reads(&around, &with_holes()), [(0, 10), (5, 1)]);
}

#[test]
fn a_register_that_means_something_else_when_alone_is_read_both_ways() {
    // The second word of a voltage, and an identification code when it is read by itself.
    let voltages = [point(8, 2), point(10, 2), alone(11), point(12, 2)];
    assert_eq!(reads(&voltages, &Limits::default()), [(8, 6), (11, 1)]);
}

#[test]
fn functions_are_kept_apart() {
    let input = |start| Point {
        function: Some(ReadFunction::InputRegisters),
        ..point(start, 1)
    };
    let mixed = [point(0, 1), input(1), point(2, 1), input(3), point(1, 1)];
    let found: Vec<_> = plan(&mixed, &with_holes())
        .reads
        .into_iter()
        .map(|read| (read.function, read.range, read.points))
        .collect();
    assert_eq!(
        found,
        [
            (HOLDING, range(0, 3), vec![0, 4, 2]),
            (ReadFunction::InputRegisters, range(1, 3), vec![1, 3]),
        ]
    );
}

#[test]
fn a_point_wider_than_the_meter_reads_is_asked_for_as_it_is() {
    let limits = Limits {
        read_registers: 11,
        ..Limits::default()
    };
    // Three points, two reads: the narrow ones do not need the wide one.
    let found = reads(&points(&[(0, 1), (0, 20), (1, 1)]), &limits);
    assert_eq!(found, [(0, 2), (0, 20)]);
}

#[test]
fn the_last_register_can_be_read() {
    assert_eq!(
        reads(&points(&[(0xFFFF, 1), (0xFFFD, 2)]), &Limits::default()),
        [(0xFFFD, 3)]
    );
}

#[test]
fn eight_hundred_points_are_planned() {
    let many: Vec<Point> = (0..800).map(|index| point(3 * index, 2)).collect();
    let plan = plan(&many, &with_holes());
    let mut planned: Vec<usize> = plan
        .reads
        .iter()
        .flat_map(|read| read.points.iter().copied())
        .collect();
    planned.sort_unstable();
    assert_eq!(planned, (0..800).collect::<Vec<usize>>());
    // 42 points of every 3 registers, less the last hole, fill 125 registers.
    assert_eq!(plan.reads.len(), 20);
}
