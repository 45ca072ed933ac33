//! The simulated line as a transport.

use std::sync::Arc;
use std::time::Duration;

use meterpoll::codec::rtu::{check, decode_reply};
use meterpoll::codec::{Reply, Response, Unit, UnitRange};
use meterpoll::sim::{Meter, SimulatedLine};
use meterpoll::transport::{Clock, Transport};

#[path = "support/clock.rs"]
mod clock;

use clock::FakeClock;

/// Unit 17, function 08: loopback. The answer is the same.
const LOOPBACK: [u8; 8] = [0x11, 0x08, 0x00, 0x00, 0x00, 0x00, 0xE2, 0x9B];

const WAIT: Duration = Duration::from_millis(300);

/// A frame with a right CRC: `body` is the unit and the data unit.
fn sealed(body: &[u8]) -> Vec<u8> {
    [body, &check(body)].concat()
}

fn line() -> (SimulatedLine, Arc<FakeClock>) {
    let clock = Arc::new(FakeClock::new());
    (SimulatedLine::new(1, clock.clone()), clock)
}

fn receive(line: &mut SimulatedLine) -> Vec<u8> {
    let mut bytes = [0; 300];
    let count = line.receive(&mut bytes, WAIT).unwrap();
    bytes[..count].to_vec()
}

/// The registers that are answered to a request.
fn registers(line: &mut SimulatedLine, request: &[u8]) -> Vec<u16> {
    line.send(request).unwrap();
    match decode_reply(&receive(line)) {
        Ok((_, Reply::Normal(Response::Registers { values, .. }))) => values.into_vec(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn an_answer_is_there_at_once() {
    let (mut line, clock) = line();
    line.send(&LOOPBACK).unwrap();
    assert_eq!(receive(&mut line), LOOPBACK);
    assert_eq!(clock.now(), Duration::ZERO);
}

#[test]
fn an_answer_can_be_received_in_pieces() {
    let (mut line, clock) = line();
    line.send(&LOOPBACK).unwrap();
    let mut heard = Vec::new();
    while heard.len() < LOOPBACK.len() {
        let mut piece = [0; 3];
        let count = line.receive(&mut piece, WAIT).unwrap();
        heard.extend_from_slice(&piece[..count]);
    }
    assert_eq!(heard, LOOPBACK);
    assert_eq!(clock.now(), Duration::ZERO);
}

#[test]
fn silence_lets_the_whole_wait_pass() {
    let (mut line, clock) = line();
    assert_eq!(receive(&mut line), Vec::<u8>::new());
    assert_eq!(clock.now(), WAIT);
    // Nobody is unit 18.
    line.send(&sealed(&[0x12, 0x07])).unwrap();
    assert_eq!(receive(&mut line), Vec::<u8>::new());
    assert_eq!(clock.now(), 2 * WAIT);
}

#[test]
fn discarded_answers_are_gone() {
    let (mut line, _) = line();
    line.send(&LOOPBACK).unwrap();
    line.discard_input().unwrap();
    assert_eq!(receive(&mut line), Vec::<u8>::new());
}

#[test]
fn every_meter_on_the_line_answers_for_its_own_unit() {
    let unit = |number| Unit::new(number, UnitRange::Extended).unwrap();
    let meters = vec![Meter::pqm(unit(1), 1), Meter::pqm(unit(255), 2)];
    let mut line = SimulatedLine::with_meters(meters, Arc::new(FakeClock::new()));
    for unit in [1, 255] {
        let request = sealed(&[unit, 0x08, 0x00, 0x00, 0x00, 0x00]);
        line.send(&request).unwrap();
        assert_eq!(receive(&mut line), request);
    }
}

#[test]
fn there_is_one_meter_of_each_kind_on_the_line() {
    let found: Vec<_> = SimulatedLine::meters(1)
        .iter()
        .map(|meter| (meter.unit().get(), meter.profile().name.clone()))
        .collect();
    let expected = [(1, "em24"), (2, "pm290"), (3, "em21"), (17, "pqm")];
    assert_eq!(found, expected.map(|(unit, name)| (unit, name.to_owned())));
}

#[test]
fn each_unit_shows_its_own_meter() {
    // The PM290 is busy at the full hour.
    let clock = Arc::new(FakeClock::starting("2026-05-04T08:15:00Z"));
    let mut line = SimulatedLine::new(1, clock);
    // The identification code, the setup, the identification code, the product code.
    for (request, expected) in [
        (&[0x01, 0x04, 0x00, 0x0B, 0x00, 0x01], 70),
        (&[0x02, 0x03, 0x09, 0x02, 0x00, 0x01], 200),
        (&[0x03, 0x04, 0x00, 0x0B, 0x00, 0x01], 57),
        (&[0x11, 0x03, 0x00, 0x00, 0x00, 0x01], 65),
    ] {
        assert_eq!(registers(&mut line, &sealed(request)), [expected]);
    }
}

#[test]
fn other_units_and_broadcasts_are_met_with_silence() {
    let (mut line, _) = line();
    for unit in (0..=255).filter(|unit| ![1, 2, 3, 17].contains(unit)) {
        line.send(&sealed(&[unit, 0x08, 0x00, 0x00, 0x00, 0x00]))
            .unwrap();
        assert_eq!(receive(&mut line), Vec::<u8>::new(), "unit {unit}");
    }
    // To all: clear the demands of a PM290, and those of an EM24.
    for body in [
        [0x00, 0x06, 0x01, 0x18, 0x00, 0x00],
        [0x00, 0x06, 0x30, 0x05, 0x00, 0x01],
    ] {
        line.send(&sealed(&body)).unwrap();
        assert_eq!(receive(&mut line), Vec::<u8>::new());
    }
}

#[test]
fn the_meters_clock_is_the_lines_clock() {
    let (mut line, clock) = line();
    let request = sealed(&[0x11, 0x03, 0x02, 0x30, 0x00, 0x04]);
    // 12:00, 0 ms, January 15, 2026.
    assert_eq!(registers(&mut line, &request), [0x0C00, 0, 0x010F, 2026]);
    clock.advance(Duration::from_millis(3_661_234));
    assert_eq!(registers(&mut line, &request), [0x0D01, 1234, 0x010F, 2026]);
}

#[test]
fn the_same_seed_and_clock_give_the_same_registers() {
    let request = sealed(&[0x11, 0x03, 0x02, 0x40, 0x00, 0x7D]);
    let read = |seed| {
        let clock = Arc::new(FakeClock::starting("2026-05-04T08:00:00Z"));
        registers(&mut SimulatedLine::new(seed, clock), &request)
    };
    assert_eq!(read(7), read(7));
    assert_ne!(read(7), read(8));
}
