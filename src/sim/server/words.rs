//! Requests and answers in words.

use crate::codec::length::{Direction, of_frame};
use crate::codec::rtu::{self, Destination, Hex};
use crate::codec::{Reply, Request, Response, Write};
use crate::words::counted;

/// What a request asks: `unit 17, function 03 (Read Holding Registers) 0x0240+1`.
pub(super) fn request(frame: &[u8]) -> String {
    let (destination, request) = match rtu::decode_request(frame) {
        Ok(asked) => asked,
        Err(error) => return format!("{}: {error}", Hex(frame)),
    };
    let function = request.function();
    let what = match request {
        Request::Read { range, .. } => format!(" {range}"),
        Request::Write(Write::Coil { address, on }) => {
            format!(" {address} {}", if on { "on" } else { "off" })
        }
        Request::Write(Write::Register { address, value }) => {
            format!(" {address}: {value:04X}")
        }
        Request::Write(Write::Registers(block)) => {
            format!(" {}: {}", block.start(), words(block.values()))
        }
        Request::ReadExceptionStatus => String::new(),
        Request::ReturnQueryData(word) => format!(" {word:04X}"),
    };
    match destination {
        Destination::Unit(unit) => format!("unit {unit}, {function}{what}"),
        Destination::Broadcast => format!("all units, {function}{what}"),
    }
}

/// What bytes on their way to a client say: `unit 17, 1 register: 019F`.
pub(super) fn answer(bytes: &[u8]) -> String {
    let said: Vec<String> = frames(bytes).map(one_answer).collect();
    said.join("; ")
}

fn one_answer(frame: &[u8]) -> String {
    let (unit, reply) = match rtu::decode_reply(frame) {
        Ok(answered) => answered,
        Err(error) => {
            let bytes = frame.len();
            return format!("{bytes} bytes that are no answer: {error}");
        }
    };
    match reply {
        Reply::Exception { function, code } => format!("unit {unit}, {code} to {function}"),
        Reply::Normal(Response::Registers { values, .. }) => {
            let values = values.into_vec();
            let registers = counted(values.len(), "register", "registers");
            format!("unit {unit}, {registers}: {}", words(&values))
        }
        Reply::Normal(Response::ExceptionStatus(bits)) => format!("unit {unit}, status {bits:08b}"),
        Reply::Normal(response) => format!("unit {unit}, {} done", response.function()),
    }
}

fn words(values: &[u16]) -> String {
    let words: Vec<String> = values.iter().map(|word| format!("{word:04X}")).collect();
    words.join(" ")
}

/// The answers in a run of bytes: whole and right frames, and what is left over.
pub(super) fn frames(bytes: &[u8]) -> impl Iterator<Item = &[u8]> {
    let mut rest = bytes;
    std::iter::from_fn(move || {
        if rest.is_empty() {
            return None;
        }
        let length = of_frame(rest, Direction::Response).unwrap_or(rest.len());
        let whole = rest.get(..length).filter(|frame| rtu::open(frame).is_ok());
        let frame = whole.unwrap_or(rest);
        rest = rest.get(frame.len()..).unwrap_or_default();
        Some(frame)
    })
}
