//! The simulated meter on a terminal.

#![cfg(unix)]

use std::io::{Read, Write};
use std::time::Duration;

use meterpoll::codec::rtu::check;
use meterpoll::sim::SimulatedLine;
use meterpoll::transport::serial::Serial;
use meterpoll::transport::{LineSettings, SystemClock};
use serialport::{SerialPort, TTYPort};

#[path = "support/simulated_meter.rs"]
#[allow(dead_code, reason = "its main is not called here")]
mod simulated_meter;

/// Unit 17, function 08: loopback. The answer is the same.
const LOOPBACK: [u8; 8] = [0x11, 0x08, 0x00, 0x00, 0x00, 0x00, 0xE2, 0x9B];

/// A frame with a right CRC: `body` is the unit and the data unit.
fn sealed(body: &[u8]) -> Vec<u8> {
    [body, &check(body)].concat()
}

#[test]
fn the_meters_on_a_terminal_answer_until_the_line_hangs_up() {
    let (mut client, terminal) = TTYPort::pair().unwrap();
    let path = terminal.name().unwrap();
    // Both ends of a pair are held exclusively: only this one is handed over.
    drop(terminal);
    let mut server = Serial::open(&path, LineSettings::default()).unwrap();
    let serving = std::thread::spawn(move || {
        simulated_meter::serve(&mut server, &SimulatedLine::meters(1), &SystemClock::new())
    });
    client.set_timeout(Duration::from_secs(10)).unwrap();

    let illegal = sealed(&[0x11, 0x2B, 0x0E, 0x01, 0x00]);
    let refusal = sealed(&[0x11, 0xAB, 0x01]);
    let loopback = &LOOPBACK[..];
    // Unit 1 has no more than 11 registers to give.
    let (much, too_much) = (sealed(&[1, 4, 0, 0, 0, 12]), sealed(&[1, 0x84, 3]));
    let echo = |unit| sealed(&[unit, 8, 0, 0, 0xA5, 0x37]);
    for (request, answer) in [
        (loopback, loopback),
        (&illegal, &refusal),
        (&much, &too_much),
        (&echo(2), &echo(2)),
        (&echo(3), &echo(3)),
        (loopback, loopback),
    ] {
        client.write_all(request).unwrap();
        let mut heard = vec![0; answer.len()];
        client.read_exact(&mut heard).unwrap();
        assert_eq!(heard, answer);
    }

    drop(client);
    let lost = serving.join().unwrap();
    assert_eq!(lost.to_string(), format!("port {path} was lost"));
}
