//! Points in a table.

use super::legend::Legend;
use super::sheet::Sheet;
use super::terms;
use crate::output::columns::columns;
use crate::output::escape;
use crate::output::table::{FOOTNOTE, UNVERIFIED};
use crate::profile::point::Access;
use crate::profile::scaling::Scaling;
use crate::profile::{Point, Profile};

/// What a column has for a point.
type Cell<'a> = &'a dyn Fn(&Point) -> String;

/// What is only read in a table of its own, which is narrow enough for most terminals: bounds and
/// most labels are those of the others.
pub(super) fn tables(points: &[Point], legend: &Legend<'_>) -> Vec<String> {
    let is_read = |point: &&Point| point.access == Access::Read;
    let (read, written): (Vec<&Point>, Vec<&Point>) = points.iter().partition(is_read);
    [read, written]
        .iter()
        .filter(|points| !points.is_empty())
        .map(|points| table(points.iter().copied(), legend))
        .collect()
}

/// A line a point. Columns that would be empty are left out.
pub(super) fn table<'a>(
    points: impl IntoIterator<Item = &'a Point>,
    legend: &Legend<'_>,
) -> String {
    let points: Vec<&Point> = points.into_iter().collect();
    let all: [(&str, Cell<'_>); 9] = [
        ("ADDRESS", &registers),
        ("NAME", &name),
        ("TYPE", &kind),
        ("SCALE", &scale),
        ("UNIT", &unit),
        ("FUNCTION", &function),
        ("ACCESS", &access),
        ("PAGE", &page),
        ("LABELS", &|point| legend.cell(point)),
    ];
    let mut header = Vec::new();
    let mut lines = vec![Vec::new(); points.len()];
    for (name, cell) in all {
        let cells: Vec<String> = points.iter().map(|point| escape(&cell(point))).collect();
        if cells.iter().any(|cell| !cell.is_empty()) {
            header.push(name);
            lines
                .iter_mut()
                .zip(cells)
                .for_each(|(line, cell)| line.push(cell));
        }
    }
    columns(&header, &[], lines)
}

/// `0x0240`, or `0x0240+2` where it takes two registers: as they are typed to be read.
fn registers(point: &Point) -> String {
    match point.range.count() {
        1 => point.range.start().to_string(),
        _ => point.range.to_string(),
    }
}

fn name(point: &Point) -> String {
    let mark = if point.verified { "" } else { UNVERIFIED };
    format!("{}{mark}", point.name)
}

fn kind(point: &Point) -> String {
    let order = terms::unusual_order(point);
    let order = order.map(|order| format!(" {order}"));
    format!("{}{}", point.kind, order.unwrap_or_default())
}

/// Of more than one factor only that there are: they stand below.
fn scale(point: &Point) -> String {
    match point.scaling {
        Scaling::TimesByRaw(_) => "by raw".to_owned(),
        _ => terms::scale(point).unwrap_or_default(),
    }
}

fn unit(point: &Point) -> String {
    point.unit.clone().unwrap_or_default()
}

fn function(point: &Point) -> String {
    let code = terms::function(point);
    code.map_or_else(String::new, |code| format!("{code:02}"))
}

/// What can be done with it, and the raw numbers that may be written; nothing for what is only
/// read, as most points are.
fn access(point: &Point) -> String {
    let access = match point.access {
        Access::Read => return String::new(),
        Access::Write => "w",
        Access::ReadWrite => "rw",
    };
    match terms::taken(point) {
        Some(taken) => format!("{access} {taken}"),
        None => access.to_owned(),
    }
}

fn page(point: &Point) -> String {
    point.page.clone()
}

/// The scales that go by the raw number.
pub(super) fn scales(points: &[Point]) -> Option<String> {
    let mut sheet = Sheet::default();
    let long = points
        .iter()
        .filter(|point| matches!(point.scaling, Scaling::TimesByRaw(_)));
    for point in long.clone() {
        sheet.text(&point.name, &point.scaling.to_string());
    }
    (long.count() > 0).then(|| sheet.to_string())
}

/// The factors that scales in the table name.
pub(super) fn formulas(profile: &Profile, points: &[Point]) -> Option<String> {
    let formulas = terms::formulas(profile, points);
    (!formulas.is_empty()).then(|| formulas.join("\n") + "\n")
}

/// What the mark behind some names means, where a point has it or something else has.
pub(super) fn footnote(points: &[Point], is_marked: bool) -> Option<String> {
    let is_marked = is_marked || points.iter().any(|point| !point.verified);
    is_marked.then(|| format!("{FOOTNOTE}\n"))
}
