//! From words to arguments, or to what is said in their place.

use std::ffi::OsString;
use std::io;

use clap::{CommandFactory, Parser};
use clap_complete::{Shell, generate};

use super::Arguments;

/// What there is to say in place of arguments: what is wrong with the command line, or the help or
/// version that it asked for.
#[derive(Debug)]
pub struct Usage(clap::Error);

impl Usage {
    /// Whether the command line is wrong, and not a question for help or version.
    pub fn is_error(&self) -> bool {
        self.0.use_stderr()
    }

    /// Prints it: help and version on stdout, errors on stderr.
    ///
    /// # Errors
    /// What the stream says.
    pub fn print(&self) -> io::Result<()> {
        self.0.print()
    }
}

/// Reads a command line, the program's own name first.
///
/// # Errors
/// [`Usage`] when there is nothing to run.
pub fn parse(arguments: impl IntoIterator<Item = OsString>) -> Result<Arguments, Usage> {
    Arguments::try_parse_from(arguments).map_err(Usage)
}

/// The completion script of a shell.
pub fn completion_script(shell: Shell) -> Vec<u8> {
    let mut script = Vec::new();
    generate(shell, &mut Arguments::command(), "meterpoll", &mut script);
    script
}
