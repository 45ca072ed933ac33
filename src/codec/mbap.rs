//! Modbus TCP frames: a header in place of unit and CRC ("Modbus Messaging on TCP/IP
//! Implementation Guide V1.0b", 3.1.3; MB below).
//!
//! ```text
//! transaction (2) · protocol, 0 (2) · length of the rest (2) · unit (1) · data unit (1 to 253)
//! ```

use super::cursor::{self, Cursor};
use super::error::DecodeError;
use super::length::MOST_DATA_BYTES;

/// Bytes before the data unit.
const HEADER_BYTES: usize = 7;

/// Bytes before those that the length counts.
const UNCOUNTED: usize = 6;

/// Modbus among the protocols that the header can be of (MB 3.1.3).
const MODBUS: u16 = 0;

/// What goes before a data unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Header {
    /// The client's number for the request, which its answer bears as well.
    pub transaction: u16,
    /// The unit behind the server that is meant; any number at all.
    pub unit: u8,
}

/// The frame of a data unit of at most [`MOST_DATA_BYTES`]; more are cut off.
pub fn encode(header: Header, data_unit: &[u8]) -> Vec<u8> {
    let data_unit = data_unit.get(..MOST_DATA_BYTES).unwrap_or(data_unit);
    // The unit and at most 253 bytes fit.
    let length = u16::try_from(1 + data_unit.len()).unwrap_or_default();
    let mut frame = Vec::with_capacity(HEADER_BYTES + data_unit.len());
    for field in [header.transaction, MODBUS, length] {
        frame.extend_from_slice(&field.to_be_bytes());
    }
    frame.push(header.unit);
    frame.extend_from_slice(data_unit);
    frame
}

/// How many bytes the frame has that starts with `start`; `None` when the bytes end before its
/// length can be told.
///
/// # Errors
/// [`DecodeError::Field`] for another protocol, and for a length that leaves no room for a data
/// unit or has too much of it: nothing behind it can be made sense of.
pub fn of_frame(start: &[u8]) -> Result<Option<usize>, DecodeError> {
    let Some(start) = cursor::window(start, 0, UNCOUNTED) else {
        return Ok(None);
    };
    let (_, length) = fields(&mut Cursor::new(start))?;
    Ok(Some(UNCOUNTED + length))
}

/// Splits a whole frame into its header and its data unit.
///
/// # Errors
/// What [`of_frame`] finds, and [`DecodeError::Truncated`] or [`DecodeError::Trailing`] where the
/// length is not that of the frame.
pub fn open(frame: &[u8]) -> Result<(Header, &[u8]), DecodeError> {
    let mut cursor = Cursor::new(frame);
    let (transaction, length) = fields(&mut cursor)?;
    let counted = cursor.remaining();
    if counted > length {
        return Err(DecodeError::Trailing {
            extra: counted - length,
        });
    }
    let unit = cursor.u8("unit")?;
    let data_unit = cursor::window(frame, HEADER_BYTES, length - 1);
    let data_unit = data_unit.ok_or(DecodeError::Truncated { field: "data unit" })?;
    Ok((Header { transaction, unit }, data_unit))
}

/// The transaction, and how many bytes follow the length: at least 2.
fn fields(cursor: &mut Cursor<'_>) -> Result<(u16, usize), DecodeError> {
    let field = |field, found| DecodeError::Field { field, found };
    let transaction = cursor.u16("transaction")?;
    match cursor.u16("protocol")? {
        MODBUS => {}
        found => return Err(field("protocol", found)),
    }
    let found = cursor.u16("length")?;
    let length = usize::from(found);
    if (2..=1 + MOST_DATA_BYTES).contains(&length) {
        Ok((transaction, length))
    } else {
        Err(field("length", found))
    }
}
