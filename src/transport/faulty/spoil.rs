//! Answers made wrong: frames in, frames out.

use fastrand::Rng;

use super::effect::CountChange;
use crate::codec::length::MOST_FRAME_BYTES;
use crate::codec::{ExceptionCode, ReadFunction, rtu};

/// Index of the byte that counts the data in the answer to a read.
const COUNT_AT: usize = 2;

/// Index of the first byte of data behind it.
const DATA_AT: usize = 3;

/// Bit of the function byte that makes an answer an exception.
const EXCEPTION: u8 = 0x80;

/// The most random bytes before or after an answer.
const MOST_NOISE: usize = 32;

/// The longest burst that the CRC detects every time.
const DETECTED_BURST: usize = 16;

/// Exception codes that have a name.
const CODES: [u8; 9] = [1, 2, 3, 4, 5, 6, 8, 10, 11];

/// The frame of a unit and a data unit, with its CRC.
pub(super) fn seal(mut body: Vec<u8>) -> Vec<u8> {
    body.extend_from_slice(&rtu::check(&body));
    body
}

/// The frame without its CRC.
pub(super) fn body(frame: &[u8]) -> &[u8] {
    frame.split_last_chunk::<2>().map_or(&[], |(body, _)| body)
}

/// Where an answer of so many bytes is parted: both parts have a byte at least, where it has two.
pub(super) fn part(wanted: Option<usize>, length: usize, chance: &mut Rng) -> usize {
    let most = length.saturating_sub(1).max(1);
    wanted.map_or_else(|| chance.usize(1..=most), |wanted| wanted.min(most))
}

/// The bytes asked for, or 1 to 32 random ones.
pub(super) fn noise(wanted: Option<&[u8]>, chance: &mut Rng) -> Vec<u8> {
    wanted.map_or_else(
        || {
            let length = chance.usize(1..=MOST_NOISE);
            std::iter::repeat_with(|| chance.u8(..))
                .take(length)
                .collect()
        },
        <[u8]>::to_vec,
    )
}

/// All bits of the CRC the other way round.
pub(super) fn wrong_crc(mut frame: Vec<u8>) -> Vec<u8> {
    if let Some(crc) = frame.last_chunk_mut::<2>() {
        *crc = crc.map(|byte| !byte);
    }
    frame
}

/// The bytes of the CRC swapped; where they are equal, that would leave it right, and all its bits
/// are the other way round.
pub(super) fn swapped_crc(mut frame: Vec<u8>) -> Vec<u8> {
    match frame.last_chunk_mut::<2>() {
        Some([low, high]) if low == high => wrong_crc(frame),
        Some(crc) => {
            crc.reverse();
            frame
        }
        None => frame,
    }
}

/// One bit the other way round, by its number modulo how many there are, or any. Bits are numbered
/// as they are on the wire: bit 0 is the lowest one of the first byte.
pub(super) fn flip(mut frame: Vec<u8>, wanted: Option<usize>, chance: &mut Rng) -> Vec<u8> {
    let bits = frame.len() * 8;
    if bits > 0 {
        let bit = wanted.map_or_else(|| chance.usize(0..bits), |wanted| wanted % bits);
        turn(&mut frame, bit);
    }
    frame
}

/// So many bits in a row, no more than there are, at any place: the first and the last one are
/// turned round, those between by chance.
pub(super) fn burst(mut frame: Vec<u8>, wanted: Option<usize>, chance: &mut Rng) -> Vec<u8> {
    let bits = frame.len() * 8;
    let wanted = wanted.unwrap_or_else(|| chance.usize(1..=DETECTED_BURST));
    let length = wanted.min(bits);
    if length > 0 {
        let first = chance.usize(0..=bits - length);
        let last = first + length - 1;
        for bit in first..=last {
            if bit == first || bit == last || chance.bool() {
                turn(&mut frame, bit);
            }
        }
    }
    frame
}

fn turn(frame: &mut [u8], bit: usize) {
    if let Some(byte) = frame.get_mut(bit / 8) {
        *byte ^= 1 << (bit % 8);
    }
}

/// The answer as another unit would give it.
pub(super) fn wrong_unit(frame: &[u8], wanted: Option<u8>, chance: &mut Rng) -> Vec<u8> {
    let mut body = body(frame).to_vec();
    if let Some(unit) = body.first_mut() {
        *unit = other_unit(*unit, wanted, chance);
    }
    seal(body)
}

/// A unit that is not `own`: the one wanted, or the one after it where that is the same; any of 1
/// to 247 where none is.
pub(super) fn other_unit(own: u8, wanted: Option<u8>, chance: &mut Rng) -> u8 {
    match wanted {
        Some(wanted) if wanted == own => wanted % 255 + 1,
        Some(wanted) => wanted,
        None => match chance.u8(1..247) {
            unit if unit < own => unit,
            unit => unit + 1,
        },
    }
}

