//! Names of files that change with the meter and the time.

use std::path::PathBuf;

use jiff::Timestamp;
use jiff::fmt::strtime;
use thiserror::Error;

/// Where the name of the meter goes.
const METER: &str = "{meter}";

/// A path with `{meter}` and the fields of strftime in it, `log/{meter}-%Y-%m.csv`. Times are in UTC.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PathTemplate {
    /// What it is relative to; empty for the working directory.
    folder: PathBuf,
    text: String,
}

/// A path that names no file.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum PathError {
    /// Nothing is there.
    #[error("it is empty")]
    Empty,
    /// It is no text.
    #[error("it is not UTF-8")]
    NotUtf8,
    /// A field that strftime does not have.
    #[error("{0}")]
    Field(String),
    /// Something else than `{meter}` in braces.
    #[error("only {{meter}} can stand in braces")]
    Braces,
}

impl PathTemplate {
    /// Checks a path; a relative one is below `folder`.
    ///
    /// # Errors
    /// [`PathError`].
    pub fn new(folder: impl Into<PathBuf>, text: &str) -> Result<Self, PathError> {
        if text.is_empty() {
            return Err(PathError::Empty);
        }
        if text.replace(METER, "").contains(['{', '}']) {
            return Err(PathError::Braces);
        }
        let template = Self {
            folder: folder.into(),
            text: text.to_owned(),
        };
        template
            .filled("", Timestamp::UNIX_EPOCH)
            .map_err(|error| PathError::Field(error.to_string()))?;
        Ok(template)
    }

    /// As it was written.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Whether each meter has a file of its own.
    pub fn names_the_meter(&self) -> bool {
        self.text.contains(METER)
    }

    /// The file for a meter at a time.
    pub fn at(&self, meter: &str, time: Timestamp) -> PathBuf {
        // What was checked holds at any time: fields depend on nothing else.
        let name = self.filled(meter, time);
        self.folder.join(name.unwrap_or_else(|_| self.text.clone()))
    }

    fn filled(&self, meter: &str, time: Timestamp) -> Result<String, jiff::Error> {
        // The name of the meter is put in last: it may hold anything.
        let parts = self.text.split(METER);
        let parts = parts.map(|part| strtime::format(part, time));
        let parts: Vec<String> = parts.collect::<Result<_, _>>()?;
        Ok(parts.join(meter))
    }
}
