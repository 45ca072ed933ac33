//! What a unit taught by what it did not answer.

use std::fmt;

use crate::codec::{ReadFunction, RegisterRange};
use crate::profile::plan::Rules;

/// What was found out about a unit. Prints as what is done about it, with the setting for its
/// profile where there is one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Lesson {
    /// It gives no read that covers registers which no point names.
    NoHoles,
    /// It gives so many registers at once.
    Limit(u16),
    /// It does not give these registers in one request, but each part of them.
    Border(ReadFunction, RegisterRange),
    /// It does not give these registers.
    Refused(ReadFunction, RegisterRange),
}

impl Lesson {
    /// Makes the rules heed it.
    pub(super) fn apply(self, rules: &mut Rules) {
        match self {
            Self::NoHoles => rules.forbid_holes(),
            Self::Limit(most) => rules.limit(most),
            Self::Border(function, range) | Self::Refused(function, range) => {
                rules.refuse(function, range);
            }
        }
    }

    /// Whether the other one says the same, or the same with another number.
    pub(super) fn is_like(self, other: Self) -> bool {
        self == other || matches!((self, other), (Self::Limit(_), Self::Limit(_)))
    }

    /// Whether an answered read shows that it is not so.
    pub(super) fn is_refuted_by(
        self,
        function: ReadFunction,
        range: RegisterRange,
        has_holes: bool,
    ) -> bool {
        match self {
            Self::NoHoles => has_holes,
            Self::Limit(most) => range.count() > most,
            Self::Border(of, refused) | Self::Refused(of, refused) => {
                of == function && range.contains(refused)
            }
        }
    }
}

impl fmt::Display for Lesson {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoHoles => f.write_str(
                "only registers that points name are read from now on; a profile says so with \
                 limits.read_holes = false",
            ),
            Self::Limit(most) => write!(
                f,
                "no more than {most} registers, which worked, are read at once from now on; a \
                 profile says so with limits.read_registers = {most}, or more where the meter \
                 gives more"
            ),
            Self::Border(_, range) => write!(
                f,
                "registers {range} are read in several requests from now on"
            ),
            Self::Refused(_, range) => {
                write!(f, "no other read covers registers {range} from now on")
            }
        }
    }
}
