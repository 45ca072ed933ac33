//! How long each frame is: the one table of frame lengths.

use super::cursor;
use super::function::FunctionCode;

/// The most bytes an RTU frame can have, CRC included (SL 2.3).
pub const MOST_FRAME_BYTES: usize = 256;

/// Bytes around a data unit: the unit before it, the CRC after it.
pub const FRAME_OVERHEAD: usize = 3;

/// The most bytes a data unit has (AP 4.1).
pub const MOST_DATA_BYTES: usize = MOST_FRAME_BYTES - FRAME_OVERHEAD;

/// Bytes of an exception response: unit, function, code, CRC (AP 7).
pub const EXCEPTION_BYTES: usize = 5;

/// Which way a frame goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// From client to server.
    Request,
    /// From server to client.
    Response,
}

/// What decides the length of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rule {
    /// Always this many bytes.
    Fixed(usize),
    /// `rest` bytes and as many as the byte at index `at` says.
    Counted {
        /// Index of the byte count in the frame.
        at: usize,
        /// All other bytes of the frame, CRC included.
        rest: usize,
    },
}

/// A row: function, rule of the request, rule of the response.
type Row = (FunctionCode, Rule, Rule);

/// All lengths in bytes, unit and CRC included. Function 08 carries one data word, the only form
/// that all four meters answer.
const TABLE: [Row; 7] = [
    (
        FunctionCode::ReadHoldingRegisters,
        Rule::Fixed(8),
        Rule::Counted { at: 2, rest: 5 },
    ),
    (
        FunctionCode::ReadInputRegisters,
        Rule::Fixed(8),
        Rule::Counted { at: 2, rest: 5 },
    ),
    (
        FunctionCode::WriteSingleCoil,
        Rule::Fixed(8),
        Rule::Fixed(8),
    ),
    (
        FunctionCode::WriteSingleRegister,
        Rule::Fixed(8),
        Rule::Fixed(8),
    ),
    (
        FunctionCode::ReadExceptionStatus,
        Rule::Fixed(4),
        Rule::Fixed(5),
    ),
    (FunctionCode::Diagnostics, Rule::Fixed(8), Rule::Fixed(8)),
    (
        FunctionCode::WriteMultipleRegisters,
        Rule::Counted { at: 6, rest: 9 },
        Rule::Fixed(8),
    ),
];

/// The rule for frames with this function byte, exception responses included. `None` for
/// functions this crate does not speak.
pub fn rule(function: u8, direction: Direction) -> Option<Rule> {
    if function & 0x80 != 0 {
        return match direction {
            Direction::Request => None,
            Direction::Response => Some(Rule::Fixed(EXCEPTION_BYTES)),
        };
    }
    TABLE
        .iter()
        .find(|(row, ..)| row.get() == function)
        .map(|(_, request, response)| match direction {
            Direction::Request => *request,
            Direction::Response => *response,
        })
}

/// How many bytes the frame has that starts with `start`. `None` when the function is unknown or
/// the bytes end before the length can be told.
pub fn of_frame(start: &[u8], direction: Direction) -> Option<usize> {
    match rule(cursor::byte(start, 1)?, direction)? {
        Rule::Fixed(bytes) => Some(bytes),
        Rule::Counted { at, rest } => Some(usize::from(cursor::byte(start, at)?) + rest),
    }
}
