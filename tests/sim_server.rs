//! The server around the simulated line: what it makes of bytes and silences, and who hears what.

mod support {
    pub(crate) mod clock;
    pub(crate) mod frames_of;
    pub(crate) mod outside;
}

use std::time::Duration;

use meterpoll::codec::{ExceptionCode, FunctionCode};
use meterpoll::sim::server::State;
use meterpoll::transport::Afterwards;

use support::frames_of::{echo, framed, sealed};
use support::outside::{Scene, Seen};

fn said(at: u64, client: u64, bytes: impl AsRef<[u8]>) -> Seen {
    Seen::Said(at, client, bytes.as_ref().to_vec())
}

#[test]
fn a_request_is_answered_as_soon_as_its_last_byte_is_there() {
    let played = Scene::rtu().at(5, 0, echo(17, 1)).until(100);
    assert_eq!(played.seen, [said(5, 0, echo(17, 1))]);
    assert_eq!(
        played.server.tally().to_string(),
        "1 request (function 08: 1), 1 answer"
    );
}

#[test]
fn a_request_can_come_in_pieces_with_pauses() {
    let mut scene = Scene::rtu();
    for (at, byte) in (0..).step_by(9).zip(echo(17, 1)) {
        scene = scene.at(at, 0, [byte]);
    }
    let played = scene.until(200);
    assert_eq!(played.seen, [said(63, 0, echo(17, 1))]);
}

#[test]
fn requests_without_a_gap_are_answered_one_by_one() {
    let both = [echo(17, 1), echo(1, 2)].concat();
    let played = Scene::rtu().at(0, 0, both).until(100);
    assert_eq!(
        played.seen,
        [said(0, 0, echo(17, 1)), said(0, 0, echo(1, 2))]
    );
}

#[test]
fn a_function_of_unknown_length_ends_by_silence() {
    let played = Scene::rtu()
        .at(3, 0, sealed(&[17, 0x2B, 0x0E, 1, 0]))
        .until(100);
    assert_eq!(played.seen, [said(23, 0, sealed(&[17, 0xAB, 1]))]);
    let tally = played.server.tally();
    assert_eq!(tally.exceptions(ExceptionCode::ILLEGAL_FUNCTION), 1);
    assert_eq!(
        tally.to_string(),
        "1 request (function 2B: 1), 0 answers, 1 exception (01: 1)"
    );
}

#[test]
fn what_is_damaged_or_cut_gets_no_answer_and_does_not_spoil_the_next() {
    let mut damaged = echo(17, 1);
    damaged[5] ^= 1;
    let cut = &echo(17, 1)[..6];
    for noise in [
        &damaged[..],
        cut,
        &[0],
        &[0xFF; 40],
        &[17, 16, 0, 0, 0, 100, 200, 1, 2],
    ] {
        let played = Scene::rtu()
            .at(0, 0, noise)
            .at(30, 0, echo(17, 2))
            .until(100);
        assert_eq!(played.seen, [said(30, 0, echo(17, 2))], "{noise:02X?}");
        assert_eq!(played.server.tally().not_understood(), 1);
    }
}

#[test]
fn what_follows_noise_without_a_silence_is_noise_as_a_meter_hears_it() {
    let played = Scene::rtu()
        .at(0, 0, [0])
        .at(10, 0, echo(17, 1))
        .at(31, 0, echo(17, 2))
        .until(99);
    assert_eq!(played.seen, [said(31, 0, echo(17, 2))]);
    assert_eq!(
        played.server.tally().to_string(),
        "1 request (function 08: 1), 1 answer, 1 not understood"
    );
}

#[test]
fn noise_without_end_is_thrown_away_as_it_comes() {
    let mut scene = Scene::rtu();
    for at in 0..2000 {
        scene = scene.at(at, 0, [0xA5; 500]);
    }
    let played = scene.at(2100, 0, echo(17, 1)).until(2200);
    assert_eq!(played.seen, [said(2100, 0, echo(17, 1))]);
    assert_eq!(played.server.tally().not_understood(), 1);
}

#[test]
fn requests_to_other_units_and_to_all_get_no_answer() {
    let write = sealed(&[0, 6, 0, 1, 0, 2]);
    let played = Scene::rtu()
        .at(0, 0, echo(9, 1))
        .at(50, 0, write)
        .until(100);
    assert_eq!(played.seen, []);
    assert_eq!(
        played.server.tally().to_string(),
        "1 request (function 06: 1), 0 answers, 1 to other units"
    );
}

#[test]
fn meters_take_the_time_they_are_given() {
    let mut scene = Scene::rtu().at(10, 0, echo(17, 1));
    scene.service.answer_time = Duration::from_millis(40);
    let played = scene.until(200);
    assert_eq!(played.seen, [said(50, 0, echo(17, 1))]);
    assert!(played.turns < 6, "{}", played.turns);
}

#[test]
fn each_client_hears_its_own_answers() {
    let played = Scene::rtu()
        .at(0, 1, echo(17, 1))
        .at(0, 2, echo(17, 2))
        .until(100);
    assert_eq!(
        played.seen,
        [said(0, 1, echo(17, 1)), said(0, 2, echo(17, 2))]
    );
}

