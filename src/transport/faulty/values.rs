//! Values in a rule: each a text that is read, or refused with what is allowed.

use std::ops::RangeInclusive;
use std::time::Duration;

use super::effect::{CountChange, Moment};
use super::kind::FaultKind;
use crate::codec::length::MOST_FRAME_BYTES;

/// Reads a value; the error says what is allowed.
pub(super) type Reader<T> = fn(&str) -> Result<T, &'static str>;

/// The longest time, as for options.
const LONGEST: Duration = Duration::from_secs(24 * 60 * 60);

/// The shortest time from one byte to the next: about that of 115200 baud, and far more than it
/// takes to make one. What comes faster than it is made never ends.
const SHORTEST_PACE: Duration = Duration::from_micros(100);

pub(super) fn time(text: &str) -> Result<Duration, &'static str> {
    humantime::parse_duration(text)
        .ok()
        .filter(|time| *time <= LONGEST)
        .ok_or("a time with its unit to 24h, such as 40ms")
}

/// A time that passes, such as a time-out.
pub(super) fn span(text: &str) -> Result<Duration, &'static str> {
    time(text)
        .ok()
        .filter(|time| !time.is_zero())
        .ok_or("a time with its unit above 0 and to 24h, such as 20ms")
}

/// The time from one of many to the next.
pub(super) fn pace(text: &str) -> Result<Duration, &'static str> {
    time(text)
        .ok()
        .filter(|time| *time >= SHORTEST_PACE)
        .ok_or("a time with its unit from 100us to 24h, such as 20ms")
}

pub(super) fn time_outs(text: &str) -> Result<f64, &'static str> {
    real(text, 0.0..=100.0).ok_or("a number of time-outs from 0 to 100, such as 1.1")
}

pub(super) fn rate(text: &str) -> Result<f64, &'static str> {
    real(text, 0.0..=1.0).ok_or("a probability from 0 to 1, such as 0.3")
}

pub(super) fn bytes(text: &str) -> Result<usize, &'static str> {
    whole(text, 1..=MOST_FRAME_BYTES as u64)
        .and_then(|bytes| usize::try_from(bytes).ok())
        .ok_or("a number of bytes from 1 to 256")
}

pub(super) fn bit(text: &str) -> Result<usize, &'static str> {
    whole(text, 0..=MOST_FRAME_BYTES as u64 * 8 - 1)
        .and_then(|bit| usize::try_from(bit).ok())
        .ok_or("the number of a bit from 0 to 2047")
}

pub(super) fn bits(text: &str) -> Result<usize, &'static str> {
    whole(text, 1..=MOST_FRAME_BYTES as u64 * 8)
        .and_then(|bits| usize::try_from(bits).ok())
        .ok_or("a number of bits from 1 to 2048")
}

pub(super) fn unit(text: &str) -> Result<u8, &'static str> {
    byte(text, 0).ok_or("a unit from 0 to 255")
}

pub(super) fn code(text: &str) -> Result<u8, &'static str> {
    byte(text, 0).ok_or("an exception code from 0 to 255")
}

pub(super) fn function(text: &str) -> Result<u8, &'static str> {
    byte(text, 1)
        .filter(|function| *function < 0x80)
        .ok_or("a function from 1 to 127")
}

pub(super) fn seed(text: &str) -> Result<u64, &'static str> {
    whole(text, 0..=u64::MAX).ok_or("a whole number from 0 to 18446744073709551615")
}

/// Noise in hex: `00FF`, `00 FF`.
pub(super) fn noise(text: &str) -> Result<Vec<u8>, &'static str> {
    let digits: Option<Vec<u8>> = text
        .chars()
        .filter(|character| *character != ' ')
        .map(|digit| digit.to_digit(16).and_then(|digit| digit.try_into().ok()))
        .collect();
    digits
        .filter(|digits| digits.len().is_multiple_of(2))
        .map(|digits| {
            let (pairs, _) = digits.as_chunks::<2>();
            let bytes = pairs.iter().map(|[high, low]| high << 4 | low);
            bytes.collect::<Vec<u8>>()
        })
        .filter(|bytes| (1..=MOST_FRAME_BYTES).contains(&bytes.len()))
        .ok_or("1 to 256 bytes in hex, such as 00FF")
}

pub(super) fn change(text: &str) -> Result<CountChange, &'static str> {
    Ok(match text {
        "+1" => CountChange::More,
        "-1" => CountChange::Fewer,
        "odd" => CountChange::Odd,
        "0" => CountChange::None,
        "255" => CountChange::Most,
        _ => return Err("+1, -1, odd, 0 or 255"),
    })
}

pub(super) fn moment(text: &str) -> Result<Moment, &'static str> {
    Ok(match text {
        "before" => Moment::Before,
        "during" => Moment::During,
        "after" => Moment::After,
        _ => return Err("before, during or after"),
    })
}

/// Names of kinds with `+` between them.
pub(super) fn kinds(text: &str) -> Result<Vec<FaultKind>, &'static str> {
    text.split('+')
        .map(|name| FaultKind::named(name.trim()).filter(|kind| *kind != FaultKind::Any))
        .collect::<Option<_>>()
        .ok_or("names of faults with + between them, such as hang-up+garbage")
}

/// A number of requests or of one, from 1.
pub(super) fn ordinal(text: &str) -> Option<u64> {
    whole(text, 1..=u64::MAX)
}

fn byte(text: &str, least: u64) -> Option<u8> {
    whole(text, least..=255).and_then(|number| u8::try_from(number).ok())
}

fn whole(text: &str, range: RangeInclusive<u64>) -> Option<u64> {
    let hex = text.strip_prefix("0x").or_else(|| text.strip_prefix("0X"));
    let (digits, radix) = hex.map_or((text, 10), |hex| (hex, 16));
    // The conversion would take a sign.
    u64::from_str_radix(digits, radix)
        .ok()
        .filter(|number| !digits.starts_with('+') && range.contains(number))
}

/// Not a number is in no range.
fn real(text: &str, range: RangeInclusive<f64>) -> Option<f64> {
    text.parse().ok().filter(|number| range.contains(number))
}
