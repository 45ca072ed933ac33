//! The TOML file of a meter, key by key. Unknown keys are errors; what the values mean is checked
//! in [`super::load`].
//!
//! ```toml
//! name = "example"
//! title = "Example Works E1"
//! manual = "E1 protocol manual, rev. 3"
//!
//! [line]                        # the factory setting; all three keys can be left out
//! baud = 9600
//! parity = "none"               # none, even, odd
//! stop_bits = 1                 # 1, 2
//!
//! [limits]                      # every key can be left out
//! highest_unit = 247            # 247, or 255 where the meter uses the reserved numbers
//! functions = [3, 4, 6, 16]     # default [3, 4]
//! interchangeable_reads = true  # functions 03 and 04 read the same registers; default false
//! broadcast_functions = [6]     # obeyed on address 0; default none
//! read_registers = 125          # the most in one read, 1 to 125
//! write_registers = 123         # the most in one write, 1 to 123
//! read_holes = false            # a read may cover registers that no point names
//! table_registers = 256         # a read must not cross a multiple of this; default no limit
//! typical_answer = "40ms"       # for planning; default 0s
//! longest_answer = "500ms"      # the time-out when none is asked for; default 1s
//! pause = "0s"                  # before each request, where 3.5 characters are not enough
//!
//! [identification]              # how to tell that a unit is this meter
//! point = "device_code"
//! codes = [57, 58]              # what it holds
//!
//! [labels]                      # tables of names that several points share
//! on_off = { 0 = "off", 1 = "on" }
//!
//! [groups]                      # names and globs; `default` is read when nothing is named
//! default = ["voltage_*"]
//!
//! [[points]]
//! name = "voltage_a"
//! address = 0x0000              # as on the wire, from 0
//! type = "i32"                  # u16 i16 u32 i32 u64 i64 f32 f64 hex bits mod10000 letter
//!                               # time date ascii/N
//! order = "CDAB"                # ABCD (default), CDAB, BADC, DCBA
//! scale = 0.1                   # the raw number is multiplied with it; default 1
//! unit = "V"
//! about = "phase voltage L1-N"
//! no_value = { high_word = 0x7FFF, means = "overflow" }  # or raw = 65535, means = "absent"
//! verified = false              # address or scale were not read in the maker's manual
//! page = "8"
//!
//! [[points]]
//! name = "device_code"
//! address = 0x0001
//! type = "u16"
//! alone = true                  # must be read by a request of its own
//!
//! [[points]]
//! name = "backlight"
//! address = 0x1000
//! type = "u16"
//! access = "read-write"         # read (default), write, read-write
//! range = [0, 1]                # raw numbers that may be written
//! labels = "on_off"             # a table of [labels], or one in place; a code without a name
//!                               # shows as its number
//! function = 3                  # the one function that reads it, where the two differ
//!
//! [[points]]
//! name = "user_register"
//! address = 0x1100
//! type = "hex"
//! repeat = 8                    # user_register_1 to user_register_8, one behind the other
//! ```

use std::collections::BTreeMap;
use std::fmt;

use serde::de::value::MapAccessDeserializer;
use serde::de::{self, MapAccess, Visitor};
use serde::{Deserialize, Deserializer};
use toml::Spanned;

/// The whole file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProfileFile {
    pub(super) name: Spanned<String>,
    pub(super) title: String,
    pub(super) manual: String,
    #[serde(default)]
    pub(super) line: LineTable,
    #[serde(default)]
    pub(super) limits: LimitsTable,
    pub(super) identification: Option<IdentificationTable>,
    #[serde(default)]
    pub(super) labels: BTreeMap<String, LabelTable>,
    #[serde(default)]
    pub(super) groups: BTreeMap<Spanned<String>, Vec<Spanned<String>>>,
    pub(super) points: Vec<PointTable>,
}

/// `[line]`.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LineTable {
    pub(super) baud: Option<Spanned<u32>>,
    pub(super) parity: Option<Spanned<String>>,
    pub(super) stop_bits: Option<Spanned<u8>>,
}

