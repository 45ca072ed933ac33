//! CSV (RFC 4180, LF line ends): wide, a row a meter; and long, a row a reading.

use std::io::{self, Write};

use csv::{Terminator, Writer, WriterBuilder};

use super::{Sink, escape, status, time};
use crate::profile::{Point, Value};
use crate::readings::Row;

/// How CSV is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct CsvStyle {
    /// ` [kWh]` behind the names in a wide header.
    pub units: bool,
    /// The destination is a terminal, so text from a meter is escaped.
    pub terminal: bool,
}

/// The columns every wide row begins with.
pub const WIDE_COLUMNS: [&str; 4] = ["time", "meter", "unit_id", "status"];

/// `time,meter,unit_id,status,<point>,...`: empty cells for what is missing.
pub struct WideCsv<W: Write> {
    out: W,
    style: CsvStyle,
    headed: bool,
}

impl<W: Write> WideCsv<W> {
    /// Writes to `out`.
    pub const fn new(out: W, style: CsvStyle) -> Self {
        Self {
            out,
            style,
            headed: false,
        }
    }

    fn header(&self, points: &[Point]) -> Vec<String> {
        let names = points.iter().map(|point| match &point.unit {
            Some(unit) if self.style.units => format!("{} [{unit}]", point.name),
            _ => point.name.clone(),
        });
        WIDE_COLUMNS
            .map(str::to_owned)
            .into_iter()
            .chain(names)
            .collect()
    }
}

impl<W: Write> Sink for WideCsv<W> {
    fn row(&mut self, points: &[Point], row: &Row) -> io::Result<()> {
        let mut lines = lines();
        if !self.headed {
            lines.write_record(self.header(points))?;
            self.headed = true;
        }
        let cells = row
            .readings
            .iter()
            .map(|reading| cell(reading.as_ref().ok(), self.style));
        let fixed = [
            time(row),
            row.meter.clone(),
            row.unit.to_string(),
            status(row.worst()),
        ];
        lines.write_record(fixed.into_iter().chain(cells))?;
        put(&mut self.out, lines)
    }

    fn finish(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

/// `time,meter,unit_id,point,value,unit,status`.
pub struct LongCsv<W: Write> {
    out: W,
    style: CsvStyle,
    headed: bool,
}

impl<W: Write> LongCsv<W> {
    /// Writes to `out`.
    pub const fn new(out: W, style: CsvStyle) -> Self {
        Self {
            out,
            style,
            headed: false,
        }
    }
}

impl<W: Write> Sink for LongCsv<W> {
    fn row(&mut self, points: &[Point], row: &Row) -> io::Result<()> {
        let mut lines = lines();
        if !self.headed {
            lines.write_record([
                "time", "meter", "unit_id", "point", "value", "unit", "status",
            ])?;
            self.headed = true;
        }
        for (point, reading) in points.iter().zip(&row.readings) {
            lines.write_record([
                time(row),
                row.meter.clone(),
                row.unit.to_string(),
                point.name.clone(),
                cell(reading.as_ref().ok(), self.style),
                point.unit.clone().unwrap_or_default(),
                status(reading.as_ref().err().copied()),
            ])?;
        }
        put(&mut self.out, lines)
    }

    fn finish(&mut self) -> io::Result<()> {
        self.out.flush()
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
    lines.into_inner().map_err(csv::IntoInnerError::into_error)
}

fn lines() -> Writer<Vec<u8>> {
    WriterBuilder::new()
        .terminator(Terminator::Any(b'\n'))
        .from_writer(Vec::new())
}

/// All lines of a row in one write.
fn put(out: &mut impl Write, lines: Writer<Vec<u8>>) -> io::Result<()> {
    let bytes = lines
        .into_inner()
        .map_err(csv::IntoInnerError::into_error)?;
    out.write_all(&bytes)?;
    out.flush()
}

fn cell(value: Option<&Value>, style: CsvStyle) -> String {
    match value {
        None => String::new(),
        Some(Value::Text(text)) if style.terminal => escape(text),
        Some(value) => value.to_string(),
    }
}
