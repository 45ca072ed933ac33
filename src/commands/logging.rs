//! What is being done, on stderr, as much of it as was asked for.

use std::io::Write;

use log::LevelFilter;

use crate::cli::Verbosity;

/// Starts logging: warnings as a rule, none with `-q`, what is done with `-v`, frames with `-vv`.
pub(super) fn start(verbosity: Verbosity) {
    let level = match verbosity {
        Verbosity { quiet: true, .. } => LevelFilter::Error,
        Verbosity { verbose: 0, .. } => LevelFilter::Warn,
        Verbosity { verbose: 1, .. } => LevelFilter::Info,
        Verbosity { .. } => LevelFilter::Trace,
    };
    // Where somebody else logs already, as a program around this library may, that stays.
    let _ = env_logger::Builder::new()
        .filter_module("meterpoll", level)
        .format(|out, record| writeln!(out, "{}", record.args()))
        .try_init();
}
