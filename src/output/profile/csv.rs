//! Points as CSV.

use std::io;

use super::terms;
use crate::output::csv::records;
use crate::output::escape;
use crate::profile::Point;

const HEADER: [&str; 27] = [
    "name",
    "address",
    "registers",
    "type",
    "order",
    "scale",
    "unit",
    "lowest",
    "highest",
    "access",
    "function",
    "alone",
    "no_value",
    "only_with",
    "verified",
    "page",
    "about",
    "labels",
    "step",
    "allowed",
    "also",
    "hazard",
    "momentary",
    "write_function",
    "broadcast",
    "writable_with",
    "shown_by",
];

/// The header and a row a point.
pub(super) fn csv(points: &[Point], terminal: bool) -> io::Result<Vec<u8>> {
    let rows = points.iter().map(|point| {
        let cells = row(point);
        let shown = cells.map(|cell| if terminal { escape(&cell) } else { cell });
        shown.to_vec()
    });
    records(&HEADER, rows)
}

fn row(point: &Point) -> [String; 27] {
    let text = |text: Option<&String>| text.cloned().unwrap_or_default();
    let number =
        |number: Option<i128>| number.map_or_else(String::new, |number| number.to_string());
    let yes = |is: bool| if is { "yes" } else { "no" }.to_owned();
    let numbers = |numbers: &[i64]| {
        let numbers = numbers.iter().map(i64::to_string);
        numbers.collect::<Vec<_>>().join("; ")
    };
    let writing = point.writing();
    let no_value = point.no_value.as_ref().map(|no_value| {
        let marker = terms::marker(point, no_value);
        format!("{marker} means {}", terms::meaning(no_value))
    });
    let labels: Vec<String> = terms::labels(point)
        .into_iter()
        .map(|(number, name)| format!("{number}={name}"))
        .collect();
    [
        point.name.clone(),
        point.range.start().to_string(),
        point.range.count().to_string(),
        point.kind.to_string(),
        point.order.to_string(),
        terms::scale(point).unwrap_or_default(),
        text(point.unit.as_ref()),
        number(point.limits.map(|(lowest, _)| lowest)),
        number(point.limits.map(|(_, highest)| highest)),
        terms::access(point).to_owned(),
        number(terms::function(point).map(i128::from)),
        yes(point.alone),
        no_value.unwrap_or_default(),
        point
            .only_with
            .as_ref()
            .map(terms::setup)
            .unwrap_or_default(),
        yes(point.verified),
        point.page.clone(),
        point.about.clone(),
        labels.join("; "),
        number(Some(writing.step.into()).filter(|step| *step > 1)),
        numbers(&writing.allowed),
        numbers(&writing.also),
        text(writing.hazard.as_ref()),
        yes(writing.momentary),
        number(terms::write_function(point).map(i128::from)),
        terms::broadcast(writing.broadcast)
            .unwrap_or_default()
            .to_owned(),
        writing
            .only_with
            .as_ref()
            .map(terms::setup)
            .unwrap_or_default(),
        text(writing.shown_by.as_ref()),
    ]
}
