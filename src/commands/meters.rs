//! `meters`: what the program knows.

use super::{CommandError, ExitCode, print, report};
use crate::output::columns::columns;
use crate::profile::{Profile, builtin, find};

/// Lists the meters inside the program and the user's own.
pub(super) fn list() -> Result<ExitCode, CommandError> {
    let mut lines: Vec<Vec<String>> = Vec::new();
    for meter in builtin::all() {
        lines.push(line(&meter.profile(), "built in"));
    }
    for path in find::own_files() {
        match find::file(&path) {
            Ok(profile) => lines.push(line(&profile, &path.display().to_string())),
            Err(error) => report::warning(&error.to_string()),
        }
    }
    lines.sort();
    let header = ["NAME", "METER", "POINTS", "LINE", "FROM"];
    print(columns(&header, &[2], lines).as_bytes())
}

fn line(profile: &Profile, from: &str) -> Vec<String> {
    vec![
        profile.name.clone(),
        profile.title.clone(),
        profile.points.len().to_string(),
        profile.line.to_string(),
        from.to_owned(),
    ]
}
