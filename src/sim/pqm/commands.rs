//! What a PQM does when it is told to: operations (format F7, manual pages 187, 193 and 253), its
//! clock (page 194), the setpoints that clear something (page 233).

use std::ops::RangeInclusive;

use jiff::Timestamp;
use jiff::civil::{Date, Time};

use super::Pqm;
use super::state::{Cleared, Relay};
use crate::codec::value::{ByteOrder, Raw, RegisterType, decode};
use crate::codec::{ExceptionCode, RegisterBlock, Write};
use crate::sim::model::{Deed, Destiny, Word};

/// The command area and the clock behind it. The map names registers to 008C; a message needs more
/// of them, and none of the longest writes reaches the clock.
const AREA: RangeInclusive<u16> = 0x0080..=0x00FF;
const FIRST: u16 = 0x0080;

/// What the first of them holds: function 05 is to be carried out.
const EXECUTE: u16 = 5;

/// Registers that set the clock: two for the time, two for the date.
const TIME: u16 = 0x00F0;
const DATE: u16 = 0x00F2;

/// The setpoints of which "yes" clears something, and what; they read "no" again at once.
const CLEARING: [(&str, &[Cleared]); 10] = [
    ("clear_energy", &[Cleared::Energy]),
    ("clear_max_demand", &[Cleared::MaximumDemand]),
    ("clear_minmax_current", &[Cleared::Current]),
    ("clear_minmax_voltage", &[Cleared::Voltage]),
    ("clear_minmax_power", &[Cleared::Power]),
    ("clear_max_thd", &[Cleared::Distortion]),
    ("clear_pulse_inputs", &[Cleared::Pulses]),
    ("clear_event_record", &[Cleared::Events]),
    ("clear_all_demand", &[Cleared::Demand]),
    ("clear_minmax_frequency", &[Cleared::Frequency]),
];

fn clearing(point: &str) -> Option<&'static [Cleared]> {
    let row = CLEARING.iter().find(|(name, _)| *name == point);
    row.map(|(_, cleared)| *cleared)
}

/// What becomes of a word in a register that is no command.
pub(super) fn destiny(word: &Word<'_>) -> Destiny {
    let name = word.point.name.as_str();
    if name != "modbus_address" && clearing(name).is_none() {
        Destiny::Setting
    } else if word.point.takes(&[word.value]).is_ok() {
        Destiny::Told
    } else {
        Destiny::Refused(ExceptionCode::ILLEGAL_DATA_VALUE)
    }
}

