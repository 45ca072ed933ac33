//! Writes over the simulated line with clients on it: broadcasts to all meters, and writes of which the
//! answer goes wrong.

mod support {
    pub(crate) mod clock;
    pub(crate) mod frames_of;
    pub(crate) mod outside;
}

use support::frames_of::{echo, framed, sealed};
use support::outside::{Played, Scene, Seen};

/// Unit 17, a PQM: the primary of its current transformers, 600 A in the beginning.
const SET_800: [u8; 6] = [17, 6, 0x10, 0x50, 0x03, 0x20];
const READ: [u8; 6] = [17, 3, 0x10, 0x50, 0, 1];

fn said(at: u64, client: u64, bytes: impl AsRef<[u8]>) -> Seen {
    Seen::Said(at, client, bytes.as_ref().to_vec())
}

/// The answer of one register.
fn holds(unit: u8, value: u16) -> Vec<u8> {
    let [high, low] = value.to_be_bytes();
    sealed(&[unit, 3, 2, high, low])
}

/// The last that was said.
fn last(played: &Played) -> Option<&Seen> {
    played.seen.last()
}

#[test]
fn what_one_client_writes_another_one_reads() {
    let played = Scene::rtu()
        .at(0, 1, sealed(&SET_800))
        .at(10, 2, sealed(&READ))
        .until(100);
    let expected = [said(0, 1, sealed(&SET_800)), said(10, 2, holds(17, 800))];
    assert_eq!(played.seen, expected);
    assert_eq!(
        played.server.tally().to_string(),
        "2 requests (function 03: 1, 06: 1), 2 answers"
    );
}

#[test]
fn a_write_is_done_whatever_becomes_of_its_answer() {
    for fault in [
        "silence",
        "late=1.1",
        "delay=500ms",
        "crc",
        "crc-swapped",
        "cut=3",
        "flip=20",
        "echo-only",
        "garbage",
        "endless",
        "twice",
        "wrong-unit=9",
        "stranger-only=9",
        "wrong-function=4",
        "exception=2",
        "exception=6",
        "exception-for=16",
        "hang-up=during",
        "hang-up=after",
    ] {
        let played = Scene::rtu()
            .faults(&[&format!("{fault},on=1")])
            .at(0, 1, sealed(&SET_800))
            .at(5000, 2, sealed(&READ))
            .until(6000);
        assert_eq!(
            last(&played),
            Some(&said(5000, 2, holds(17, 800))),
            "{fault}"
        );
    }
}

#[test]
fn a_write_that_a_line_never_carries_is_not_done() {
    let played = Scene::rtu()
        .faults(&["hang-up=before,on=1"])
        .at(0, 1, sealed(&SET_800))
        .at(100, 2, sealed(&READ))
        .until(200);
    assert_eq!(last(&played), Some(&said(100, 2, holds(17, 600))));
}

#[test]
fn all_meters_hear_a_broadcast_and_those_obey_it_that_are_said_to() {
    // Function 06 to 3000h: a reset on the EM24 and the EM21, nothing on the others.
    let reset = sealed(&[0, 6, 0x30, 0, 0, 1]);
    let energies = [
        sealed(&[1, 3, 0, 0x3E, 0, 2]),
        sealed(&[3, 3, 0, 0x34, 0, 2]),
    ];
    let zero = |unit| sealed(&[unit, 3, 4, 0, 0, 0, 0]);
    let played = Scene::rtu()
        .at(0, 1, &reset)
        .at(10, 1, &energies[0])
        .at(20, 1, &energies[1])
        .at(30, 1, sealed(&READ))
        .until(100);
    assert_eq!(
        played.seen,
        [
            said(10, 1, zero(1)),
            said(20, 1, zero(3)),
            said(30, 1, holds(17, 600)),
        ]
    );
    assert_eq!(
        played.server.tally().to_string(),
        "4 requests (function 03: 3, 06: 1), 3 answers"
    );
}

#[test]
fn a_broadcast_is_obeyed_by_its_function_and_a_read_of_all_is_ignored() {
    let all = |unit, tail: &[u8]| sealed(&[&[unit][..], tail].concat());
    let set = [6, 0x10, 0x50, 0x03, 0x20];
    let set_many = [16, 0x10, 0x50, 0, 1, 2, 0x03, 0x20];
    let read = [3, 0x10, 0x50, 0, 1];
    for (frame, value) in [
        // The PQM obeys functions 05 and 16 alone.
        (all(0, &set), 600),
        (all(0, &set_many), 800),
        (all(0, &read), 600),
        (all(0, &[7]), 600),
        (all(0, &[0x2B, 1, 2]), 600),
    ] {
        let played = Scene::rtu()
            .at(0, 1, &frame)
            .at(100, 1, sealed(&READ))
            .until(200);
        assert_eq!(
            played.seen,
            [said(100, 1, holds(17, value))],
            "{frame:02X?}"
        );
    }
}

#[test]
fn a_broadcast_keeps_nobody_waiting() {
    let reset = sealed(&[0, 6, 0x30, 0, 0, 1]);
    let played = Scene::rtu()
        .at(0, 1, &reset)
        .at(0, 2, echo(1, 5))
        .until(100);
    assert_eq!(played.seen, [said(0, 2, echo(1, 5))]);
    let played = Scene::tcp()
        .at(0, 1, framed(7, &reset))
        .at(0, 2, framed(8, &echo(1, 5)))
        .until(100);
    assert_eq!(played.seen, [said(0, 2, framed(8, &echo(1, 5)))]);
}

#[test]
fn a_meter_that_got_another_address_is_heard_there_and_no_longer_where_it_was() {
    let moves = sealed(&[17, 6, 0x10, 0x18, 0, 200]);
    let read = sealed(&[200, 3, 0x10, 0x18, 0, 1]);
    let played = Scene::rtu()
        .at(0, 1, &moves)
        .at(10, 1, &moves)
        .at(50, 1, &read)
        .until(100);
    let expected = [said(0, 1, &moves), said(50, 1, holds(200, 200))];
    assert_eq!(played.seen, expected);
    assert_eq!(
        played.server.tally().to_string(),
        "2 requests (function 03: 1, 06: 1), 2 answers, 1 to other units"
    );
}

#[test]
fn refused_writes_are_counted_as_exceptions() {
    let played = Scene::rtu()
        .at(0, 1, sealed(&[17, 6, 0x10, 0x50, 0xFF, 0xFF]))
        .at(10, 1, sealed(&[17, 6, 0x02, 0x40, 0, 0]))
        .until(100);
    assert_eq!(
        played.server.tally().to_string(),
        "2 requests (function 06: 2), 0 answers, 2 exceptions (02: 1, 03: 1)"
    );
}
