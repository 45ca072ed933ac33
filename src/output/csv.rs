//! CSV (RFC 4180, LF line ends): wide, a row a meter; and long, a row a reading.
//!
//! A row is always one line: control characters of a text are shown as in `\n`.

use std::io;

use csv::{Terminator, Writer, WriterBuilder};

use super::{LineFormat, escape, status, time};
use crate::append::Start;
use crate::profile::{Point, Value};
use crate::readings::Row;

/// How the header of wide CSV names points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Names {
    /// By their names: `energy_import`.
    #[default]
    Bare,
    /// With their units: `energy_import [kWh]`.
    WithUnits,
}

/// The columns every wide row begins with.
pub const WIDE_COLUMNS: [&str; 4] = ["time", "meter", "unit_id", "status"];

/// The columns of every long row.
const LONG_COLUMNS: [&str; 7] = [
    "time", "meter", "unit_id", "point", "value", "unit", "status",
];

/// `time,meter,unit_id,status,<point>,...`: empty cells for what is missing.
#[derive(Debug, Clone, Copy, Default)]
pub struct WideCsv(pub Names);

impl LineFormat for WideCsv {
    fn start(&self, points: &[Point]) -> io::Result<Start> {
        let names = points.iter().map(|point| match &point.unit {
            Some(unit) if self.0 == Names::WithUnits => format!("{} [{unit}]", point.name),
            _ => point.name.clone(),
        });
        header(WIDE_COLUMNS.map(str::to_owned).into_iter().chain(names))
    }

    fn lines(&self, _: &[Point], row: &Row) -> io::Result<Vec<u8>> {
        let cells = row.readings.iter();
        let cells = cells.map(|reading| cell(reading.as_ref().ok()));
        let fixed = [
            time(row),
            row.meter.clone(),
            row.unit.to_string(),
            status(row.worst()),
        ];
        let mut lines = lines();
        lines.write_record(shown(fixed.into_iter().chain(cells)))?;
        bytes(lines)
    }
}

/// `time,meter,unit_id,point,value,unit,status`.
#[derive(Debug, Clone, Copy, Default)]
pub struct LongCsv;

impl LineFormat for LongCsv {
    fn start(&self, _: &[Point]) -> io::Result<Start> {
        header(LONG_COLUMNS.map(str::to_owned))
    }

    fn lines(&self, points: &[Point], row: &Row) -> io::Result<Vec<u8>> {
        let mut lines = lines();
        for (point, reading) in points.iter().zip(&row.readings) {
            lines.write_record(shown([
                time(row),
                row.meter.clone(),
                row.unit.to_string(),
                point.name.clone(),
                cell(reading.as_ref().ok()),
                point.unit.clone().unwrap_or_default(),
                status(reading.as_ref().err().copied()),
            ]))?;
        }
        bytes(lines)
    }
}

/// A header and rows of as many cells.
pub(super) fn records(
    header: &[&str],
    rows: impl IntoIterator<Item = Vec<String>>,
) -> io::Result<Vec<u8>> {
    let mut lines = lines();
    lines.write_record(header)?;
    for row in rows {
        lines.write_record(row)?;
    }
    bytes(lines)
}

fn lines() -> Writer<Vec<u8>> {
    WriterBuilder::new()
        .terminator(Terminator::Any(b'\n'))
        .from_writer(Vec::new())
}

fn bytes(lines: Writer<Vec<u8>>) -> io::Result<Vec<u8>> {
    lines.into_inner().map_err(csv::IntoInnerError::into_error)
}

fn header(names: impl IntoIterator<Item = String>) -> io::Result<Start> {
    let mut lines = lines();
    lines.write_record(shown(names))?;
    let mut header = bytes(lines)?;
    // Its line end.
    header.pop();
    Ok(Start::Header(header))
}

/// Cells whose text stays in its line.
fn shown(cells: impl IntoIterator<Item = String>) -> impl Iterator<Item = String> {
    cells.into_iter().map(|cell| escape(&cell))
}

fn cell(value: Option<&Value>) -> String {
    value.map(Value::to_string).unwrap_or_default()
}