#[test]
fn pieces_of_two_clients_do_not_mix() {
    let (one, two) = (echo(17, 1), echo(17, 2));
    let played = Scene::rtu()
        .at(0, 1, &one[..4])
        .at(1, 2, &two[..5])
        .at(2, 1, &one[4..])
        .at(3, 2, &two[5..])
        .until(100);
    assert_eq!(played.seen, [said(2, 1, one), said(3, 2, two)]);
}

#[test]
fn a_client_waits_while_another_is_to_be_answered() {
    let scene = Scene::rtu().faults(&["delay=300ms,on=1"]);
    let played = scene
        .at(0, 1, echo(17, 1))
        .at(10, 2, echo(17, 2))
        .until(500);
    assert_eq!(
        played.seen,
        [said(300, 1, echo(17, 1)), said(300, 2, echo(17, 2))]
    );
}

#[test]
fn requests_that_find_no_room_to_wait_are_counted() {
    let scene = Scene::rtu().faults(&["delay=300ms,on=1"]);
    let played = scene
        .at(0, 1, echo(17, 1))
        .at(10, 2, echo(17, 2).repeat(67))
        .until(500);
    assert_eq!(
        played.server.tally().to_string(),
        "65 requests (function 08: 65), 65 answers, 3 lost because too many waited"
    );
}

#[test]
fn a_client_does_not_wait_for_ever() {
    let scene = Scene::rtu().faults(&["endless,on=1,every=100ms"]);
    let played = scene
        .at(0, 1, echo(17, 1))
        .at(10, 2, echo(17, 2))
        .until(3000);
    let last = played.seen.last();
    assert_eq!(last, Some(&said(1000, 2, echo(17, 2))));
}

#[test]
fn a_late_answer_comes_into_the_next_request_of_the_same_client() {
    let scene = Scene::rtu().faults(&["late=1.1,on=1"]);
    let played = scene
        .at(0, 0, echo(17, 1))
        .at(1050, 0, echo(17, 2))
        .until(2000);
    assert_eq!(
        played.seen,
        [said(1050, 0, echo(17, 2)), said(1100, 0, echo(17, 1))]
    );
    assert_eq!(played.server.faults().all_faults(), 1);
}

#[test]
fn nobody_hears_what_was_for_a_client_that_has_left() {
    let scene = Scene::rtu().faults(&["delay=300ms,on=1"]);
    let played = scene
        .at(0, 1, echo(17, 1))
        .leaves(10, 1)
        .at(20, 2, echo(17, 2))
        .until(500);
    assert_eq!(played.seen, [said(300, 2, echo(17, 2))]);
}

#[test]
fn spoiled_answers_are_counted_apart() {
    let scene = Scene::rtu().faults(&["cut=3,on=1", "crc,on=2"]);
    let played = scene
        .at(0, 0, echo(17, 1))
        .at(50, 0, echo(17, 2))
        .until(200);
    assert_eq!(
        played.server.tally().to_string(),
        "2 requests (function 08: 2), 0 answers, 2 spoiled"
    );
}

#[test]
fn a_fault_hangs_up_and_the_line_is_there_again() {
    let scene = Scene::rtu().faults(&["hang-up=before,on=1"]);
    let played = scene
        .at(0, 0, echo(17, 1))
        .at(50, 0, echo(17, 2))
        .until(200);
    assert_eq!(played.seen, [Seen::HungUp(0, 0), said(50, 0, echo(17, 2))]);
    assert_eq!(played.state, State::Serving);
}

#[test]
fn bytes_before_a_hang_up_are_sent() {
    let scene = Scene::rtu().faults(&["hang-up=after,on=1"]);
    let played = scene.at(0, 3, echo(17, 1)).until(200);
    assert_eq!(played.seen, [said(0, 3, echo(17, 1)), Seen::HungUp(0, 3)]);
}

#[test]
fn a_line_that_cannot_be_found_again_ends_the_server() {
    let mut scene = Scene::rtu().faults(&["hang-up=before"]);
    scene.afterwards = Afterwards::Closed;
    let played = scene.at(7, 0, echo(17, 1)).until(200);
    assert_eq!((played.state, played.end), (State::HungUp, 7));
}

#[test]
fn after_so_many_requests_nothing_more_is_heard() {
    let mut scene = Scene::rtu().faults(&["delay=300ms,on=2"]);
    scene.service.count = Some(2);
    let scene = scene
        .at(0, 0, echo(9, 1))
        .at(50, 0, echo(17, 1))
        .at(60, 0, echo(17, 2));
    let played = scene.at(70, 0, echo(17, 3)).until(2000);
    assert_eq!(
        played.seen,
        [said(50, 0, echo(17, 1)), said(360, 0, echo(17, 2))]
    );
    assert_eq!((played.state, played.end), (State::Done, 360));
    assert_eq!(
        played
            .server
            .tally()
            .requests_with(FunctionCode::Diagnostics),
        2
    );
}

