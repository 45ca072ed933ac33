//! What a meter does when it is told to, and what is dangerous.

use super::sheet::Sheet;
use super::terms;
use crate::output::columns::columns;
use crate::output::escape;
use crate::output::table::UNVERIFIED;
use crate::profile::writing::Action;
use crate::profile::{Operation, Point};

/// What a column has for an operation.
type Cell = fn(&Operation) -> String;

/// A line an operation; nothing where there is none. Columns that would be empty are left out.
pub(super) fn table(operations: &[Operation]) -> Option<String> {
    let all: [(&str, Cell); 5] = [
        ("OPERATION", name),
        ("BY", by),
        ("DATA", data),
        ("ONLY WITH", only_with),
        ("PAGE", |operation| operation.page.clone()),
    ];
    let mut header = Vec::new();
    let mut lines = vec![Vec::new(); operations.len()];
    for (name, cell) in all {
        let cells: Vec<String> = operations
            .iter()
            .map(|operation| escape(&cell(operation)))
            .collect();
        if cells.iter().any(|cell| !cell.is_empty()) {
            header.push(name);
            for (line, cell) in lines.iter_mut().zip(cells) {
                line.push(cell);
            }
        }
    }
    (!operations.is_empty()).then(|| columns(&header, &[], lines))
}

fn name(operation: &Operation) -> String {
    let mark = if operation.verified { "" } else { UNVERIFIED };
    format!("{}{mark}", operation.name)
}

fn data(operation: &Operation) -> String {
    let data = operation.data();
    data.map_or_else(String::new, |data| data.kind.to_string())
}

fn only_with(operation: &Operation) -> String {
    let with = operation.only_with.as_ref();
    with.map_or_else(String::new, terms::setup)
}

/// How the meter is told: `14`, or `0x0A00=65535`.
fn by(operation: &Operation) -> String {
    match &operation.action {
        Action::Number { number, .. } => number.to_string(),
        Action::Register { address, value } => format!("{address}={value}"),
    }
}

/// What operations do that nobody wants by accident.
pub(super) fn hazards(operations: &[Operation]) -> Option<String> {
    grouped(operations.iter().filter_map(|operation| {
        let hazard = operation.hazard.as_deref()?;
        Some((operation.name.as_str(), hazard))
    }))
}

/// What writing points does that nobody wants by accident.
pub(super) fn hazards_of_points(points: &[Point]) -> Option<String> {
    grouped(points.iter().filter_map(|point| {
        let hazard = point.writing().hazard.as_deref()?;
        Some((point.name.as_str(), hazard))
    }))
}

/// Each hazard once, with all that have it.
fn grouped<'a>(all: impl Iterator<Item = (&'a str, &'a str)>) -> Option<String> {
    let mut groups: Vec<(&str, Vec<&str>)> = Vec::new();
    for (name, hazard) in all {
        match groups.iter_mut().find(|(known, _)| *known == hazard) {
            Some((_, names)) => names.push(name),
            None => groups.push((hazard, vec![name])),
        }
    }
    let lines = groups
        .iter()
        .map(|(hazard, names)| format!("{hazard}: {}", names.join(", ")));
    let mut sheet = Sheet::default();
    sheet.lines("hazards", lines);
    (!groups.is_empty()).then(|| sheet.to_string())
}
