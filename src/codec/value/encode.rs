//! Values back into registers.

use super::{ByteOrder, Raw, RegisterType};

/// Writes a value into registers, the inverse of [`decode`](super::decode): text is filled up with
/// spaces. `None` when the type does not hold such a value.
pub fn encode(kind: RegisterType, order: ByteOrder, value: &Raw) -> Option<Vec<u16>> {
    let words = match (kind, value) {
        (RegisterType::F32, Raw::Single(number)) => words(number.to_bits().into(), 2),
        (RegisterType::F64, Raw::Double(number)) => words(number.to_bits(), 4),
        (RegisterType::Time, Raw::Time(time)) => time_words(*time)?,
        (RegisterType::Date, Raw::Date(date)) => date_words(*date)?,
        (RegisterType::Ascii(characters), Raw::Text(text)) => {
            return text_words(characters, order, text);
        }
        (RegisterType::Letter, Raw::Text(letter)) => {
            let number = match letter.as_bytes() {
                [letter @ b'A'..=b'Z'] => letter - b'A' + 1,
                _ => return None,
            };
            return encode_integer(kind, order, number.into());
        }
        (RegisterType::Hex | RegisterType::Bits, Raw::Word(word)) => vec![*word],
        (RegisterType::Hex | RegisterType::Bits | RegisterType::Letter, _) => return None,
        (_, Raw::Integer(number)) => return encode_integer(kind, order, *number),
        _ => return None,
    };
    Some(order.arrange(&words))
}

/// The low words of some bits, high word first.
fn words(bits: u64, count: u16) -> Vec<u16> {
    let word = |word: u16| {
        let [.., high, low] = (bits >> (16 * word)).to_be_bytes();
        u16::from_be_bytes([high, low])
    };
    (0..count).rev().map(word).collect()
}

/// Hour and minute, then milliseconds in the minute; finer parts of a second have no place.
fn time_words(time: jiff::civil::Time) -> Option<Vec<u16>> {
    if time.microsecond() != 0 || time.nanosecond() != 0 {
        return None;
    }
    let milliseconds = u32::try_from(time.second()).ok()? * 1000;
    let milliseconds = milliseconds + u32::try_from(time.millisecond()).ok()?;
    let hour_minute = bytes(time.hour(), time.minute())?;
    Some(vec![hour_minute, u16::try_from(milliseconds).ok()?])
}

/// Month and day, then the year, 1 to 9999.
fn date_words(date: jiff::civil::Date) -> Option<Vec<u16>> {
    let year = u16::try_from(date.year()).ok().filter(|year| *year > 0)?;
    Some(vec![bytes(date.month(), date.day())?, year])
}

fn bytes(high: i8, low: i8) -> Option<u16> {
    let bytes = [u8::try_from(high).ok()?, u8::try_from(low).ok()?];
    Some(u16::from_be_bytes(bytes))
}

/// Two characters a register, in address order; only the bytes can be swapped.
fn text_words(characters: u8, order: ByteOrder, text: &str) -> Option<Vec<u16>> {
    let count = usize::from(characters);
    // A last byte behind an odd number of characters is no part of the text.
    let mut padded = bytes_of(text).filter(|bytes| bytes.len() <= count)?;
    padded.resize(count, b' ');
    padded.resize(count.next_multiple_of(2), 0);
    let words = padded.chunks_exact(2).map(|pair| {
        let pair = [pair[0], pair[1]];
        if order.low_byte_first() {
            u16::from_le_bytes(pair)
        } else {
            u16::from_be_bytes(pair)
        }
    });
    Some(words.collect())
}

/// The bytes that show as this text: ASCII, and `\xE9` for what is not.
fn bytes_of(text: &str) -> Option<Vec<u8>> {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text;
    while let Some(character) = rest.chars().next() {
        if let Some(byte) = shown_byte(rest) {
            bytes.push(byte);
            rest = rest.get(4..)?;
        } else {
            bytes.push(u8::try_from(character).ok().filter(u8::is_ascii)?);
            rest = rest.get(1..)?;
        }
    }
    Some(bytes)
}

/// The byte that is not ASCII and shows as the first four characters.
fn shown_byte(text: &str) -> Option<u8> {
    let digits = text.strip_prefix("\\x")?.get(..2)?;
    let byte = u8::from_str_radix(digits, 16).ok()?;
    (!byte.is_ascii() && format!("{byte:02X}") == digits).then_some(byte)
}

/// Writes an integer into registers; the inverse of [`decode`](super::decode) for integers, hex and
/// bits, and 1 to 26 for a letter. `None` when the type is not an integer or does not hold the number.
pub fn encode_integer(kind: RegisterType, order: ByteOrder, number: i128) -> Option<Vec<u16>> {
    let (lowest, highest) = kind.bounds()?;
    if !(lowest..=highest).contains(&number) {
        return None;
    }
    let bits = if kind == RegisterType::Mod10000 {
        ((number / 10_000) << 16) | (number % 10_000)
    } else {
        number
    };
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "taking each word's low 16 bits is the point"
    )]
    let words: Vec<u16> = (0..kind.registers())
        .rev()
        .map(|word| (bits >> (16 * word)) as u16)
        .collect();
    Some(order.arrange(&words))
}
