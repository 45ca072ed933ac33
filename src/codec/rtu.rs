//! RTU frames: unit, data unit, CRC (SL 2.5.1).

use std::fmt;

use crc::{CRC_16_MODBUS, Crc};

use super::address::{Broadcast, Unit, UnitRange};
use super::cursor;
use super::error::DecodeError;
use super::length::{FRAME_OVERHEAD, MOST_DATA_BYTES, MOST_FRAME_BYTES};
use super::reply::Reply;
use super::request::{Request, Write};

/// CRC-16/MODBUS: starts at `0xFFFF`, reversed polynomial `0xA001`, sent low byte first (SL 2.5.1.2).
const CRC: Crc<u16> = Crc::<u16>::new(&CRC_16_MODBUS);

/// The two check bytes of `body`, in wire order.
pub fn check(body: &[u8]) -> [u8; 2] {
    CRC.checksum(body).to_le_bytes()
}

/// A whole frame, ready to be sent in one write. Prints as hex pairs.
///
/// It is never longer than the 256 bytes of the standard: it is made of a request or a reply, and
/// the longest of each hold 250 bytes of registers ([`super::ReadValues`]) behind 2 others, or 246
/// ([`super::RegisterBlock`]) behind 6. Unit and CRC make that 255. [`seal`] cuts.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Frame(Vec<u8>);

impl Frame {
    fn new(address: u8, encode: impl FnOnce(&mut Vec<u8>)) -> Self {
        let mut bytes = Vec::with_capacity(MOST_FRAME_BYTES);
        bytes.push(address);
        encode(&mut bytes);
        bytes.extend_from_slice(&check(&bytes));
        Self(bytes)
    }

    /// The bytes, CRC included.
    pub fn as_bytes(&self) -> &[u8] {
        &self.0
    }
}

impl fmt::Display for Frame {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        Hex(&self.0).fmt(f)
    }
}

/// Prints bytes as hex pairs with spaces: `11 03 00 6B`.
#[derive(Debug, Clone, Copy)]
pub struct Hex<'a>(pub &'a [u8]);

impl fmt::Display for Hex<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, byte) in self.0.iter().enumerate() {
            if index > 0 {
                f.write_str(" ")?;
            }
            write!(f, "{byte:02X}")?;
        }
        Ok(())
    }
}

/// Whom a request is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Destination {
    /// One unit, which answers.
    Unit(Unit),
    /// All of them; none answers.
    Broadcast,
}

/// The frame of a request to one unit.
pub fn encode_request(unit: Unit, request: &Request) -> Frame {
    Frame::new(unit.get(), |bytes| request.encode(bytes))
}

/// The frame of a write to every unit.
pub fn encode_broadcast(_: Broadcast, write: &Write) -> Frame {
    Frame::new(0, |bytes| write.encode(bytes))
}

/// The frame of a unit's reply.
pub fn encode_reply(unit: Unit, reply: &Reply) -> Frame {
    Frame::new(unit.get(), |bytes| reply.encode(bytes))
}

/// The frame of a data unit as it is, right or wrong, of at most 253 bytes; more are cut off.
pub fn seal(address: u8, data_unit: &[u8]) -> Frame {
    let data_unit = data_unit.get(..MOST_DATA_BYTES).unwrap_or(data_unit);
    Frame::new(address, |bytes| bytes.extend_from_slice(data_unit))
}

/// Checks length and CRC and splits a frame into its address byte and its data unit.
///
/// # Errors
/// [`DecodeError::Truncated`], [`DecodeError::TooLong`] or [`DecodeError::Crc`].
pub fn open(frame: &[u8]) -> Result<(u8, &[u8]), DecodeError> {
    if frame.len() > MOST_FRAME_BYTES {
        return Err(DecodeError::TooLong { found: frame.len() });
    }
    if frame.len() <= FRAME_OVERHEAD {
        return Err(DecodeError::Truncated { field: "CRC" });
    }
    let (body, found) =
        cursor::split_check(frame).ok_or(DecodeError::Truncated { field: "CRC" })?;
    let computed = check(body);
    if found != computed {
        return Err(DecodeError::Crc { found, computed });
    }
    let (address, unit) = body
        .split_first()
        .ok_or(DecodeError::Truncated { field: "unit" })?;
    Ok((*address, unit))
}

/// Reads a whole request frame. Any unit to 255 is taken: who may have it is the meter's matter.
///
/// # Errors
/// What [`open`] and [`Request::decode`] find; [`DecodeError::Broadcast`] for a broadcast of
/// anything but a write.
pub fn decode_request(frame: &[u8]) -> Result<(Destination, Request), DecodeError> {
    let (address, unit) = open(frame)?;
    let request = Request::decode(unit)?;
    if address == 0 {
        return match request {
            Request::Write(_) => Ok((Destination::Broadcast, request)),
            _ => Err(DecodeError::Broadcast(request.function())),
        };
    }
    let unit = Unit::new(u16::from(address), UnitRange::Extended)?;
    Ok((Destination::Unit(unit), request))
}

/// Reads a whole reply frame. Any unit to 255 is taken.
///
/// # Errors
/// What [`open`] and [`Reply::decode`] find; a reply from address 0 is a
/// [`DecodeError::Address`].
pub fn decode_reply(frame: &[u8]) -> Result<(Unit, Reply), DecodeError> {
    let (address, unit) = open(frame)?;
    let reply = Reply::decode(unit)?;
    Ok((Unit::new(u16::from(address), UnitRange::Extended)?, reply))
}

/// `length` bytes of `bytes` from `start`, as long as they are all there and their CRC holds.
pub fn checked_window(bytes: &[u8], start: usize, length: usize) -> Option<&[u8]> {
    cursor::window(bytes, start, length).filter(|frame| open(frame).is_ok())
}
