//! Writes: what a meter refuses, what it holds from then on, and what it does.

use jiff::Timestamp;

use super::Kind;
use super::fixed::Fixed;
use crate::codec::value::{RegisterType, decode};
use crate::codec::{ExceptionCode, RegisterRange, Write};
use crate::profile::{Point, Profile};
use crate::sim::model::{Deed, Destiny, Word};

impl Kind {
    /// Carries out a write, all of it or nothing.
    pub(super) fn write(
        &mut self,
        write: &Write,
        fixed: &mut Fixed,
        now: Timestamp,
    ) -> Result<(), ExceptionCode> {
        if let Some(outcome) = self.model.command(write, now) {
            match outcome? {
                Deed::Done => {}
                Deed::SettingsLost => fixed.lose_settings(&self.profile.points),
            }
            return Ok(());
        }
        let (start, values) = match write {
            Write::Coil { .. } => return Err(ExceptionCode::ILLEGAL_DATA_ADDRESS),
            Write::Register { address, value } => (address.get(), std::slice::from_ref(value)),
            Write::Registers(block) => (block.start().get(), block.values()),
        };
        self.store(start, values, fixed, now)
    }

    /// Writes registers from `start` on.
    fn store(
        &mut self,
        start: u16,
        values: &[u16],
        fixed: &mut Fixed,
        now: Timestamp,
    ) -> Result<(), ExceptionCode> {
        // A block is never longer than what can be read, and ends where addresses end.
        let range = u16::try_from(values.len())
            .ok()
            .and_then(|count| RegisterRange::new(start, count).ok());
        let range = range.filter(|range| self.is_in_one_table(*range));
        range.ok_or(ExceptionCode::ILLEGAL_DATA_ADDRESS)?;
        let measured = self.model.measure(now);
        let shown = |name: &str| {
            let point = self.profile.point(name)?;
            let registers = fixed.registers(point, measured.as_ref());
            registers.first().copied()
        };
        let words = (start..=u16::MAX).zip(values).map(|(address, value)| {
            Some(Word {
                point: writable(&self.profile, address)?,
                address,
                value: *value,
            })
        });
        let words: Option<Vec<Word<'_>>> = words.collect();
        let words = words.ok_or(ExceptionCode::ILLEGAL_DATA_ADDRESS)?;
        let mut held = Vec::new();
        let mut told = Vec::new();
        for word in words {
            let taken = || is_taken(word.point, start, values);
            match self.model.destiny(&word, &shown) {
                Destiny::Refused(code) => return Err(code),
                Destiny::Told => told.push(word),
                Destiny::Setting if !taken() => return Err(ExceptionCode::ILLEGAL_DATA_VALUE),
                Destiny::Else(instead) if !taken() => held.push((word.address, instead)),
                Destiny::Setting | Destiny::Anything | Destiny::Else(_) => {
                    held.push((word.address, word.value));
                }
            }
        }
        drop(measured);
        for (address, value) in held {
            fixed.hold(address, value);
        }
        for word in &told {
            fixed.let_go(word.point, word.address);
        }
        if !told.is_empty() {
            self.model.tell(&told, now);
        }
        Ok(())
    }
}

/// The point that a register belongs to when it is written.
fn writable(profile: &Profile, address: u16) -> Option<&Point> {
    let range = RegisterRange::new(address, 1).ok()?;
    let mut points = profile.points.iter();
    points.find(|point| point.access.writable() && point.range.overlaps(range))
}

/// Whether a point takes what a write from `start` on brings it. A write of a part of it is taken: the
/// meters without function 16 have to be written word by word, and what the half that comes first
/// makes together with the old other half is nobody's setting.
fn is_taken(point: &Point, start: u16, values: &[u16]) -> bool {
    let first = point.range.start().get().checked_sub(start);
    let registers = first.and_then(|first| {
        let end = usize::from(first) + usize::from(point.range.count());
        values.get(usize::from(first)..end)
    });
    let Some(registers) = registers else {
        return true;
    };
    // Dates and times have no limits but those of the calendar and the clock.
    let is_of_a_kind = match point.kind {
        RegisterType::Time | RegisterType::Date => {
            decode(point.kind, point.order, registers).is_ok()
        }
        _ => true,
    };
    is_of_a_kind && point.takes(registers).is_ok()
}
