//! A point: one quantity of a meter, where it lies and what it means.

use std::collections::BTreeMap;
use std::sync::Arc;

use rust_decimal::Decimal;
use rust_decimal::prelude::ToPrimitive;
use serde::{Deserialize, Serialize};

use super::scaling::{Band, Scaling, span_step, times, within};
use super::setup::Scales;
use super::value::{Missing, Value};
use super::writing::Writing;
use crate::codec::value::{self, ByteOrder, Raw, RegisterType, ValueError};
use crate::codec::{ReadFunction, RegisterRange};

/// One quantity of a meter.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Point {
    /// Its name: lower case, digits and `_`; or a raw register's address in hex.
    pub name: String,
    /// What it is, in a few words; empty for raw registers.
    pub about: String,
    /// The registers it lies in.
    pub range: RegisterRange,
    /// What they hold.
    pub kind: RegisterType,
    /// How the bytes lie in them.
    pub order: ByteOrder,
    /// How the raw number becomes a figure.
    pub scaling: Scaling,
    /// The unit of the scaled number: `A`, `kWh`.
    pub unit: Option<String>,
    /// Whether it can be read and written.
    pub access: Access,
    /// Lowest and highest raw integer that may be written; what else a setup point holds is no
    /// setting, and nothing is scaled by it.
    pub limits: Option<(i128, i128)>,
    /// Names of codes or of bits.
    #[serde(skip)]
    pub labels: Labels,
    /// The name of the table they stand in, where points share one.
    #[serde(skip)]
    pub label_table: Option<Arc<str>>,
    /// What the meter stores in place of a value it does not have.
    pub no_value: Option<NoValue>,
    /// The setup it means anything with; `None` when it always does.
    pub only_with: Option<OnlyWith>,
    /// It must be read by a request of its own.
    pub alone: bool,
    /// The one function it can be read with; `None` leaves the choice to the meter's limits.
    pub function: Option<ReadFunction>,
    /// What is to be known before it is written: see [`Point::writing`].
    pub writing: Option<Box<Writing>>,
    /// Its address and scale were read in the maker's manual, not worked out or taken from a driver.
    pub verified: bool,
    /// Page of the manual.
    pub page: String,
}

/// What can be done with a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Access {
    /// Read only.
    #[default]
    Read,
    /// Write only.
    Write,
    /// Both.
    ReadWrite,
}

impl Access {
    /// Whether it can be read.
    pub const fn readable(self) -> bool {
        !matches!(self, Self::Write)
    }

    /// Whether it can be written.
    pub const fn writable(self) -> bool {
        !matches!(self, Self::Read)
    }
}

/// Names for numbers or bits, by the register that holds them. Points that share a table of the
/// profile hold the same one.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Labels {
    /// None: the number itself is shown.
    #[default]
    None,
    /// A name a code.
    Codes(Arc<Names>),
    /// A name a mask, lowest bit first.
    Bits(Arc<Names>),
}

/// Names by the codes or masks they stand for.
pub type Names = BTreeMap<u16, String>;

/// The marker a meter stores in place of a value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct NoValue {
    /// What to look for.
    pub marker: Marker,
    /// What it means.
    pub missing: Missing,
}

/// How a marker is recognised.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Marker {
    /// The most significant word has this value, whatever the others hold.
    HighWord(u16),
    /// The whole raw integer has this value.
    Raw(i128),
}

/// What a point means anything with: another one that holds one of these, or any value at all.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct OnlyWith {
    /// The name of the other point.
    pub point: String,
    /// The raw numbers of its one register; `None` when any value will do.
    pub codes: Option<Vec<u16>>,
}

impl OnlyWith {
    /// Whether what the other point holds will do; `None` is a value that is no number.
    pub fn means_something(&self, setting: Option<i128>) -> bool {
        let Some(codes) = &self.codes else {
            return true;
        };
        codes.iter().any(|code| setting == Some(i128::from(*code)))
    }
}

