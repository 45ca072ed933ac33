//! `--list`: what a meter can do.

use crate::commands::{CommandError, ExitCode, print};
use crate::output::operations::table;
use crate::profile::Profile;

/// Prints the operations of a meter.
pub(super) fn list(profile: &Profile) -> Result<ExitCode, CommandError> {
    if profile.operations.is_empty() {
        return Err(CommandError::NoOperations {
            meter: profile.name.clone(),
        });
    }
    print(table(&profile.operations).as_bytes())
}
