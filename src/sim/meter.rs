//! A simulated meter: the server side of the codec.

mod answering;
mod bank;
mod fixed;
mod writing;

use std::sync::LazyLock;

use jiff::Timestamp;

pub use self::fixed::{Setting, SettingError};

use self::answering::Refusal;
use self::fixed::Fixed;
use super::em2x::Em2x;
use super::model::Model;
use super::pm290::Pm290;
use super::pqm::Pqm;
use crate::codec::{Frame, FunctionCode, Reply, Unit, rtu};
use crate::profile::{Profile, builtin};

/// The address that all meters hear.
const BROADCAST: u8 = 0;

/// A meter on the simulated line.
pub struct Meter {
    unit: Unit,
    kind: LazyLock<Kind, Box<dyn FnOnce() -> Kind + Send>>,
    /// What registers hold whatever the model says.
    fixed: Fixed,
}

/// What it is a meter of.
struct Kind {
    profile: Profile,
    model: Box<dyn Model>,
}

impl Meter {
    /// A meter that answers as `unit`, with the points and limits of a profile and the values of a
    /// model. Both are made when they are first needed: most meters on a line are never asked.
    pub fn new(
        unit: Unit,
        make: impl FnOnce() -> (Profile, Box<dyn Model>) + Send + 'static,
    ) -> Self {
        Self {
            unit,
            kind: LazyLock::new(Box::new(|| {
                let (profile, model) = make();
                Kind { profile, model }
            })),
            fixed: Fixed::default(),
        }
    }

    /// A PQM with the built-in profile; its load comes from `seed`.
    pub fn pqm(unit: Unit, seed: u64) -> Self {
        Self::builtin(unit, "pqm", move || {
            Box::new(Pqm::new(seed).with_unit(unit))
        })
    }

    /// A PM290 with the built-in profile; its load comes from `seed`.
    pub fn pm290(unit: Unit, seed: u64) -> Self {
        Self::builtin(unit, "pm290", move || Box::new(Pm290::new(seed)))
    }

    /// An EM21 with the built-in profile; its load comes from `seed`.
    pub fn em21(unit: Unit, seed: u64) -> Self {
        Self::builtin(unit, "em21", move || Box::new(Em2x::em21(unit, seed)))
    }

    /// An EM24-DIN with the built-in profile; its load comes from `seed`.
    pub fn em24(unit: Unit, seed: u64) -> Self {
        Self::builtin(unit, "em24", move || Box::new(Em2x::em24(unit, seed)))
    }

    /// # Panics
    /// When no built-in meter has this name; tests make a meter of every name that is given here.
    pub(super) fn builtin(
        unit: Unit,
        name: &'static str,
        model: impl FnOnce() -> Box<dyn Model> + Send + 'static,
    ) -> Self {
        Self::new(unit, move || {
            #[expect(clippy::expect_used, reason = "the names are those of built-in meters")]
            let builtin = builtin::find(name).expect("a built-in meter");
            (builtin.profile(), model())
        })
    }

    /// The unit it answers as.
    pub const fn unit(&self) -> Unit {
        self.unit
    }

    /// Its points and limits.
    pub fn profile(&self) -> &Profile {
        &self.kind.profile
    }

    /// Makes registers hold what they are given from now on, whatever the model says; the last one
    /// counts where several settings are of one point. Scales that depend on the setup are those of
    /// the meter at `now`, with the setup that is given.
    ///
    /// What cannot be held is returned, each by its index in `settings`; the others are.
    pub fn fix(&mut self, settings: &[Setting], now: Timestamp) -> Vec<(usize, SettingError)> {
        self.kind.fix(&mut self.fixed, settings, now)
    }

    /// Does what the bytes that it heard ask for, at the time of day `now`, and says what it
    /// answers. `None` is silence: the CRC is wrong, the frame is cut, or it is for another unit or
    /// for all of them, which is obeyed if it is a write that the meter obeys then.
    ///
    /// A write to the setting of its own unit is answered as the unit it was; after that it is the
    /// other one.
    pub fn answer(&mut self, frame: &[u8], now: Timestamp) -> Option<Frame> {
        let (address, data_unit) = rtu::open(frame).ok()?;
        let is_broadcast = address == BROADCAST;
        if !is_broadcast && address != self.unit.get() {
            return None;
        }
        // From 80h on it is the exception response of somebody with the same number.
        let function = FunctionCode::try_from(*data_unit.first()?).ok()?;
        if is_broadcast && !self.obeys_broadcasts_of(function) {
            return None;
        }
        if self.kind.model.is_silent(now) {
            return None;
        }
        let was = self.unit;
        let told_before = self.kind.model.unit();
        let outcome = self.kind.obey(function, data_unit, &mut self.fixed, now);
        self.answer_as_told(told_before);
        let reply = match outcome {
            _ if is_broadcast => return None,
            Ok(response) => Reply::Normal(response),
            Err(Refusal::Exception(code)) => Reply::Exception { function, code },
            Err(Refusal::Silence) => return None,
        };
        Some(rtu::encode_reply(was, &reply))
    }

    fn obeys_broadcasts_of(&self, function: FunctionCode) -> bool {
        let is_write = matches!(
            function,
            FunctionCode::WriteSingleCoil
                | FunctionCode::WriteSingleRegister
                | FunctionCode::WriteMultipleRegisters
        );
        is_write && {
            let limits = &self.kind.profile.limits;
            limits.broadcast_functions.contains(&function)
        }
    }

    /// Takes the unit that it has just been told to be, if there is such a unit.
    fn answer_as_told(&mut self, before: Option<u8>) {
        let told = self.kind.model.unit();
        if told != before
            && let Some(number) = told
            && let Ok(unit) = Unit::new(number.into(), self.kind.profile.limits.units)
        {
            self.unit = unit;
        }
    }
}
