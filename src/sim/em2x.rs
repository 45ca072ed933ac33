//! A Carlo Gavazzi EM21 and an EM24-DIN: the same measurements, and what each has besides.
//!
//! Names are those of the built-in meters `em21` and `em24`. Register facts follow their protocol
//! documents, measurements page 8 of both. Values are taken to be those of the primary side; the
//! pages that could be had do not say so. So they stay as they are when a transformer ratio is
//! written, as do all others when anything is set up: settings are held, and that is all, but for the
//! unit and the resets.

mod em21;
mod em24;
mod energy;
mod inputs;
mod instant;
mod overflow;
mod resets;

use std::cell::OnceCell;

use jiff::Timestamp;

use self::energy::Energy;
use self::instant::INSTANT;
use self::overflow::Overflow;
use self::resets::Resets;
use super::history::Sums;
use super::load::{Installation, Load, Values};
use super::model::{Content, Destiny, Measured, Model, Word};
use super::powers::Powers;
use super::wave::{Moment, Random};
use super::words::rounded;
use crate::codec::Unit;

/// A tenth of a volt, a watt, a hertz or a kilowatt hour.
const TENTH: f64 = 0.1;
/// A thousandth of an ampere or of a power factor.
const THOUSANDTH: f64 = 0.001;

/// Which of the two it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Em21,
    Em24,
}

/// An EM21 or an EM24-DIN and the load it measures.
#[derive(Debug)]
pub struct Em2x {
    kind: Kind,
    unit: u8,
    load: Load,
    /// Of the EM24, up to 10 digits.
    serial_number: u64,
    overflow: Option<Overflow>,
    /// What has been set to zero.
    resets: Resets,
}

impl Em2x {
    /// The EM21 AV5 that answers as `unit` and measures the load of `seed` over current transformers.
    pub fn em21(unit: Unit, seed: u64) -> Self {
        Self::new(Kind::Em21, unit, em21::SHOP, seed)
    }

    /// The EM24-DIN AV9 that answers as `unit` and measures the load of `seed` directly; its serial
    /// number comes from there too.
    pub fn em24(unit: Unit, seed: u64) -> Self {
        Self::new(Kind::Em24, unit, em24::HOUSE, seed)
    }

    fn new(kind: Kind, unit: Unit, installation: Installation, seed: u64) -> Self {
        Self {
            kind,
            unit: unit.get(),
            load: Load::new(installation, seed),
            // A row of numbers other than the load's.
            serial_number: Random::new(!seed).next() % 10_000_000_000,
            overflow: None,
            resets: Resets::default(),
        }
    }

    /// The same meter with the point of this name out of range, a measurement of table 2.3-1.
    #[must_use]
    pub fn with_overflow(mut self, point: &str) -> Self {
        self.overflow = Some(Overflow::new(point));
        self
    }
}

impl Model for Em2x {
    fn unit(&self) -> Option<u8> {
        Some(self.unit)
    }

    fn destiny(&self, word: &Word<'_>, _: &dyn Fn(&str) -> Option<u16>) -> Destiny {
        let name = word.point.name.as_str();
        match (name, self.kind) {
            _ if name.starts_with("reset_") => Destiny::Told,
            ("rs485_address", _) if word.point.takes(&[word.value]).is_ok() => Destiny::Told,
            // "No default is substituted": what is out of range stays so (page 9).
            (_, Kind::Em21) => Destiny::Anything,
            (_, Kind::Em24) => em24::destiny(name),
        }
    }

    /// 1 resets; any other number in a register of a reset does nothing (EM21 page 10, EM24 page 13).
    fn tell(&mut self, words: &[Word<'_>], now: Timestamp) {
        for word in words {
            match (word.point.name.as_str(), word.value) {
                ("rs485_address", unit) => self.unit = u8::try_from(unit).unwrap_or(self.unit),
                (name, 1) => self.resets.reset(name, &self.load, now),
                _ => {}
            }
        }
    }

    fn measure(&self, now: Timestamp) -> Box<dyn Measured + '_> {
        let moment = Moment::of(now);
        let values = self.load.at(moment.seconds());
        Box::new(Reading {
            meter: self,
            now,
            moment,
            values,
            powers: Powers::of(&values, TENTH, THOUSANDTH),
            energy: OnceCell::new(),
            demand: OnceCell::new(),
        })
    }
}

/// All that the meter knows at one instant.
struct Reading<'a> {
    meter: &'a Em2x,
    now: Timestamp,
    moment: Moment,
    values: Values,
    powers: Powers,
    energy: OnceCell<Energy>,
    demand: OnceCell<Sums>,
}

impl Measured for Reading<'_> {
    fn content(&self, point: &str) -> Option<Content> {
        let overflow = self.meter.overflow.as_ref();
        overflow
            .and_then(|overflow| overflow.shows(point, self.meter.kind))
            .or_else(|| self.instant(point))
            .map(Content::Number)
            .or_else(|| match self.meter.kind {
                Kind::Em21 => self.em21(point).map(Content::Number),
                Kind::Em24 => self.em24(point),
            })
    }
}

impl Reading<'_> {
    /// What both of them measure.
    fn instant(&self, point: &str) -> Option<i128> {
        let (_, quantity, step) = INSTANT.iter().find(|(name, ..)| *name == point)?;
        let measured = || rounded(self.values.get(*quantity) / step);
        Some(self.powers.get(*quantity).unwrap_or_else(measured))
    }

    /// The counters of energy; worked out for the first one that is asked for.
    fn energy(&self) -> &Energy {
        self.energy
            .get_or_init(|| self.meter.resets.energy(&self.meter.load, self.moment))
    }

    /// The demands of the last quarter of an hour; worked out for the first one that is asked for.
    fn demand(&self) -> &Sums {
        let load = &self.meter.load;
        self.demand
            .get_or_init(|| load.history().demand(load, self.moment))
    }
}

/// A register that holds the same always.
fn fixed(registers: &[(&str, i128)], point: &str) -> Option<i128> {
    let found = registers.iter().find(|(name, _)| *name == point);
    found.map(|(_, number)| *number)
}
