//! From what a person types after `--meter` to a profile: a file, one of the user's own, or one
//! inside the program.

use std::borrow::Cow;
use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

use super::builtin::{self, Builtin};
use super::error::ProfileError;
use super::load;
use super::model::Profile;

/// Why there is no such profile.
#[derive(Debug, Error)]
pub enum FindError {
    /// No meter of that name.
    #[error("there is no meter '{name}'; known are {}", .known.join(", "))]
    Unknown {
        /// The name given.
        name: String,
        /// All names there are.
        known: Vec<String>,
    },
    /// The file cannot be read.
    #[error("profile {file} cannot be read")]
    Unreadable {
        /// The file.
        file: String,
        /// What the system said.
        source: io::Error,
    },
    /// The file is in another encoding than TOML has.
    #[error("{file}:{line}: not UTF-8, as TOML is: save the file in that encoding")]
    NotUtf8 {
        /// The file.
        file: String,
        /// The line of the first byte that is no UTF-8, from 1.
        line: usize,
    },
    /// One of the user's own is named otherwise than its file.
    #[error("profile {file} has name = \"{name}\", and its file says otherwise")]
    Misnamed {
        /// The file.
        file: String,
        /// The name in it.
        name: String,
    },
    /// The file does not load.
    #[error(transparent)]
    Invalid(#[from] ProfileError),
}

/// Where a profile is.
#[derive(Debug, Clone)]
pub enum Origin {
    /// A file, named by its path.
    File(PathBuf),
    /// A file of the user's own, found by its name.
    Own(PathBuf),
    /// Inside the program.
    BuiltIn(Builtin),
}

impl Origin {
    /// Loads it.
    ///
    /// # Errors
    /// What [`file()`] or [`own`] find.
    pub fn profile(&self) -> Result<Profile, FindError> {
        match self {
            Self::File(path) => file(path),
            Self::Own(path) => own(path),
            Self::BuiltIn(meter) => Ok(meter.profile()),
        }
    }

    /// The text it is loaded from, right or wrong.
    ///
    /// # Errors
    /// [`FindError::Unreadable`] or [`FindError::NotUtf8`].
    pub fn text(&self) -> Result<Cow<'static, str>, FindError> {
        match self {
            Self::File(path) | Self::Own(path) => text(path).map(Cow::Owned),
            Self::BuiltIn(meter) => Ok(Cow::Borrowed(meter.text)),
        }
    }
}

/// Finds a profile and loads it.
///
/// # Errors
/// [`FindError`] tells an unknown name, an unreadable file and a wrong one apart.
pub fn find(meter: &str) -> Result<Profile, FindError> {
    let origin = origin(meter)?;
    if let Origin::File(path) | Origin::Own(path) = &origin {
        log::info!("the profile is {}", path.display());
    }
    origin.profile()
}

/// Finds a profile. What looks like a path (a separator in it, or `.toml` at its end) is a file;
/// else the user's own come before the program's.
///
/// # Errors
/// [`FindError::Unknown`].
pub fn origin(meter: &str) -> Result<Origin, FindError> {
    let path = Path::new(meter);
    if meter.contains(std::path::is_separator) || is_toml(path) {
        return Ok(Origin::File(path.to_owned()));
    }
    if let Some(path) = own_folder().map(|folder| folder.join(format!("{meter}.toml")))
        && is_there(&path)
    {
        return Ok(Origin::Own(path));
    }
    let built_in = builtin::find(meter).map(Origin::BuiltIn);
    built_in.ok_or_else(|| FindError::Unknown {
        name: meter.to_owned(),
        known: names(),
    })
}

/// All meters that can be named: the user's own and the program's, each once, by name.
pub fn names() -> Vec<String> {
    let mut names: Vec<String> = own_files()
        .iter()
        .filter_map(|path| Some(path.file_stem()?.to_str()?.to_owned()))
        .chain(builtin::all().iter().map(|meter| meter.name.to_owned()))
        .collect();
    names.sort_unstable();
    names.dedup();
    names
}

/// The user's own profiles, by name.
pub fn own_files() -> Vec<PathBuf> {
    let entries = own_folder().and_then(|folder| std::fs::read_dir(folder).ok());
    let mut files: Vec<PathBuf> = entries
        .into_iter()
        .flatten()
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| is_toml(path))
        .collect();
    files.sort_unstable();
    files
}

/// Loads one of the user's own: it is found by its file's name, so that must be its name.
///
/// # Errors
/// What [`file()`] finds, or [`FindError::Misnamed`].
pub fn own(path: &Path) -> Result<Profile, FindError> {
    let profile = file(path)?;
    if path.file_stem().and_then(|stem| stem.to_str()) == Some(&profile.name) {
        return Ok(profile);
    }
    Err(FindError::Misnamed {
        file: path.display().to_string(),
        name: profile.name,
    })
}

/// Loads a profile from a file.
///
/// # Errors
/// [`FindError::Unreadable`], [`FindError::NotUtf8`] or [`FindError::Invalid`].
pub fn file(path: &Path) -> Result<Profile, FindError> {
    let text = text(path)?;
    Ok(load::load(&path.display().to_string(), &text)?)
}

/// Reads a profile's file.
///
/// # Errors
/// [`FindError::Unreadable`] or [`FindError::NotUtf8`].
pub fn text(path: &Path) -> Result<String, FindError> {
    let file = || path.display().to_string();
    let bytes = std::fs::read(path).map_err(|source| FindError::Unreadable {
        file: file(),
        source,
    })?;
    String::from_utf8(bytes).map_err(|error| {
        let good = error.utf8_error().valid_up_to();
        let before = error.as_bytes().iter().take(good);
        FindError::NotUtf8 {
            file: file(),
            line: before.filter(|byte| **byte == b'\n').count() + 1,
        }
    })
}

/// Whether there is anything of that name, a broken link included: an own profile that cannot be
/// read is an error, not a reason to take another meter.
fn is_there(path: &Path) -> bool {
    match path.symlink_metadata() {
        Ok(_) => true,
        Err(error) => !matches!(
            error.kind(),
            io::ErrorKind::NotFound | io::ErrorKind::NotADirectory
        ),
    }
}

fn is_toml(path: &Path) -> bool {
    path.extension().is_some_and(|end| end == "toml")
}

/// `meterpoll/meters` in the user's configuration folder.
fn own_folder() -> Option<PathBuf> {
    let set = |name| std::env::var_os(name).filter(|value| !value.is_empty());
    let config = match set("XDG_CONFIG_HOME") {
        Some(folder) => PathBuf::from(folder),
        None if cfg!(windows) => PathBuf::from(set("APPDATA")?),
        None => PathBuf::from(set("HOME")?).join(".config"),
    };
    Some(config.join("meterpoll").join("meters"))
}
