//! `meters export`: the text of a profile, to begin one's own with.

use crate::cli::ExportMeter;
use crate::commands::{CommandError, ExitCode, print};
use crate::profile::find;

/// Prints the profile as it stands in its file.
pub(super) fn run(arguments: &ExportMeter) -> Result<ExitCode, CommandError> {
    print(find::origin(&arguments.meter)?.text()?.as_bytes())
}
