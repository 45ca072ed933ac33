//! What is wrong with a site file, and where.

use std::error::Error;
use std::fmt;
use std::io;

use thiserror::Error;

use super::path::PathError;
use crate::codec::AddressError;
use crate::profile::find::FindError;
use crate::profile::selector::SelectError;

/// A site file that is none.
#[derive(Debug, Error)]
pub enum SiteError {
    /// It cannot be read.
    #[error("site {file} cannot be read")]
    Unreadable {
        /// The file.
        file: String,
        /// What the system said.
        source: io::Error,
    },
    /// It is in another encoding than TOML has.
    #[error("{file}:{line}: not UTF-8, as TOML is: save the file in that encoding")]
    NotUtf8 {
        /// The file.
        file: String,
        /// The line of the first byte that is no UTF-8, from 1.
        line: usize,
    },
    /// Something in it is wrong.
    #[error(transparent)]
    Wrong(Box<Wrong>),
}

/// The file, the line, the key, and what is wrong there.
#[derive(Debug)]
pub struct Wrong {
    /// The file as it was named.
    pub file: String,
    /// The line, from 1.
    pub line: usize,
    /// The key at fault, `meters.main.every`; empty where there is none.
    pub key: String,
    /// What is wrong.
    pub problem: SiteProblem,
}

impl fmt::Display for Wrong {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            file,
            line,
            key,
            problem,
        } = self;
        let colon = if key.is_empty() { "" } else { ": " };
        write!(f, "{file}:{line}: {key}{colon}{problem}")
    }
}

// By hand, for the message tells the problem, and so the cause is what is behind that.
impl Error for Wrong {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        match &self.problem {
            SiteProblem::Find(error) => error.source(),
            _ => None,
        }
    }
}

/// What can be wrong with a key of a site file.
#[derive(Debug, Error)]
pub enum SiteProblem {
    /// Not TOML, an unknown key, a missing one.
    #[error("{0}")]
    Syntax(String),
    /// A value of another kind, or out of its bounds.
    #[error("{found} is not {expected}")]
    Value {
        /// What stands there.
        found: String,
        /// What could stand there.
        expected: String,
    },
    /// A name that does not look like one.
    #[error("'{0}' is no name: letters, digits, '_', '-' and '.', a letter or digit first")]
    Name(String),
    /// A second one of the same name.
    #[error("there is a {what} of this name in line {first} already")]
    Duplicate {
        /// What both are.
        what: &'static str,
        /// Line of the first.
        first: usize,
    },
    /// A name that nothing has.
    #[error("there is no {what} '{found}'; there {}", there_are(.known))]
    Unknown {
        /// What was looked for.
        what: &'static str,
        /// Its name.
        found: String,
        /// The names there are.
        known: Vec<String>,
    },
    /// A key that must be there, for there are several to choose from.
    #[error("this key is missing: {0}")]
    Needed(&'static str),
    /// Two keys that do not go together, or one that does nothing.
    #[error("{0}")]
    Conflict(&'static str),
    /// A unit that no meter, or not this one, can have.
    #[error("{0}")]
    Unit(AddressError),
    /// A selection that is none.
    #[error("{0}")]
    Select(SelectError),
    /// A profile that is none.
    #[error("{0}")]
    Find(FindError),
    /// A path that names no file.
    #[error("{0}")]
    Path(PathError),
    /// A line whose meters leave the factory with different settings.
    #[error("the meters on this line leave the factory with {}: give baud, parity and stop_bits", .0.join(" and "))]
    Settings(Vec<String>),
}

fn there_are(known: &[String]) -> String {
    match known {
        [] => "are none".to_owned(),
        [one] => format!("is {one}"),
        _ => format!("are {}", known.join(", ")),
    }
}
