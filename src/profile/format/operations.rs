//! What a meter does when it is told to, and what else there is to say about writing to it.

use serde::Deserialize;
use toml::Spanned;

use super::{LabelsKey, OnlyWithTable, verified};

/// One of `[[operations]]`: by its number, or by a value in a register.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OperationTable {
    pub(in crate::profile) name: Spanned<String>,
    pub(in crate::profile) about: String,
    pub(in crate::profile) number: Option<Spanned<u16>>,
    pub(in crate::profile) register: Option<Spanned<u16>>,
    pub(in crate::profile) value: Option<Spanned<u16>>,
    pub(in crate::profile) data: Option<Spanned<DataTable>>,
    pub(in crate::profile) hazard: Option<Spanned<String>>,
    pub(in crate::profile) broadcast: Option<Spanned<String>>,
    pub(in crate::profile) only_with: Option<OnlyWithTable>,
    #[serde(default = "verified")]
    pub(in crate::profile) verified: bool,
    #[serde(default)]
    pub(in crate::profile) page: String,
}

/// What goes with the number of an operation.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DataTable {
    #[serde(rename = "type")]
    pub(in crate::profile) kind: Spanned<String>,
    #[serde(default)]
    pub(in crate::profile) about: String,
    pub(in crate::profile) labels: Option<Spanned<LabelsKey>>,
    pub(in crate::profile) range: Option<Spanned<Vec<i64>>>,
}

/// `[command_registers]`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CommandRegistersTable {
    pub(in crate::profile) address: Spanned<u16>,
    pub(in crate::profile) code: u16,
}

/// `[clock]`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ClockTable {
    pub(in crate::profile) time: Spanned<String>,
    pub(in crate::profile) date: Spanned<String>,
}

/// One of `[[distinct]]`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DistinctTable {
    pub(in crate::profile) of: Spanned<Vec<Spanned<String>>>,
    #[serde(default)]
    pub(in crate::profile) except: Vec<u16>,
    pub(in crate::profile) about: String,
}
