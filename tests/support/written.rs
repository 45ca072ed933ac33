//! Writes, and what a meter answers to them.

#![allow(dead_code, reason = "each test file uses its share")]

use std::time::Duration;

use meterpoll::client::{Confirmation, Unwritten};
use meterpoll::codec::rtu::{check, encode_request};
use meterpoll::codec::{RegisterAddress, RegisterBlock, Request, Write};

use super::script::unit;

pub(crate) const fn ms(milliseconds: u64) -> Duration {
    Duration::from_millis(milliseconds)
}

/// Function 06.
pub(crate) const fn set(address: u16, value: u16) -> Write {
    let address = RegisterAddress(address);
    Write::Register { address, value }
}

/// Function 05, as a PQM carries out an operation.
pub(crate) const fn coil(number: u16) -> Write {
    Write::Coil {
        address: RegisterAddress(number),
        on: true,
    }
}

/// Function 16.
pub(crate) fn block(start: u16, values: &[u16]) -> Write {
    let block = RegisterBlock::new(start, values.to_vec());
    Write::Registers(block.expect("1 to 123 registers"))
}

/// A frame with a right CRC: `body` is the unit and the data unit.
pub(crate) fn sealed(body: &[u8]) -> Vec<u8> {
    [body, &check(body)].concat()
}

/// The frame in which a write goes to unit 17.
pub(crate) fn frame(write: &Write) -> Vec<u8> {
    let request = Request::Write(write.clone());
    encode_request(unit(17), &request).as_bytes().to_vec()
}

/// What a meter answers that does what a frame says.
pub(crate) fn confirmed(frame: &[u8]) -> Vec<u8> {
    sealed(&frame[..6])
}

/// What unit 17 answers when it has done what it was told.
pub(crate) fn answer(write: &Write) -> Vec<u8> {
    confirmed(&frame(write))
}

/// What it answers when it has not.
pub(crate) fn refusal(write: &Write, code: u8) -> Vec<u8> {
    refused(&frame(write), code)
}

/// What a meter answers that does not do what a frame says.
pub(crate) fn refused(frame: &[u8], code: u8) -> Vec<u8> {
    sealed(&[frame[0], frame[1] | 0x80, code])
}

/// What became of a write, in words.
pub(crate) fn outcome(result: &Result<Confirmation, Unwritten>) -> String {
    match result {
        Ok(Confirmation::Done) => "done".to_owned(),
        Ok(Confirmation::Stored(value)) => format!("stored {value}"),
        Ok(Confirmation::Accepted) => "accepted".to_owned(),
        Err(unwritten) => unwritten.to_string(),
    }
}
