//! A GE Multilin PQM: which quantity stands behind which point, in whole steps of its registers.
//!
//! Names are those of the built-in meter `pqm`. Register facts follow the PQM manual, edition
//! 3.6x, chapter 7: areas of the memory map pages 197 to 251, formats F22 to F25 page 257.

mod commands;
mod minmax;
mod records;
mod setpoints;
mod signals;
mod state;
mod steady;
mod table;
mod words;

use std::cell::OnceCell;
use std::ops::RangeInclusive;

use jiff::{Timestamp, civil};

use self::minmax::Since;
use self::signals::Signals;
use self::state::{Cleared, State};
use self::table::{DEMANDS, HUNDREDTH, QUANTITIES, Statistic, TEN_WATTS};
use self::words::{date, date_of, time_of};
use super::history::{self, Extremes, Metered, Sums, since};
use super::load::{Installation, Load, Quantity, Values};
use super::model::{Content, Deed, Destiny, Measured, Model, Word};
use super::powers::Powers;
use super::wave::{Moment, Random, Wave};
use super::words::{counter, rounded, text};
use crate::codec::{ExceptionCode, Unit, Write};

/// What functions 03 and 04 can read: product information; user map and actual values; setpoints. The
/// command area behind the first is write only.
const AREAS: [RangeInclusive<u16>; 3] = [0x0000..=0x007F, 0x0100..=0x0E1F, 0x1000..=0x131F];

/// Cents for a kilowatt hour: the factory setting of all three tariffs (manual page 233).
const CENTS_PER_KILOWATT_HOUR: f64 = 10.0;

/// Watt seconds in a kilowatt hour.
const KILOWATT_HOUR: f64 = 3.6e6;

/// Seconds in a day.
const DAY: u32 = 24 * 3600;

/// A PQM and the load it measures.
#[derive(Debug)]
pub struct Pqm {
    load: Load,
    signals: Signals,
    serial_number: String,
    /// What its setpoint says.
    unit: u8,
    /// What that says when all settings are lost.
    first_unit: u8,
    state: State,
}

impl Pqm {
    /// The PQM that belongs to `seed`: its load and its serial number come from there.
    pub fn new(seed: u64) -> Self {
        // A row of numbers other than the load's.
        let mut random = Random::new(!seed);
        let number = random.next() % 10_000_000;
        Self {
            load: Load::new(Installation::FACTORY, seed),
            signals: Signals::new(&mut random),
            serial_number: format!("C{number:07}"),
            unit: 17,
            first_unit: 17,
            state: State::default(),
        }
    }

    /// The same meter set up as another unit; without that its setpoint says 17.
    #[must_use]
    pub const fn with_unit(mut self, unit: Unit) -> Self {
        self.unit = unit.get();
        self.first_unit = unit.get();
        self
    }

    fn read(&self, now: Timestamp) -> Reading<'_> {
        let moment = Moment::of(now);
        let values = self.load.at(moment.seconds());
        Reading {
            pqm: self,
            now,
            moment,
            values,
            powers: Powers::of(&values, TEN_WATTS, HUNDREDTH),
            energy: OnceCell::new(),
            demand: OnceCell::new(),
            since: Since::default(),
        }
    }
}

impl Model for Pqm {
    fn areas(&self) -> &[RangeInclusive<u16>] {
        &AREAS
    }

    fn status(&self, _: Timestamp) -> u8 {
        self.state.status()
    }

    fn unit(&self) -> Option<u8> {
        Some(self.unit)
    }

    fn destiny(&self, word: &Word<'_>, _: &dyn Fn(&str) -> Option<u16>) -> Destiny {
        commands::destiny(word)
    }

    fn tell(&mut self, words: &[Word<'_>], now: Timestamp) {
        self.obey(words, now);
    }

    fn command(&mut self, write: &Write, now: Timestamp) -> Option<Result<Deed, ExceptionCode>> {
        self.carry_out(write, now)
    }

    fn measure(&self, now: Timestamp) -> Box<dyn Measured + '_> {
        Box::new(self.read(now))
    }
}

