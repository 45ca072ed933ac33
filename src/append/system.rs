//! Files by their names: opened, made, and whether a name is still theirs.

use std::fs::{self, File, Metadata, OpenOptions};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use super::error::Problem;

/// Opens a file for reading and appending; `None` when there is none.
pub(super) fn open(path: &Path) -> Result<Option<File>, Problem> {
    // Before it is opened: opening a pipe can wait for ever.
    match fs::metadata(path) {
        Ok(found) => plain(&found)?,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(Problem::Open(error)),
    }
    match options().open(path) {
        Ok(file) => Ok(Some(checked(file)?)),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(Problem::Open(error)),
    }
}

/// Makes a file, and the folders it is in; opens one that somebody else has just made. Returns as
/// well which folders have a new name in them.
pub(super) fn make(path: &Path) -> Result<(File, Vec<PathBuf>), Problem> {
    let own = folder(path);
    let mut folders = vec![own.to_owned()];
    let mut missing = own;
    while !missing.exists() && folder(missing) != missing {
        missing = folder(missing);
        folders.push(missing.to_owned());
    }
    fs::create_dir_all(own).map_err(|source| Problem::NoPlace {
        folder: own.to_owned(),
        source,
    })?;
    let file = options().create(true).open(path).map_err(Problem::Open)?;
    Ok((checked(file)?, folders))
}

/// Brings new names in folders to the disk. The rows are there in any case; and some file systems
/// take no such request, for theirs are.
pub(super) fn sync_folders(folders: &[PathBuf]) {
    for folder in folders {
        let _ = File::open(folder).and_then(|folder| folder.sync_all());
    }
}

/// Removes a file that was made for rows that could not be written. Its lock is ours, so nobody has
/// written to it, and who waits for the lock finds the name gone. Where it stays, it is empty.
pub(super) fn unmake(file: &File, path: &Path) {
    let is_empty = file.metadata().is_ok_and(|found| found.len() == 0);
    // The name may be a link that was there before.
    let is_ours = fs::symlink_metadata(path).is_ok_and(|found| found.is_file());
    if is_empty && is_ours {
        let _ = fs::remove_file(path);
    }
}

/// Whether a file could be made, as far as that shows without making it.
pub(super) fn may_make(path: &Path) -> Result<(), Problem> {
    let mut folder = folder(path);
    loop {
        let problem = |source| Problem::NoPlace {
            folder: folder.to_owned(),
            source,
        };
        match fs::metadata(folder) {
            Ok(found) if found.is_dir() => return may_write(folder).map_err(problem),
            Ok(_) => return Err(problem(ErrorKind::NotADirectory.into())),
            Err(error) => match self::folder(folder) {
                above if error.kind() == ErrorKind::NotFound && above != folder => folder = above,
                _ => return Err(problem(error)),
            },
        }
    }
}

/// The folder a path is in.
fn folder(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if folder.as_os_str().is_empty() => Path::new("."),
        Some(folder) => folder,
        // The root is in itself.
        None => path,
    }
}

fn checked(file: File) -> Result<File, Problem> {
    plain(&file.metadata().map_err(Problem::Open)?)?;
    Ok(file)
}

fn plain(found: &Metadata) -> Result<(), Problem> {
    match found {
        _ if found.is_file() => Ok(()),
        _ if found.is_dir() => Err(Problem::Folder),
        _ => Err(Problem::Device),
    }
}

#[cfg(unix)]
fn options() -> OpenOptions {
    use std::os::unix::fs::OpenOptionsExt;

    use rustix::fs::OFlags;

    // For what has become a pipe or a terminal since it was looked at.
    let flags = OFlags::NONBLOCK | OFlags::NOCTTY;
    let mut options = OpenOptions::new();
    options.read(true).append(true);
    options.custom_flags(flags.bits().cast_signed());
    options
}

#[cfg(not(unix))]
fn options() -> OpenOptions {
    let mut options = OpenOptions::new();
    options.read(true).append(true);
    options
}

/// Whether an open file is still the one of that name.
#[cfg(unix)]
pub(super) fn is_at(file: &File, path: &Path) -> Result<bool, Problem> {
    use std::os::unix::fs::MetadataExt;

    let identity = |found: &Metadata| (found.dev(), found.ino());
    let ours = file.metadata().map_err(Problem::Open)?;
    match fs::metadata(path) {
        Ok(found) => Ok(identity(&found) == identity(&ours)),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(false),
        Err(error) => Err(Problem::Open(error)),
    }
}

/// Elsewhere a file that is open keeps its name.
#[cfg(not(unix))]
pub(super) fn is_at(_: &File, path: &Path) -> Result<bool, Problem> {
    path.try_exists().map_err(Problem::Open)
}

#[cfg(unix)]
fn may_write(folder: &Path) -> io::Result<()> {
    use rustix::fs::{Access, access};

    Ok(access(folder, Access::WRITE_OK | Access::EXEC_OK)?)
}

#[cfg(not(unix))]
fn may_write(_: &Path) -> io::Result<()> {
    Ok(())
}
