//! What the EM24-DIN has of its own: pages 8 to 13 of its document.

use super::{Reading, TENTH, THOUSANDTH, energy, inputs};
use crate::sim::history::Metered;
use crate::sim::load::Installation;
use crate::sim::model::{Content, Destiny};
use crate::sim::wave::Moment;
use crate::sim::words::{rounded, text};

/// A large house on 230/400 V that draws 5 to 39 A.
pub(super) const HOUSE: Installation = Installation {
    voltage: 230.0,
    current: 22.0,
    shares: [1.0, 0.9, 1.1],
    swing: 3.5,
    frequency: 50.0,
    power_window: 15 * 60,
    current_window: 15 * 60,
};

/// Registers that hold the same always.
const FIXED: [(&str, i128); 22] = [
    // An EM24-DIN AV9.
    ("identification_code", 70),
    // L1-L2-L3.
    ("phase_sequence", 0),
    // Published drivers list 0 to 10, all of them models PFA, which have no application H.
    ("firmware_version_code", 11),
    ("firmware_revision_code", 3),
    // Position 1: settings can be written.
    ("front_selector_status", 2),
    ("password", 0),
    // H: power has a sign.
    ("application", 7),
    // Three phases with neutral.
    ("measuring_system", 0),
    // Minutes: the window of the load.
    ("demand_interval", 15),
    ("selector_page_position_3", 3),
    ("selector_page_position_2", 2),
    ("selector_page_position_1", 1),
    ("selector_page_position_0", 0),
    ("filter_span", 2),
    ("filter_coefficient", 2),
    // 9600.
    ("rs485_baud_rate", 1),
    ("user_id_1", 1),
    ("user_id_2", 2),
    ("user_id_3", 3),
    // The tariff is set over the line, by another client than this one.
    ("tariff_via_serial", 1),
    // No transformers.
    ("ct_ratio", 10),
    ("vt_ratio", 10),
];

impl Reading<'_> {
    pub(super) fn em24(&self, point: &str) -> Option<Content> {
        if point == "serial_number" {
            // 13 characters, the last in a high byte (page 13).
            return Some(text(&format!("BX{:010}A", self.meter.serial_number)));
        }
        self.counted(point)
            .or_else(|| self.demanded(point))
            .or_else(|| self.input(point))
            .or_else(|| self.setup(point))
            .map(Content::Number)
    }

    fn counted(&self, point: &str) -> Option<i128> {
        Some(match point {
            "energy_active_import_total" => self.energy().total.active(),
            "energy_reactive_import_total" => self.energy().total.reactive(),
            "energy_active_import_partial" => self.energy().partial.active(),
            "energy_reactive_import_partial" => self.energy().partial.reactive(),
            "energy_active_import_l1" => self.energy().total.phase(0),
            "energy_active_import_l2" => self.energy().total.phase(1),
            "energy_active_import_l3" => self.energy().total.phase(2),
            "energy_active_import_t1" => self.energy().day().active(),
            "energy_reactive_import_t1" => self.energy().day().reactive(),
            "energy_active_import_t2" => self.energy().night.active(),
            "energy_reactive_import_t2" => self.energy().night.reactive(),
            // There are two tariffs, and the load takes real power and lags, always.
            "energy_active_import_t3"
            | "energy_active_import_t4"
            | "energy_reactive_import_t3"
            | "energy_reactive_import_t4"
            | "energy_active_export_total"
            | "energy_reactive_export_total" => 0,
            "current_tariff" => i128::from(energy::is_night(self.moment)),
            "hour_counter" => hours(self.moment) - self.meter.resets.hours,
            _ => return None,
        })
    }

    /// What belongs to an input, of which the counters may have been set to zero.
    fn input(&self, point: &str) -> Option<i128> {
        let raw = inputs::get(point, self.moment)?;
        Some(raw - self.meter.resets.counter(point))
    }

    fn demanded(&self, point: &str) -> Option<i128> {
        let highest = |metered| {
            self.meter
                .resets
                .highest(&self.meter.load, metered, self.now)
        };
        let current = || {
            let phases = [Metered::CurrentA, Metered::CurrentB, Metered::CurrentC];
            phases.map(highest).into_iter().fold(0.0, f64::max)
        };
        Some(match point {
            "demand_active_power_sys" => rounded(self.demand().get(Metered::RealPower) / TENTH),
            "demand_apparent_power_sys" => {
                rounded(self.demand().get(Metered::ApparentPower) / TENTH)
            }
            "demand_active_power_max" => rounded(highest(Metered::RealPower) / TENTH),
            "demand_apparent_power_max" => rounded(highest(Metered::ApparentPower) / TENTH),
            "demand_current_max" => rounded(current() / THOUSANDTH),
            _ => return None,
        })
    }

    fn setup(&self, point: &str) -> Option<i128> {
        match point {
            "rs485_address" => Some(self.meter.unit.into()),
            "secondary_address" => Some((self.meter.serial_number % 100_000_000).into()),
            _ => super::fixed(&FIXED, point),
        }
    }
}

/// Hundredths of an hour since 2020.
pub(super) fn hours(moment: Moment) -> i128 {
    i128::from(moment.since_2020() / 36)
}

/// What becomes of a setting. For these the EM24 puts a value of its own in place of one that is out
/// of range (page 10 to 12); of the others the pages that could be had say nothing.
pub(super) fn destiny(point: &str) -> Destiny {
    match point {
        "password" => Destiny::Else(0),
        // Page 1 is number 0.
        _ if point.starts_with("selector_page_") => Destiny::Else(0),
        _ if point.starts_with("digital_input_") && point.ends_with("_type") => Destiny::Else(0),
        _ if point.ends_with("_prescaler") => Destiny::Else(1),
        _ => Destiny::Setting,
    }
}
