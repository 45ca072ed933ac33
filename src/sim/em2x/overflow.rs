//! A measurement that is out of range.

use super::Kind;

/// The most significant word of what is out of range; any word can go with it.
const OVERFLOW: i128 = 0x7FFF;
const ANY_WORD: i128 = 0x1234;

/// What is out of range.
#[derive(Debug)]
pub(super) struct Overflow {
    point: String,
}

impl Overflow {
    pub(super) fn new(point: &str) -> Self {
        Self {
            point: point.to_owned(),
        }
    }

    /// What a point shows because of it; `None` for one that has nothing to do with it. On the EM24
    /// the value of all phases is out of range as well, and the power factor of the phase is 0
    /// (installation manual). Demand, hours and energy, which a real one then stops, go on.
    pub(super) fn shows(&self, point: &str, kind: Kind) -> Option<i128> {
        let is_em24 = kind == Kind::Em24;
        if point == self.point || (is_em24 && self.system() == Some(point)) {
            let is_one_word = point.starts_with("power_factor_") || point == "frequency";
            return Some(if is_one_word {
                OVERFLOW
            } else {
                OVERFLOW << 16 | ANY_WORD
            });
        }
        let phase = point.strip_prefix("power_factor_")?;
        let mut phases = self.point.split('_');
        (is_em24 && phases.any(|part| part == phase)).then_some(0)
    }

    /// The point of all phases that the point of a phase goes into.
    fn system(&self) -> Option<&'static str> {
        let (what, rest) = self.point.split_once("_l")?;
        Some(match what {
            "voltage" if rest.ends_with("_n") => "voltage_ln_sys",
            "voltage" => "voltage_ll_sys",
            "active_power" => "active_power_sys",
            "apparent_power" => "apparent_power_sys",
            "reactive_power" => "reactive_power_sys",
            "power_factor" => "power_factor_sys",
            _ => return None,
        })
    }
}
