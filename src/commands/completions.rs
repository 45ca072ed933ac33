//! `completions`: a shell's completion script.

use super::{CommandError, ExitCode, print};
use crate::cli::{self, Completions};

/// Prints the script for the shell.
pub(super) fn print_script(arguments: &Completions) -> Result<ExitCode, CommandError> {
    print(&cli::completion_script(arguments.shell))
}
