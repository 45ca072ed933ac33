//! What is wrong with a profile, and where.

use thiserror::Error;

/// A profile that does not load: the file, the line, the key, and what is wrong there.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{file}:{line}: {key}{}{problem}", if .key.is_empty() { "" } else { ": " })]
pub struct ProfileError {
    /// The file as it was named, or the built-in meter's.
    pub file: String,
    /// The line, from 1.
    pub line: usize,
    /// The key at fault, `current_a.address`; empty where there is none.
    pub key: String,
    /// What is wrong.
    pub problem: Box<Problem>,
}

/// What can be wrong with a key of a profile.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum Problem {
    /// Not TOML, an unknown key, or a value of another kind.
    #[error("{0}")]
    Syntax(String),
    /// A name that does not look like one.
    #[error("'{0}' is no name: small letters, digits and '_', a letter first")]
    Name(String),
    /// A second point of the same name.
    #[error("there is a point of this name in line {first} already")]
    DuplicateName {
        /// Line of the first.
        first: usize,
    },
    /// A second operation that has what another has.
    #[error("there is an operation of this {what} in line {first} already")]
    DuplicateOperation {
        /// What both have.
        what: &'static str,
        /// Line of the first.
        first: usize,
    },
    /// Two points on the same registers, neither of them read alone.
    #[error("{range} overlaps {other} in line {line}; if both are meant, set alone = true on one")]
    Overlap {
        /// The registers of this one.
        range: String,
        /// The name of the other.
        other: String,
        /// The line of the other.
        line: usize,
    },
    /// Registers past the last address, or past the end of the meter's table.
    #[error("{count} registers from 0x{start:04X} run past {end}")]
    PastEnd {
        /// First register.
        start: u16,
        /// Number of registers.
        count: u16,
        /// What they run past.
        end: String,
    },
    /// A point that takes more registers than the meter gives in one read.
    #[error("takes {count} registers, and the meter gives {most} in one read")]
    TooWide {
        /// Registers of the point.
        count: u16,
        /// The meter's limit.
        most: u16,
    },
    /// A value out of its bounds.
    #[error("{found} is not {expected}")]
    Value {
        /// What stands there.
        found: String,
        /// What could stand there.
        expected: String,
    },
    /// A name that nothing has.
    #[error("there is no {what} '{found}'")]
    Unknown {
        /// What was looked for.
        what: &'static str,
        /// Its name.
        found: String,
    },
    /// A factor that follows from itself.
    #[error("goes round in a circle: {0}")]
    Cycle(String),
    /// Two keys that do not go together.
    #[error("{0}")]
    Conflict(&'static str),
    /// The same code or bit named twice.
    #[error("{code} is named twice, '{first}' and '{second}'")]
    LabelClash {
        /// The code as it is written.
        code: String,
        /// The first name.
        first: String,
        /// The second name.
        second: String,
    },
}
