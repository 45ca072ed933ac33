//! Three phases of an installation: the physical model.
//!
//! Voltages, currents and power factors of the phases and the frequency are slow [`Wave`]s; all
//! else follows from them. Everything is in volts, amperes, watts, vars, volt-amperes and hertz;
//! unbalances and power factors are fractions of 1.

use std::sync::OnceLock;

use super::history::History;
use super::wave::{Random, Wave};

/// An angle of a third of a turn, by which the phases follow each other.
const THIRD: f64 = std::f64::consts::TAU / 3.0;

/// Something that can be measured at an instant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Phase A to neutral, V: that of the installation within 1 %.
    VoltageAn,
    /// Phase B to neutral, V.
    VoltageBn,
    /// Phase C to neutral, V.
    VoltageCn,
    /// Mean of the phase voltages, V.
    VoltageLnAverage,
    /// Phase A to B, V.
    VoltageAb,
    /// Phase B to C, V.
    VoltageBc,
    /// Phase C to A, V.
    VoltageCa,
    /// Mean of the line voltages, V.
    VoltageLlAverage,
    /// Greatest distance of a phase voltage from their mean, as a fraction of it.
    VoltageUnbalance,
    /// Phase A, A: its share of that of the installation, and up to a fifth of the swing more or less.
    CurrentA,
    /// Phase B, A.
    CurrentB,
    /// Phase C, A.
    CurrentC,
    /// Mean of the phase currents, A.
    CurrentAverage,
    /// In the neutral, A: the vector sum of the phase currents.
    CurrentN,
    /// Greatest distance of a phase current from their mean, as a fraction of it.
    CurrentUnbalance,
    /// Phase A, W.
    RealPowerA,
    /// Phase B, W.
    RealPowerB,
    /// Phase C, W.
    RealPowerC,
    /// All phases, W: their sum.
    RealPowerTotal,
    /// Phase A, var; positive, since the load lags.
    ReactivePowerA,
    /// Phase B, var.
    ReactivePowerB,
    /// Phase C, var.
    ReactivePowerC,
    /// All phases, var: their sum.
    ReactivePowerTotal,
    /// Phase A, VA: voltage times current.
    ApparentPowerA,
    /// Phase B, VA.
    ApparentPowerB,
    /// Phase C, VA.
    ApparentPowerC,
    /// All phases, VA: the vector of the sums of W and var.
    ApparentPowerTotal,
    /// Phase A, W by VA: 0.90 to 0.98.
    PowerFactorA,
    /// Phase B.
    PowerFactorB,
    /// Phase C.
    PowerFactorC,
    /// All phases.
    PowerFactorTotal,
    /// Hz: that of the installation within 0.03.
    Frequency,
}

impl Quantity {
    /// How many there are.
    pub const COUNT: usize = Self::Frequency as usize + 1;
}

/// All quantities at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Values([f64; Quantity::COUNT]);

impl Values {
    /// The value of one of them, in its unit.
    pub const fn get(&self, quantity: Quantity) -> f64 {
        self.0[quantity as usize]
    }

    /// All of them, in the order of [`Quantity`].
    pub(super) const fn as_array(&self) -> &[f64; Quantity::COUNT] {
        &self.0
    }

    fn put<const N: usize>(&mut self, quantities: [Quantity; N], values: [f64; N]) {
        for (quantity, value) in quantities.into_iter().zip(values) {
            self.0[quantity as usize] = value;
        }
    }
}

/// What a load hangs on, how much it draws, and over which times its demand is a mean.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Installation {
    /// Phase to neutral, V.
    pub voltage: f64,
    /// Mean current of the phases, A.
    pub current: f64,
    /// What part of it each phase draws; together 3.
    pub shares: [f64; 3],
    /// How far the currents go from there: 1 for up to a fifth, 4 for up to four fifths; below 5.
    pub swing: f64,
    /// Hz.
    pub frequency: f64,
    /// Seconds that the demand of power is a mean of; below a day.
    pub power_window: u32,
    /// Seconds that the demand of current is a mean of; below a day.
    pub current_window: u32,
}

impl Installation {
    /// A factory on 347/600 V and 60 Hz that draws 300 to 450 A.
    pub const FACTORY: Self = Self {
        voltage: 347.0,
        current: 375.0,
        shares: [1.0; 3],
        swing: 1.0,
        frequency: 60.0,
        power_window: 900,
        current_window: 900,
    };
}

/// The load and what has become of it: a function of a seed and of time.
#[derive(Debug)]
pub struct Load {
    installation: Installation,
    frequency: Wave,
    /// What all three voltages have in common: the day's course of the network.
    network: Wave,
    /// What all three currents have in common: the day's course of the work.
    work: Wave,
    voltages: [Wave; 3],
    currents: [Wave; 3],
    power_factors: [Wave; 3],
    /// Worked out when first asked for: most reads never do.
    history: OnceLock<History>,
}

