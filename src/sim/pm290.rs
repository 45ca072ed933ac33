//! A Satec PM290: its measurements as parts of a full scale that follows from its setup.
//!
//! Names are those of the built-in meter `pm290`. Register facts follow the PM290 Reference Guide:
//! conversion page 19, basic data page 21, setup pages 24 to 26. The order of the measurements is
//! that of sibling meters, as in the profile.

mod keypad;
mod powers;
mod scale;
mod setup;
mod writes;

use std::cell::OnceCell;

use jiff::Timestamp;

pub use keypad::Keypad;
pub use setup::{Setup, Wiring};

use self::powers::Powers;
use self::scale::{FullScale, lin3};
use self::writes::Writes;
use super::history::{Metered, Sums};
use super::load::{Installation, Load, Quantity, Values};
use super::model::{Content, Deed, Destiny, Measured, Model, Word};
use super::wave::Moment;
use super::words::counter;
use crate::codec::{ExceptionCode, RegisterRange, Write};

/// A workshop on 230/400 V that draws 55 to 165 A. Its demands are means of the periods in the
/// setup: 20 minutes of power, 900 seconds of current.
const WORKSHOP: Installation = Installation {
    voltage: 230.0,
    current: 110.0,
    shares: [0.9, 1.1, 1.0],
    swing: 2.0,
    frequency: 50.0,
    power_window: 20 * 60,
    current_window: 900,
};

/// Watt seconds in a kilowatt hour.
const KILOWATT_HOUR: f64 = 3.6e6;

/// Where energy counters begin again (page 21): two registers of 0 to 9999.
const COUNTER_END: i128 = 100_000_000;

/// A PM290 and the load it measures.
#[derive(Debug)]
pub struct Pm290 {
    load: Load,
    setup: Setup,
    keypad: Keypad,
    writes: Writes,
}

impl Pm290 {
    /// The PM290 that measures the load of `seed`: four wires, no voltage transformers, current
    /// transformers of 200 A, and somebody at its keys every hour.
    pub fn new(seed: u64) -> Self {
        Self {
            load: Load::new(WORKSHOP, seed),
            setup: Setup::default(),
            keypad: Keypad::Hourly,
            writes: Writes::default(),
        }
    }

    /// The same load measured with another setup.
    #[must_use]
    pub const fn with_setup(mut self, setup: Setup) -> Self {
        self.setup = setup;
        self
    }

    /// The same meter with its keys in use at other times.
    #[must_use]
    pub const fn with_keypad(mut self, keypad: Keypad) -> Self {
        self.keypad = keypad;
        self
    }
}

impl Model for Pm290 {
    fn is_busy(&self, range: RegisterRange, now: Timestamp) -> bool {
        self.keypad.blocks(range, now)
    }

    fn is_silent(&self, now: Timestamp) -> bool {
        self.writes.is_restarting(now)
    }

    fn destiny(&self, word: &Word<'_>, shown: &dyn Fn(&str) -> Option<u16>) -> Destiny {
        writes::destiny(word, shown)
    }

    fn tell(&mut self, words: &[Word<'_>], now: Timestamp) {
        for word in words {
            self.setup.tell(&word.point.name, word.value);
            self.writes.clear(word.address, &self.load, now);
        }
    }

    fn command(&mut self, write: &Write, now: Timestamp) -> Option<Result<Deed, ExceptionCode>> {
        let is_restart = writes::is_restart(write);
        is_restart.then(|| {
            self.writes.restart(now);
            Ok(Deed::Done)
        })
    }

    fn measure(&self, now: Timestamp) -> Box<dyn Measured + '_> {
        let moment = Moment::of(now);
        let values = self.load.at(moment.seconds());
        let full = FullScale::of(self.setup);
        Box::new(Reading {
            meter: self,
            now,
            moment,
            values,
            full,
            powers: Powers::of(&values, full.power, self.setup.wiring),
            energy: OnceCell::new(),
            demand: OnceCell::new(),
        })
    }
}

/// All that the meter knows at one instant.
struct Reading<'a> {
    meter: &'a Pm290,
    now: Timestamp,
    moment: Moment,
    values: Values,
    full: FullScale,
    powers: Powers,
    energy: OnceCell<Sums>,
    demand: OnceCell<Sums>,
}

impl Measured for Reading<'_> {
    fn content(&self, point: &str) -> Option<Content> {
        self.instant(point)
            .or_else(|| self.powers.get(point))
            .or_else(|| self.demand(point))
            .or_else(|| self.energy(point))
            .or_else(|| self.meter.setup.get(point))
            .map(Content::Number)
    }
}

impl Reading<'_> {
    fn instant(&self, point: &str) -> Option<i128> {
        use Quantity as Q;

        let wiring = self.meter.setup.wiring;
        let [ab, bc, ca] = if wiring.is_to_neutral() {
            [Q::VoltageAn, Q::VoltageBn, Q::VoltageCn]
        } else {
            [Q::VoltageAb, Q::VoltageBc, Q::VoltageCa]
        };
        let between = |quantity, low, high| Some(lin3(self.values.get(quantity), low, high));
        match point {
            "voltage_a" => between(ab, 0.0, self.full.voltage),
            "voltage_b" => between(bc, 0.0, self.full.voltage),
            "voltage_c" => between(ca, 0.0, self.full.voltage),
            "current_a" => between(Q::CurrentA, 0.0, self.full.current),
            "current_b" => between(Q::CurrentB, 0.0, self.full.current),
            "current_c" => between(Q::CurrentC, 0.0, self.full.current),
            // Without a neutral nothing flows in it.
            "unbalanced_current" if !wiring.has_four_wires() => Some(0),
            "unbalanced_current" => between(Q::CurrentN, 0.0, self.full.current),
            "frequency" => between(Q::Frequency, 45.0, 65.0),
            _ => None,
        }
    }

    /// The running demands are those of the period that ends now.
    fn demand(&self, point: &str) -> Option<i128> {
        let load = &self.meter.load;
        let power = |watts| Some(lin3(watts, -self.full.power, self.full.power));
        let writes = &self.meter.writes;
        let running = |metered| {
            let demand = self.demand.get_or_init(|| writes.demand(load, self.now));
            power(demand.get(metered))
        };
        let highest = |metered| writes.highest_demand(load, metered, self.now);
        let current = |metered| Some(lin3(highest(metered), 0.0, self.full.current));
        match point {
            "accumulated_active_demand" => running(Metered::RealPower),
            "accumulated_apparent_demand" => running(Metered::ApparentPower),
            "max_active_demand" => power(highest(Metered::RealPower)),
            "max_apparent_demand" => power(highest(Metered::ApparentPower)),
            "max_current_demand_a" => current(Metered::CurrentA),
            "max_current_demand_b" => current(Metered::CurrentB),
            "max_current_demand_c" => current(Metered::CurrentC),
            _ => None,
        }
    }

    fn energy(&self, point: &str) -> Option<i128> {
        let of = |metered| {
            let load = &self.meter.load;
            let sums = self
                .energy
                .get_or_init(|| load.history().sums(load, self.moment));
            let counted = sums.get(metered) - self.meter.writes.cleared(metered);
            Some(counter(counted / KILOWATT_HOUR) % COUNTER_END)
        };
        match point {
            "energy_active_import" => of(Metered::RealPower),
            "energy_reactive_positive" => of(Metered::ReactivePower),
            // The load takes real power and lags, always.
            "energy_active_export" | "energy_reactive_negative" => Some(0),
            _ => None,
        }
    }
}
