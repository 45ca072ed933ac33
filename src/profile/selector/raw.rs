//! Raw registers as they are typed.

use rust_decimal::Decimal;

use super::{Numbering, Reading, SelectError};
use crate::codec::value::{ByteOrder, RegisterType};
use crate::codec::{AddressError, FunctionCode, ReadFunction, RegisterRange};
use crate::profile::point::Point;
use crate::profile::scaling::Scaling;

/// Raw registers: `ADDRESS[+COUNT][:TYPE[/ORDER]][*FACTOR][=UNIT]`.
pub(super) fn registers(selector: &str, reading: Reading<'_>) -> Result<Vec<Point>, SelectError> {
    let malformed = |problem: String| SelectError::Malformed {
        selector: selector.to_owned(),
        problem,
    };
    let address = |problem| SelectError::Address {
        selector: selector.to_owned(),
        problem,
    };
    let (rest, unit) = split(selector, '=');
    let (rest, factor) = split(rest, '*');
    let (place, form) = split(rest, ':');
    let (start, count) = split(place, '+');
    let (start, implied) = first_register(start, reading.numbering).map_err(malformed)?;
    if let (Some(implied), Some(typed)) = (implied, reading.function)
        && implied != typed
    {
        return Err(SelectError::FunctionClash {
            selector: selector.to_owned(),
            implied: FunctionCode::from(implied).get(),
            typed: FunctionCode::from(typed).get(),
        });
    }
    let (kind, order) = form
        .map_or(Ok((RegisterType::U16, ByteOrder::Abcd)), type_and_order)
        .map_err(malformed)?;
    let scale = match factor {
        None => Decimal::ONE,
        Some(text) if kind.is_number() => Decimal::from_str_exact(text)
            .ok()
            .filter(|factor| !factor.is_zero())
            .ok_or_else(|| malformed(format!("'{text}' is no factor, such as 0.1")))?,
        Some(_) => return Err(malformed(format!("type {kind} takes no factor"))),
    };
    let width = kind.registers();
    let total = match count {
        None => width,
        Some(text) => number(text).ok_or_else(|| malformed(not_a_number(text)))?,
    };
    if total == 0 {
        return Err(malformed("0 registers are nothing to read".to_owned()));
    }
    if total % width != 0 {
        return Err(malformed(format!(
            "{total} registers are no whole number of {kind} values, {width} registers each"
        )));
    }
    if u32::from(start) + u32::from(total) > 0x1_0000 {
        return Err(address(AddressError::PastEnd {
            start,
            count: total,
        }));
    }
    let points: Vec<Point> = (0..total / width)
        .map(|index| {
            let range = RegisterRange::new(start + index * width, width).map_err(address)?;
            Ok(Point {
                scaling: Scaling::Times(scale),
                unit: unit.map(str::to_owned),
                function: implied.or(reading.function),
                ..Point::raw(range, kind, order)
            })
        })
        .collect::<Result<_, SelectError>>()?;
    match lonely(&points, reading) {
        Some(name) => Err(SelectError::Lonely {
            selector: selector.to_owned(),
            name: name.to_owned(),
        }),
        None => Ok(points),
    }
}

/// The point of the meter that must be read alone, or means something else then, and lies among
/// these when there are several.
fn lonely<'a>(points: &[Point], reading: Reading<'a>) -> Option<&'a str> {
    let [_, _, ..] = points else {
        return None;
    };
    let mut apart = reading.profile?.points.iter().filter(|point| point.alone);
    let is_among = |apart: &&Point| points.iter().any(|raw| apart.range.contains(raw.range));
    apart.find(is_among).map(|point| point.name.as_str())
}

/// The part before `mark`, and the part after it if there is one.
fn split(text: &str, mark: char) -> (&str, Option<&str>) {
    match text.split_once(mark) {
        Some((before, after)) => (before, Some(after)),
        None => (text, None),
    }
}

fn number(text: &str) -> Option<u16> {
    let hex = text.strip_prefix("0x").or_else(|| text.strip_prefix("0X"));
    let (digits, radix) = hex.map_or((text, 10), |hex| (hex, 16));
    // The conversion would take a sign.
    if digits.starts_with('+') {
        return None;
    }
    u16::from_str_radix(digits, radix).ok()
}

fn not_a_number(text: &str) -> String {
    format!("'{text}' is no number from 0 to 65535, or 0x0 to 0xFFFF")
}

/// The protocol address of the first register, and the function its numbering implies.
fn first_register(text: &str, numbering: Numbering) -> Result<(u16, Option<ReadFunction>), String> {
    if numbering == Numbering::Protocol || text.starts_with("0x") || text.starts_with("0X") {
        return number(text)
            .map(|address| (address, None))
            .ok_or_else(|| not_a_number(text));
    }
    let expected = || {
        format!(
            "'{text}' is no register in Modicon numbering: 30001 to 39999 or 300001 to 365536 \
             for input registers, 40001 to 49999 or 400001 to 465536 for holding registers"
        )
    };
    if text.len() != 5 && text.len() != 6 {
        return Err(expected());
    }
    let function = match text.as_bytes().first() {
        Some(b'3') => ReadFunction::InputRegisters,
        Some(b'4') => ReadFunction::HoldingRegisters,
        _ => return Err(expected()),
    };
    let register: Option<u32> = text.get(1..).and_then(|digits| digits.parse().ok());
    register
        .and_then(|register| u16::try_from(register.checked_sub(1)?).ok())
        .map(|address| (address, Some(function)))
        .ok_or_else(expected)
}

/// `TYPE`, `TYPE/ORDER`, `ascii/N` or `ascii/N/ORDER`.
fn type_and_order(text: &str) -> Result<(RegisterType, ByteOrder), String> {
    let whole = |text: &str| {
        text.parse::<RegisterType>()
            .map_err(|error| error.to_string())
    };
    match text.rsplit_once('/') {
        Some((kind, order)) if kind != "ascii" => {
            let order = order
                .parse::<ByteOrder>()
                .map_err(|error| error.to_string())?;
            Ok((whole(kind)?, order))
        }
        _ => Ok((whole(text)?, ByteOrder::Abcd)),
    }
}
