//! `simulate` takes writes wherever its clients come from, and tells of them in words.

#![cfg(unix)]

mod support {
    pub(crate) mod frames_of;
    pub(crate) mod program;
    pub(crate) mod simulation;
}

use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::Duration;

use support::frames_of::{framed, sealed};
use support::program::Program;
use support::simulation::{Ended, Simulation};

/// Sends a request and expects this answer.
#[track_caller]
fn ask(client: &mut (impl Read + Write), request: &[u8], answer: &[u8]) {
    client.write_all(request).unwrap();
    let mut heard = vec![0; answer.len()];
    client.read_exact(&mut heard).unwrap();
    assert_eq!(heard, answer);
}

fn connect(simulation: &Simulation) -> TcpStream {
    let stream = TcpStream::connect(simulation.address()).unwrap();
    let patience = Some(Duration::from_secs(10));
    stream.set_read_timeout(patience).unwrap();
    stream
}

const TOLD: &str = "\
asked: unit 17, function 16 (Write Multiple Registers) 0x1050: 0320
answered: unit 17, function 16 (Write Multiple Registers) done
asked: unit 17, function 06 (Write Single Register) 0x1050: FFFF
answered: unit 17, exception 03 (ILLEGAL DATA VALUE) to function 06 (Write Single Register)
asked: unit 17, function 05 (Write Single Coil) 0x000E on
answered: unit 17, function 05 (Write Single Coil) done
asked: all units, function 05 (Write Single Coil) 0x0022 on
asked: unit 17, function 03 (Read Holding Registers) 0x1050+1
answered: unit 17, 1 register: 0320
5 requests (function 03: 1, 05: 2, 06: 1, 10: 1), 3 answers, 1 exception (03: 1)
";

/// Writes that are taken, refused and for all, and a read.
fn talk(client: &mut (impl Read + Write), frame: impl Fn(&[u8]) -> Vec<u8>) {
    let set = [17, 16, 0x10, 0x50, 0, 1, 2, 0x03, 0x20];
    let refused = [17, 6, 0x10, 0x50, 0xFF, 0xFF];
    let operation = [17, 5, 0, 14, 0xFF, 0];
    ask(client, &frame(&set), &frame(&set[..6]));
    ask(client, &frame(&refused), &frame(&[17, 0x86, 3]));
    ask(client, &frame(&operation), &frame(&operation));
    client.write_all(&frame(&[0, 5, 0, 34, 0xFF, 0])).unwrap();
    let read = frame(&[17, 3, 0x10, 0x50, 0, 1]);
    ask(client, &read, &frame(&[17, 3, 2, 0x03, 0x20]));
}

#[test]
fn a_serial_client_writes_and_everybody_reads_it() {
    let simulation = Simulation::new("-v --count 5");
    let port = serialport::new(&simulation.path, 115_200);
    let port = port.timeout(Duration::from_secs(10));
    let mut client = port.open_native().expect("the port opens");
    talk(&mut client, sealed);
    assert_eq!(simulation.ended(), Ended::with(0, TOLD));
}

#[test]
fn clients_over_tcp_write_with_either_framing() {
    let simulation = Simulation::new("-v --count 5 --port rtu+tcp://127.0.0.1:0");
    talk(&mut connect(&simulation), sealed);
    assert_eq!(simulation.ended(), Ended::with(0, TOLD));
    let simulation = Simulation::new("-v --count 5 --port tcp://127.0.0.1:0");
    talk(&mut connect(&simulation), |body| framed(1, &sealed(body)));
    assert_eq!(simulation.ended(), Ended::with(0, TOLD));
}

#[test]
fn what_was_written_lasts_as_long_as_the_simulation() {
    let simulation = Simulation::new("--meter pqm");
    let set = sealed(&[17, 6, 0x10, 0x50, 0x03, 0x20]);
    {
        let port = serialport::new(&simulation.path, 115_200);
        let port = port.timeout(Duration::from_secs(10));
        let mut client = port.open_native().expect("the port opens");
        ask(&mut client, &set, &set);
    }
    let read = |port: &str| {
        let output = Program::new("read-registers -a 17 --meter pqm ct_primary -f csv -p")
            .argument(port)
            .output();
        let text = String::from_utf8(output.stdout).unwrap();
        let row = text.lines().nth(1).map(str::to_owned).unwrap();
        row.rsplit(',').next().map(str::to_owned)
    };
    assert_eq!(read(&simulation.path).as_deref(), Some("800"));
    // Another one, and the line inside the program, begin anew.
    let other = Simulation::new("--meter pqm");
    assert_eq!(read(&other.path).as_deref(), Some("600"));
    assert_eq!(read("sim:").as_deref(), Some("600"));
}