impl Load {
    /// The load of an installation that belongs to `seed`.
    pub fn new(installation: Installation, seed: u64) -> Self {
        let random = &mut Random::new(seed);
        let factory = Installation::FACTORY;
        let volts = installation.voltage / factory.voltage;
        let amperes = installation.current / factory.current * installation.swing;
        // Amplitudes, here those of the factory, add up to less than the ranges in `Quantity`. Cycles
        // a week: 7 is a day, 168 an hour; the fastest, 20 minutes, is still slow beside the steps of
        // `history`.
        Self {
            installation,
            frequency: Wave::new(installation.frequency, &[(0.018, 61), (0.010, 307)], random),
            network: Wave::scaled(installation.voltage, volts, &[(1.5, 7)], random),
            work: Wave::scaled(
                installation.current,
                amperes,
                &[(30.0, 7), (12.0, 15), (8.0, 151)],
                random,
            ),
            voltages: [(); 3].map(|()| Wave::scaled(0.0, volts, &[(1.0, 211), (0.6, 503)], random)),
            currents: installation.shares.map(|share| {
                let apart = (share - 1.0) * installation.current;
                Wave::scaled(apart, amperes, &[(15.0, 97), (7.0, 331)], random)
            }),
            power_factors: [(); 3].map(|()| Wave::new(0.94, &[(0.020, 61), (0.012, 271)], random)),
            history: OnceLock::new(),
        }
    }

    /// What it is the load of.
    pub const fn installation(&self) -> &Installation {
        &self.installation
    }

    /// Sums, demand and extremes.
    pub fn history(&self) -> &History {
        self.history.get_or_init(|| History::of(self))
    }

    /// Everything there is to measure this many seconds into the week.
    pub fn at(&self, second: f64) -> Values {
        use Quantity as Q;

        let common = |shared: &Wave, own: &[Wave; 3]| {
            let shared = shared.at(second);
            own.each_ref().map(|wave| shared + wave.at(second))
        };
        let volts = common(&self.network, &self.voltages);
        let amperes = common(&self.work, &self.currents);
        let factors = self.power_factors.each_ref().map(|wave| wave.at(second));
        let apparent = [0, 1, 2].map(|phase| volts[phase] * amperes[phase]);
        let real = [0, 1, 2].map(|phase| apparent[phase] * factors[phase]);
        let reactive = [0, 1, 2].map(|phase| reactive(apparent[phase], real[phase]));
        let lines = [
            line_voltage(volts[0], volts[1]),
            line_voltage(volts[1], volts[2]),
            line_voltage(volts[2], volts[0]),
        ];
        let real_total: f64 = real.iter().sum();
        let reactive_total: f64 = reactive.iter().sum();
        let apparent_total = real_total.hypot(reactive_total);

        let mut values = Values([0.0; Quantity::COUNT]);
        values.put([Q::VoltageAn, Q::VoltageBn, Q::VoltageCn], volts);
        values.put([Q::VoltageAb, Q::VoltageBc, Q::VoltageCa], lines);
        values.put([Q::CurrentA, Q::CurrentB, Q::CurrentC], amperes);
        values.put([Q::RealPowerA, Q::RealPowerB, Q::RealPowerC], real);
        values.put(
            [Q::ReactivePowerA, Q::ReactivePowerB, Q::ReactivePowerC],
            reactive,
        );
        values.put(
            [Q::ApparentPowerA, Q::ApparentPowerB, Q::ApparentPowerC],
            apparent,
        );
        values.put([Q::PowerFactorA, Q::PowerFactorB, Q::PowerFactorC], factors);
        values.put(
            [Q::VoltageLnAverage, Q::VoltageLlAverage, Q::CurrentAverage],
            [mean(volts), mean(lines), mean(amperes)],
        );
        values.put(
            [Q::VoltageUnbalance, Q::CurrentUnbalance],
            [unbalance(volts), unbalance(amperes)],
        );
        values.put([Q::CurrentN], [neutral(amperes, factors)]);
        values.put(
            [Q::RealPowerTotal, Q::ReactivePowerTotal],
            [real_total, reactive_total],
        );
        values.put(
            [Q::ApparentPowerTotal, Q::PowerFactorTotal],
            [apparent_total, real_total / apparent_total],
        );
        values.put([Q::Frequency], [self.frequency.at(second)]);
        values
    }
}

fn reactive(apparent: f64, real: f64) -> f64 {
    (apparent * apparent - real * real).sqrt()
}

/// The voltage between two phases a third of a turn apart: the law of cosines.
fn line_voltage(first: f64, second: f64) -> f64 {
    (first * first + second * second + first * second).sqrt()
}

fn mean(phases: [f64; 3]) -> f64 {
    phases.iter().sum::<f64>() / 3.0
}

fn unbalance(phases: [f64; 3]) -> f64 {
    let mean = mean(phases);
    let greatest = phases.map(|value| (value - mean).abs()).into_iter();
    greatest.fold(0.0, f64::max) / mean
}

/// The vector sum of three currents, each behind its voltage by the angle of its power factor.
fn neutral(amperes: [f64; 3], factors: [f64; 3]) -> f64 {
    let behind = [0.0, THIRD, 2.0 * THIRD];
    let (mut along, mut across) = (0.0, 0.0);
    for ((current, factor), behind) in amperes.into_iter().zip(factors).zip(behind) {
        let angle = behind + factor.acos();
        along += current * angle.cos();
        across += current * angle.sin();
    }
    along.hypot(across)
}