/// `[limits]`.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LimitsTable {
    pub(super) highest_unit: Option<Spanned<u16>>,
    pub(super) functions: Option<Spanned<Vec<Spanned<u8>>>>,
    #[serde(default)]
    pub(super) interchangeable_reads: bool,
    #[serde(default)]
    pub(super) broadcast_functions: Vec<Spanned<u8>>,
    pub(super) read_registers: Option<Spanned<u16>>,
    pub(super) write_registers: Option<Spanned<u16>>,
    #[serde(default)]
    pub(super) read_holes: bool,
    pub(super) table_registers: Option<Spanned<u16>>,
    pub(super) typical_answer: Option<Spanned<String>>,
    pub(super) longest_answer: Option<Spanned<String>>,
    pub(super) pause: Option<Spanned<String>>,
}

/// `[identification]`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct IdentificationTable {
    pub(super) point: Spanned<String>,
    pub(super) codes: Spanned<Vec<u16>>,
}

/// Names of codes or bits; keys are numbers, decimal or `0x`.
pub type LabelTable = BTreeMap<Spanned<String>, String>;

/// One of `[[points]]`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PointTable {
    pub(super) name: Spanned<String>,
    pub(super) address: Spanned<u16>,
    pub(super) repeat: Option<Spanned<u16>>,
    #[serde(rename = "type")]
    pub(super) kind: Spanned<String>,
    pub(super) order: Option<Spanned<String>>,
    pub(super) scale: Option<Spanned<Number>>,
    pub(super) unit: Option<String>,
    #[serde(default)]
    pub(super) about: String,
    pub(super) access: Option<Spanned<String>>,
    pub(super) range: Option<Spanned<Vec<i64>>>,
    pub(super) labels: Option<Spanned<LabelsKey>>,
    pub(super) no_value: Option<Spanned<NoValueTable>>,
    #[serde(default)]
    pub(super) alone: bool,
    pub(super) function: Option<Spanned<u8>>,
    #[serde(default = "verified")]
    pub(super) verified: bool,
    #[serde(default)]
    pub(super) page: String,
}

const fn verified() -> bool {
    true
}

/// A number with or without decimals.
#[derive(Debug, Clone, Copy)]
pub enum Number {
    /// Without.
    Integer(i64),
    /// With; its shortest form is what was written.
    Float(f64),
}

impl<'de> Deserialize<'de> for Number {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Either;

        impl Visitor<'_> for Either {
            type Value = Number;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number")
            }

            fn visit_i64<E: de::Error>(self, number: i64) -> Result<Number, E> {
                Ok(Number::Integer(number))
            }

            fn visit_f64<E: de::Error>(self, number: f64) -> Result<Number, E> {
                Ok(Number::Float(number))
            }
        }

        deserializer.deserialize_any(Either)
    }
}

/// The name of a shared table, or the table itself.
#[derive(Debug)]
pub enum LabelsKey {
    /// A table of `[labels]`.
    Shared(String),
    /// A table in place.
    Own(LabelTable),
}

// By hand, because what serde derives for "one of two" loses the lines of the keys.
impl<'de> Deserialize<'de> for LabelsKey {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Either;

        impl<'de> Visitor<'de> for Either {
            type Value = LabelsKey;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a table of names, or the name of one in [labels]")
            }

            fn visit_str<E: de::Error>(self, name: &str) -> Result<LabelsKey, E> {
                Ok(LabelsKey::Shared(name.to_owned()))
            }

            fn visit_map<A: MapAccess<'de>>(self, table: A) -> Result<LabelsKey, A::Error> {
                LabelTable::deserialize(MapAccessDeserializer::new(table)).map(LabelsKey::Own)
            }
        }

        deserializer.deserialize_any(Either)
    }
}

/// What stands for "no value": one of the two markers, and what it means.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NoValueTable {
    pub(super) high_word: Option<u16>,
    pub(super) raw: Option<Spanned<i64>>,
    pub(super) means: Spanned<String>,
}
