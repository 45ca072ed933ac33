//! What the PM290 is set up for (pages 24 to 26).

/// The setup that full scales follow from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Setup {
    /// How voltages and currents are connected.
    pub wiring: Wiring,
    /// Ratio of the voltage transformers in tenths, 1 to 65000; 10 without any.
    pub pt_ratio: u16,
    /// Primary current of the current transformers in A, 1 to 50000.
    pub ct_primary: u16,
}

impl Default for Setup {
    /// Four wires measured to neutral, no voltage transformers, current transformers of 200 A.
    fn default() -> Self {
        Self {
            wiring: Wiring::FourWireLineToNeutral,
            pt_ratio: 10,
            ct_primary: 200,
        }
    }
}

/// How voltages and currents are connected (page 25), by the code of the register.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wiring {
    /// 0: three wires, direct.
    ThreeWireDirect,
    /// 1: four wires, voltages to neutral.
    FourWireLineToNeutral,
    /// 2: three wires, open delta.
    ThreeWireOpenDelta,
    /// 3: four wires, voltages between lines.
    FourWireLineToLine,
}

impl Wiring {
    const ALL: [Self; 4] = [
        Self::ThreeWireDirect,
        Self::FourWireLineToNeutral,
        Self::ThreeWireOpenDelta,
        Self::FourWireLineToLine,
    ];

    /// Whether the voltages are those to neutral.
    pub(super) const fn is_to_neutral(self) -> bool {
        matches!(self, Self::FourWireLineToNeutral)
    }

    /// Whether there is a neutral, so that the power of a phase means anything.
    pub(super) const fn has_four_wires(self) -> bool {
        matches!(self, Self::FourWireLineToNeutral | Self::FourWireLineToLine)
    }
}

/// The points that scales follow from.
pub(super) const IS_SCALED_BY: [&str; 3] =
    ["wiring_configuration", "pt_ratio", "ct_primary_current"];

/// What stands for "suppressed" and "not assigned".
const NONE: i128 = 65535;

impl Setup {
    /// Sets up what a point of this name holds: the same load is measured on other scales from then
    /// on, as with the transformers and the wires that were set up, and what lies above the new full
    /// scale shows as the highest number.
    pub(super) fn tell(&mut self, point: &str, value: u16) {
        match point {
            "wiring_configuration" => {
                let wiring = Wiring::ALL.get(usize::from(value));
                self.wiring = wiring.copied().unwrap_or(self.wiring);
            }
            "pt_ratio" => self.pt_ratio = value,
            "ct_primary_current" => self.ct_primary = value,
            _ => {}
        }
    }

    /// The register of a point that is set up or tells the state of the meter.
    pub(super) fn get(self, point: &str) -> Option<i128> {
        Some(match point {
            "wiring_configuration" => self.wiring as i128,
            "pt_ratio" => self.pt_ratio.into(),
            "ct_primary_current" => self.ct_primary.into(),
            // The windows of the load.
            "power_demand_period" => 20,
            "ampere_demand_period" => 900,
            "averaging_buffer_size" => 8,
            "pulse_kwh_import" | "pulse_kwh_export" | "pulse_kvarh" => NONE,
            channel if channel.starts_with("analog_channel_") => NONE,
            "firmware_version" => 221,
            // Resets are allowed; all is well; while a key is pressed this cannot be read; relays
            // and contacts are open.
            "reset_mode" | "state_flags" | "keypad_status" | "relay_status" | "dip_switches"
            | "dry_contacts" | "analog_reserved_1" | "analog_reserved_2" => 0,
            _ => return None,
        })
    }
}
