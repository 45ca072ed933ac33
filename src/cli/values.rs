//! Values of options: durations with a unit, lists of units, speeds.

use std::path::PathBuf;
use std::str::FromStr;
use std::time::Duration;

/// The longest time an option takes.
const LONGEST: Duration = Duration::from_secs(24 * 60 * 60);

/// A duration with its unit: `500ms`, `2s`, `15m`; at most a day.
pub(super) fn duration(text: &str) -> Result<Duration, String> {
    match humantime::parse_duration(text) {
        Ok(time) if time > LONGEST => Err("the longest time is 24h".to_owned()),
        Ok(time) => Ok(time),
        Err(_) if text.parse::<f64>().is_ok() => Err(format!(
            "a time needs its unit, such as {text}s or {text}ms"
        )),
        Err(error) => Err(format!(
            "{error}; a time is a number and its unit, such as 500ms, 2s or 15m"
        )),
    }
}

/// From one read to the next.
pub(super) fn interval(text: &str) -> Result<Duration, String> {
    match duration(text)? {
        time if time < Duration::from_millis(10) => Err("the shortest interval is 10ms".to_owned()),
        time => Ok(time),
    }
}

/// A duration above zero.
pub(super) fn timeout(text: &str) -> Result<Duration, String> {
    match duration(text)? {
        Duration::ZERO => Err("no meter answers in no time".to_owned()),
        time => Ok(time),
    }
}

/// A speed in bits a second; the slowest in use is 50.
pub(super) fn baud(text: &str) -> Result<u32, String> {
    match text.parse() {
        Ok(baud) if baud >= 50 => Ok(baud),
        _ => Err("a speed is a whole number of bits a second from 50, such as 9600".to_owned()),
    }
}

/// A file to append to.
pub(super) fn file(text: &str) -> Result<PathBuf, String> {
    match text {
        "" => Err("a file has a name".to_owned()),
        "-" => Err("rows go to stdout without it; a file of that name is ./-".to_owned()),
        name => Ok(name.into()),
    }
}

/// Unit numbers as typed: `17`, `1,2,5-9`. Which of them a meter can have is checked later.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Units(pub Vec<u16>);

impl FromStr for Units {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut units = Vec::new();
        for unit in numbers(text)? {
            if !units.contains(&unit) {
                units.push(unit);
            }
        }
        Ok(Self(units))
    }
}

/// All numbers as typed, those that are there again as well.
fn numbers(text: &str) -> Result<Vec<u16>, String> {
    let mut numbers = Vec::new();
    for part in text.split(',') {
        let (first, last) = part.split_once('-').unwrap_or((part, part));
        let (first, last) = (number(first)?, number(last)?);
        if first > last {
            return Err(format!("{part} runs backwards"));
        }
        numbers.extend(first..=last);
    }
    Ok(numbers)
}

fn number(text: &str) -> Result<u16, String> {
    let text = text.trim();
    let hex = text.strip_prefix("0x").or_else(|| text.strip_prefix("0X"));
    let (digits, radix) = hex.map_or((text, 10), |hex| (hex, 16));
    match u8::from_str_radix(digits, radix) {
        // The conversion would take a sign.
        Ok(number) if !digits.starts_with('+') => Ok(number.into()),
        _ => Err(format!(
            "'{text}' is no unit: a number from 1 to 255, or a list such as 1,2,5-9"
        )),
    }
}

/// A meter to simulate and its units: `pqm`, `pqm=17,18`, `./mine.toml=1`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MeterUnits {
    /// A name or a profile file.
    pub meter: String,
    /// The units, when any were given; one that was given twice is there twice.
    pub units: Option<Vec<u16>>,
}

impl FromStr for MeterUnits {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let whole = || Self {
            meter: text.to_owned(),
            units: None,
        };
        let Some((meter, units)) = text.rsplit_once('=') else {
            return Ok(whole());
        };
        match numbers(units) {
            // A file may have any name.
            Err(_) if units.contains(std::path::is_separator) => Ok(whole()),
            Err(_) if has_ending(units) => Ok(whole()),
            Err(problem) => Err(problem),
            Ok(units) if units.contains(&0) => {
                Err("unit 0 is the broadcast address, which no meter answers".to_owned())
            }
            Ok(units) => Ok(Self {
                meter: meter.to_owned(),
                units: Some(units),
            }),
        }
    }
}

fn has_ending(name: &str) -> bool {
    std::path::Path::new(name)
        .extension()
        .is_some_and(|ending| ending == "toml")
}
