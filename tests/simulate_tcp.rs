//! `simulate` over TCP: RTU frames, and Modbus TCP.

#![cfg(unix)]

mod support {
    pub(crate) mod frames_of;
    pub(crate) mod program;
    pub(crate) mod simulation;
}

use std::io::{ErrorKind, Read, Write};
use std::net::{Shutdown, TcpStream};
use std::time::Duration;

use meterpoll::transport::listen::Listener;

use support::frames_of::{echo, framed, sealed};
use support::simulation::{Ended, Simulation};

fn connect(simulation: &Simulation) -> TcpStream {
    let stream = TcpStream::connect(simulation.address()).expect("it listens");
    stream
        .set_read_timeout(Some(Duration::from_secs(10)))
        .unwrap();
    stream
}

/// Sends a request and expects this answer.
#[track_caller]
fn ask(client: &mut TcpStream, request: &[u8], answer: &[u8]) {
    client.write_all(request).unwrap();
    hear(client, answer);
}

#[track_caller]
fn hear(client: &mut TcpStream, answer: &[u8]) {
    let mut heard = vec![0; answer.len()];
    client.read_exact(&mut heard).unwrap();
    assert_eq!(heard, answer);
}

/// What comes until the other side closes.
fn rest(mut client: TcpStream) -> Vec<u8> {
    let mut heard = Vec::new();
    // A connection that is reset has ended as well.
    let _ = client.read_to_end(&mut heard);
    heard
}

#[test]
fn rtu_over_tcp_serves_several_clients_at_once() {
    let simulation = Simulation::new("--port rtu+tcp://127.0.0.1:0");
    assert!(simulation.path.starts_with("rtu+tcp://127.0.0.1:"));
    let mut clients: Vec<TcpStream> = (0..5).map(|_| connect(&simulation)).collect();
    for (unit, client) in [1, 2, 3, 1, 17].into_iter().zip(&mut clients) {
        ask(client, &echo(unit, 7), &echo(unit, 7));
    }
    let (first, others) = clients.split_first_mut().unwrap();
    let request = echo(1, 8);
    first.write_all(&request[..4]).unwrap();
    ask(&mut others[0], &echo(2, 9), &echo(2, 9));
    drop(clients);
    let mut client = connect(&simulation);
    ask(&mut client, &request, &request);
    let expected = "7 requests (function 08: 7), 7 answers\n";
    assert_eq!(simulation.stop("TERM"), Ended::by(15, expected));
    assert_eq!(rest(client), [0_u8; 0]);
}

#[test]
fn modbus_tcp_echoes_each_transaction() {
    let simulation = Simulation::new("--port tcp://127.0.0.1:0");
    let mut one = connect(&simulation);
    let mut other = connect(&simulation);
    let request = |transaction| framed(transaction, &echo(17, 1));
    for transaction in [0, 1, 0x1234, 0xFFFF] {
        ask(&mut one, &request(transaction), &request(transaction));
        ask(&mut other, &request(!transaction), &request(!transaction));
    }
    // Two at once, and one in pieces.
    one.write_all(&[request(5), request(6)].concat()).unwrap();
    hear(&mut one, &request(5));
    hear(&mut one, &request(6));
    one.write_all(&request(7)[..9]).unwrap();
    ask(&mut one, &request(7)[9..], &request(7));
    let read = framed(9, &sealed(&[17, 3, 0, 0, 0, 1]));
    ask(&mut other, &read, &framed(9, &sealed(&[17, 3, 2, 0, 65])));
    // Nobody of this number is here.
    one.write_all(&framed(10, &echo(9, 1))).unwrap();
    one.shutdown(Shutdown::Write).unwrap();
    assert_eq!(rest(one), [0_u8; 0]);
    let expected = "12 requests (function 03: 1, 08: 11), 12 answers, 1 to other units\n";
    assert_eq!(simulation.stop("INT"), Ended::by(2, expected));
}

#[test]
fn who_does_not_speak_modbus_tcp_is_hung_up_on_and_nobody_else() {
    let simulation = Simulation::new("--port tcp://127.0.0.1:0");
    let mut good = connect(&simulation);
    let mut bad = connect(&simulation);
    bad.write_all(b"GET / HTTP/1.1\r\n\r\n").unwrap();
    assert_eq!(rest(bad), [0_u8; 0]);
    ask(
        &mut good,
        &framed(1, &echo(17, 1)),
        &framed(1, &echo(17, 1)),
    );
    let expected = "1 request (function 08: 1), 1 answer, 1 not understood\n";
    assert_eq!(simulation.stop("INT"), Ended::by(2, expected));
}

#[test]
fn the_last_answer_arrives_when_it_ends_by_count() {
    for (scheme, request) in [("tcp", framed(1, &echo(17, 1))), ("rtu+tcp", echo(17, 1))] {
        let simulation = Simulation::new(&format!("--port {scheme}://localhost:0 --count 1"));
        let mut client = connect(&simulation);
        client.write_all(&request).unwrap();
        assert_eq!(rest(client), request);
        let expected = "1 request (function 08: 1), 1 answer\n";
        assert_eq!(simulation.ended(), Ended::with(0, expected));
    }
}

#[test]
fn a_fault_hangs_up_on_the_client_that_asked() {
    for (scheme, request) in [("tcp", framed(1, &echo(17, 1))), ("rtu+tcp", echo(17, 1))] {
        let port = format!("--port {scheme}://127.0.0.1:0");
        let simulation = Simulation::new(&format!("{port} --fault hang-up=before,on=2"));
        let mut one = connect(&simulation);
        let mut other = connect(&simulation);
        ask(&mut one, &request, &request);
        one.write_all(&request).unwrap();
        assert_eq!(rest(one), [0_u8; 0]);
        ask(&mut other, &request, &request);
        ask(&mut connect(&simulation), &request, &request);
        let expected = "4 requests (function 08: 4), 3 answers\nfaults: hang-up 1\n";
        assert_eq!(simulation.stop("INT"), Ended::by(2, expected));
    }
}

#[test]
fn requests_of_all_clients_count_for_the_rules() {
    let simulation = Simulation::new("--port rtu+tcp://127.0.0.1:0 --fault exception=6,on=1/2");
    let busy = sealed(&[17, 0x88, 6]);
    for _ in 0..3 {
        ask(&mut connect(&simulation), &echo(17, 1), &busy);
        ask(&mut connect(&simulation), &echo(17, 1), &echo(17, 1));
    }
}

#[test]
fn a_listener_that_ends_lets_go_of_clients_that_nobody_has_heard_of() {
    let listener = Listener::open("127.0.0.1:0").unwrap();
    let clients = [(); 20].map(|()| TcpStream::connect(listener.address()).unwrap());
    drop(listener);
    for client in clients {
        let limit = Some(Duration::from_secs(10));
        client.set_read_timeout(limit).unwrap();
        match (&client).read(&mut [0]) {
            Ok(count) => assert_eq!(count, 0),
            Err(error) => assert_eq!(error.kind(), ErrorKind::ConnectionReset),
        }
    }
}

#[test]
fn a_client_that_reads_nothing_does_not_keep_the_others() {
    let simulation = Simulation::new("--port rtu+tcp://127.0.0.1:0");
    let mut deaf = connect(&simulation);
    let mut good = connect(&simulation);
    let many = echo(17, 1).repeat(5000);
    for _ in 0..20 {
        deaf.write_all(&many).unwrap();
    }
    ask(&mut good, &echo(1, 3), &echo(1, 3));
    drop(deaf);
    ask(&mut good, &echo(1, 4), &echo(1, 4));
}