impl Point {
    /// A raw register as a point: read only, no labels, nothing known about it.
    pub fn raw(range: RegisterRange, kind: RegisterType, order: ByteOrder) -> Self {
        Self {
            name: range.start().to_string(),
            about: String::new(),
            range,
            kind,
            order,
            scaling: Scaling::NONE,
            unit: None,
            access: Access::Read,
            limits: None,
            labels: Labels::None,
            label_table: None,
            no_value: None,
            only_with: None,
            alone: false,
            function: None,
            writing: None,
            verified: true,
            page: String::new(),
        }
    }

    /// What the raw number is multiplied with, where that is always the same number.
    pub const fn constant_scale(&self) -> Option<Decimal> {
        match self.scaling {
            Scaling::Times(scale) => Some(scale),
            _ => None,
        }
    }

    /// The difference that one raw step makes, on a meter that is set up like this; 0 where steps
    /// are not known or too small to tell.
    pub fn step(&self, scales: &Scales) -> f64 {
        let step = match (&self.scaling, self.kind.is_integer()) {
            (_, false) => None,
            (Scaling::Times(scale), true) => Some(*scale),
            (Scaling::TimesFactor(name), true) => scales.step(name).ok(),
            (Scaling::TimesByRaw(bands), true) => bands.iter().map(|band| band.factor.abs()).max(),
            (Scaling::Span { full, low, high }, true) => {
                let ends = scales.operand(low).ok().zip(scales.operand(high).ok());
                ends.and_then(|(low, high)| span_step(*full, low, high))
            }
        };
        step.and_then(|step| step.abs().to_f64())
            .unwrap_or_default()
    }

    /// What the registers of this point mean on a meter that is set up like this.
    ///
    /// # Errors
    /// [`Missing`] when the meter marks the value as not there, when it means nothing with this
    /// setup, or when the registers cannot hold one.
    pub fn interpret(&self, registers: &[u16], scales: &Scales) -> Result<Value, Missing> {
        if let Some(with) = &self.only_with
            && !with.means_something(scales.setting(&with.point)?)
        {
            return Err(Missing::Absent);
        }
        match self.raw_value(registers)? {
            Raw::Integer(number) => self.integer(number, scales),
            Raw::Single(number) => self.single(number),
            Raw::Double(number) => self.double(number),
            Raw::Word(word) => Ok(Value::Text(self.word(word))),
            Raw::Text(text) => Ok(Value::Text(text)),
            Raw::Time(time) => Ok(Value::Text(format!("{time:.3}"))),
            Raw::Date(date) => Ok(Value::Text(date.to_string())),
        }
    }

    /// The name of a code; `None` when it has none.
    pub fn label(&self, code: u16) -> Option<&str> {
        match &self.labels {
            Labels::Codes(names) => names.get(&code).map(String::as_str),
            Labels::Bits(_) | Labels::None => None,
        }
    }

    /// What the registers of this point hold, before its scale.
    ///
    /// # Errors
    /// [`Missing`] when the meter marks the value as not there, or the registers cannot hold one.
    pub(super) fn raw_value(&self, registers: &[u16]) -> Result<Raw, Missing> {
        let raw = value::decode(self.kind, self.order, registers).map_err(|error| match error {
            ValueError::Unset => Missing::Absent,
            ValueError::Length { .. } | ValueError::Impossible { .. } => Missing::Mismatch,
        });
        // The marker comes first: what it stands for need not be a value of the type.
        match self.no_value {
            Some(no_value) if self.is_marked(no_value.marker, registers, raw.as_ref().ok()) => {
                Err(no_value.missing)
            }
            _ => raw,
        }
    }

    fn is_marked(&self, marker: Marker, registers: &[u16], raw: Option<&Raw>) -> bool {
        match marker {
            Marker::HighWord(word) => self.order.high_word(registers) == Some(word),
            Marker::Raw(number) => match raw {
                Some(Raw::Integer(found)) => *found == number,
                Some(Raw::Word(found)) => i128::from(*found) == number,
                _ => false,
            },
        }
    }

