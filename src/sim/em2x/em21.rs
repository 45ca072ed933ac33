//! What the EM21 has of its own: pages 8 to 10 of its document.

use super::Reading;
use crate::sim::load::Installation;

/// A shop on 230/400 V that draws 36 to 84 A: 1.8 to 4.2 A behind its current transformers.
pub(super) const SHOP: Installation = Installation {
    voltage: 230.0,
    current: 60.0,
    shares: [1.1, 1.0, 0.9],
    swing: 1.5,
    frequency: 50.0,
    power_window: 900,
    current_window: 900,
};

/// Registers that hold the same always.
const FIXED: [(&str, i128); 10] = [
    // An EM21 AV5.
    ("identification_code", 57),
    // L1-L2-L3.
    ("phase_sequence", 0),
    // Version B, revision 2.
    ("firmware_version_code", 1),
    ("firmware_revision_code", 2),
    ("password", 0),
    // A.
    ("application", 0),
    // Three phases with neutral.
    ("measuring_system", 0),
    // 100 A to 5 A, no voltage transformers.
    ("ct_ratio", 200),
    ("vt_ratio", 10),
    // 0.1 kWh.
    ("pulse_weight", 10),
];

impl Reading<'_> {
    pub(super) fn em21(&self, point: &str) -> Option<i128> {
        match point {
            "energy_active_import_total" => Some(self.energy().total.active()),
            "energy_reactive_import_total" => Some(self.energy().total.reactive()),
            "rs485_address" => Some(self.meter.unit.into()),
            _ => super::fixed(&FIXED, point),
        }
    }
}
