//! What went wrong while points of a unit were read, in words.

use crate::codec::{RegisterAddress, Unit};
use crate::profile::Point;
use crate::readings::Trouble;

/// Of a long list so many are named.
const NAMED: usize = 3;

/// Where, what and how often something was tried.
pub(super) struct Place<'a> {
    /// The meter, where it takes its name to tell which one it is; else empty.
    pub(super) meter: &'a str,
    /// `sim: at 9600 8N1`.
    pub(super) line: &'a str,
    /// The unit.
    pub(super) unit: Unit,
    /// What was asked for.
    pub(super) points: &'a [Point],
    /// How often a read is tried.
    pub(super) attempts: u32,
}

impl Place<'_> {
    /// Whether these points have names of their own: those of registers are their addresses.
    pub(super) fn are_named(&self, points: &[usize]) -> bool {
        let mut points = points.iter().filter_map(|index| self.points.get(*index));
        points.all(is_named)
    }
}

fn is_named(point: &Point) -> bool {
    point.name != point.range.start().to_string()
}

/// One line about it.
pub(super) fn text(place: &Place<'_>, trouble: &Trouble) -> String {
    let mut at = format!("unit {} on {}", place.unit, place.line);
    if !place.meter.is_empty() {
        at = format!("{}, {at}", place.meter);
    }
    match trouble {
        Trouble::Unread {
            read,
            failure,
            untried,
            ..
        } => {
            let points = read
                .points
                .iter()
                .filter_map(|index| place.points.get(*index));
            let points: Vec<&Point> = points.collect();
            let what = if points.len() > NAMED {
                format!("registers {}", read.range)
            } else {
                names_and_registers(&points)
            };
            let mut text = format!("{at}, {what}: {failure}");
            if place.attempts > 1 && failure.is_worth_a_retry() {
                text = format!("{text}, {} attempts", place.attempts);
            }
            match untried {
                0 => text,
                1 => text + "; 1 more read of this unit was not tried",
                _ => format!("{text}; {untried} more reads of this unit were not tried"),
            }
        }
        Trouble::Refused { points, code } => {
            let points = points.iter().filter_map(|index| place.points.get(*index));
            let what = names_and_registers(&points.collect::<Vec<_>>());
            format!("{at}, {what}: the meter refused: {code}")
        }
        Trouble::NoSetting { point, registers } => {
            let words = words(registers);
            format!(
                "{at}, {point}: registers {words} hold no such value; what depends on it is missing"
            )
        }
        Trouble::NoScale { point, factor } => {
            format!("{at}, {point}: there is no {factor} to scale it by with this setup")
        }
        Trouble::Impossible {
            point,
            expected,
            registers,
        } => {
            let words = words(registers);
            format!("{at}, {point}: registers {words} hold no {expected}")
        }
    }
}

fn words(registers: &[u16]) -> String {
    let words: Vec<String> = registers.iter().map(|word| format!("{word:04X}")).collect();
    words.join(" ")
}

/// `current_a, current_b (registers 0x0240+1, 0x0250+1)`; registers by address have no other name.
fn names_and_registers(points: &[&Point]) -> String {
    let registers = format!("registers {}", short(&stretches(points)));
    let names: Vec<String> = points
        .iter()
        .filter(|point| is_named(point))
        .map(|point| point.name.clone())
        .collect();
    if names.is_empty() {
        return registers;
    }
    format!("{} ({registers})", short(&names))
}

/// The registers of points, as few stretches as they make.
fn stretches(points: &[&Point]) -> Vec<String> {
    let mut ranges: Vec<_> = points.iter().map(|point| point.range).collect();
    ranges.sort_unstable();
    let mut stretches: Vec<(RegisterAddress, u32)> = Vec::new();
    for range in ranges {
        match stretches.last_mut() {
            Some((_, end)) if u32::from(range.start().get()) <= *end => {
                *end = range.end().max(*end);
            }
            _ => stretches.push((range.start(), range.end())),
        }
    }
    let shown = stretches
        .into_iter()
        .map(|(start, end)| format!("{start}+{}", end - u32::from(start.get())));
    shown.collect()
}

/// The first few of a list.
fn short(list: &[String]) -> String {
    let shown = list.get(..NAMED).unwrap_or(list).join(", ");
    match list.len().saturating_sub(NAMED) {
        0 => shown,
        more => format!("{shown} and {more} more"),
    }
}
