//! Registers that hold what was given or written, whatever the load does.

use std::collections::BTreeMap;

use jiff::Timestamp;
use thiserror::Error;

use super::{Kind, bank};
use crate::codec::RegisterRange;
use crate::profile::encoding::EncodeError;
use crate::profile::selector::near;
use crate::profile::{Point, Setup};
use crate::sim::model::Measured;

/// What was given: whole points, and single registers.
#[derive(Debug, Clone, Default)]
pub(super) struct Fixed {
    points: BTreeMap<String, Vec<u16>>,
    words: BTreeMap<u16, u16>,
}

impl Fixed {
    /// The registers of a point: what it is to hold, else what is measured.
    pub(super) fn registers(&self, point: &Point, measured: &dyn Measured) -> Vec<u16> {
        let mut registers = match self.points.get(&point.name) {
            Some(registers) => registers.clone(),
            None => bank::registers(point, measured),
        };
        // A model that knows nothing of a point has no registers for it.
        registers.resize(usize::from(point.range.count()), 0);
        self.lay(point.range.start().get(), &mut registers);
        registers
    }

    /// Holds a word in a register from now on.
    pub(super) fn hold(&mut self, address: u16, word: u16) {
        self.words.insert(address, word);
    }

    /// Leaves the point of a register to the model again.
    pub(super) fn let_go(&mut self, point: &Point, address: u16) {
        self.points.remove(&point.name);
        self.words.remove(&address);
    }

    /// Leaves all that can be written to the model again.
    pub(super) fn lose_settings(&mut self, points: &[Point]) {
        let writable = || points.iter().filter(|point| point.access.writable());
        for point in writable() {
            self.points.remove(&point.name);
        }
        self.words.retain(|address, _| {
            let range = RegisterRange::new(*address, 1);
            range.is_ok_and(|range| !writable().any(|point| point.range.overlaps(range)))
        });
    }

    /// Puts single registers into those from `first`.
    pub(super) fn lay(&self, first: u16, registers: &mut [u16]) {
        for (address, register) in (first..=u16::MAX).zip(registers) {
            if let Some(word) = self.words.get(&address) {
                *register = *word;
            }
        }
    }
}

/// What a register is to hold.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Setting {
    /// The name of a point, or the address of a register, `0x0240`.
    pub name: String,
    /// A value as the point reads; a whole register, `415` or `0x019F`.
    pub value: String,
}

/// Why a register cannot hold what it is to hold.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum SettingError {
    /// The meter has no such point.
    #[error("{meter} has no such point{}", did_you_mean(.near))]
    NoPoint {
        /// The meter.
        meter: String,
        /// Names that look like it.
        near: Vec<String>,
    },
    /// Nothing can be read there.
    #[error("{meter} has no register there that can be read")]
    NoRegister {
        /// The meter.
        meter: String,
    },
    /// Not what a register holds.
    #[error("'{found}' is not a register: 0 to 65535, or 0x0000 to 0xFFFF")]
    NoWord {
        /// What was given.
        found: String,
    },
    /// The point does not hold this value.
    #[error(transparent)]
    Value(#[from] EncodeError),
}

impl SettingError {
    /// Whether another meter may have what this one has not.
    pub const fn is_of_another_meter(&self) -> bool {
        matches!(self, Self::NoPoint { .. } | Self::NoRegister { .. })
    }
}

fn did_you_mean(near: &[String]) -> String {
    match near {
        [] => String::new(),
        near => format!("; did you mean {}?", near.join(", ")),
    }
}

impl Kind {
    /// Holds these settings from now on, the last one where several are of one point. A setting that
    /// cannot be held is told by its index and changes nothing.
    pub(super) fn fix(
        &self,
        fixed: &mut Fixed,
        settings: &[Setting],
        now: Timestamp,
    ) -> Vec<(usize, SettingError)> {
        let setup = Setup::of(&self.profile.points, Some(&self.profile));
        let is_setup = |name: &str| setup.points().iter().any(|point| point.name == name);
        // Scales follow from registers and from setup points, so these come first.
        let rank = |setting: &Setting| match address(&setting.name) {
            Some(_) => 0,
            None if is_setup(&setting.name) => 1,
            None => 2,
        };
        let mut order: Vec<(usize, &Setting)> = settings.iter().enumerate().collect();
        order.sort_by_key(|(_, setting)| rank(setting));
        let mut failed = Vec::new();
        for (index, setting) in order {
            if let Err(error) = self.fix_one(fixed, &setup, setting, now) {
                failed.push((index, error));
            }
        }
        failed.sort_by_key(|(index, _)| *index);
        failed
    }

    fn fix_one(
        &self,
        fixed: &mut Fixed,
        setup: &Setup,
        Setting { name, value }: &Setting,
        now: Timestamp,
    ) -> Result<(), SettingError> {
        let meter = || self.profile.name.clone();
        if let Some(address) = address(name) {
            if !self.is_there(address) {
                return Err(SettingError::NoRegister { meter: meter() });
            }
            let word = word(value).ok_or_else(|| SettingError::NoWord {
                found: value.clone(),
            })?;
            fixed.words.insert(address, word);
            return Ok(());
        }
        let point = self.profile.point(name);
        let point = point.ok_or_else(|| SettingError::NoPoint {
            meter: meter(),
            near: near(name, &self.profile),
        })?;
        let measured = self.model.measure(now);
        let needed = setup.needed_by(point);
        let read = setup
            .points()
            .iter()
            .filter(|point| needed.contains(point.name.as_str()))
            .map(|point| {
                let registers = fixed.registers(point, measured.as_ref());
                (point.name.clone(), registers)
            });
        let registers = point.encode(value, &setup.scales(&read.collect()))?;
        fixed.points.insert(name.clone(), registers);
        Ok(())
    }

    /// Whether a read can have this register.
    fn is_there(&self, address: u16) -> bool {
        let Ok(range) = RegisterRange::new(address, 1) else {
            return false;
        };
        let mut points = self.profile.points.iter();
        points.any(|point| point.access.readable() && point.range.overlaps(range))
            || self.is_in_one_area(range)
    }
}

/// The address in a name that is one: names of points begin with a letter.
fn address(name: &str) -> Option<u16> {
    if name.starts_with(|first: char| first.is_ascii_digit()) {
        word(name)
    } else {
        None
    }
}

/// `415`, `0x019F`.
fn word(text: &str) -> Option<u16> {
    let text = text.trim();
    let hex = text.strip_prefix("0x").or_else(|| text.strip_prefix("0X"));
    let (digits, radix) = hex.map_or((text, 10), |hex| (hex, 16));
    // The conversion would take a sign.
    let is_number = !digits.starts_with('+');
    u16::from_str_radix(digits, radix)
        .ok()
        .filter(|_| is_number)
}
