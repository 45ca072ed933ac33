//! Names to go on with where a file holds something else.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// The highest number: nobody changes columns so often.
const HIGHEST: u32 = 9999;

/// `name.csv`, `name.2.csv`, `name.3.csv` and on.
pub(super) fn names(path: &Path) -> impl Iterator<Item = PathBuf> {
    std::iter::once(path.to_owned()).chain((2..=HIGHEST).map(|number| name(path, number)))
}

fn name(path: &Path, number: u32) -> PathBuf {
    let mut name = path.file_stem().map(OsString::from).unwrap_or_default();
    name.push(format!(".{number}"));
    if let Some(ending) = path.extension() {
        name.push(".");
        name.push(ending);
    }
    path.with_file_name(name)
}
