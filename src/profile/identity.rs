//! What must hold between the values of a meter, whatever the load: the sum of the phases, the
//! triangle of powers, the mains frequency. On a live meter it shows whether points that were not
//! read in the maker's manual are where they are thought to be.

use std::fmt;

use rust_decimal::Decimal;
use rust_decimal::prelude::ToPrimitive;
use serde::{Deserialize, Serialize};

/// A law and how far from it readings may lie.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity {
    /// What must hold.
    pub law: Law,
    /// By how much of the greater side the two sides may differ: 0.02 is 2 %. Values read one after
    /// the other belong to a load that has moved on.
    pub tolerance: Decimal,
}

/// What must hold. Points are given by name.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub enum Law {
    /// The whole is the sum of its parts.
    Sum {
        /// The whole.
        whole: String,
        /// The parts.
        parts: Vec<String>,
    },
    /// The mean is that of its parts.
    Mean {
        /// The mean.
        mean: String,
        /// The parts.
        parts: Vec<String>,
    },
    /// Apparent power squared is real power squared plus reactive power squared.
    Apparent {
        /// Apparent power.
        apparent: String,
        /// Real power.
        real: String,
        /// Reactive power.
        reactive: String,
    },
    /// The power factor is real power by apparent power, signs aside: makers give them in more than
    /// one way.
    PowerFactor {
        /// The power factor.
        power_factor: String,
        /// Real power.
        real: String,
        /// Apparent power.
        apparent: String,
    },
    /// The voltage between two phases follows from the voltages of both, a third of a turn apart.
    LineVoltage {
        /// The voltage between the phases.
        line: String,
        /// The voltages of the phases.
        phases: [String; 2],
    },
    /// The value is near one of a few.
    Near {
        /// The value.
        point: String,
        /// What it can be near.
        targets: Vec<Decimal>,
    },
}

/// A value and the step of its register.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Figure {
    /// The value.
    pub value: f64,
    /// The difference that one raw step makes.
    pub step: f64,
}

/// What became of a test.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Outcome {
    /// Both sides agree.
    Holds {
        /// The value of the first point.
        found: f64,
        /// What it should be by the others.
        expected: f64,
    },
    /// They do not.
    Fails {
        /// The value of the first point.
        found: f64,
        /// What it should be by the others.
        expected: f64,
    },
    /// So little flows that anything would agree.
    TooSmall,
    /// A value is missing.
    NoValue,
}

/// Values below this many raw steps prove nothing.
const LEAST_STEPS: f64 = 20.0;

impl Identity {
    /// The tolerance where none is given: 2 %.
    pub const TOLERANCE: Decimal = Decimal::from_parts(2, 0, 0, false, 2);

    /// Tests the law on values by name.
    pub fn test(&self, figure: impl Fn(&str) -> Option<Figure>) -> Outcome {
        self.sides(&figure).map_or(Outcome::NoValue, |sides| {
            let greater = sides.found.abs().max(sides.expected.abs());
            let tolerance = self.tolerance.to_f64().unwrap_or_default();
            let Sides {
                found, expected, ..
            } = sides;
            if sides.is_too_small || greater == 0.0 || greater < LEAST_STEPS * sides.steps {
                Outcome::TooSmall
            } else if (found - expected).abs() <= tolerance * greater + sides.steps {
                Outcome::Holds { found, expected }
            } else {
                Outcome::Fails { found, expected }
            }
        })
    }