impl Pqm {
    /// Does what setpoints say that are not held.
    pub(super) fn obey(&mut self, words: &[Word<'_>], now: Timestamp) {
        for word in words {
            let name = word.point.name.as_str();
            if name == "modbus_address" {
                self.unit = u8::try_from(word.value).unwrap_or(self.unit);
            }
            let yes = clearing(name).filter(|_| word.value == 1);
            for what in yes.unwrap_or_default() {
                self.state.clear(*what, now);
            }
        }
    }

    /// Carries out a write to the command area or the clock, which are written with function 16 in one
    /// piece, and the operations of function 05; `None` for other writes. The manual does not tell the
    /// exceptions: 02 is for what does not begin where a command or a part of the clock does, 03 for
    /// what is none.
    pub(super) fn carry_out(
        &mut self,
        write: &Write,
        now: Timestamp,
    ) -> Option<Result<Deed, ExceptionCode>> {
        match write {
            Write::Coil { address, on: true } => Some(self.operate(address.get(), &[], now)),
            // Nothing is ever switched off like this: FF00 is all that the manual has (page 187).
            Write::Coil { on: false, .. } => Some(Err(ExceptionCode::ILLEGAL_DATA_VALUE)),
            Write::Register { address, .. } => AREA
                .contains(&address.get())
                .then_some(Err(ExceptionCode::ILLEGAL_DATA_ADDRESS)),
            Write::Registers(block) => self.carry_out_block(block, now),
        }
    }

    fn carry_out_block(
        &mut self,
        block: &RegisterBlock,
        now: Timestamp,
    ) -> Option<Result<Deed, ExceptionCode>> {
        let start = block.start().get();
        let end = u32::from(start) + u32::from(block.count());
        if *AREA.end() < start || end <= (*AREA.start()).into() {
            return None;
        }
        Some(match (start, block.values()) {
            (FIRST, [EXECUTE, operation, data @ ..]) => self.operate(*operation, data, now),
            (FIRST, _) => Err(ExceptionCode::ILLEGAL_DATA_VALUE),
            (TIME, [time @ .., month, year]) if time.len() == 2 => {
                self.set_clock(Some(time), Some(&[*month, *year]), now)
            }
            (TIME, time @ [_, _]) => self.set_clock(Some(time), None, now),
            (DATE, date @ [_, _]) => self.set_clock(None, Some(date), now),
            _ => Err(ExceptionCode::ILLEGAL_DATA_ADDRESS),
        })
    }

    /// Sets what is given of the clock, if both are a time and a date.
    fn set_clock(
        &mut self,
        time: Option<&[u16]>,
        date: Option<&[u16]>,
        now: Timestamp,
    ) -> Result<Deed, ExceptionCode> {
        let time = time.map(time_in).transpose()?;
        let date = date.map(date_in).transpose()?;
        self.state.set_clock(time, date, now);
        Ok(Deed::Done)
    }

    /// Carries out an operation. What has to do with the display, the keys, the logs or the trace
    /// memory is taken and does nothing here; nor does the way to new firmware, which on a real one
    /// ends all talk.
    fn operate(
        &mut self,
        operation: u16,
        data: &[u16],
        now: Timestamp,
    ) -> Result<Deed, ExceptionCode> {
        let was_near_factory = std::mem::take(&mut self.state.is_near_factory);
        match (operation, data) {
            (2, _) => self.state.energise(Relay::Alarm),
            (3, _) => self.state.release(Relay::Alarm),
            (4, _) => self.state.energise(Relay::Aux1),
            (5, _) => self.state.release(Relay::Aux1),
            (6, _) => self.state.energise(Relay::Aux2),
            (7, _) => self.state.release(Relay::Aux2),
            (8, _) => self.state.energise(Relay::Aux3),
            (9, _) => self.state.release(Relay::Aux3),
            (10, [hour, milliseconds, ..]) => {
                return self.set_clock(Some(&[*hour, *milliseconds]), None, now);
            }
            (11, [month, year, ..]) => return self.set_clock(None, Some(&[*month, *year]), now),
            (13, [key, ..]) if is_key(*key) => {}
            (14, _) => self.state.clear(Cleared::Energy, now),
            (15, _) => self.state.clear(Cleared::MaximumDemand, now),
            (16, _) => self.state.clear(Cleared::Current, now),
            (17, _) => self.state.clear(Cleared::Voltage, now),
            (18, _) => self.state.clear(Cleared::Power, now),
            (19, _) => self.state.clear(Cleared::Distortion, now),
            (20, _) => self.state.clear(Cleared::Pulses, now),
            (24, _) if was_near_factory => {
                self.unit = self.first_unit;
                return Ok(Deed::SettingsLost);
            }
            (25, _) => self.state.is_near_factory = true,
            (31, _) => self.state.clear(Cleared::Events, now),
            (34, _) => self.state.clear(Cleared::Demand, now),
            (35, _) => self.state.clear(Cleared::Frequency, now),
            (1 | 12 | 21..=23 | 26..=30 | 32 | 33, _) => {}
            // Unknown, without what goes with it, or the second step without the first.
            _ => return Err(ExceptionCode::ILLEGAL_DATA_VALUE),
        }
        Ok(Deed::Done)
    }
}

/// Whether there is such a key (format F8).
const fn is_key(code: u16) -> bool {
    matches!(code, 49..=57 | 97)
}

fn time_in(registers: &[u16]) -> Result<Time, ExceptionCode> {
    match decode(RegisterType::Time, ByteOrder::Abcd, registers) {
        Ok(Raw::Time(time)) => Ok(time),
        _ => Err(ExceptionCode::ILLEGAL_DATA_VALUE),
    }
}

fn date_in(registers: &[u16]) -> Result<Date, ExceptionCode> {
    match decode(RegisterType::Date, ByteOrder::Abcd, registers) {
        Ok(Raw::Date(date)) => Ok(date),
        _ => Err(ExceptionCode::ILLEGAL_DATA_VALUE),
    }
}
