//! What writes to a PM290 do besides what they set (guide pages 21 and 26).

use jiff::{SignedDuration, Timestamp};

use crate::codec::{ExceptionCode, Write};
use crate::sim::history::{Metered, Sums, since};
use crate::sim::load::Load;
use crate::sim::model::{Destiny, Word};
use crate::sim::wave::Moment;

/// Any value written to one of these clears all of them.
const FIRST_DEMAND: u16 = 0x0118;
const LAST_DEMAND: u16 = 0x011E;
/// Pairs of registers; 0 in either of a pair clears its energy, and that of both reactive ones in any
/// of theirs.
const IMPORT: u16 = 0x011F;
const EXPORT: u16 = 0x0121;
const REACTIVE: u16 = 0x0123;
const LAST_ENERGY: u16 = 0x0126;
/// This value in this register restarts the meter.
const STATE: u16 = 0x0A00;
const RESTART: u16 = 0xFFFF;

/// How long a restart takes. The guide does not say; nothing is lost by it.
const RESTARTING: SignedDuration = SignedDuration::from_secs(1);

/// What was cleared, and when.
#[derive(Debug, Default)]
pub(super) struct Writes {
    /// Watt seconds and var seconds that had been counted then.
    import: f64,
    reactive: f64,
    demands: Option<Timestamp>,
    restarted: Option<Timestamp>,
}

/// What becomes of a word. The guide does not tell the exception for a value that clears nothing, nor
/// for clearing while that is forbidden: here it is 03 for both.
pub(super) fn destiny(word: &Word<'_>, shown: &dyn Fn(&str) -> Option<u16>) -> Destiny {
    const FORBIDDEN: u16 = 1;

    let refused = Destiny::Refused(ExceptionCode::ILLEGAL_DATA_VALUE);
    let takes = || word.point.takes(&[word.value]).is_ok();
    match (word.address, word.value) {
        (FIRST_DEMAND..=LAST_ENERGY, _) if shown("reset_mode") == Some(FORBIDDEN) => refused,
        (FIRST_DEMAND..=LAST_DEMAND, _) | (IMPORT..=LAST_ENERGY, 0) => Destiny::Told,
        (IMPORT..=LAST_ENERGY, _) => refused,
        // The scales follow from these: the model keeps them.
        _ if super::setup::IS_SCALED_BY.contains(&&*word.point.name) => {
            if takes() {
                Destiny::Told
            } else {
                refused
            }
        }
        _ => Destiny::Setting,
    }
}

/// Whether a write restarts the meter: that value in that register alone, which takes no other.
pub(super) fn is_restart(write: &Write) -> bool {
    match write {
        Write::Register { address, value } => (address.get(), *value) == (STATE, RESTART),
        Write::Registers(block) => (block.start().get(), block.values()) == (STATE, &[RESTART]),
        Write::Coil { .. } => false,
    }
}

impl Writes {
    /// Restarts.
    pub(super) const fn restart(&mut self, now: Timestamp) {
        self.restarted = Some(now);
    }

    /// Clears what a word in this register clears.
    pub(super) fn clear(&mut self, address: u16, load: &Load, now: Timestamp) {
        let sum = |metered| load.history().sums(load, Moment::of(now)).get(metered);
        match address {
            FIRST_DEMAND..=LAST_DEMAND => self.demands = Some(now),
            // The load gives nothing back: what is exported, between these, is 0 anyhow.
            IMPORT..EXPORT => self.import = sum(Metered::RealPower),
            REACTIVE..=LAST_ENERGY => self.reactive = sum(Metered::ReactivePower),
            _ => {}
        }
    }

    /// Whether it says nothing since it restarts.
    pub(super) fn is_restarting(&self, now: Timestamp) -> bool {
        self.restarted.is_some_and(|at| {
            let since = now.duration_since(at);
            !since.is_negative() && since < RESTARTING
        })
    }

    /// What had been counted when it was cleared.
    pub(super) const fn cleared(&self, metered: Metered) -> f64 {
        match metered {
            Metered::RealPower => self.import,
            Metered::ReactivePower => self.reactive,
            _ => 0.0,
        }
    }

    /// The running demands.
    pub(super) fn demand(&self, load: &Load, now: Timestamp) -> Sums {
        let history = load.history();
        match self.demands {
            Some(cleared) => history.demand_since(load, cleared, now),
            None => history.demand(load, Moment::of(now)),
        }
    }

    /// The highest demand since they were cleared.
    pub(super) fn highest_demand(&self, load: &Load, metered: Metered, now: Timestamp) -> f64 {
        let history = load.history();
        let Some(cleared) = self.demands else {
            return history.of_demand(metered).highest;
        };
        let demand = |at| [history.demand_since(load, cleared, at).get(metered)];
        let [extremes] = since::extremes(cleared, now, demand);
        extremes.highest
    }
}
