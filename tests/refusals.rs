//! What becomes of reads that a meter refuses: only what it really does not have is missing, and
//! nothing is asked twice that it has shown not to give.

mod support {
    pub(crate) mod clock;
    pub(crate) mod fussy;
    pub(crate) mod script;
}

use meterpoll::codec::ExceptionCode;
use meterpoll::profile::Limits;
use meterpoll::readings::Trouble;

use support::fussy::{Fussy, Run, point, points, statuses};

fn with_holes() -> Limits {
    Limits {
        read_holes: true,
        ..Limits::default()
    }
}

/// The points that were told as refused, and why.
fn refused(troubles: &[Trouble]) -> Vec<(Vec<usize>, ExceptionCode)> {
    let refused = troubles.iter().map(|trouble| match trouble {
        Trouble::Refused { points, code } => (points.clone(), *code),
        other => panic!("{other:?}"),
    });
    refused.collect()
}

#[test]
fn a_meter_of_11_registers_gives_all_of_24() {
    for code in [2, 3] {
        let mut run = Run::new(Fussy::new(Some(code)).limit(11));
        run.read_all(&points(0..24));
        assert_eq!(
            run.requests(),
            [
                (0, 24),
                (0, 12),
                (12, 12),
                // Both halves of 12 are there now, so that 6 is what it gives for sure.
                (0, 6),
                (6, 6),
                (12, 6),
                (18, 6)
            ]
        );
        run.read_all(&points(0..24));
        assert_eq!(run.requests(), [(0, 6), (6, 6), (12, 6), (18, 6)]);
    }
}

#[test]
fn a_learned_limit_holds_for_reads_that_were_planned_before() {
    let mut run = Run::new(Fussy::new(Some(3)).limit(11));
    run.read_all(&points((0..20).chain(0x100..0x114)));
    assert_eq!(
        run.requests(),
        [(0, 20), (0, 10), (10, 10), (0x100, 10), (0x10A, 10)]
    );
}

#[test]
fn what_was_answered_before_is_the_limit() {
    let mut run = Run::new(Fussy::new(Some(3)).limit(11));
    // The 12 are refused and come in halves; 11 were answered before.
    run.read_all(&points((0..11).chain(0x100..0x10C).chain(0x200..0x20B)));
    assert_eq!(
        run.requests(),
        [(0, 11), (0x100, 12), (0x100, 6), (0x106, 6), (0x200, 11)]
    );
}

#[test]
fn one_refused_register_among_twenty_costs_one_cell() {
    let mut run = Run::new(Fussy::new(Some(2)).without(7..8));
    let points = points(0..20);
    let (row, troubles) = run.read(&points);
    assert_eq!(statuses(&points, &row), "0x0007 exception:2\n");
    assert_eq!(
        refused(&troubles),
        [(vec![7], ExceptionCode::ILLEGAL_DATA_ADDRESS)]
    );
    assert_eq!(
        run.requests(),
        [
            (0, 20),
            (0, 10),
            (10, 10),
            (0, 5),
            (5, 5),
            (5, 2),
            (7, 3),
            (7, 1),
            (8, 2)
        ]
    );
    // It is asked for again, and nothing else with it.
    let (row, _) = run.read(&points);
    assert_eq!(statuses(&points, &row), "0x0007 exception:2\n");
    assert_eq!(run.requests(), [(0, 7), (7, 1), (8, 12)]);
}

#[test]
fn many_refused_registers_are_one_trouble() {
    let mut run = Run::new(Fussy::new(Some(2)).without(0x10..0x30));
    let points = points(0..0x40);
    let (_, troubles) = run.read(&points);
    assert_eq!(
        refused(&troubles),
        [((0x10..0x30).collect(), ExceptionCode::ILLEGAL_DATA_ADDRESS)]
    );
}

