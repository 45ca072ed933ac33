//! Arguments of `meters` and its commands.

use clap::{Args, Subcommand};

/// Arguments of `meters`.
#[derive(Debug, Args)]
pub struct Meters {
    /// What to do with them; list them when left out
    #[command(subcommand)]
    pub command: Option<MetersCommand>,
}

/// The commands of `meters`.
#[derive(Debug, Subcommand)]
pub enum MetersCommand {
    /// List the meters inside the program and your own
    List,
    /// Print the profile of a meter as the TOML file that it is
    Export(ExportMeter),
}

const EXPORT_EXAMPLES: &str = "\
Examples:
  meterpoll meters export pqm > mine.toml
  meterpoll read-registers -p /dev/ttyUSB0 -a 17 --meter mine.toml";

/// Arguments of `meters export`.
#[derive(Debug, Args)]
#[command(after_help = EXPORT_EXAMPLES)]
pub struct ExportMeter {
    /// A name that `meters list` shows, or a profile file
    #[arg(value_name = "METER")]
    pub meter: String,
}
