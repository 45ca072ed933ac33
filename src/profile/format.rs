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
//! functions = [3, 4, 6, 7, 8, 16]  # default [3, 4]; there is 5 as well
//! interchangeable_reads = true  # functions 03 and 04 read the same registers; default false
//! broadcast_functions = [6, 16] # obeyed on address 0; default none
//! broadcast = "any"             # what may be written there: any (default), or only what is "marked"
//! loopback_data = "any"         # what function 08 sends back: any (default) or zero alone
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
//! [factors]                     # numbers that follow from setup registers, for scales
//! multiplier = { product = [1.2, "ct_ratio"] }     # of numbers, points and other factors
//! full_scale = { by = "ct_ratio", cases = { 1 = 500 }, otherwise = "multiplier" }
//!                               # one of several, by the raw number of a point
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
//! scale = 0.1                   # the raw number is multiplied with it; default 1. Also the name of
//!                               # a factor, or one number or another by where the raw one lies
//! unit = "V"                    # "" says that there is none
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
//! name = "ct_ratio"
//! address = 0x1001
//! type = "u16"
//! access = "read-write"
//! range = [1, 6000]             # what else stands there gives no scale
//!
//! [[points]]
//! name = "active_power"
//! address = 0x1002
//! type = "u16"
//! span = { full = 9999, low = "-full_scale", high = "full_scale" }  # raw 0 is low, 9999 is high
//! only_with = { point = "backlight", codes = [1] }  # means nothing when it holds anything else;
//!                               # without codes: when that point has no value
//!
//! [[points]]
//! name = "user_register"
//! address = 0x1100
//! type = "hex"
//! repeat = 8                    # user_register_1 to user_register_8, one behind the other
//!
//! [[points]]
//! name = "frequency"
//! address = 0x1200
//! type = "u16"
//! scale = [{ raw = [40, 70], factor = 1 }, { raw = [400, 700], factor = 0.1 }]
//! unit = "Hz"
//!
//! [[points]]
//! name = "com_baud"
//! address = 0x1300
//! type = "u16"
//! access = "read-write"         # the keys below are for what can be written; all can be left out
//! hazard = "changes how the meter is reached"  # asked about before: completes "this ..."
//! range = [5, 100]
//! step = 5                      # the raw number is a multiple of this
//! also = [65535]                # raw numbers that it takes besides those of range and step
//! write_function = 16           # the one function that writes it; 6 for one register alone
//! broadcast = "allowed"         # may be written to all meters at once; "only": in no other way
//! writable_with = { point = "backlight", codes = [0] }  # refused while it holds anything else
//!
//! [[points]]
//! name = "demand_period"
//! address = 0x1301
//! type = "u16"
//! access = "read-write"
//! allowed = [1, 5, 15]          # the only raw numbers it takes, instead of a step
//!
//! [[points]]
//! name = "channel"
//! address = 0x1310
//! type = "u16"
//! access = "read-write"
//! repeat = 4
//!
//! [[points]]
//! name = "set_time"
//! address = 0x1302
//! type = "time"
//! access = "write"
//! shown_by = "clock_time"       # where what was written can be read; needed only with "write"
//!
//! [[points]]
//! name = "set_date"
//! address = 0x1304
//! type = "date"
//! access = "write"
//!
//! [[points]]
//! name = "reset_energy"
//! address = 0x1306
//! type = "u16"
//! access = "write"
//! momentary = true              # does something when written, keeps nothing
//! moves = "port"                # changes how the meter is reached: its address, its port's setting
//! hazard = "sets the energy counters to zero"
//!
//! [[points]]
//! name = "clock_time"
//! address = 0x1307
//! type = "time"
//!
//! [clock]                       # the points that set the clock, the date right behind the time
//! time = "set_time"
//! date = "set_date"
//!
//! [status_bits]                 # what function 07 answers; needs 7 in limits.functions
//! 0x01 = "alarm"
//!
//! [command_registers]           # take operations by number: code, number, data in one write
//! address = 0x0080              # needs 16 in limits.functions
//! code = 5                      # what the first of them is to hold
//!
//! [[operations]]                # what the meter does when it is told to
//! name = "test_leds"
//! number = 26                   # with function 05 or in the command registers
//! about = "lights LEDs"
//! hazard = "lights what operators watch"
//! broadcast = "allowed"         # to all meters at once; "only": in no other way
//! only_with = { point = "backlight", codes = [1] }  # carried out only while it holds this
//! data = { type = "bits", labels = { 0x1 = "alarm" }, about = "which" }  # behind the number;
//!                               # also range, as of a point
//! page = "12"                   # and verified, as of a point
//!
//! [[operations]]
//! name = "clear_energy"
//! register = 0x1306             # or by a value in a register, with 6 or 16; without a hazard of its
//! value = 1                     # own it has that of the point there
//! about = "starts the energy counters anew"
//!
//! [[distinct]]                  # of these points no two may hold the same
//! of = ["channel_*"]            # names and globs; points of one register
//! except = [65535]              # raw numbers that several may hold
//! about = "a channel gives one quantity"
//!
//! [[identities]]                # what must hold on a live meter: `meters verify` tests it
//! near = "frequency"            # or one of the five below
//! one_of = [50, 60]
//! tolerance = 0.02              # a part of the greater side; default 0.02
//! # sum = "power", of = ["power_a", "power_b", "power_c"]
//! # mean = "voltage", of = ["voltage_a", "voltage_b", "voltage_c"]
//! # apparent = "va", real = "w", reactive = "var"
//! # power_factor = "pf", real = "w", apparent = "va"
//! # line_voltage = "voltage_ab", between = ["voltage_a", "voltage_b"]
//! ```

