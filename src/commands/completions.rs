//! `completions`: a shell's completion script.

use clap::CommandFactory;
use clap_complete::{Shell, generate};

use super::{CommandError, ExitCode, print};
use crate::cli::Arguments;

/// Prints the script for `shell`.
pub(super) fn print_script(shell: Shell) -> Result<ExitCode, CommandError> {
    let mut script = Vec::new();
    generate(shell, &mut Arguments::command(), "meterpoll", &mut script);
    print(&script)
}
