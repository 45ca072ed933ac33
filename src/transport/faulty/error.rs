//! What can be wrong with a fault script.

use std::fmt;

use thiserror::Error;

/// A rule that is none.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("fault rule {place}: {problem}")]
pub struct FaultScriptError {
    /// Where it is.
    pub place: RulePlace,
    /// What is wrong with it, and what is allowed.
    pub problem: RuleProblem,
}

/// A rule and where it is. Prints as `'crc,on=0'` or `'crc,on=0' in line 3`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RulePlace {
    /// The rule as it was typed.
    pub rule: String,
    /// Its line, from 1, when it is from a file.
    pub line: Option<usize>,
}

impl fmt::Display for RulePlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // What is in a file may be anything, and this goes to a terminal.
        write!(f, "'{}'", self.rule.escape_debug())?;
        match self.line {
            Some(line) => write!(f, " in line {line}"),
            None => Ok(()),
        }
    }
}

/// What is wrong with a rule.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum RuleProblem {
    /// A fault that there is not.
    #[error("there is no fault '{}'; {}", .found.escape_debug(), names(.near))]
    UnknownKind {
        /// What was typed.
        found: String,
        /// The kinds whose names look most like it; all there are where none does.
        near: Vec<&'static str>,
    },
    /// A key that this kind of fault has no use for.
    #[error("{kind} has no use for '{}'; {}", .found.escape_debug(), names(.allowed))]
    UselessKey {
        /// The kind of fault.
        kind: &'static str,
        /// What was typed.
        found: String,
        /// The keys that look most like it; all that are allowed where none does.
        allowed: Vec<&'static str>,
    },
    /// A key that is there more than once.
    #[error("'{key}' is there more than once")]
    Repeated {
        /// The key.
        key: String,
    },
    /// A value where there is none.
    #[error("{kind} takes no value, and '{}' was found", .found.escape_debug())]
    NoValue {
        /// The kind of fault.
        kind: &'static str,
        /// What was typed.
        found: String,
    },
    /// A value that is none, or out of its range.
    #[error("{key} is '{}'; allowed is {allowed}", .found.escape_debug())]
    Value {
        /// The key, or the kind whose value it is.
        key: &'static str,
        /// What was typed; nothing when only the key was.
        found: String,
        /// What is allowed.
        allowed: &'static str,
    },
    /// `any` without a kind that it could pick.
    #[error("'any' has no fault left to pick from; allowed is to leave out some, not all")]
    NothingLeft,
}

fn names(allowed: &[&'static str]) -> String {
    match allowed {
        [one] => format!("did you mean '{one}'?"),
        many => format!("allowed are {}", many.join(", ")),
    }
}

/// The names that look most like `found`; all where none does.
pub(super) fn near(found: &str, allowed: impl Iterator<Item = &'static str>) -> Vec<&'static str> {
    const ALIKE: f64 = 0.8;
    let found = found.to_lowercase();
    let allowed: Vec<_> = allowed.collect();
    let nearest = allowed
        .iter()
        .map(|name| (strsim::jaro_winkler(&found, name), *name))
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .filter(|(score, _)| *score >= ALIKE);
    nearest.map_or(allowed, |(_, name)| vec![name])
}
