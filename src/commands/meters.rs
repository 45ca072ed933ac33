//! `meters`: what the program knows about meters.

mod check;
mod export;
mod list;
mod show;
mod verify;

use super::report::Report;
use super::{CommandError, ExitCode};
use crate::cli::{Meters, MetersCommand};

/// Does what was asked for with the meters, or lists them.
pub(super) fn run(arguments: &Meters, report: &mut Report) -> Result<ExitCode, CommandError> {
    match &arguments.command {
        None | Some(MetersCommand::List) => list::run(report),
        Some(MetersCommand::Show(arguments)) => show::run(arguments, report),
        Some(MetersCommand::Export(arguments)) => export::run(arguments),
        Some(MetersCommand::Check(arguments)) => check::run(arguments, report),
        Some(MetersCommand::Verify(arguments)) => verify::run(arguments, report),
    }
}
