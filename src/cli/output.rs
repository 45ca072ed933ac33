//! Options about files that rows are appended to.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::values::file;

/// The file rows are appended to.
#[derive(Debug, Args)]
#[command(next_help_heading = "File")]
pub struct OutputArguments {
    /// Append the rows to this file and print none: as csv, or jsonl or influx with --format
    ///
    /// Its folders are made. All rows of a run go in together, or none does, under a lock, so that
    /// several runs can share a file. The header comes before the first row alone. A last line that
    /// was never finished, as after a power cut, is removed, and stderr says what it was. A file with
    /// other columns, or that holds something else, is not touched.
    #[arg(short, long, value_name = "FILE", value_parser = file)]
    pub output: Option<PathBuf>,
    /// What to do about a file with other columns, or that holds something else
    #[arg(
        long,
        value_name = "WHAT",
        default_value = "refuse",
        requires = "output"
    )]
    pub on_schema_change: SchemaChange,
    /// Leave it to the system when rows reach the disk: less wear of flash memory, and a power cut
    /// can take the last ones
    #[arg(long, requires = "output")]
    pub no_sync: bool,
}

/// `--on-schema-change`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SchemaChange {
    /// Write nothing, and end with code 7
    Refuse,
    /// Go on in name.2.csv, name.3.csv and on, the first that fits
    NewFile,
}
