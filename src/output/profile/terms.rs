//! The words for what a point is.

use std::collections::VecDeque;

use crate::codec::FunctionCode;
use crate::profile::point::{Access, Labels, Marker, NoValue, OnlyWith};
use crate::profile::value::Missing;
use crate::profile::writing::Broadcasting;
use crate::profile::{Point, Profile};

/// What its raw number is multiplied with or where it lies; nothing for what is no number.
pub(super) fn scale(point: &Point) -> Option<String> {
    point.kind.is_number().then(|| point.scaling.to_string())
}

/// The order of its bytes, where that is not the standard's own.
pub(super) fn unusual_order(point: &Point) -> Option<String> {
    (point.order != <_>::default()).then(|| point.order.to_string())
}

/// What can be done with it, as in a profile's file.
pub(super) const fn access(point: &Point) -> &'static str {
    match point.access {
        Access::Read => "read",
        Access::Write => "write",
        Access::ReadWrite => "read-write",
    }
}

/// A raw number as it is written in manuals: in hex where it is not the number that counts.
pub(super) fn raw(point: &Point, number: impl Into<i128>) -> String {
    let number = number.into();
    if point.kind.is_integer() {
        number.to_string()
    } else {
        format!("0x{number:04X}")
    }
}

/// The longest list of numbers that stands in a table.
const LONGEST_LIST: usize = 16;

/// The raw numbers that may be written: `0..12000 by 5`, `1..200, 65535`, `8, 32`, of many numbers
/// that they are some; nothing where that is whatever the type holds.
pub(super) fn taken(point: &Point) -> Option<String> {
    let writing = point.writing();
    let listed = |numbers: &[i64]| {
        let numbers = numbers.iter().map(|number| raw(point, *number));
        numbers.collect::<Vec<_>>().join(", ")
    };
    if let Some((lowest, highest)) = writing
        .allowed
        .iter()
        .min()
        .zip(writing.allowed.iter().max())
    {
        let list = listed(&writing.allowed);
        if list.len() <= LONGEST_LIST {
            return Some(list);
        }
        let [low, high] = [lowest, highest].map(|number| raw(point, *number));
        return Some(format!("some of {low}..{high}"));
    }
    let range = point.limits.map(|(lowest, highest)| {
        let [low, high] = [lowest, highest].map(|number| raw(point, number));
        if low == high {
            low
        } else {
            format!("{low}..{high}")
        }
    });
    let step = (writing.step > 1).then(|| format!("by {}", writing.step));
    let steps: Vec<String> = range.into_iter().chain(step).collect();
    let also = (!writing.also.is_empty()).then(|| listed(&writing.also));
    let parts: Vec<String> = Some(steps.join(" "))
        .filter(|steps| !steps.is_empty())
        .into_iter()
        .chain(also)
        .collect();
    (!parts.is_empty()).then(|| parts.join(", "))
}

/// The one function it is written with, where it has its own.
pub(super) fn write_function(point: &Point) -> Option<u8> {
    let function = point.writing().function?;
    Some(FunctionCode::from(function).get())
}

/// What is said of broadcasting it, as in a profile's file.
pub(super) const fn broadcast(broadcasting: Broadcasting) -> Option<&'static str> {
    match broadcasting {
        Broadcasting::Unmarked => None,
        Broadcasting::Allowed => Some("allowed"),
        Broadcasting::Only => Some("only"),
    }
}

/// Names by their codes or bits.
pub(super) fn labels(point: &Point) -> Vec<(String, &str)> {
    let (Labels::Bits(names) | Labels::Codes(names)) = &point.labels else {
        return Vec::new();
    };
    let names = names.iter();
    names
        .map(|(number, name)| (raw(point, *number), name.as_str()))
        .collect()
}

/// The marker that stands for no value: `raw 65535`, `high word 0x7FFF`.
pub(super) fn marker(point: &Point, no_value: &NoValue) -> String {
    match no_value.marker {
        Marker::HighWord(word) => format!("high word 0x{word:04X}"),
        Marker::Raw(number) => format!("raw {}", raw(point, number)),
    }
}

/// What a marker means.
pub(super) const fn meaning(no_value: &NoValue) -> &'static str {
    match no_value.missing {
        Missing::Overflow => "overflow",
        Missing::Absent => "absent",
        Missing::Mismatch => "mismatch",
    }
}

/// What a point means something with: `wiring = 0, 3`, or a point that has a value.
pub(super) fn setup(with: &OnlyWith) -> String {
    let Some(codes) = &with.codes else {
        return with.point.clone();
    };
    let codes: Vec<String> = codes.iter().map(u16::to_string).collect();
    format!("{} = {}", with.point, codes.join(", "))
}

/// The one function it is read with, where it has its own.
pub(super) fn function(point: &Point) -> Option<u8> {
    let function = point.function?;
    Some(FunctionCode::from(function).get())
}

/// The factors that the scales of points follow from, each before those it needs itself.
pub(super) fn formulas(profile: &Profile, points: &[Point]) -> Vec<String> {
    let mut names: Vec<&str> = Vec::new();
    let mut formulas = Vec::new();
    let mut next: VecDeque<&str> = points
        .iter()
        .flat_map(|point| point.scaling.names())
        .collect();
    while let Some(name) = next.pop_front() {
        let factor = profile.factors.iter().find(|factor| factor.name == name);
        if let Some(factor) = factor.filter(|_| !names.contains(&name)) {
            names.push(name);
            formulas.push(factor.to_string());
            next.extend(factor.names());
        }
    }
    formulas
}
