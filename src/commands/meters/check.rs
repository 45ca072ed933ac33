//! `meters check`: whether profile files load, and what they may lack all the same.

use std::fmt::Write;
use std::path::Path;

use crate::cli::CheckMeters;
use crate::commands::report::Report;
use crate::commands::{CommandError, ExitCode, print};
use crate::output::escape;
use crate::output::profile::count;
use crate::profile::advice::advise;
use crate::profile::find::{self, FindError};
use crate::words::counted;

/// Checks every file, whatever is wrong with the others.
pub(super) fn run(arguments: &CheckMeters, report: &mut Report) -> Result<ExitCode, CommandError> {
    let mut end = ExitCode::Done;
    for file in &arguments.files {
        match check(file, report.is_quiet()) {
            Ok(text) => drop(print(text.as_bytes())?),
            Err(error) => end = report.error(&error.into()),
        }
    }
    Ok(end)
}

/// What a profile is, and advice about it, a line each.
fn check(file: &Path, is_quiet: bool) -> Result<String, FindError> {
    let name = file.display().to_string();
    let (profile, advice) = advise(&name, &find::text(file)?)?;
    let mut text = String::new();
    if !is_quiet {
        let groups = match profile.groups.len() {
            0 => "no groups".to_owned(),
            count => counted(count, "group", "groups"),
        };
        let title = escape(&profile.title);
        let points = count(&profile.points);
        text = format!("{name}: {} ({title}), {points}, {groups}\n", profile.name);
    }
    for advice in advice {
        let _ = writeln!(
            text,
            "{name}:{}: {}",
            advice.line,
            escape(&format!("{}: {}", advice.key, advice.matter))
        );
    }
    Ok(text)
}
