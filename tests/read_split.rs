//! The parts of a read that a meter does not give.

use meterpoll::codec::value::{ByteOrder, RegisterType};
use meterpoll::codec::{ReadFunction, RegisterRange};
use meterpoll::profile::Point;
use meterpoll::profile::plan::PlannedRead;
use proptest::prelude::*;

fn range(start: u16, count: u16) -> RegisterRange {
    RegisterRange::new(start, count).expect("a range")
}

fn points(places: &[(u16, u16)]) -> Vec<Point> {
    let point = |(start, count): &(u16, u16)| {
        Point::raw(range(*start, *count), RegisterType::U16, ByteOrder::Abcd)
    };
    places.iter().map(point).collect()
}

/// The read of all of these points.
fn whole(points: &[Point]) -> PlannedRead {
    let starts = points.iter().map(|point| point.range.start().get());
    let start = starts.min().expect("a point");
    let end = points.iter().map(|point| point.range.end()).max();
    let count = end.expect("a point") - u32::from(start);
    PlannedRead {
        function: ReadFunction::HoldingRegisters,
        range: range(start, u16::try_from(count).expect("a read")),
        points: (0..points.len()).collect(),
    }
}

/// Start and count of each part of the read of all these points, of which those in `left` are left.
fn parts_of(places: &[(u16, u16)], left: &[usize]) -> Vec<(u16, u16)> {
    let points = points(places);
    let parts = whole(&points).pieces(&points, left);
    parts
        .iter()
        .map(|part| (part.range.start().get(), part.range.count()))
        .collect()
}

fn parts(places: &[(u16, u16)]) -> Vec<(u16, u16)> {
    parts_of(places, &(0..places.len()).collect::<Vec<_>>())
}

#[test]
fn a_read_with_holes_falls_into_the_stretches_between_them() {
    assert_eq!(
        parts(&[(0, 2), (2, 1), (4, 2), (9, 1)]),
        [(0, 3), (4, 2), (9, 1)]
    );
}

#[test]
fn holes_are_what_no_point_names() {
    let holes = |places: &[(u16, u16)]| {
        let points = points(places);
        whole(&points).holes(&points)
    };
    assert_eq!(
        holes(&[(0, 4), (1, 1), (6, 2), (9, 1)]),
        [range(4, 2), range(8, 1)]
    );
    assert_eq!(holes(&[(0, 2), (2, 1), (1, 4)]), []);
    assert_eq!(holes(&[(0xFFF0, 2), (0xFFF8, 8)]), [range(0xFFF2, 6)]);
}

#[test]
fn a_read_without_holes_falls_into_halves() {
    assert_eq!(parts(&[(0, 1), (1, 1), (2, 1), (3, 1)]), [(0, 2), (2, 2)]);
    // Of two cuts as near to the middle, the first.
    assert_eq!(parts(&[(0, 1), (1, 1), (2, 1)]), [(0, 1), (1, 2)]);
    assert_eq!(parts(&[(0, 4), (4, 1), (5, 1), (6, 4)]), [(0, 5), (5, 5)]);
    assert_eq!(parts(&[(0, 2), (2, 8)]), [(0, 2), (2, 8)]);
}

#[test]
fn points_that_are_there_already_are_left_out() {
    let places = [(0, 1), (1, 1), (2, 1), (3, 1), (4, 1)];
    assert_eq!(parts_of(&places, &[1, 2, 3, 4]), [(1, 2), (3, 2)]);
    assert_eq!(parts_of(&places, &[4]), [(4, 1)]);
    assert_eq!(parts_of(&places, &[]), []);
}

#[test]
fn points_that_overlap_are_cut_apart_beside_each_other_if_they_can_be() {
    // Between 5 and 6 would be nearer to the middle, and through the first point.
    assert_eq!(parts(&[(0, 7), (5, 1), (6, 1), (7, 3)]), [(0, 7), (7, 3)]);
    assert_eq!(parts(&[(0, 6), (5, 5)]), [(0, 6), (5, 5)]);
    // One cut would leave the first half as long as the whole, one the second.
    assert_eq!(parts(&[(0, 3), (0, 7), (1, 9)]), [(0, 7), (1, 9)]);
    assert_eq!(parts(&[(0, 6), (1, 9), (2, 1)]), [(0, 6), (1, 9)]);
}

#[test]
fn a_point_as_wide_as_the_read_is_known() {
    let points = points(&[(0, 3), (0, 8), (1, 1), (0, 8)]);
    let read = whole(&points);
    assert_eq!(read.as_wide(&points), [1, 3]);
    let (first, rest) = read.first_and_rest(&points).expect("both");
    assert_eq!((first.points, rest.points), (vec![0], vec![1, 3, 2]));
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn every_point_is_in_one_part_and_no_part_is_the_read_again(
        places in prop::collection::vec((0_u16..60, 1_u16..20), 1..12)
    ) {
        let points = points(&places);
        let read = whole(&points);
        let wide = read.as_wide(&points);
        let left: Vec<usize> = (0..points.len()).filter(|index| !wide.contains(index)).collect();
        let parts = read.pieces(&points, &left);
        let mut covered: Vec<usize> = Vec::new();
        for part in &parts {
            prop_assert!(part.range != read.range || read.has_holes(&points));
            let mut ranges = part.points.iter().map(|index| points[*index].range);
            prop_assert!(ranges.all(|range| part.range.contains(range)));
            covered.extend(&part.points);
        }
        covered.sort_unstable();
        prop_assert_eq!(covered, left);
        prop_assert!(!read.has_holes(&points) || parts.iter().all(|part| !part.has_holes(&points)));
    }
}
