//! What a unit holds before it is written to.

use thiserror::Error;

use crate::client::{Client, Failure};
use crate::profile::point::OnlyWith;
use crate::profile::write_plan::Change;
use crate::profile::writing::Distinct;
use crate::profile::{Profile, Scales, Value};
use crate::readings::{Fault, Inquiry, Memory, Trouble, echo, take};

/// What a unit holds before it is written to.
#[derive(Debug)]
pub struct Before {
    /// The values of the points of the inquiry, in their order.
    pub old: Vec<Result<Value, Fault>>,
    /// What their setup gives to scale with, and what rules ask for.
    pub scales: Scales,
    /// What went wrong.
    troubles: Vec<Trouble>,
}

impl Before {
    /// Why a read brought nothing; `None` when every read was answered.
    pub fn failure(&self) -> Option<&Failure> {
        self.troubles.iter().find_map(|trouble| match trouble {
            Trouble::Unread { failure, .. } => Some(failure),
            _ => None,
        })
    }

    /// Whether nothing can be sent: the port is lost, or the line never silent.
    pub fn is_hopeless(&self) -> bool {
        matches!(
            self.failure(),
            Some(Failure::Port(_) | Failure::NeverQuiet { .. })
        )
    }
}

/// Reads the points of an inquiry, which are those to be written as far as they can be read, and
/// finds out whether the line echoes: the answer to some writes looks like their echo.
///
/// # Errors
/// [`Failure`] when the port is lost.
pub fn before(
    client: &mut Client,
    inquiry: &Inquiry<'_, '_>,
    profile: Option<&Profile>,
    memory: &mut Memory,
) -> Result<Before, Failure> {
    let taken = take(client, inquiry, memory);
    let before = Before {
        old: taken.row.readings,
        scales: taken.scales,
        troubles: taken.troubles,
    };
    if !before.is_hopeless() && !client.knows_echo() {
        echo::find_out(
            client,
            inquiry.unit,
            &echo::probe(profile),
            inquiry.patience,
        )?;
    }
    Ok(before)
}

/// Why a change cannot be made on a unit as it is now.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum NotNow {
    /// Another point holds what forbids it.
    #[error("{name} cannot be {verb} while {point} is {found}")]
    Setting {
        /// What was to be done: the name of a point or an operation.
        name: String,
        /// `written`, `carried out`.
        verb: &'static str,
        /// The point that forbids it.
        point: String,
        /// What that holds.
        found: String,
    },
    /// It is not known what the other point holds.
    #[error("{name} cannot be {verb} without knowing what {point} holds, which could not be read")]
    Unknown {
        /// What was to be done.
        name: String,
        /// `written`, `carried out`.
        verb: &'static str,
        /// The point that may forbid it.
        point: String,
    },
    /// Another point holds the same already, and may not.
    #[error("{name} would hold the same as {other}: {about}")]
    Alike {
        /// The point to be written.
        name: String,
        /// The other one.
        other: String,
        /// Why it may not.
        about: String,
    },
}

/// Whether what `only_with` asks for holds.
///
/// # Errors
/// [`NotNow`] when it does not, or when that is not known.
pub fn allowed(
    name: &str,
    verb: &'static str,
    only_with: Option<&OnlyWith>,
    scales: &Scales,
    profile: &Profile,
) -> Result<(), NotNow> {
    let Some(with) = only_with else {
        return Ok(());
    };
    let Ok(setting) = scales.setting(&with.point) else {
        return Err(NotNow::Unknown {
            name: name.to_owned(),
            verb,
            point: with.point.clone(),
        });
    };
    if with.means_something(setting) {
        return Ok(());
    }
    let code = setting.and_then(|raw| u16::try_from(raw).ok());
    let label = code.and_then(|code| profile.point(&with.point)?.label(code));
    Err(NotNow::Setting {
        name: name.to_owned(),
        verb,
        point: with.point.clone(),
        found: label.map_or_else(
            || setting.map_or_else(|| "as it is".to_owned(), |raw| raw.to_string()),
            str::to_owned,
        ),
    })
}

/// Whether none of the changes makes a point hold what another one holds that may not.
///
/// # Errors
/// [`NotNow::Alike`] names two of them, [`NotNow::Unknown`] one of which that is not known.
pub fn distinct(changes: &[Change], rules: &[Distinct], scales: &Scales) -> Result<(), NotNow> {
    for (rule, change) in rules
        .iter()
        .flat_map(|rule| changes.iter().map(move |change| (rule, change)))
    {
        let [register] = change.registers.as_slice() else {
            continue;
        };
        if !rule.points.contains(&change.name) || rule.except.contains(register) {
            continue;
        }
        let is_written = |name: &&String| changes.iter().any(|change| change.name == **name);
        for other in rule.points.iter().filter(|name| !is_written(name)) {
            let name = change.name.clone();
            match scales.setting(other) {
                Ok(Some(raw)) if raw == i128::from(*register) => {
                    return Err(NotNow::Alike {
                        name,
                        other: other.clone(),
                        about: rule.about.clone(),
                    });
                }
                Ok(_) => {}
                Err(_) => {
                    return Err(NotNow::Unknown {
                        name,
                        verb: "written",
                        point: other.clone(),
                    });
                }
            }
        }
    }
    Ok(())
}
