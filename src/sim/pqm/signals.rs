//! Distortion, crest factors and the analog input: slow signals of their own beside the load's.

use std::f64::consts::SQRT_2;

use super::table::Statistic;
use crate::sim::history::Extremes;
use crate::sim::model::Content;
use crate::sim::wave::{Random, Wave};
use crate::sim::words::rounded;

/// What has a distortion, by the end of its point's name.
const DISTORTED: [&str; 10] = [
    "current_a",
    "current_b",
    "current_c",
    "current_n",
    "van",
    "vbn",
    "vcn",
    "vab",
    "vbc",
    "vca",
];

/// All of them, in the steps of their registers.
#[derive(Debug)]
pub(super) struct Signals {
    /// As in [`DISTORTED`], in tenths of a percent.
    distortions: [Wave; DISTORTED.len()],
    /// Of the phase currents, in thousandths.
    crest_factors: [Wave; 3],
    analog_input: Wave,
}

impl Signals {
    pub(super) fn new(random: &mut Random) -> Self {
        let distortions = DISTORTED.map(|name| match name {
            "current_n" => Wave::new(180.0, &[(24.0, 7), (9.0, 97)], random),
            "current_a" | "current_b" | "current_c" => {
                Wave::new(80.0, &[(12.0, 7), (5.0, 97)], random)
            }
            _ => Wave::new(22.0, &[(4.0, 7), (2.0, 151)], random),
        });
        Self {
            distortions,
            crest_factors: [(); 3].map(|()| Wave::new(1520.0, &[(20.0, 7), (9.0, 97)], random)),
            analog_input: Wave::new(620.0, &[(70.0, 7), (15.0, 61)], random),
        }
    }

    /// What the point of this name holds this many seconds into the week, with the extremes of a
    /// distortion as far back as they go.
    pub(super) fn content(
        &self,
        point: &str,
        second: f64,
        extremes: impl Fn(&Wave) -> Extremes,
    ) -> Option<Content> {
        if let Some(name) = point.strip_prefix("thd_") {
            return self.distortion(name, second, extremes);
        }
        let value = match point {
            "analog_input" => self.analog_input.at(second),
            "crest_factor_a" | "crest_factor_b" | "crest_factor_c" | "thdf_a" | "thdf_b"
            | "thdf_c" => {
                let (name, phase) = point.rsplit_once('_')?;
                let phase = ["a", "b", "c"].iter().position(|other| *other == phase)?;
                let crest_factor = self.crest_factors[phase].at(second);
                match name {
                    // Hundredths: that of a sine by that of the current.
                    "thdf" => 100.0 * SQRT_2 / (crest_factor / 1000.0),
                    _ => crest_factor,
                }
            }
            _ => return None,
        };
        Some(Content::Number(rounded(value)))
    }

    fn distortion(
        &self,
        name: &str,
        second: f64,
        extremes: impl Fn(&Wave) -> Extremes,
    ) -> Option<Content> {
        let mean = |waves: &[Wave]| {
            let sum: f64 = waves.iter().map(|wave| wave.at(second)).sum();
            sum / 3.0
        };
        let value = match name {
            "current_avg" => mean(&self.distortions[0..3]),
            "voltage_avg" => mean(&self.distortions[4..7]),
            _ => {
                let (name, statistic) = Statistic::split(name);
                let index = DISTORTED.iter().position(|other| *other == name)?;
                let wave = &self.distortions[index];
                if let Some(statistic) = statistic {
                    return Some(statistic.of(&extremes(wave), 1.0));
                }
                wave.at(second)
            }
        };
        Some(Content::Number(rounded(value)))
    }
}