    fn integer(&self, number: i128, scales: &Scales) -> Result<Value, Missing> {
        if let (Labels::Codes(codes), Some(code)) = (&self.labels, register(number))
            && let Some(label) = codes.get(&code)
        {
            return Ok(Value::Text(label.clone()));
        }
        let factor = match &self.scaling {
            Scaling::Times(scale) => *scale,
            Scaling::TimesFactor(name) => scales.step(name)?,
            Scaling::TimesByRaw(bands) => {
                let holds = |band: &&Band| (band.lowest..=band.highest).contains(&number);
                bands.iter().find(holds).ok_or(Missing::Mismatch)?.factor
            }
            Scaling::Span { full, low, high } => {
                let (low, high) = (scales.operand(low)?, scales.operand(high)?);
                return within(number, *full, low, high).map(Value::Decimal);
            }
        };
        times(number, 0, factor)
            .map(Value::Decimal)
            .ok_or(Missing::Mismatch)
    }

    fn single(&self, number: f32) -> Result<Value, Missing> {
        finite(f64::from(number))?;
        if self.scaling == Scaling::NONE {
            return Ok(Value::Single(number));
        }
        self.scaled(f64::from(number), &number.to_string())
    }

    fn double(&self, number: f64) -> Result<Value, Missing> {
        finite(number)?;
        if self.scaling == Scaling::NONE {
            return Ok(Value::Double(number));
        }
        self.scaled(number, &number.to_string())
    }

    /// Scaled from the digits a float prints, not from the ones its binary form adds, and rounded
    /// once; as a float where the product is no decimal.
    fn scaled(&self, number: f64, printed: &str) -> Result<Value, Missing> {
        // The loader gives a float no other scale than a number.
        let scale = self.constant_scale().ok_or(Missing::Mismatch)?;
        let exact = Decimal::from_str_exact(printed)
            .ok()
            .and_then(|printed| times(printed.mantissa(), printed.scale(), scale));
        let scaled = match exact.and_then(|product| product.to_string().parse().ok()) {
            Some(scaled) => scaled,
            None => number * scale.to_f64().ok_or(Missing::Mismatch)?,
        };
        finite(scaled).map(Value::Double)
    }

    fn word(&self, word: u16) -> String {
        match (&self.labels, self.kind) {
            (Labels::Bits(names), _) => bit_names(names, word),
            (Labels::Codes(names), _) if names.contains_key(&word) => names[&word].clone(),
            (_, RegisterType::Bits) => format!("0b{word:016b}"),
            _ => format!("0x{word:04X}"),
        }
    }
}

/// The register that holds a number of one register, negative ones included: labels go by that.
fn register(number: i128) -> Option<u16> {
    let signed = || i16::try_from(number).ok().map(i16::cast_unsigned);
    u16::try_from(number).ok().or_else(signed)
}

const fn finite(number: f64) -> Result<f64, Missing> {
    if number.is_nan() {
        Err(Missing::Absent)
    } else if number.is_infinite() {
        Err(Missing::Overflow)
    } else {
        Ok(number)
    }
}

/// Names of the bits that are set, `|` between them; bits without a name as one number in hex.
fn bit_names(names: &Names, word: u16) -> String {
    let mut shown: Vec<String> = Vec::new();
    let mut unknown = word;
    for (mask, name) in names {
        // A name for 0 is the name of "no bit at all".
        if word & mask == *mask && (*mask != 0 || word == 0) {
            shown.push(name.clone());
            unknown &= !mask;
        }
    }
    if unknown != 0 {
        shown.push(format!("0x{unknown:04X}"));
    }
    if shown.is_empty() {
        return "none".to_owned();
    }
    shown.join("|")
}