#[test]
fn what_has_no_end_does_not_keep_a_server_that_has_heard_all() {
    let mut scene = Scene::rtu().faults(&["garbage,every=100ms"]);
    scene.service.count = Some(1);
    let played = scene.at(0, 0, echo(17, 1)).until(60_000);
    assert_eq!((played.state, played.end), (State::Done, 10_000));
}

#[test]
fn an_answer_goes_out_however_late_it_is_for_a_server_that_has_heard_all() {
    let mut scene = Scene::rtu().faults(&["late=3,timeout=10s"]);
    scene.service.count = Some(1);
    let played = scene.at(0, 0, echo(17, 1)).until(60_000);
    assert_eq!(played.seen, [said(30_000, 0, echo(17, 1))]);
    assert_eq!((played.state, played.end), (State::Done, 30_000));

    let mut scene = Scene::rtu().faults(&["garbage,every=1s,lasts=20s"]);
    scene.service.count = Some(1);
    let played = scene.at(0, 0, echo(17, 1)).until(60_000);
    assert_eq!(played.state, State::Done);
    assert_eq!(played.end, 19_000);
}

#[test]
fn a_stream_that_is_faster_than_it_is_sent_does_not_keep_a_turn() {
    let mut scene = Scene::rtu().faults(&["garbage,every=100us"]);
    scene.look = Duration::from_millis(1);
    let played = scene.at(0, 0, echo(17, 1)).leaves(1000, 0).until(2000);
    let said = |seen: &Seen| matches!(seen, Seen::Said(at, ..) if *at >= 1000);
    assert_eq!(played.state, State::Serving);
    assert!(played.seen.len() > 10 && !played.seen.iter().any(said));
}

#[test]
fn modbus_tcp_echoes_transaction_and_unit() {
    let request = framed(0x1501, &echo(17, 1));
    let played = Scene::tcp().at(0, 1, &request).until(100);
    assert_eq!(played.seen, [said(0, 1, &request)]);
    assert_eq!(request, [0x15, 1, 0, 0, 0, 6, 17, 8, 0, 0, 0, 0]);
}

#[test]
fn modbus_tcp_needs_no_silence_and_minds_none() {
    let (one, two) = (framed(1, &echo(1, 1)), framed(2, &echo(2, 2)));
    let both = [&one[..], &two[..]].concat();
    let mut scene = Scene::tcp();
    for (at, byte) in (0..).step_by(1000).zip(&both) {
        scene = scene.at(at, 1, [*byte]);
    }
    let played = scene.until(60_000);
    assert_eq!(played.seen, [said(11_000, 1, one), said(23_000, 1, two)]);
}

#[test]
fn modbus_tcp_exceptions_are_those_of_the_meter() {
    let request = framed(7, &sealed(&[17, 3, 0xFF, 0xF0, 0, 1]));
    let played = Scene::tcp().at(0, 1, request).until(100);
    assert_eq!(
        played.seen,
        [said(0, 1, framed(7, &sealed(&[17, 0x83, 2])))]
    );
}

#[test]
fn what_is_not_modbus_tcp_is_hung_up_on() {
    let played = Scene::tcp().at(0, 4, b"GET / HTTP/1.1\r\n").until(100);
    assert_eq!(played.seen, [Seen::HungUp(0, 4)]);
    assert_eq!(
        played.server.tally().to_string(),
        "0 requests, 0 answers, 1 not understood"
    );
}

#[test]
fn a_late_answer_over_modbus_tcp_bears_the_number_of_its_own_request() {
    let scene = Scene::tcp().faults(&["late=1.1,on=1"]);
    let (one, two) = (framed(1, &echo(17, 1)), framed(2, &echo(17, 2)));
    let played = scene.at(0, 1, &one).at(1050, 1, &two).until(2000);
    assert_eq!(played.seen, [said(1100, 1, one), said(1100, 1, two)]);
}

#[test]
fn faults_that_leave_whole_frames_show_over_modbus_tcp() {
    let scene = Scene::tcp().faults(&["wrong-unit=3,on=1", "exception=6,on=2", "twice,on=3"]);
    let request = framed(9, &echo(17, 1));
    let played = scene
        .at(0, 1, &request)
        .at(1, 1, &request)
        .at(2, 1, &request)
        .until(100);
    let other = framed(9, &echo(3, 0));
    let busy = framed(9, &sealed(&[17, 0x88, 6]));
    assert_eq!(
        played.seen,
        [
            said(0, 1, other),
            said(1, 1, busy),
            said(2, 1, &request),
            said(2, 1, &request)
        ]
    );
}

#[test]
fn a_request_without_an_answer_does_not_keep_the_next_over_modbus_tcp() {
    let scene = Scene::tcp().faults(&["silence,on=1"]);
    let (one, two) = (framed(1, &echo(17, 1)), framed(2, &echo(17, 2)));
    let played = scene.at(0, 1, one).at(5, 1, &two).until(100);
    assert_eq!(played.seen, [said(5, 1, two)]);
}
