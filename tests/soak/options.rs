//! What is asked of a run.

use std::fmt;

use crate::line::{Kind, Pace, Plan};

/// The options, by default those of a short run.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Options {
    /// Requests on all lines together.
    pub(crate) transactions: u64,
    /// The share of them that is spoiled, 0 to 1.
    pub(crate) faults: f64,
    pub(crate) seed: u64,
    pub(crate) lines: u64,
}

impl Options {
    /// Reads `--name value` pairs; the error says what is wrong.
    pub(crate) fn parse(mut typed: impl Iterator<Item = String>) -> Result<Self, String> {
        let mut options = Self {
            transactions: 20_000,
            faults: 0.3,
            seed: 7,
            lines: 32,
        };
        while let Some(name) = typed.next() {
            // Cargo adds this by itself.
            if name == "--bench" {
                continue;
            }
            let value = typed.next().ok_or(format!("{name} has no value"))?;
            let wrong = |what| format!("{name} is {what}, found {value:?}");
            let whole = || {
                value
                    .parse()
                    .map_err(|_| wrong("a whole number, such as 16"))
            };
            match name.as_str() {
                "--transactions" => options.transactions = whole()?,
                "--seed" => options.seed = whole()?,
                "--lines" => options.lines = whole()?.clamp(1, 500),
                "--faults" => {
                    let rate = value.parse().ok().filter(|rate| (0.0..=1.0).contains(rate));
                    options.faults = rate.ok_or_else(|| wrong("a share from 0 to 1"))?;
                }
                _ => return Err(format!("there is no option {name:?}")),
            }
        }
        Ok(options)
    }

    /// What the line with this number, from 0, has to do: there are lines of all kinds at each pace.
    pub(crate) fn line(&self, number: u64) -> Plan {
        let kinds = Kind::ALL;
        let round = number / kinds.len() as u64;
        Plan {
            number,
            seed: mix(self.seed ^ mix(number)),
            transactions: self.transactions.div_ceil(self.lines),
            faults: self.faults,
            // Within the array by the remainder, which is small.
            kind: kinds[usize::try_from(number).unwrap_or_default() % kinds.len()],
            pace: if round.is_multiple_of(2) {
                Pace::Fast
            } else {
                Pace::None
            },
        }
    }
}

impl fmt::Display for Options {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "soak           --transactions {} --faults {} --seed {} --lines {}",
            self.transactions, self.faults, self.seed, self.lines
        )
    }
}

/// The finalizer of `SplitMix64`: neighbouring numbers become unlike ones.
fn mix(number: u64) -> u64 {
    let number = number.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let number = (number ^ (number >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let number = (number ^ (number >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    number ^ (number >> 31)
}
