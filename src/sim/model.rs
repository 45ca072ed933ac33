//! What a simulated meter of one kind holds and measures, and how it differs from the others. Where
//! its points lie and what may be asked of it is the matter of its profile.

use std::ops::RangeInclusive;

use jiff::Timestamp;

use crate::codec::value::Raw;
use crate::codec::{ExceptionCode, RegisterRange, Write};
use crate::profile::Point;

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

    /// Whether it says and does nothing at all, since it starts again.
    fn is_silent(&self, _now: Timestamp) -> bool {
        false
    }

    /// The unit that it has been told to be, on a meter that can be told.
    fn unit(&self) -> Option<u8> {
        None
    }

    /// Measures everything at one instant.
    fn measure(&self, now: Timestamp) -> Box<dyn Measured + '_>;

    /// What becomes of a word that is written into a register of a point. Nothing is done yet: a
    /// later word of the same write may be refused. `shown` tells what the first register of any
    /// point shows now, by its name.
    fn destiny(&self, _word: &Word<'_>, _shown: &dyn Fn(&str) -> Option<u16>) -> Destiny {
        Destiny::Setting
    }

    /// Does what the words of one write tell it to do: those of which the destiny is
    /// [`Destiny::Told`], in the order of their addresses.
    fn tell(&mut self, _words: &[Word<'_>], _now: Timestamp) {}

    /// Carries out a write that is a command and no matter of registers; `None` where it is none.
    ///
    /// # Errors
    /// The exception that refuses it; then nothing is done.
    fn command(&mut self, _write: &Write, _now: Timestamp) -> Option<Result<Deed, ExceptionCode>> {
        None
    }
}

/// A word on its way into a register.
#[derive(Debug, Clone, Copy)]
pub struct Word<'a> {
    /// A point that can be written there.
    pub point: &'a Point,
    /// The register.
    pub address: u16,
    /// What is written into it.
    pub value: u16,
}

/// What becomes of a word that is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Destiny {
    /// The register holds it if the point takes the value that it is part of; else exception 03.
    Setting,
    /// The register holds it, whatever it is.
    Anything,
    /// The register holds it if the point takes it, and else this.
    Else(u16),
    /// The model is told, and the register shows what the model says then.
    Told,
    /// It is refused.
    Refused(ExceptionCode),
}

/// What has been done at a command, besides what the model knows itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Deed {
    /// Nothing.
    Done,
    /// All that can be written holds again what it held in the beginning.
    SettingsLost,
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
