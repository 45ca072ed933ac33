//! A point as a JSON object.

use rust_decimal::Decimal;
use serde::{Serialize, Serializer};

use super::{CodesObject, OperandValue, codes, operand};
use crate::output::json::Exact;
use crate::output::profile::terms;
use crate::profile::Point;
use crate::profile::point::{Marker, NoValue};
use crate::profile::scaling::{Band, Scaling};

/// Names by their numbers, in the order of these.
pub(super) struct Labels<'a>(pub(super) Vec<(String, &'a str)>);

impl Serialize for Labels<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(number, name)| (number, name)))
    }
}

/// Every key is always there; `null` where a point has nothing of the kind.
#[derive(Serialize)]
pub(super) struct PointObject<'a> {
    name: &'a str,
    address: u16,
    registers: u16,
    #[serde(rename = "type")]
    kind: String,
    order: String,
    scale: Option<ScaleValue<'a>>,
    span: Option<SpanObject>,
    unit: Option<&'a str>,
    about: Option<&'a str>,
    access: &'static str,
    range: Option<[Exact<i128>; 2]>,
    labels: Option<Labels<'a>>,
    no_value: Option<MarkerObject>,
    only_with: Option<CodesObject<'a>>,
    alone: bool,
    function: Option<u8>,
    hazard: Option<&'a str>,
    momentary: bool,
    step: Option<u16>,
    allowed: Option<&'a [i64]>,
    also: Option<&'a [i64]>,
    write_function: Option<u8>,
    broadcast: Option<&'static str>,
    writable_with: Option<CodesObject<'a>>,
    shown_by: Option<&'a str>,
    verified: bool,
    page: Option<&'a str>,
}

#[derive(Serialize)]
#[serde(untagged)]
enum ScaleValue<'a> {
    Number(Exact<Decimal>),
    Factor(&'a str),
    Bands(Vec<BandObject>),
}

#[derive(Serialize)]
struct BandObject {
    raw: [Exact<i128>; 2],
    factor: Exact<Decimal>,
}

#[derive(Serialize)]
struct SpanObject {
    full: u16,
    low: OperandValue,
    high: OperandValue,
}

/// One of the two markers, and what it means.
#[derive(Serialize)]
struct MarkerObject {
    #[serde(skip_serializing_if = "Option::is_none")]
    high_word: Option<u16>,
    #[serde(skip_serializing_if = "Option::is_none")]
    raw: Option<Exact<i128>>,
    means: &'static str,
}

pub(super) fn point(point: &Point) -> PointObject<'_> {
    let labels = terms::labels(point);
    let (scale, span) = scaling(point);
    let writing = point.writing();
    PointObject {
        name: &point.name,
        address: point.range.start().get(),
        registers: point.range.count(),
        kind: point.kind.to_string(),
        order: point.order.to_string(),
        scale,
        span,
        unit: point.unit.as_deref(),
        about: filled(&point.about),
        access: terms::access(point),
        range: point.limits.map(|(low, high)| [low, high].map(Exact)),
        labels: (!labels.is_empty()).then_some(Labels(labels)),
        no_value: point.no_value.as_ref().map(marker),
        only_with: point.only_with.as_ref().map(codes),
        alone: point.alone,
        function: terms::function(point),
        hazard: writing.hazard.as_deref(),
        momentary: writing.momentary,
        step: Some(writing.step).filter(|step| *step > 1),
        allowed: Some(writing.allowed.as_slice()).filter(|numbers| !numbers.is_empty()),
        also: Some(writing.also.as_slice()).filter(|numbers| !numbers.is_empty()),
        write_function: terms::write_function(point),
        broadcast: terms::broadcast(writing.broadcast),
        writable_with: writing.only_with.as_ref().map(codes),
        shown_by: writing.shown_by.as_deref(),
        verified: point.verified,
        page: filled(&point.page),
    }
}

fn marker(no_value: &NoValue) -> MarkerObject {
    let (high_word, raw) = match no_value.marker {
        Marker::HighWord(word) => (Some(word), None),
        Marker::Raw(number) => (None, Some(Exact(number))),
    };
    MarkerObject {
        high_word,
        raw,
        means: terms::meaning(no_value),
    }
}

/// What is not empty.
pub(super) fn filled(text: &str) -> Option<&str> {
    Some(text).filter(|text| !text.is_empty())
}

/// The keys `scale` and `span`, of which a number has one.
fn scaling(point: &Point) -> (Option<ScaleValue<'_>>, Option<SpanObject>) {
    if !point.kind.is_number() {
        return (None, None);
    }
    let scale = match &point.scaling {
        Scaling::Times(number) => ScaleValue::Number(Exact(*number)),
        Scaling::TimesFactor(name) => ScaleValue::Factor(name),
        Scaling::TimesByRaw(bands) => ScaleValue::Bands(bands.iter().map(band).collect()),
        Scaling::Span { full, low, high } => {
            let span = SpanObject {
                full: *full,
                low: operand(low),
                high: operand(high),
            };
            return (None, Some(span));
        }
    };
    (Some(scale), None)
}

fn band(band: &Band) -> BandObject {
    BandObject {
        raw: [band.lowest, band.highest].map(Exact),
        factor: Exact(band.factor),
    }
}