mod keys;
mod operations;

use std::collections::BTreeMap;

use serde::Deserialize;
use toml::Spanned;

pub use keys::{LabelsKey, Number, OperandKey, ScaleKey};
pub use operations::{ClockTable, CommandRegistersTable, DataTable, DistinctTable, OperationTable};

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
    pub(super) labels: BTreeMap<Spanned<String>, LabelTable>,
    #[serde(default)]
    pub(super) factors: BTreeMap<Spanned<String>, FactorTable>,
    #[serde(default)]
    pub(super) groups: BTreeMap<Spanned<String>, Vec<Spanned<String>>>,
    pub(super) points: Vec<PointTable>,
    #[serde(default)]
    pub(super) identities: Vec<Spanned<IdentityTable>>,
    #[serde(default)]
    pub(super) operations: Vec<Spanned<OperationTable>>,
    pub(super) command_registers: Option<Spanned<CommandRegistersTable>>,
    pub(super) clock: Option<ClockTable>,
    pub(super) status_bits: Option<Spanned<LabelTable>>,
    #[serde(default)]
    pub(super) distinct: Vec<DistinctTable>,
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
    pub(super) broadcast: Option<Spanned<String>>,
    pub(super) loopback_data: Option<Spanned<String>>,
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
    pub(super) scale: Option<Spanned<ScaleKey>>,
    pub(super) span: Option<Spanned<SpanTable>>,
    pub(super) unit: Option<String>,
    #[serde(default)]
    pub(super) about: String,
    pub(super) access: Option<Spanned<String>>,
    pub(super) range: Option<Spanned<Vec<i64>>>,
    pub(super) labels: Option<Spanned<LabelsKey>>,
    pub(super) no_value: Option<Spanned<NoValueTable>>,
    pub(super) only_with: Option<OnlyWithTable>,
    #[serde(default)]
    pub(super) alone: bool,
    pub(super) function: Option<Spanned<u8>>,
    pub(super) hazard: Option<Spanned<String>>,
    pub(super) momentary: Option<Spanned<bool>>,
    pub(super) moves: Option<Spanned<String>>,
    pub(super) step: Option<Spanned<u16>>,
    pub(super) allowed: Option<Spanned<Vec<Spanned<i64>>>>,
    pub(super) also: Option<Spanned<Vec<Spanned<i64>>>>,
    pub(super) write_function: Option<Spanned<u8>>,
    pub(super) broadcast: Option<Spanned<String>>,
    pub(super) writable_with: Option<Spanned<OnlyWithTable>>,
    pub(super) shown_by: Option<Spanned<String>>,
    #[serde(default = "verified")]
    pub(super) verified: bool,
    #[serde(default)]
    pub(super) page: String,
}

/// Rows are verified unless they say otherwise.
const fn verified() -> bool {
    true
}

/// What stands for "no value": one of the two markers, and what it means.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NoValueTable {
    pub(super) high_word: Option<u16>,
    pub(super) raw: Option<Spanned<i64>>,
    pub(super) means: Spanned<String>,
}

/// Where a figure lies between two others.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpanTable {
    pub(super) full: Spanned<u16>,
    pub(super) low: Spanned<OperandKey>,
    pub(super) high: Spanned<OperandKey>,
}

/// Raw numbers that share a scale.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BandTable {
    pub(super) raw: Spanned<Vec<i64>>,
    pub(super) factor: Spanned<Number>,
}

/// The setup a point means anything with.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OnlyWithTable {
    pub(super) point: Spanned<String>,
    pub(super) codes: Option<Spanned<Vec<u16>>>,
}

/// One of `[factors]`: a product, or a choice by a point.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FactorTable {
    pub(super) product: Option<Vec<Spanned<OperandKey>>>,
    pub(super) by: Option<Spanned<String>>,
    pub(super) cases: Option<BTreeMap<Spanned<String>, Spanned<OperandKey>>>,
    pub(super) otherwise: Option<Spanned<OperandKey>>,
}

/// One of `[[identities]]`; which law it is shows by its keys.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct IdentityTable {
    pub(super) sum: Option<Spanned<String>>,
    pub(super) mean: Option<Spanned<String>>,
    pub(super) of: Option<Vec<Spanned<String>>>,
    pub(super) apparent: Option<Spanned<String>>,
    pub(super) real: Option<Spanned<String>>,
    pub(super) reactive: Option<Spanned<String>>,
    pub(super) power_factor: Option<Spanned<String>>,
    pub(super) line_voltage: Option<Spanned<String>>,
    pub(super) between: Option<[Spanned<String>; 2]>,
    pub(super) near: Option<Spanned<String>>,
    pub(super) one_of: Option<Vec<Spanned<Number>>>,
    pub(super) tolerance: Option<Spanned<Number>>,
}
