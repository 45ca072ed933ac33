//! Values of options: durations with a unit, lists of units, speeds.

use std::str::FromStr;
use std::time::Duration;

/// A duration with its unit: `500ms`, `2s`, `15m`.
pub(super) fn duration(text: &str) -> Result<Duration, String> {
    humantime::parse_duration(text).map_err(|error| {
        if text.parse::<f64>().is_ok() {
            format!("a time needs its unit, such as {text}s or {text}ms")
        } else {
            format!("{error}; a time is a number and its unit, such as 500ms, 2s or 15m")
        }
    })
}

/// A speed in bits a second.
pub(super) fn baud(text: &str) -> Result<u32, String> {
    match text.parse() {
        Ok(baud) if baud > 0 => Ok(baud),
        _ => Err("a speed is a whole number of bits a second, such as 9600".to_owned()),
    }
}

/// Unit numbers as typed: `17`, `1,2,5-9`. Which of them a meter can have is checked later.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Units(pub Vec<u16>);

impl FromStr for Units {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut units = Vec::new();
        for part in text.split(',') {
            let (first, last) = part.split_once('-').unwrap_or((part, part));
            let (first, last) = (number(first)?, number(last)?);
            if first > last {
                return Err(format!("{part} runs backwards"));
            }
            units.extend(
                (first..=last)
                    .filter(|unit| !units.contains(unit))
                    .collect::<Vec<_>>(),
            );
        }
        Ok(Self(units))
    }
}

fn number(text: &str) -> Result<u16, String> {
    let number = match text.strip_prefix("0x") {
        Some(hex) => u8::from_str_radix(hex, 16).ok(),
        None => text.parse().ok(),
    };
    number.map(u16::from).ok_or_else(|| {
        format!("'{text}' is no unit: a number from 1 to 247, or a list such as 1,2,5-9")
    })
}