    fn sides(&self, figure: &impl Fn(&str) -> Option<Figure>) -> Option<Sides> {
        let all = |names: &[String]| names.iter().map(|name| figure(name)).collect::<Option<_>>();
        Some(match &self.law {
            Law::Sum { whole, parts } => {
                let (whole, parts): (Figure, Vec<Figure>) = (figure(whole)?, all(parts)?);
                Sides {
                    found: whole.value,
                    expected: parts.iter().map(|part| part.value).sum(),
                    steps: whole.step + parts.iter().map(|part| part.step).sum::<f64>(),
                    is_too_small: false,
                }
            }
            Law::Mean { mean, parts } => {
                let (mean, parts): (Figure, Vec<Figure>) = (figure(mean)?, all(parts)?);
                let of_parts = |sum: f64| sum / parts.len().to_f64().unwrap_or(f64::NAN);
                Sides {
                    found: mean.value,
                    expected: of_parts(parts.iter().map(|part| part.value).sum()),
                    steps: mean.step + of_parts(parts.iter().map(|part| part.step).sum()),
                    is_too_small: false,
                }
            }
            Law::Apparent {
                apparent,
                real,
                reactive,
            } => {
                let (apparent, real, reactive) =
                    (figure(apparent)?, figure(real)?, figure(reactive)?);
                Sides {
                    found: apparent.value.abs(),
                    expected: real.value.hypot(reactive.value),
                    steps: apparent.step + real.step + reactive.step,
                    is_too_small: false,
                }
            }
            Law::PowerFactor {
                power_factor,
                real,
                apparent,
            } => {
                let (factor, real, apparent) =
                    (figure(power_factor)?, figure(real)?, figure(apparent)?);
                let size = apparent.value.abs();
                Sides {
                    found: factor.value.abs(),
                    expected: real.value.abs() / size,
                    steps: factor.step + (real.step + apparent.step) / size,
                    is_too_small: size < LEAST_STEPS * apparent.step || size == 0.0,
                }
            }
            Law::LineVoltage {
                line,
                phases: [first, second],
            } => {
                let (line, a, b) = (figure(line)?, figure(first)?, figure(second)?);
                let squares = a.value * a.value + b.value * b.value + a.value * b.value;
                Sides {
                    found: line.value,
                    expected: squares.sqrt(),
                    steps: line.step + a.step + b.step,
                    is_too_small: false,
                }
            }
            Law::Near { point, targets } => {
                let figure = figure(point)?;
                let distance = |target: &f64| (target - figure.value).abs();
                let targets = targets.iter().filter_map(ToPrimitive::to_f64);
                Sides {
                    found: figure.value,
                    expected: targets.min_by(|a, b| distance(a).total_cmp(&distance(b)))?,
                    steps: figure.step,
                    is_too_small: figure.value == 0.0,
                }
            }
        })
    }
}

/// Both sides of a law, and what the steps of the registers allow them to differ by.
struct Sides {
    found: f64,
    expected: f64,
    steps: f64,
    is_too_small: bool,
}

impl Law {
    /// The points it is about, the one that is compared first.
    pub fn points(&self) -> Vec<&str> {
        let names: Vec<&String> = match self {
            Self::Sum { whole, parts } => [whole].into_iter().chain(parts).collect(),
            Self::Mean { mean, parts } => [mean].into_iter().chain(parts).collect(),
            Self::Apparent {
                apparent,
                real,
                reactive,
            } => vec![apparent, real, reactive],
            Self::PowerFactor {
                power_factor,
                real,
                apparent,
            } => vec![power_factor, real, apparent],
            Self::LineVoltage { line, phases } => [line].into_iter().chain(phases).collect(),
            Self::Near { point, .. } => vec![point],
        };
        names.into_iter().map(String::as_str).collect()
    }
}

impl fmt::Display for Law {
    /// As a formula: `power_factor_a = real_power_a / apparent_power_a`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Sum { whole, parts } => write!(f, "{whole} = {}", parts.join(" + ")),
            Self::Mean { mean, parts } => {
                write!(f, "{mean} = ({}) / {}", parts.join(" + "), parts.len())
            }
            Self::Apparent {
                apparent,
                real,
                reactive,
            } => write!(f, "{apparent}² = {real}² + {reactive}²"),
            Self::PowerFactor {
                power_factor,
                real,
                apparent,
            } => write!(f, "|{power_factor}| = |{real}| / {apparent}"),
            Self::LineVoltage {
                line,
                phases: [first, second],
            } => write!(f, "{line} = √({first}² + {second}² + {first} × {second})"),
            Self::Near { point, targets } => {
                let targets: Vec<String> = targets.iter().map(Decimal::to_string).collect();
                write!(f, "{point} near {}", targets.join(" or "))
            }
        }
    }
}
