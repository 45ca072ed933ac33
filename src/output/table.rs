//! A table for people.

use std::io::{self, Write};

use jiff::Timestamp;

use super::columns::columns;
use super::{Sink, escape, status};
use crate::codec::Unit;
use crate::profile::{Point, Value};
use crate::readings::{Fault, Row};

/// Behind the name of a point whose address or scale was not read in the maker's manual.
pub(super) const UNVERIFIED: &str = " *";

/// What that mark means.
pub(super) const FOOTNOTE: &str =
    "* not verified: address or scale was not read in the maker's manual";

/// A table a meter: a heading, the points with values and units, and what is missing and why.
pub struct Table<W: Write> {
    out: W,
    heading: Heading,
    begun: bool,
}

/// What stands above each table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Heading {
    /// Meter, unit, line and time, and footnotes below.
    Full {
        /// Where the readings come from, `/dev/ttyUSB0 at 9600 8N1`.
        line: String,
    },
    /// Which unit it is.
    Unit,
    /// Nothing: there is only one.
    None,
}

impl<W: Write> Table<W> {
    /// Writes to `out`.
    pub const fn new(out: W, heading: Heading) -> Self {
        Self {
            out,
            heading,
            begun: false,
        }
    }
}

impl<W: Write> Sink for Table<W> {
    fn row(&mut self, points: &[Point], row: &Row) -> io::Result<()> {
        let mut text = String::new();
        if self.begun {
            text.push('\n');
        }
        self.begun = true;
        match &self.heading {
            Heading::Full { line } => {
                text = format!("{text}{}\n", heading(row, line));
            }
            Heading::Unit => text = format!("{text}unit {}\n", row.unit),
            Heading::None => {}
        }
        text.push_str(&grid(points, row));
        let has_footnotes = matches!(self.heading, Heading::Full { .. });
        if has_footnotes && points.iter().any(|point| !point.verified) {
            text = format!("{text}\n{FOOTNOTE}\n");
        }
        self.out.write_all(text.as_bytes())?;
        self.out.flush()
    }

    fn finish(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

/// Which meter was read, where and when.
pub(super) fn heading(row: &Row, line: &str) -> String {
    title(&row.meter, row.unit, line, row.time)
}

/// The same of a meter, which has no name when it is empty, and a unit.
pub(super) fn title(meter: &str, unit: Unit, line: &str, time: Timestamp) -> String {
    let meter = match meter {
        "" => String::new(),
        meter => format!("{meter}, "),
    };
    let time = time.strftime("%Y-%m-%d %H:%M:%S UTC");
    format!("{meter}unit {unit} on {line}, {time}\n")
}

fn grid(points: &[Point], row: &Row) -> String {
    let decimals = row
        .readings
        .iter()
        .filter_map(|reading| reading.as_ref().ok().and_then(decimals))
        .max()
        .unwrap_or(0);
    let missing = row.worst().is_some();
    let mut header = vec!["POINT", "VALUE", "UNIT"];
    if missing {
        header.push("STATUS");
    }
    let lines = points.iter().zip(&row.readings).map(|(point, reading)| {
        let mark = if point.verified { "" } else { UNVERIFIED };
        let mut cells = vec![
            format!("{}{mark}", point.name),
            shown(reading, decimals),
            unit(point, reading),
        ];
        if missing {
            cells.push(status(reading.as_ref().err().copied()));
        }
        cells
    });
    columns(&header, &[1], lines)
}

/// The unit of a number; the name of a code, such as `off`, has none.
fn unit(point: &Point, reading: &Result<Value, Fault>) -> String {
    match reading {
        Ok(value) if !value.is_number() => String::new(),
        _ => escape(point.unit.as_deref().unwrap_or_default()),
    }
}

/// A value as it stands in its column: numbers so that their decimal marks align.
fn shown(reading: &Result<Value, Fault>, decimals: usize) -> String {
    match reading {
        Err(_) => format!("-{}", " ".repeat(decimals)),
        Ok(value) => {
            let text = escape(&value.to_string());
            let Some(own) = self::decimals(value) else {
                return folded(&text);
            };
            format!("{text}{}", " ".repeat(decimals - own))
        }
    }
}

/// Many flags that are set, as many in a line as fit.
fn folded(text: &str) -> String {
    const WIDEST: usize = 40;
    let mut lines: Vec<String> = Vec::new();
    for flag in text.split_inclusive('|') {
        match lines.last_mut() {
            Some(line) if line.chars().count() + flag.chars().count() <= WIDEST => {
                line.push_str(flag);
            }
            _ => lines.push(flag.to_owned()),
        }
    }
    lines.join("\n")
}

/// Characters of a number from its decimal mark on; `None` for text.
fn decimals(value: &Value) -> Option<usize> {
    if !value.is_number() {
        return None;
    }
    let text = value.to_string();
    Some(text.find('.').map_or(0, |mark| text.len() - mark))
}
