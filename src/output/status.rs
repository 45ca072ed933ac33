//! The status bits of function 07: a line a unit, a row a unit, or an object a unit.

use std::io::{self, Write};

use jiff::Timestamp;
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

use super::csv::records;
use super::json::line;
use super::{escape, rfc3339, status};
use crate::codec::Unit;
use crate::profile::Profile;
use crate::readings::Fault;

/// A bit and what it means when it is set.
pub type Bit = (u8, String);

/// What is printed of a status.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// For people, under a heading.
    Table,
    /// For people, without a heading.
    Lines,
    /// `time,meter,unit_id,status,value`, and a column of 0 and 1 a bit.
    Csv,
    /// One array of objects.
    Json,
}

/// The status of one unit.
#[derive(Debug)]
pub struct StatusRow<'a> {
    /// When it was asked for.
    pub time: Timestamp,
    /// The meter's name; empty for an unknown one.
    pub meter: &'a str,
    /// The unit.
    pub unit: Unit,
    /// The bits, or why there are none.
    pub bits: Result<u8, Fault>,
}

/// The bits a meter has names for, lowest first; all eight of a meter that has none, `bit_0` to
/// `bit_7`.
pub fn bits(profile: Option<&Profile>) -> Vec<Bit> {
    let named = profile.map(|profile| &profile.status_bits);
    match named.filter(|named| !named.is_empty()) {
        Some(named) => named
            .iter()
            .map(|(mask, name)| (*mask, name.clone()))
            .collect(),
        None => (0..8).map(|bit| (1 << bit, format!("bit_{bit}"))).collect(),
    }
}

/// Prints one status after the other.
pub struct Statuses<W: Write> {
    out: W,
    bits: Vec<Bit>,
    form: Form,
    begun: bool,
}

impl<W: Write> Statuses<W> {
    /// Writes to `out`.
    pub const fn new(out: W, bits: Vec<Bit>, form: Form) -> Self {
        Self {
            out,
            bits,
            form,
            begun: false,
        }
    }

    /// Prints one.
    ///
    /// # Errors
    /// What the destination says.
    pub fn row(&mut self, row: &StatusRow<'_>) -> io::Result<()> {
        let is_first = !std::mem::replace(&mut self.begun, true);
        let text = match self.form {
            Form::Table if is_first => format!("UNIT  VALUE  STATUS\n{}", self.told(row)),
            Form::Table | Form::Lines => self.told(row),
            Form::Csv => self.record(row, is_first)?,
            Form::Json => {
                let begin = if is_first { "[\n" } else { ",\n" };
                format!("{begin}{}", line(&self.object(row))?)
            }
        };
        self.out.write_all(text.as_bytes())?;
        self.out.flush()
    }

    /// Prints what comes after the last one.
    ///
    /// # Errors
    /// What the destination says.
    pub fn finish(&mut self) -> io::Result<()> {
        if self.form == Form::Json {
            let end = if self.begun { "\n]\n" } else { "[]\n" };
            self.out.write_all(end.as_bytes())?;
        }
        self.out.flush()
    }

    fn told(&self, row: &StatusRow<'_>) -> String {
        let (value, said) = match row.bits {
            Err(fault) => ("-".to_owned(), fault.to_string()),
            Ok(value) => (hex(value), self.set(value)),
        };
        format!("{:<4}  {value:<5}  {}\n", row.unit, escape(&said))
    }

    /// The names of the bits that are set; those without a name as one number in hex.
    fn set(&self, value: u8) -> String {
        let is_set = |bit: &&Bit| value & bit.0 == bit.0;
        let set: Vec<&Bit> = self.bits.iter().filter(is_set).collect();
        let mut names: Vec<String> = set.iter().map(|(_, name)| name.clone()).collect();
        let unnamed = set.iter().fold(value, |rest, (mask, _)| rest & !mask);
        if unnamed != 0 {
            names.push(hex(unnamed));
        }
        if names.is_empty() {
            return "none".to_owned();
        }
        names.join("|")
    }

    fn record(&self, row: &StatusRow<'_>, is_first: bool) -> io::Result<String> {
        let fixed = ["time", "meter", "unit_id", "status", "value"];
        let names: Vec<String> = self.bits.iter().map(|(_, name)| column(name)).collect();
        let header: Vec<&str> = fixed
            .into_iter()
            .chain(names.iter().map(String::as_str))
            .collect();
        let cells = vec![
            rfc3339(row.time),
            row.meter.to_owned(),
            row.unit.to_string(),
            status(row.bits.err()),
            row.bits.map(hex).unwrap_or_default(),
        ];
        let bits = self.bits.iter().map(|(mask, _)| match row.bits {
            Ok(value) => u8::from(value & mask == *mask).to_string(),
            Err(_) => String::new(),
        });
        let cells: Vec<String> = cells.into_iter().chain(bits).collect();
        let cells: Vec<&str> = cells.iter().map(String::as_str).collect();
        let mut bytes = Vec::new();
        if is_first {
            bytes = records(&header, [])?;
        }
        bytes.extend(records(&cells, [])?);
        Ok(String::from_utf8_lossy(&bytes).into_owned())
    }

    fn object<'a>(&'a self, row: &'a StatusRow<'_>) -> Object<'a> {
        Object {
            time: rfc3339(row.time),
            meter: Some(row.meter).filter(|meter| !meter.is_empty()),
            unit_id: row.unit.get(),
            status: status(row.bits.err()),
            value: row.bits.ok(),
            bits: row.bits.ok().map(|value| Set(&self.bits, value)),
        }
    }
}

fn hex(value: u8) -> String {
    format!("0x{value:02X}")
}

/// A name as a column has it.
fn column(name: &str) -> String {
    name.replace(' ', "_")
}

/// One status.
#[derive(Serialize)]
struct Object<'a> {
    time: String,
    meter: Option<&'a str>,
    unit_id: u8,
    status: String,
    value: Option<u8>,
    bits: Option<Set<'a>>,
}

/// Which of the bits are set.
struct Set<'a>(&'a [Bit], u8);

impl Serialize for Set<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Self(bits, value) = self;
        let mut map = serializer.serialize_map(Some(bits.len()))?;
        for (mask, name) in *bits {
            map.serialize_entry(&column(name), &(value & mask == *mask))?;
        }
        map.end()
    }
}
