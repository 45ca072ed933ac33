//! One point, with all there is to say about it.

use std::slice;

use rust_decimal::Decimal;

use super::sheet::Sheet;
use super::terms;
use crate::codec::value::ByteOrder;
use crate::output::escape;
use crate::profile::writing::Broadcasting;
use crate::profile::{Point, Profile};

/// Name, meaning, and a line for everything else that there is.
pub(super) fn card(profile: &Profile, point: &Point) -> String {
    let mut sheet = Sheet::default();
    sheet.text("registers", &registers(profile, point));
    let order = match point.order {
        ByteOrder::Abcd => "",
        ByteOrder::Cdab => ", order CDAB: low word first",
        ByteOrder::Badc => ", order BADC: low byte first",
        ByteOrder::Dcba => ", order DCBA: low word and low byte first",
    };
    sheet.text("type", &format!("{}{order}", point.kind));
    if let Some(scale) = terms::scale(point) {
        sheet.text("scale", &scale);
    }
    sheet.lines("", terms::formulas(profile, slice::from_ref(point)));
    if let Some(unit) = &point.unit {
        sheet.text("unit", unit);
    }
    sheet.text("access", terms::access(point));
    if let Some(limits) = point.limits {
        sheet.text("range", &range(point, limits));
    }
    writing(&mut sheet, point);
    let labels = terms::labels(point).into_iter();
    sheet.lines(
        "labels",
        labels.map(|(number, name)| format!("{number} = {name}")),
    );
    if let Some(no_value) = &point.no_value {
        let marker = terms::marker(point, no_value);
        sheet.text(
            "no value",
            &format!("{marker} means {}", terms::meaning(no_value)),
        );
    }
    if let Some(with) = &point.only_with {
        sheet.text("only with", &terms::setup(with));
    }
    if point.verified {
        sheet.text("verified", "yes");
    } else {
        sheet.text(
            "verified",
            "no: address or scale was not read in the maker's manual",
        );
    }
    if !point.page.is_empty() {
        sheet.text("page", &format!("{} of {}", point.page, profile.manual));
    }
    let about = match point.about.as_str() {
        "" => String::new(),
        about => format!(": {}", escape(about)),
    };
    format!("{}{about}\n\n{sheet}", point.name)
}

/// What is to be known before it is written.
fn writing(sheet: &mut Sheet, point: &Point) {
    let writing = point.writing();
    let listed = |numbers: &[i64]| {
        let numbers = numbers.iter().map(|number| terms::raw(point, *number));
        numbers.collect::<Vec<String>>()
    };
    if writing.step > 1 {
        sheet.text("step", &format!("{} raw", writing.step));
    }
    if !writing.allowed.is_empty() {
        sheet.list("allowed", listed(&writing.allowed));
    }
    if !writing.also.is_empty() {
        sheet.list("also", listed(&writing.also));
    }
    if let Some(hazard) = &writing.hazard {
        sheet.text("hazard", hazard);
    }
    if writing.momentary {
        sheet.text(
            "momentary",
            "does something when it is written, keeps nothing",
        );
    }
    if let Some(code) = terms::write_function(point) {
        sheet.text("written", &format!("with function {code:02}"));
    }
    match writing.broadcast {
        Broadcasting::Unmarked => {}
        Broadcasting::Allowed => sheet.text("broadcast", "allowed"),
        Broadcasting::Only => sheet.text("broadcast", "only, and to no meter by itself"),
    }
    if let Some(with) = &writing.only_with {
        sheet.text("writable", &format!("with {}", terms::setup(with)));
    }
    if let Some(shown_by) = &writing.shown_by {
        sheet.text("shown by", shown_by);
    }
}

/// Where it lies, and the request that reads it.
fn registers(profile: &Profile, point: &Point) -> String {
    let mut text = point.range.to_string();
    if let Some(code) = terms::function(point) {
        text = format!("{text}, read with function {code:02}");
    }
    if point.alone {
        text.push_str(", read by a request of its own");
    }
    let others = profile
        .points
        .iter()
        .filter(|other| other.name != point.name && other.range.overlaps(point.range));
    for other in others {
        text = format!("{text}; {} lies there as well", other.name);
    }
    text
}

/// What may be written, raw and in the unit.
fn range(point: &Point, (lowest, highest): (i128, i128)) -> String {
    let [low, high] = [lowest, highest].map(|number| terms::raw(point, number));
    if low == high {
        return format!("{low} only");
    }
    let raw = format!("{low} to {high}");
    let scaled = |raw: i128| {
        let scale = point
            .constant_scale()
            .filter(|scale| *scale != Decimal::ONE)?;
        Decimal::try_from_i128_with_scale(raw, 0)
            .ok()?
            .checked_mul(scale)
    };
    match (scaled(lowest), scaled(highest)) {
        (Some(low), Some(high)) => {
            let unit = point.unit.as_deref().unwrap_or_default();
            format!("{raw} raw, {low} to {high} {unit}")
        }
        _ => raw,
    }
}
