//! Influx line protocol: a line a row, `meter,meter=pqm,unit_id=17 status="ok",current_a=415 <time>`.
//!
//! The measurement is `meter`; meter and unit are tags, the status and each point are fields. What
//! is missing is no field, and the status says why. Numbers are floats to the database, and are
//! written here with every digit they have. The time is in nanoseconds.

use std::io;

use super::{LineFormat, escape, status};
use crate::append::Start;
use crate::profile::{Point, Value};
use crate::readings::Row;

/// Names that no point can have beside the tags and the status.
pub const INFLUX_NAMES: [&str; 4] = ["time", "meter", "unit_id", "status"];

/// A line a row.
#[derive(Debug, Clone, Copy, Default)]
pub struct Influx;

impl LineFormat for Influx {
    fn start(&self, _: &[Point]) -> io::Result<Start> {
        // The measurement; tags follow always.
        Ok(Start::Prefix("meter,"))
    }

    fn lines(&self, points: &[Point], row: &Row) -> io::Result<Vec<u8>> {
        let meter = match row.meter.as_str() {
            "" => String::new(),
            meter => format!("meter={},", key(meter)),
        };
        let unit = row.unit;
        let status = text(&status(row.worst()));
        let mut line = format!("meter,{meter}unit_id={unit} status={status}");
        for (point, reading) in points.iter().zip(&row.readings) {
            let Ok(value) = reading else { continue };
            line = format!("{line},{}={}", key(&point.name), field(value));
        }
        let time = row.time.as_nanosecond();
        Ok(format!("{line} {time}\n").into_bytes())
    }
}

fn field(value: &Value) -> String {
    match value {
        Value::Text(content) => text(content),
        number => number.to_string(),
    }
}

/// The name of a field, or what a tag is.
fn key(name: &str) -> String {
    let mut key = String::new();
    for c in escape(name).chars() {
        if matches!(c, ',' | '=' | ' ') {
            key.push('\\');
        }
        key.push(c);
    }
    key
}

/// A text of one line between quotes.
fn text(content: &str) -> String {
    let mut text = String::from('"');
    for c in escape(content).chars() {
        if matches!(c, '"' | '\\') {
            text.push('\\');
        }
        text.push(c);
    }
    text.push('"');
    text
}