#[test]
fn a_refused_hole_is_left_out_and_no_other_is_crossed() {
    let mut run = Run::with(Fussy::new(Some(2)).without(4..6), &with_holes());
    let points = points((0..4).chain(6..10).chain([0x100, 0x102]));
    run.read_all(&points);
    assert_eq!(
        run.requests(),
        [(0, 10), (0, 4), (6, 4), (0x100, 1), (0x102, 1)]
    );
    run.read_all(&points);
    assert_eq!(run.requests(), [(0, 4), (6, 4), (0x100, 1), (0x102, 1)]);
}

#[test]
fn a_hole_beside_a_refused_register_is_not_the_reason() {
    let mut run = Run::with(Fussy::new(Some(2)).without(0..1), &with_holes());
    let points = points([0, 1, 3, 0x100, 0x102]);
    let (row, _) = run.read(&points);
    assert_eq!(statuses(&points, &row), "0x0000 exception:2\n");
    assert_eq!(
        run.requests(),
        [(0, 4), (0, 2), (3, 1), (0, 1), (1, 1), (0x100, 3)]
    );
}

#[test]
fn a_border_is_found_and_kept() {
    let mut run = Run::new(Fussy::new(Some(2)).border(0x105));
    let points = points((0..20).chain(0x100..0x110));
    run.read_all(&points);
    assert_eq!(
        run.requests(),
        [
            (0, 20),
            (0x100, 16),
            (0x100, 8),
            (0x108, 8),
            (0x100, 4),
            (0x104, 4),
            (0x104, 2),
            (0x106, 2),
            (0x104, 1),
            (0x105, 1)
        ]
    );
    // As many registers as ever are read at once elsewhere.
    run.read_all(&points);
    assert_eq!(run.requests(), [(0, 20), (0x100, 5), (0x105, 11)]);
}

#[test]
fn a_point_is_not_cut_to_find_out() {
    let mut run = Run::new(Fussy::new(Some(2)).limit(3));
    let points = [point(0, 2), point(2, 4), point(6, 1)];
    let (row, troubles) = run.read(&points);
    assert_eq!(statuses(&points, &row), "0x0002 exception:2\n");
    assert_eq!(troubles.len(), 1);
    assert_eq!(run.requests(), [(0, 7), (0, 2), (2, 5), (2, 4), (6, 1)]);
}

#[test]
fn a_point_as_wide_as_the_refused_read_is_not_asked_for_again() {
    let mut run = Run::new(Fussy::new(Some(2)).limit(3));
    let points = [point(0, 4), point(0, 1), point(1, 1), point(3, 1)];
    let (row, _) = run.read(&points);
    assert_eq!(statuses(&points, &row), "0x0000 exception:2\n");
    assert_eq!(run.requests(), [(0, 4), (0, 2), (3, 1)]);
}

#[test]
fn a_refusal_that_is_not_about_registers_is_not_asked_about_in_parts() {
    for code in [1, 4, 5, 0x0A, 0x63] {
        let mut run = Run::new(Fussy::new(Some(code)).limit(0));
        let points = points((0..3).chain(8..9));
        let (row, troubles) = run.read(&points);
        let expected: String = ["0x0000", "0x0001", "0x0002", "0x0008"]
            .map(|name| format!("{name} exception:{code}\n"))
            .concat();
        assert_eq!(statuses(&points, &row), expected);
        assert_eq!(
            refused(&troubles),
            [(vec![0, 1, 2, 3], ExceptionCode(code))]
        );
        assert_eq!(run.requests(), [(0, 3), (8, 1)]);
    }
}

#[test]
fn a_border_met_before_anything_longer_is_taken_for_a_limit() {
    let mut run = Run::new(Fussy::new(Some(2)).border(8));
    run.read_all(&points((0..16).chain(0x100..0x110)));
    assert_eq!(
        run.requests(),
        [(0, 16), (0, 8), (8, 8), (0x100, 8), (0x108, 8)]
    );
}
