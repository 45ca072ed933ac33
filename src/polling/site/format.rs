//! The TOML file of a site, key by key. Unknown keys are errors; what the values mean is checked in
//! [`super::load`].
//!
//! ```toml
//! [defaults]                    # for all meters that do not say otherwise; all can be left out
//! every = "1m"                  # from 10ms to 24h, on round times in UTC
//! timeout = "1s"                # else the meter's longest answer time
//! retries = 2                   # at most 100
//! pause = "0s"                  # else what the meter wants
//! output = "log"                # else the only one there is
//!
//! [[lines]]
//! name = "hall"                 # letters, digits, '_', '-', '.'
//! port = "/dev/serial/by-id/usb-FTDI_1-port0"
//! baud = 9600                   # these three: else the factory setting of the meters on it
//! parity = "none"               # none, even, odd
//! stop_bits = 1                 # 1, 2
//! echo = "auto"                 # auto, on, off
//! settle = "0s"                 # after the port was opened
//! wait = "5s"                   # for a port that another program holds
//!
//! [[meters]]
//! name = "main"                 # its name in the rows
//! line = "hall"                 # can be left out where there is one line
//! unit = 17
//! profile = "pqm"               # a name, or a file below the folder of this one
//! points = ["@default"]         # as typed for read-registers; else the meter's @default group
//! every = "15m"                 # and timeout, retries, pause, output, as above
//!
//! [[meters]]
//! name = "press"
//! unit = 3
//! profile = "em24"
//!
//! [[meters.groups]]             # in place of points: each with an interval and an output
//! points = ["@power"]
//! every = "10s"
//! output = "fast"
//!
//! [[outputs]]                   # without any, rows go to stdout as wide CSV
//! name = "log"
//! path = "log/{meter}-%Y-%m.csv"  # below the folder of this file; without it: stdout
//! format = "csv"                # csv, jsonl, influx
//! layout = "wide"               # of CSV: wide, long
//! units = true                  # in the header of wide CSV
//! no_sync = false               # true: leave it to the system when rows reach the disk
//! on_schema_change = "refuse"   # of a file with other columns: refuse, new-file
//! skip_failed = false           # true: no row where nothing was read
//!
//! [[outputs]]
//! name = "fast"
//! path = "fast.jsonl"
//! format = "jsonl"
//! ```

use serde::Deserialize;
use toml::Spanned;

/// The whole file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SiteFile {
    /// What holds for all meters.
    #[serde(default)]
    pub defaults: DefaultsTable,
    /// The lines.
    pub lines: Vec<LineTable>,
    /// The meters on them.
    pub meters: Vec<MeterTable>,
    /// Where rows go.
    #[serde(default)]
    pub outputs: Vec<OutputTable>,
}

/// `[defaults]`.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DefaultsTable {
    /// How often meters are read.
    pub every: Option<Spanned<String>>,
    /// How long an answer may take to begin.
    pub timeout: Option<Spanned<String>>,
    /// How often a read is repeated.
    pub retries: Option<Spanned<u32>>,
    /// Least time before each request.
    pub pause: Option<Spanned<String>>,
    /// Where rows go.
    pub output: Option<Spanned<String>>,
}

/// One of `[[lines]]`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LineTable {
    /// Its name.
    pub name: Spanned<String>,
    /// The port.
    pub port: Spanned<String>,
    /// Bits a second.
    pub baud: Option<Spanned<u32>>,
    /// The parity.
    pub parity: Option<Spanned<String>>,
    /// 1 or 2.
    pub stop_bits: Option<Spanned<u8>>,
    /// What is known of echoes.
    pub echo: Option<Spanned<String>>,
    /// What an adapter needs after its port was opened.
    pub settle: Option<Spanned<String>>,
    /// How long a busy port is waited for.
    pub wait: Option<Spanned<String>>,
}

/// One of `[[meters]]`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MeterTable {
    /// Its name.
    pub name: Spanned<String>,
    /// The line it is on.
    pub line: Option<Spanned<String>>,
    /// Its unit.
    pub unit: Spanned<u16>,
    /// What it is.
    pub profile: Option<Spanned<String>>,
    /// What is read.
    pub points: Option<Spanned<Vec<String>>>,
    /// Several such sets, each at its own rate.
    #[serde(default)]
    pub groups: Vec<Spanned<GroupTable>>,
    /// How often it is read.
    pub every: Option<Spanned<String>>,
    /// How long an answer may take to begin.
    pub timeout: Option<Spanned<String>>,
    /// How often a read is repeated.
    pub retries: Option<Spanned<u32>>,
    /// Least time before each request.
    pub pause: Option<Spanned<String>>,
    /// Where its rows go.
    pub output: Option<Spanned<String>>,
}

/// One of `[[meters.groups]]`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GroupTable {
    /// What is read.
    pub points: Spanned<Vec<String>>,
    /// How often.
    pub every: Option<Spanned<String>>,
    /// Where its rows go.
    pub output: Option<Spanned<String>>,
}

/// One of `[[outputs]]`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OutputTable {
    /// Its name.
    pub name: Spanned<String>,
    /// The file.
    pub path: Option<Spanned<String>>,
    /// The form of its rows.
    pub format: Option<Spanned<String>>,
    /// The shape of CSV.
    pub layout: Option<Spanned<String>>,
    /// Units in the header of wide CSV.
    pub units: Option<Spanned<bool>>,
    /// Leave it to the system when rows reach the disk.
    pub no_sync: Option<Spanned<bool>>,
    /// What to do about a file with other columns.
    pub on_schema_change: Option<Spanned<String>>,
    /// Leave out rows without any value.
    pub skip_failed: Option<Spanned<bool>>,
}
