//! `meters show`: what a meter is, and what its points are.

use std::io::{self, IsTerminal};

use crate::cli::{ShowFormat, ShowMeter};
use crate::commands::report::Report;
use crate::commands::{CommandError, ExitCode, print};
use crate::output::profile::{Extent, Shown};
use crate::profile::find;
use crate::profile::selector::{Purpose, Reading, select};

/// Prints the meter, or those of its points that were asked for.
pub(super) fn run(arguments: &ShowMeter, report: &Report) -> Result<ExitCode, CommandError> {
    let profile = find::find(&arguments.meter)?;
    let reading = Reading {
        profile: Some(&profile),
        purpose: Purpose::LookUp,
        ..Reading::default()
    };
    let points = select(&arguments.what, reading)?;
    let shown = Shown {
        profile: &profile,
        points: &points,
    };
    let text = match arguments.format {
        ShowFormat::Table => {
            let extent = match (report.is_quiet(), arguments.what.is_empty()) {
                (true, _) => Extent::Bare,
                (false, true) => Extent::Whole,
                (false, false) => Extent::Points,
            };
            shown.text(extent).into_bytes()
        }
        ShowFormat::Csv => {
            let terminal = io::stdout().is_terminal();
            shown.csv(terminal).map_err(CommandError::Output)?
        }
        ShowFormat::Json => shown.json().map_err(CommandError::Output)?.into_bytes(),
    };
    print(&text)
}
