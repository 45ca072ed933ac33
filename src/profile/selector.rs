//! What a person types to choose what is read: point names, globs, groups, raw registers.

mod raw;

use std::collections::HashMap;

use thiserror::Error;
use wildmatch::WildMatch;

use super::model::Profile;
use super::point::Point;
use crate::codec::{AddressError, ReadFunction};

/// How register numbers are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Numbering {
    /// Protocol addresses, from 0.
    #[default]
    Protocol,
    /// 30001 and 300001 for the first input register, 40001 and 400001 for the first holding
    /// register. Numbers with `0x` stay protocol addresses.
    Modicon,
}

/// What points are chosen for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Purpose {
    /// To be read: registers by address can be named as well, and points that can only be written
    /// are left out.
    #[default]
    Read,
    /// To be looked up: any point of the meter, and nothing else.
    LookUp,
    /// To be written: points that can be, and registers by address.
    Write,
}

/// Why a selection is not one.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum SelectError {
    /// Not a name, a group or a register.
    #[error("{}{problem}", unless_named(.selector, .problem))]
    Malformed {
        /// What was typed.
        selector: String,
        /// What is wrong with it.
        problem: String,
    },
    /// Registers that cannot be.
    #[error("'{selector}': {problem}")]
    Address {
        /// What was typed.
        selector: String,
        /// What is wrong with it.
        problem: AddressError,
    },
    /// A name that no point has.
    #[error("{meter} has no point '{name}'{}", nearest(.near))]
    UnknownPoint {
        /// The meter.
        meter: String,
        /// The name.
        name: String,
        /// Names that look like it.
        near: Vec<String>,
        /// The groups there are.
        groups: Vec<String>,
    },
    /// A point with what only an address can have.
    #[error("'{selector}': {name} has its type and unit from the meter's profile")]
    PointForm {
        /// What was typed.
        selector: String,
        /// The point.
        name: String,
    },
    /// Registers in a row, one of which must be read by a request of its own or means something else
    /// then: it is not clear what was meant.
    #[error("'{selector}': the meter's {name} lies there, which is read by a request of its own")]
    Lonely {
        /// What was typed.
        selector: String,
        /// The point.
        name: String,
    },
    /// A group that the meter does not have.
    #[error("{meter} has no group '@{name}'; its groups are {}", .known.join(", "))]
    UnknownGroup {
        /// The meter.
        meter: String,
        /// The name.
        name: String,
        /// The groups there are.
        known: Vec<String>,
    },
    /// A glob that matches no point.
    #[error("no point of {meter} matches '{glob}'")]
    NoMatch {
        /// The meter.
        meter: String,
        /// The glob.
        glob: String,
        /// The groups there are.
        groups: Vec<String>,
    },
    /// A Modicon number of one table, and the function of the other.
    #[error(
        "'{selector}' is read with function {implied:02}, and function {typed:02} was asked for"
    )]
    FunctionClash {
        /// What was typed.
        selector: String,
        /// The function its number implies.
        implied: u8,
        /// The function that was asked for.
        typed: u8,
    },
    /// A point that can only be written.
    #[error("{name} can only be written")]
    WriteOnly {
        /// The point.
        name: String,
    },
    /// A point that can only be read.
    #[error("{name} can only be read")]
    ReadOnly {
        /// The point.
        name: String,
    },
    /// A register by address, where points are looked up.
    #[error("'{selector}' is no point of {meter}")]
    NoPoint {
        /// What was typed.
        selector: String,
        /// The meter.
        meter: String,
    },
    /// A point or group, but no meter.
    #[error("'{selector}' is no register, and without a meter there are no points")]
    NoMeter {
        /// What was typed.
        selector: String,
    },
    /// Nothing typed and nothing to fall back to.
    #[error("nothing to read: {reason}")]
    Nothing {
        /// Why not.
        reason: String,
    },
    /// Groups without members, where points are looked up.
    #[error("there is no point in {selectors}")]
    Empty {
        /// What was typed.
        selectors: String,
    },
}

/// The selector, for a problem that does not name it itself.
fn unless_named(selector: &str, problem: &str) -> String {
    let quoted = format!("'{selector}'");
    if problem.starts_with(&quoted) {
        String::new()
    } else {
        format!("{quoted}: ")
    }
}

fn nearest(near: &[String]) -> String {
    if near.is_empty() {
        String::new()
    } else {
        format!("; did you mean {}?", near.join(", "))
    }
}

/// How selectors are read.
#[derive(Debug, Clone, Copy, Default)]
pub struct Reading<'a> {
    /// How register numbers are written.
    pub numbering: Numbering,
    /// The function raw registers are read with, where one was asked for.
    pub function: Option<ReadFunction>,
    /// The meter whose points can be named.
    pub profile: Option<&'a Profile>,
    /// What the points are for.
    pub purpose: Purpose,
}

impl Reading<'_> {
    /// Whether a point can be chosen.
    fn takes(&self, point: &Point) -> bool {
        match self.purpose {
            Purpose::Read => point.access.readable(),
            Purpose::LookUp => true,
            Purpose::Write => point.access.writable(),
        }
    }
}

