//! What a simulated meter of one kind holds and measures, and how it differs from the others. Where
//! its points lie and what may be asked of it is the matter of its profile.

use std::ops::RangeInclusive;

use jiff::Timestamp;

use crate::codec::RegisterRange;
use crate::codec::value::Raw;

/// What a meter of one kind holds and measures.
pub trait Model: Send + Sync {
    /// Areas in which a read may cover registers that no point names; those read as 0. Outside of
    /// them there are only the registers of points.
    fn areas(&self) -> &[RangeInclusive<u16>] {
        &[]
    }

    /// The bits that function 07 answers, on a meter that has it.
    fn status(&self, _now: Timestamp) -> u8 {
        0
    }

    /// Whether it is too busy for a request that touches these registers.
    fn is_busy(&self, _range: RegisterRange, _now: Timestamp) -> bool {
        false
    }

    /// Measures everything at one instant.
    fn measure(&self, now: Timestamp) -> Box<dyn Measured + '_>;
}

/// All that a meter knows at one instant.
pub trait Measured {
    /// What the point of this name holds; `None` for a point the model knows nothing of.
    fn content(&self, point: &str) -> Option<Content>;
}

/// What a point holds, before its type and byte order make registers of it.
#[derive(Debug, Clone, PartialEq)]
pub enum Content {
    /// A raw integer, before scale; the bits of flags, the number of a letter.
    Number(i128),
    /// Text, a date, a time.
    Other(Raw),
}

/// A model that knows nothing: all registers hold 0.
#[derive(Debug, Clone, Copy)]
pub struct Blank;

impl Model for Blank {
    fn measure(&self, _now: Timestamp) -> Box<dyn Measured + '_> {
        Box::new(Self)
    }
}

impl Measured for Blank {
    fn content(&self, _point: &str) -> Option<Content> {
        None
    }
}
