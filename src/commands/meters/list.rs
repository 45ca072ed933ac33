//! `meters list`: the meters that can be named.

use crate::commands::report::Report;
use crate::commands::{CommandError, ExitCode, print};
use crate::output::columns::columns;
use crate::output::escape;
use crate::profile::{Profile, builtin, find};

/// Lists the meters that can be named: the user's own, and those inside the program that no own
/// one replaces. One that does not load is told, and the others are listed all the same.
pub(super) fn run(report: &mut Report) -> Result<ExitCode, CommandError> {
    let mut lines: Vec<Vec<String>> = Vec::new();
    let mut end = ExitCode::Done;
    let own = find::own_files();
    for path in &own {
        match find::own(path) {
            Ok(profile) => lines.push(line(&profile, &path.display().to_string())),
            Err(error) => end = report.error(&error.into()),
        }
    }
    for meter in builtin::all() {
        let is_replaced = own
            .iter()
            .any(|path| path.file_stem().is_some_and(|name| name == meter.name));
        if !is_replaced {
            lines.push(line(&meter.profile(), "built in"));
        }
    }
    lines.sort();
    let header = ["NAME", "METER", "POINTS", "VERIFIED", "LINE", "FROM"];
    print(columns(&header, &[2, 3], lines).as_bytes())?;
    Ok(end)
}

fn line(profile: &Profile, from: &str) -> Vec<String> {
    let verified = profile.points.iter().filter(|point| point.verified);
    vec![
        profile.name.clone(),
        escape(&profile.title),
        profile.points.len().to_string(),
        verified.count().to_string(),
        profile.line.to_string(),
        from.to_owned(),
    ]
}