/// The answer with another function; one to a read with that of the other kind of read, where none
/// is wanted.
pub(super) fn wrong_function(frame: &[u8], wanted: Option<u8>) -> Vec<u8> {
    const HOLDING: u8 = 3;
    const INPUT: u8 = 4;
    let mut body = body(frame).to_vec();
    if let Some(function) = body.get_mut(1) {
        let own = *function & !EXCEPTION;
        let other = wanted.unwrap_or(if own == HOLDING { INPUT } else { HOLDING });
        *function = *function & EXCEPTION | other_function(own, other);
    }
    seal(body)
}

/// A function that is not `own`: the one wanted, or the one after it where that is the same.
fn other_function(own: u8, wanted: u8) -> u8 {
    if wanted == own {
        wanted % 127 + 1
    } else {
        wanted
    }
}

/// The answer with more data, or with less, and its count and CRC as they are then. An answer that
/// counts no data has a byte more, or a byte less.
pub(super) fn wrong_count(frame: &[u8], change: CountChange) -> Vec<u8> {
    let mut body = body(frame).to_vec();
    if !counts_data(&body) {
        match change {
            CountChange::More | CountChange::Odd | CountChange::Most => body.push(0),
            CountChange::Fewer | CountChange::None => drop(body.pop()),
        }
        return seal(body);
    }
    let data = body.len().saturating_sub(DATA_AT);
    let wanted = match change {
        CountChange::More => data + 2,
        CountChange::Fewer => data.saturating_sub(2),
        CountChange::Odd => data + 1,
        CountChange::None => 0,
        CountChange::Most => usize::from(u8::MAX),
    };
    stretch(&mut body, DATA_AT + wanted);
    seal(body)
}

/// The answer with data until it is 257 bytes long, a byte more than a frame can have, and its
/// count, where it has one, and its CRC as they are then.
pub(super) fn oversize(frame: &[u8]) -> Vec<u8> {
    const CRC_BYTES: usize = 2;
    let mut body = body(frame).to_vec();
    stretch(&mut body, MOST_FRAME_BYTES + 1 - CRC_BYTES);
    seal(body)
}

/// Whether the answer is one to a read, which says how much data there is.
fn counts_data(body: &[u8]) -> bool {
    let function = |function: ReadFunction| crate::codec::FunctionCode::from(function).get();
    body.get(1).is_some_and(|own| {
        [ReadFunction::HoldingRegisters, ReadFunction::InputRegisters]
            .into_iter()
            .any(|read| function(read) == *own)
    })
}

/// Makes the body so long; what is added is its data over again.
fn stretch(body: &mut Vec<u8>, length: usize) {
    let data = body.get(DATA_AT..).unwrap_or_default().to_vec();
    let mut more = data.iter().copied().cycle();
    body.resize_with(length, || more.next().unwrap_or_default());
    let count = length.saturating_sub(DATA_AT);
    if counts_data(body)
        && let (Some(place), Ok(count)) = (body.get_mut(COUNT_AT), u8::try_from(count))
    {
        *place = count;
    }
}

/// An exception of the function that was asked for, in place of the answer; any code that has a
/// name where none is wanted.
pub(super) fn exception(frame: &[u8], wanted: Option<u8>, chance: &mut Rng) -> Vec<u8> {
    let code = wanted
        .or_else(|| chance.choice(CODES))
        .unwrap_or(ExceptionCode::ILLEGAL_FUNCTION.0);
    refusal(frame, |own| own, code)
}

/// Exception 02 of another function, in place of the answer.
pub(super) fn exception_for(frame: &[u8], wanted: Option<u8>, chance: &mut Rng) -> Vec<u8> {
    let wanted = wanted.unwrap_or_else(|| chance.u8(1..=127));
    let code = ExceptionCode::ILLEGAL_DATA_ADDRESS.0;
    refusal(frame, |own| other_function(own, wanted), code)
}

fn refusal(frame: &[u8], function: impl FnOnce(u8) -> u8, code: u8) -> Vec<u8> {
    match frame {
        [unit, own, ..] => seal(vec![*unit, EXCEPTION | function(own & !EXCEPTION), code]),
        _ => frame.to_vec(),
    }
}

/// What another unit might answer to this request: as long as the right answer, other data.
pub(super) fn stranger(request: &[u8], wanted: Option<u8>, chance: &mut Rng) -> Vec<u8> {
    /// Registers in one read (AP 6.3).
    const MOST_REGISTERS: u16 = 125;
    let own = request.first().copied().unwrap_or_default();
    let mut body = vec![other_unit(own, wanted, chance)];
    match request {
        [_, function @ (3 | 4), _, _, high, low, ..] => {
            let registers = u16::from_be_bytes([*high, *low]).clamp(1, MOST_REGISTERS);
            let bytes = u8::try_from(registers * 2).unwrap_or(u8::MAX);
            body.extend([*function, bytes]);
            body.extend(std::iter::repeat_with(|| chance.u8(..)).take(bytes.into()));
        }
        // A write is confirmed by its first six bytes, a loopback by the whole of it.
        [_, function @ (5 | 6 | 8 | 16), a, b, c, d, ..] => {
            body.extend([*function, *a, *b, *c, *d]);
        }
        [_, 7, ..] => body.extend([7, chance.u8(..)]),
        [_, function, ..] => body.extend([function | EXCEPTION, ExceptionCode::ILLEGAL_FUNCTION.0]),
        _ => {}
    }
    seal(body)
}