/// All that the meter knows at one instant.
struct Reading<'a> {
    pqm: &'a Pqm,
    now: Timestamp,
    moment: Moment,
    values: Values,
    powers: Powers,
    energy: OnceCell<(Sums, Sums)>,
    demand: OnceCell<Sums>,
    since: Since,
}

impl Measured for Reading<'_> {
    fn content(&self, point: &str) -> Option<Content> {
        self.product(point)
            .or_else(|| self.clock(point))
            .or_else(|| self.live(point))
            .or_else(|| self.lights(point))
            .or_else(|| records::content(point, self.moment, &self.pqm.state))
            .or_else(|| steady::content(point))
            .or_else(|| setpoints::content(point))
            .or_else(|| self.event(point))
    }
}

impl Reading<'_> {
    fn product(&self, point: &str) -> Option<Content> {
        Some(match point {
            "product_code" => Content::Number(65),
            // The letter D.
            "hardware_version" => Content::Number(4),
            "firmware_version" => Content::Number(360),
            "boot_version" => Content::Number(300),
            "supervisor_version" => Content::Number(110),
            // A display and the power analysis option.
            "options" => Content::Number(0x0011),
            "mod_file_1" | "mod_file_2" | "mod_file_3" | "mod_file_4" | "mod_file_5" => {
                Content::Number(0)
            }
            // Eight characters (F10).
            "modbus_address" => Content::Number(self.pqm.unit.into()),
            "serial_number" => text(&self.pqm.serial_number),
            "manufacture_date" => date(civil::date(2006, 3, 14)),
            "calibration_date" => date(civil::date(2006, 3, 21)),
            _ => return None,
        })
    }

    fn clock(&self, point: &str) -> Option<Content> {
        Some(match point {
            "clock_time" => time_of(self.pqm.state.by_its_clock(self.now)),
            "clock_date" => date_of(self.pqm.state.by_its_clock(self.now)),
            _ => return None,
        })
    }

    /// Relays, and the lights that tell of them.
    fn lights(&self, point: &str) -> Option<Content> {
        let state = &self.pqm.state;
        Some(Content::Number(match point {
            "output_relays" => state.relays().into(),
            "led_status" | "led_attribute" => state.lights().into(),
            _ => return None,
        }))
    }

    /// What changes with the load.
    fn live(&self, point: &str) -> Option<Content> {
        let signal = || self.signal(point);
        self.energy(point)
            .or_else(|| self.measured(point))
            .or_else(signal)
    }

    /// What has been recorded of the event.
    fn event(&self, point: &str) -> Option<Content> {
        let point = point.strip_prefix("event_")?;
        let was = self.pqm.read(records::event()).live(point)?;
        // Nothing has happened since the record was cleared.
        let is_cleared = self.cleared(Cleared::Events).is_some();
        Some(if is_cleared { Content::Number(0) } else { was })
    }

    fn energy(&self, point: &str) -> Option<Content> {
        let whole = |value| Content::Number(counter(value));
        let of = |metered| whole(self.sums().0.get(metered) / KILOWATT_HOUR);
        let real = || self.sums().0.get(Metered::RealPower) / KILOWATT_HOUR;
        let day = || real() - self.sums().1.get(Metered::RealPower) / KILOWATT_HOUR;
        Some(match point {
            "energy_real_pos" => of(Metered::RealPower),
            "energy_reactive_pos" => of(Metered::ReactivePower),
            "energy_apparent" => of(Metered::ApparentPower),
            // The load takes real power and lags, always.
            "energy_real_neg" | "energy_reactive_neg" => Content::Number(0),
            "energy_real_24h" => whole(day()),
            "energy_cost_total" => whole(real() * CENTS_PER_KILOWATT_HOUR),
            "energy_cost_per_day" => whole(day() * CENTS_PER_KILOWATT_HOUR),
            _ => return None,
        })
    }

    /// What has added up until now and until a day ago, since it was cleared; worked out for the
    /// first counter that is asked for.
    fn sums(&self) -> &(Sums, Sums) {
        self.energy.get_or_init(|| {
            let load = &self.pqm.load;
            let until = |moment| load.history().sums(load, moment);
            let (now, day_ago) = (self.moment, self.moment.earlier(DAY));
            let Some(cleared) = self.cleared(Cleared::Energy) else {
                return (until(now), until(day_ago));
            };
            let before = until(Moment::of(cleared));
            let is_of_today = self.now.duration_since(cleared).as_secs() < DAY.into();
            let day_ago = if is_of_today {
                Sums::ZERO
            } else {
                until(day_ago).since(&before)
            };
            (until(now).since(&before), day_ago)
        })
    }

    /// When this was cleared, where that was before now.
    fn cleared(&self, what: Cleared) -> Option<Timestamp> {
        let cleared = self.pqm.state.cleared(what);
        cleared.filter(|cleared| *cleared <= self.now)
    }

    /// A measured point, or the minimum or maximum of one, or when that was.
    fn measured(&self, point: &str) -> Option<Content> {
        let load = &self.pqm.load;
        let (name, statistic) = Statistic::split(point);
        if let Some(row) = QUANTITIES.iter().position(|(row, ..)| *row == name) {
            let (_, quantity, step) = QUANTITIES[row];
            return Some(match (statistic, self.since.of_quantity(self, row)) {
                (None, _) => Content::Number(self.raw(quantity, step)),
                (Some(statistic), Some(extremes)) => statistic.of(&extremes, 1.0),
                (Some(statistic), None) => statistic.of(load.history().of_quantity(quantity), step),
            });
        }
        let row = DEMANDS.iter().position(|(row, ..)| *row == name)?;
        let (_, metered, step) = DEMANDS[row];
        Some(match (statistic, self.since.of_demand(self, row)) {
            (None, _) => {
                let demand = self.demand.get_or_init(|| self.demand_at(self.now));
                Content::Number(rounded(demand.get(metered) / step))
            }
            (Some(statistic), Some(extremes)) => statistic.of(&extremes, 1.0),
            (Some(statistic), None) => statistic.of(load.history().of_demand(metered), step),
        })
    }

    /// The register of a quantity.
    fn raw(&self, quantity: Quantity, step: f64) -> i128 {
        let measured = || rounded(self.values.get(quantity) / step);
        self.powers.get(quantity).unwrap_or_else(measured)
    }

    /// The demands as they were shown at a moment.
    fn demand_at(&self, at: Timestamp) -> Sums {
        let load = &self.pqm.load;
        match self.cleared(Cleared::Demand) {
            Some(cleared) if cleared <= at => load.history().demand_since(load, cleared, at),
            _ => load.history().demand(load, Moment::of(at)),
        }
    }

    /// Distortion and the like.
    fn signal(&self, point: &str) -> Option<Content> {
        let extremes = |wave: &Wave| match self.cleared(Cleared::Distortion) {
            None => history::extremes(wave),
            Some(cleared) => {
                let value = |at| [wave.at(Moment::of(at).seconds())];
                let [extremes] = since::extremes(cleared, self.now, value);
                self.by_its_clock(&extremes)
            }
        };
        let second = self.moment.seconds();
        self.pqm.signals.content(point, second, extremes)
    }

    /// The same with times as its clock would have shown them.
    fn by_its_clock(&self, extremes: &Extremes) -> Extremes {
        let state = &self.pqm.state;
        Extremes {
            lowest_at: state.by_its_clock(extremes.lowest_at),
            highest_at: state.by_its_clock(extremes.highest_at),
            ..*extremes
        }
    }
}
