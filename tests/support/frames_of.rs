//! Frames made for a test.

#![allow(dead_code, reason = "each test file uses its share")]

use meterpoll::codec::mbap::{self, Header};
use meterpoll::codec::rtu::{check, open};

/// A frame with a right CRC: `body` is the unit and the data unit.
pub(crate) fn sealed(body: &[u8]) -> Vec<u8> {
    [body, &check(body)].concat()
}

/// Function 08, to be sent back. A PQM sends zeros alone, so the word is of no account there.
pub(crate) fn echo(unit: u8, word: u8) -> Vec<u8> {
    let word = if unit == 17 { 0 } else { word };
    sealed(&[unit, 8, 0, 0, 0, word])
}

/// The same frame with the header of Modbus TCP.
pub(crate) fn framed(transaction: u16, frame: &[u8]) -> Vec<u8> {
    let (unit, data_unit) = open(frame).unwrap();
    mbap::encode(Header { transaction, unit }, data_unit)
}
