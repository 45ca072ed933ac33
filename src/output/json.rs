//! JSON: an object a reading, on lines of their own or in one array.

use std::fmt::Display;
use std::io::{self, Write};

use serde::{Serialize, Serializer};
use serde_json::value::RawValue;

use super::{LineFormat, Sink, status, time};
use crate::append::Start;
use crate::profile::{Point, Value};
use crate::readings::Row;

/// One reading. Numbers carry every digit the meter gave.
#[derive(Serialize)]
struct Object<'a> {
    time: &'a str,
    meter: Option<&'a str>,
    unit_id: u8,
    point: &'a str,
    value: Option<Box<RawValue>>,
    unit: Option<&'a str>,
    status: String,
}

fn objects(points: &[Point], row: &Row) -> io::Result<Vec<String>> {
    let time = time(row);
    points
        .iter()
        .zip(&row.readings)
        .map(|(point, reading)| {
            let object = Object {
                time: &time,
                meter: Some(row.meter.as_str()).filter(|meter| !meter.is_empty()),
                unit_id: row.unit.get(),
                point: &point.name,
                value: reading.as_ref().ok().map(raw).transpose()?,
                unit: point.unit.as_deref(),
                status: status(reading.as_ref().err().copied()),
            };
            line(&object)
        })
        .collect()
}

/// Anything in one line.
pub(super) fn line(value: &impl Serialize) -> io::Result<String> {
    // The one control character that JSON lets pass.
    Ok(serde_json::to_string(value)?.replace('\u{7f}', "\\u007f"))
}

/// A number that JSON has digit by digit as it prints.
pub(super) struct Exact<N>(pub(super) N);

impl<N: Display> Serialize for Exact<N> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let digits = RawValue::from_string(self.0.to_string());
        digits
            .map_err(serde::ser::Error::custom)?
            .serialize(serializer)
    }
}

/// A number as its own digits, everything else as a string.
fn raw(value: &Value) -> Result<Box<RawValue>, serde_json::Error> {
    let text = if value.is_number() {
        value.to_string()
    } else {
        serde_json::to_string(&value.to_string())?
    };
    RawValue::from_string(text)
}

/// One object a line.
#[derive(Debug, Clone, Copy, Default)]
pub struct JsonLines;

impl LineFormat for JsonLines {
    fn start(&self, _: &[Point]) -> io::Result<Start> {
        // The first key of an object.
        Ok(Start::Prefix("{\"time\":\""))
    }

    fn lines(&self, points: &[Point], row: &Row) -> io::Result<Vec<u8>> {
        let lines = objects(points, row)?.into_iter();
        Ok(lines.flat_map(|line| (line + "\n").into_bytes()).collect())
    }
}

/// All objects in one array.
pub struct Json<W: Write> {
    out: W,
    begun: bool,
}

impl<W: Write> Json<W> {
    /// Writes to `out`.
    pub const fn new(out: W) -> Self {
        Self { out, begun: false }
    }
}

impl<W: Write> Sink for Json<W> {
    fn row(&mut self, points: &[Point], row: &Row) -> io::Result<()> {
        let start = if self.begun { ",\n" } else { "[\n" };
        self.begun = true;
        let text = format!("{start}{}", objects(points, row)?.join(",\n"));
        self.out.write_all(text.as_bytes())?;
        self.out.flush()
    }

    fn finish(&mut self) -> io::Result<()> {
        let end = if self.begun { "\n]\n" } else { "[]\n" };
        self.out.write_all(end.as_bytes())?;
        self.out.flush()
    }
}