/// The points that `selectors` choose, in their order, each once. Without any, those of the default
/// group are read, and all are looked up.
///
/// # Errors
/// [`SelectError`] for the first selector that chooses nothing.
pub fn select(selectors: &[String], reading: Reading<'_>) -> Result<Vec<Point>, SelectError> {
    let default = match reading.purpose {
        Purpose::Read => [format!("@{}", Profile::DEFAULT_GROUP)],
        Purpose::LookUp | Purpose::Write => ["*".to_owned()],
    };
    let selectors = if selectors.is_empty() {
        is_default_there(reading)?;
        &default
    } else {
        selectors
    };
    let mut points: Vec<Point> = Vec::new();
    let mut named: HashMap<String, Vec<usize>> = HashMap::new();
    for selector in selectors {
        for point in one(selector, reading)? {
            let alike = named.entry(point.name.clone()).or_default();
            if !alike.iter().any(|index| points.get(*index) == Some(&point)) {
                alike.push(points.len());
                points.push(point);
            }
        }
    }
    if points.is_empty() {
        let selectors = selectors.join(" ");
        return Err(match reading.purpose {
            Purpose::Read => SelectError::Nothing {
                reason: format!("{selectors} has no point that can be read"),
            },
            Purpose::LookUp | Purpose::Write => SelectError::Empty { selectors },
        });
    }
    Ok(points)
}

fn is_default_there(reading: Reading<'_>) -> Result<(), SelectError> {
    let reason = match reading.profile {
        None => "name registers such as 0x0000+10, or a meter with --meter".to_owned(),
        Some(profile)
            if reading.purpose == Purpose::Read
                && profile.group(Profile::DEFAULT_GROUP).is_none() =>
        {
            format!("{} has no group @default, so name points", profile.name)
        }
        Some(_) => return Ok(()),
    };
    Err(SelectError::Nothing { reason })
}

pub(super) fn one(selector: &str, reading: Reading<'_>) -> Result<Vec<Point>, SelectError> {
    if selector.starts_with(|first: char| first.is_ascii_digit()) {
        return match (reading.purpose, reading.profile) {
            (Purpose::LookUp, Some(profile)) => Err(SelectError::NoPoint {
                selector: selector.to_owned(),
                meter: profile.name.clone(),
            }),
            _ => raw::registers(selector, reading),
        };
    }
    let Some(profile) = reading.profile else {
        return Err(SelectError::NoMeter {
            selector: selector.to_owned(),
        });
    };
    let meter = profile.name.clone();
    if let Some(name) = selector.strip_prefix('@') {
        let Some(group) = profile.group(name) else {
            return Err(SelectError::UnknownGroup {
                meter,
                name: name.to_owned(),
                known: groups(profile),
            });
        };
        return Ok(group
            .filter(|point| reading.takes(point))
            .cloned()
            .collect());
    }
    if selector.contains(['*', '?']) {
        let glob = WildMatch::new(selector);
        let matches: Vec<Point> = profile
            .points
            .iter()
            .filter(|point| reading.takes(point) && glob.matches(&point.name))
            .cloned()
            .collect();
        if matches.is_empty() {
            let glob = selector.to_owned();
            let groups = groups(profile);
            return Err(SelectError::NoMatch {
                meter,
                glob,
                groups,
            });
        }
        return Ok(matches);
    }
    match profile.point(selector) {
        Some(point) if reading.takes(point) => Ok(vec![point.clone()]),
        Some(point) => {
            let name = point.name.clone();
            Err(match reading.purpose {
                Purpose::Write => SelectError::ReadOnly { name },
                Purpose::Read | Purpose::LookUp => SelectError::WriteOnly { name },
            })
        }
        None => Err(unknown(selector, profile)),
    }
}

/// Why a name that no point has is refused.
fn unknown(selector: &str, profile: &Profile) -> SelectError {
    let name = selector.split([':', '=', '+']).next().unwrap_or_default();
    if let Some(point) = profile.point(name) {
        return SelectError::PointForm {
            selector: selector.to_owned(),
            name: point.name.clone(),
        };
    }
    SelectError::UnknownPoint {
        meter: profile.name.clone(),
        name: selector.to_owned(),
        near: near(selector, profile),
        groups: groups(profile),
    }
}

fn groups(profile: &Profile) -> Vec<String> {
    let groups = profile.groups.iter();
    groups.map(|group| format!("@{}", group.name)).collect()
}

/// Up to three names of points that look like `name`, the nearest first.
pub fn near(name: &str, profile: &Profile) -> Vec<String> {
    alike(name, profile.points.iter().map(|point| point.name.as_str()))
}

/// Up to three of these names that look like `name`, the nearest first.
pub fn alike<'a>(name: &str, names: impl Iterator<Item = &'a str>) -> Vec<String> {
    const ALIKE: f64 = 0.75;
    // Names are lower case.
    let name = &*name.to_lowercase();
    let mut scored: Vec<(f64, &str)> = names
        .map(|known| (strsim::jaro_winkler(name, known), known))
        .filter(|(score, _)| *score >= ALIKE)
        .collect();
    scored.sort_by(|a, b| b.0.total_cmp(&a.0));
    scored
        .iter()
        .take(3)
        .map(|(_, name)| (*name).to_owned())
        .collect()
}
