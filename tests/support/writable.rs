//! A meter on a pty that can be written to, and runs of the program on it.

#![allow(dead_code, reason = "each test file uses its share")]

use std::collections::BTreeMap;

use meterpoll::codec::rtu::check;

use super::program::{Program, without_times};
use super::pty::{Behaviour, PtyMeter, answer_with};

/// Registers by address.
pub(crate) type Registers = BTreeMap<u16, u16>;

/// A frame with a right CRC: `body` is the unit and the data unit.
pub(crate) fn sealed(body: &[u8]) -> Vec<u8> {
    [body, &check(body)].concat()
}

fn word(frame: &[u8], at: usize) -> u16 {
    u16::from_be_bytes([frame[at], frame[at + 1]])
}

/// Does what a write says, and answers.
pub(crate) fn obey(frame: &[u8], registers: &mut Registers) -> Vec<u8> {
    match frame[1] {
        6 => {
            registers.insert(word(frame, 2), word(frame, 4));
        }
        16 => {
            let values = (0..word(frame, 4)).map(|index| word(frame, 7 + 2 * usize::from(index)));
            registers.extend((word(frame, 2)..).zip(values));
        }
        _ => {}
    }
    sealed(&frame[..6])
}

/// Refuses a request.
pub(crate) fn refuse(frame: &[u8], code: u8) -> Vec<u8> {
    sealed(&[frame[0], frame[1] | 0x80, code])
}

/// Whether a frame writes.
pub(crate) fn is_write(frame: &[u8]) -> bool {
    matches!(frame[1], 5 | 6 | 16)
}

/// A meter at unit 17 that holds these registers and treats writes like this.
pub(crate) fn meter(
    held: &[(u16, u16)],
    treat: impl FnMut(&[u8], &mut Registers) -> Vec<u8> + Send + 'static,
) -> PtyMeter {
    PtyMeter::new(behaviour(held, treat))
}

/// What such a meter does.
pub(crate) fn behaviour(
    held: &[(u16, u16)],
    mut treat: impl FnMut(&[u8], &mut Registers) -> Vec<u8> + Send + 'static,
) -> Box<Behaviour> {
    let mut registers: Registers = held.iter().copied().collect();
    Box::new(move |frame| {
        if is_write(frame) {
            return treat(frame, &mut registers);
        }
        if frame[1] == 8 {
            return frame.to_vec();
        }
        let answer = answer_with(17, frame, |address| registers.get(&address).copied());
        answer.unwrap_or_default()
    })
}

/// The writes among the requests that a meter has seen, in hex and without CRC.
pub(crate) fn writes(meter: &PtyMeter) -> Vec<String> {
    let requests = meter.requests();
    let writes = requests.iter().filter(|request| is_write(request));
    writes
        .map(|request| hex(&request[..request.len() - 2]))
        .collect()
}

/// `11 06 10 28`.
pub(crate) fn hex(bytes: &[u8]) -> String {
    let bytes: Vec<String> = bytes.iter().map(|byte| format!("{byte:02X}")).collect();
    bytes.join(" ")
}

/// What a run came to; the port is `PORT`, times are `<time>`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Told {
    pub(crate) code: Option<i32>,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

/// Runs a command on a port, as fast as a line can be.
pub(crate) fn run(path: &str, command: &str) -> Told {
    finished(path, &on(path, command))
}

/// The command on a port.
pub(crate) fn on(path: &str, command: &str) -> Program {
    let (name, arguments) = command.split_once(' ').expect("a command and arguments");
    Program::new(&format!("{name} -p {path} -b 115200 {arguments}"))
}

/// Runs it.
pub(crate) fn finished(path: &str, program: &Program) -> Told {
    let output = program.output();
    let text = |bytes: Vec<u8>| {
        let text = String::from_utf8(bytes).expect("UTF-8");
        without_times(&text.replace(path, "PORT"))
    };
    Told {
        code: output.status.code(),
        stdout: text(output.stdout),
        stderr: text(output.stderr),
    }
}

/// Compares what a run came to, text by text.
#[track_caller]
pub(crate) fn came_to(told: &Told, code: i32, stdout: &str, stderr: &str) {
    assert_eq!(told.stderr, stderr);
    assert_eq!(told.stdout, stdout);
    assert_eq!(told.code, Some(code));
}
