//! What advice there is, in words.

use std::fmt;

use rust_decimal::Decimal;

/// What to look at again, and why.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Matter {
    /// The file would not be found by the name in it.
    FileName {
        /// The name.
        name: String,
    },
    /// Nothing tells that a unit is this meter.
    NoIdentification,
    /// There is no group that is read when none is named.
    NoDefaultGroup,
    /// A group without points.
    EmptyGroup,
    /// A default group of which nothing can be read.
    UnreadableDefault,
    /// Points outside all groups.
    Ungrouped {
        /// Their names.
        names: Vec<String>,
    },
    /// Labels that no point has.
    UnusedLabels,
    /// A factor that nothing is scaled with.
    UnusedFactor,
    /// The name of several bits at once.
    ManyBits {
        /// The mask.
        mask: u16,
    },
    /// Registers that are another point as well.
    SharedRegisters {
        /// The name of the other.
        other: String,
        /// Its line.
        line: usize,
    },
    /// A point that can be written, whatever its type holds.
    NoRange,
    /// Points that can be written, and no function to write them with.
    NoWriteFunction,
    /// No point has a page.
    NoPages,
    /// A verified point without a page, where others have one.
    NoPage,
    /// A scaled number without a unit.
    NoUnit,
    /// A factor that is no power of ten.
    OddFactor {
        /// The factor.
        factor: Decimal,
    },
    /// A float with a scale.
    ScaledFloat,
    /// A frequency that can be neither 50 nor 60 Hz.
    NoMains,
    /// A power factor that can only be -1, 0 or 1.
    WholePowerFactor,
    /// A percentage in steps of more than one.
    CoarsePercentage {
        /// The step.
        step: Decimal,
    },
    /// A counter of energy of 16 bits with a sign.
    SignedCounter,
}

/// How many names of points are spelled out.
const SPELLED: usize = 5;

impl fmt::Display for Matter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::FileName { name } => {
                return write!(f, "to be found by this name, the file must be {name}.toml");
            }
            Self::NoIdentification => "missing, so nothing tells that a unit is this meter",
            Self::NoDefaultGroup => "missing, so a read has to name its points",
            Self::EmptyGroup => "has no points",
            Self::UnreadableDefault => "has no point that can be read",
            Self::Ungrouped { names } => return ungrouped(f, names),
            Self::UnusedLabels => "no point has these labels",
            Self::UnusedFactor => "nothing is scaled with it",
            Self::ManyBits { mask } => {
                return write!(
                    f,
                    "0x{mask:04X} is more than one bit; the name shows when all of them are set"
                );
            }
            Self::SharedRegisters { other, line } => {
                return write!(f, "shares registers with {other} in line {line}");
            }
            Self::NoRange => "missing, so whatever the type holds may be written",
            Self::NoWriteFunction => "can be written, and limits.functions has neither 6 nor 16",
            Self::NoPages => "no point has the page of the manual it was read on",
            Self::NoPage => "missing; a point not read in the manual has verified = false",
            Self::NoUnit => "missing, and the number is scaled; \"\" says that it has none",
            Self::OddFactor { factor } => {
                return write!(
                    f,
                    "{factor} is no power of ten; a ratio that is set in the meter belongs in \
                     [factors]"
                );
            }
            Self::ScaledFloat => "a float mostly is in its unit already",
            Self::NoMains => "no raw number gives 50 or 60 Hz",
            Self::WholePowerFactor => "a power factor in whole numbers can only be -1, 0 or 1",
            Self::CoarsePercentage { step } => {
                return write!(f, "a percentage in steps of {step}");
            }
            Self::SignedCounter => {
                "a counter of energy that turns over at 32767, into the negative"
            }
        })
    }
}

fn ungrouped(f: &mut fmt::Formatter<'_>, names: &[String]) -> fmt::Result {
    let (spelled, others) = names.split_at(names.len().min(SPELLED));
    let spelled = spelled.join(", ");
    match (names.len(), others.len()) {
        (1, _) => write!(f, "{spelled} is in none"),
        (_, 0) => write!(f, "{spelled} are in none"),
        (_, others) => write!(f, "{spelled} and {others} more are in none"),
    }
}
