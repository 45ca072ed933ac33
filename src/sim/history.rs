//! What a [`Load`] has added up to, its demand, and how low and high it has been.
//!
//! One week is worked through in steps of three minutes; every other week is the same again. What
//! has been since something was cleared is in `since`.

pub(super) mod since;

use jiff::Timestamp;

use super::load::{Installation, Load, Quantity, Values};
use super::wave::{Moment, PERIOD_SECONDS, Wave};

/// Seconds between two samples.
const STEP: u32 = 180;
/// Samples in a week.
const STEPS: usize = (PERIOD_SECONDS / STEP) as usize;
/// Samples between two sums that are kept: a quarter of an hour.
const STEPS_KEPT: u32 = 5;
/// Seconds between two sums that are kept.
const KEPT: u32 = STEP * STEPS_KEPT;

/// A quantity that is summed over time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Metered {
    /// Three-phase real power, W.
    RealPower,
    /// Three-phase reactive power, var.
    ReactivePower,
    /// Three-phase apparent power, VA.
    ApparentPower,
    /// Phase A current, A.
    CurrentA,
    /// Phase B current, A.
    CurrentB,
    /// Phase C current, A.
    CurrentC,
    /// Neutral current, A.
    CurrentN,
    /// Phase A real power, W.
    RealPowerA,
    /// Phase B real power, W.
    RealPowerB,
    /// Phase C real power, W.
    RealPowerC,
}

impl Metered {
    /// How many there are.
    const COUNT: usize = Self::RealPowerC as usize + 1;

    /// All of them, in their order.
    const ALL: [Self; Self::COUNT] = [
        Self::RealPower,
        Self::ReactivePower,
        Self::ApparentPower,
        Self::CurrentA,
        Self::CurrentB,
        Self::CurrentC,
        Self::CurrentN,
        Self::RealPowerA,
        Self::RealPowerB,
        Self::RealPowerC,
    ];

    /// The seconds that its demand is a mean of.
    const fn window(self, installation: &Installation) -> u32 {
        match self {
            Self::CurrentA | Self::CurrentB | Self::CurrentC | Self::CurrentN => {
                installation.current_window
            }
            _ => installation.power_window,
        }
    }
}

/// What each [`Metered`] sums, in its order.
const SUMMED: [Quantity; Metered::COUNT] = [
    Quantity::RealPowerTotal,
    Quantity::ReactivePowerTotal,
    Quantity::ApparentPowerTotal,
    Quantity::CurrentA,
    Quantity::CurrentB,
    Quantity::CurrentC,
    Quantity::CurrentN,
    Quantity::RealPowerA,
    Quantity::RealPowerB,
    Quantity::RealPowerC,
];

/// A sum of each [`Metered`], in its unit times seconds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sums([f64; Metered::COUNT]);

impl Sums {
    pub(super) const ZERO: Self = Self([0.0; Metered::COUNT]);

    /// The sum of one of them, in its unit times seconds.
    pub const fn get(&self, metered: Metered) -> f64 {
        self.0[metered as usize]
    }

    /// What a stretch of `seconds` between two instants adds.
    fn add(&mut self, from: &Values, to: &Values, seconds: f64) {
        for (sum, quantity) in self.0.iter_mut().zip(SUMMED) {
            *sum += f64::midpoint(from.get(quantity), to.get(quantity)) * seconds;
        }
    }

    /// What has been added since it was `earlier`.
    pub(super) fn since(&self, earlier: &Self) -> Self {
        let mut sums = *self;
        for (sum, earlier) in sums.0.iter_mut().zip(earlier.0) {
            *sum -= earlier;
        }
        sums
    }
}

/// How low and how high something has been, and when.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extremes {
    /// At most the lowest value it ever has, in its unit.
    pub lowest: f64,
    /// When that was, in the first week of 2020.
    pub lowest_at: Timestamp,
    /// At least the highest value it ever has, in its unit.
    pub highest: f64,
    /// When that was, in the first week of 2020.
    pub highest_at: Timestamp,
}

/// Finds the extremes of a row of samples.
#[derive(Debug, Clone, Copy)]
struct Finder {
    lowest: (f64, u32),
    highest: (f64, u32),
    last: f64,
    greatest_change: f64,
}

impl Finder {
    const fn new(first: f64) -> Self {
        Self {
            lowest: (first, 0),
            highest: (first, 0),
            last: first,
            greatest_change: 0.0,
        }
    }

    fn see(&mut self, value: f64, second: u32) {
        if value < self.lowest.0 {
            self.lowest = (value, second);
        }
        if value > self.highest.0 {
            self.highest = (value, second);
        }
        self.greatest_change = self.greatest_change.max((value - self.last).abs());
        self.last = value;
    }

    /// Widened by the greatest change from one sample to the next. Between two samples a value
    /// strays past both by half a step times its steepest slope at the most, and the greatest
    /// change is more than half of that product for sines slower than five steps.
    fn extremes(&self) -> Extremes {
        Extremes {
            // Nothing here is ever negative.
            lowest: (self.lowest.0 - self.greatest_change).max(0.0),
            lowest_at: Moment::in_first_week(self.lowest.1),
            highest: self.highest.0 + self.greatest_change,
            highest_at: Moment::in_first_week(self.highest.1),
        }
    }
}

/// The extremes of a signal.
pub(super) fn extremes(signal: &Wave) -> Extremes {
    let mut finder = Finder::new(signal.at(0.0));
    for second in (0..=PERIOD_SECONDS).step_by(STEP as usize) {
        finder.see(signal.at(f64::from(second)), second);
    }
    finder.extremes()
}

/// The history of one load.
#[derive(Debug)]
pub struct History {
    /// What the week has added up to at each quarter of an hour, from 0 to the whole week.
    kept: Vec<Sums>,
    whole_week: Sums,
    values: Vec<Extremes>,
    demands: Vec<Extremes>,
}

impl History {
    /// Works through a week of `load`.
    pub(super) fn of(load: &Load) -> Self {
        let mut previous = load.at(0.0);
        let mut finders = previous.as_array().map(Finder::new);
        let mut sums = vec![Sums::ZERO];
        let mut sum = Sums::ZERO;
        let mut second = 0;
        for _ in 0..STEPS {
            second += STEP;
            let values = load.at(f64::from(second));
            sum.add(&previous, &values, f64::from(STEP));
            sums.push(sum);
            for (finder, value) in finders.iter_mut().zip(values.as_array()) {
                finder.see(*value, second);
            }
            previous = values;
        }
        Self {
            demands: Metered::ALL
                .map(|metered| demand(metered, load.installation(), &sums))
                .to_vec(),
            kept: sums.into_iter().step_by(STEPS_KEPT as usize).collect(),
            whole_week: sum,
            values: finders.iter().map(Finder::extremes).collect(),
        }
    }

    /// What has added up since 2020; nothing before.
    pub fn sums(&self, load: &Load, moment: Moment) -> Sums {
        let index = moment.second / KEPT;
        // One sum for every quarter of the week that a moment can lie in.
        let mut sums = self.kept[index as usize];
        let mut second = index * KEPT;
        let mut from = load.at(f64::from(second));
        while second + STEP <= moment.second {
            second += STEP;
            let to = load.at(f64::from(second));
            sums.add(&from, &to, f64::from(STEP));
            from = to;
        }
        let rest = moment.seconds() - f64::from(second);
        sums.add(&from, &load.at(moment.seconds()), rest);
        for (sum, whole) in sums.0.iter_mut().zip(self.whole_week.0) {
            *sum += whole * f64::from(moment.week);
        }
        sums
    }

    /// The mean of each [`Metered`] over its window, which ends now, in its unit.
    pub fn demand(&self, load: &Load, moment: Moment) -> Sums {
        self.means(load, moment, |window| moment.earlier(window))
    }

    /// The same, where what was before `cleared` counts as nothing.
    pub fn demand_since(&self, load: &Load, cleared: Timestamp, now: Timestamp) -> Sums {
        let moment = Moment::of(now);
        let age = now.duration_since(cleared).as_secs();
        self.means(load, moment, |window| {
            if age < i64::from(window) {
                Moment::of(cleared)
            } else {
                moment.earlier(window)
            }
        })
    }

    /// What has been added from the beginning of each window until now, by its length.
    fn means(&self, load: &Load, moment: Moment, begin: impl Fn(u32) -> Moment) -> Sums {
        let now = self.sums(load, moment);
        let mean = |window: u32| {
            let mut mean = now.since(&self.sums(load, begin(window)));
            for sum in &mut mean.0 {
                *sum /= f64::from(window);
            }
            mean
        };
        let installation = load.installation();
        let mut means = mean(installation.power_window);
        if installation.current_window != installation.power_window {
            let currents = mean(installation.current_window);
            for metered in Metered::ALL {
                if metered.window(installation) == installation.current_window {
                    means.0[metered as usize] = currents.get(metered);
                }
            }
        }
        means
    }

    /// The extremes of a quantity.
    pub fn of_quantity(&self, quantity: Quantity) -> &Extremes {
        // `of` finds one for every quantity.
        &self.values[quantity as usize]
    }

    /// The extremes of a demand.
    pub fn of_demand(&self, metered: Metered) -> &Extremes {
        // `of` finds one for every metered quantity.
        &self.demands[metered as usize]
    }
}

/// The extremes of a demand over a week of `sums`, from 0 to the whole week's sum.
fn demand(metered: Metered, installation: &Installation, sums: &[Sums]) -> Extremes {
    let window = metered.window(installation);
    let mean = |index: usize| {
        let risen = sums[index].get(metered) - before(metered, window, sums, index);
        risen / f64::from(window)
    };
    let mut finder = Finder::new(mean(0));
    for (index, second) in (0..sums.len()).zip((0..).step_by(STEP as usize)) {
        finder.see(mean(index), second);
    }
    finder.extremes()
}

/// What had been added up `window` seconds before a sample: below 0 where that was in the week
/// before, which was the same. Between samples the sum is taken to rise evenly.
fn before(metered: Metered, window: u32, sums: &[Sums], index: usize) -> f64 {
    let steps_before = |steps: usize| {
        let sum = |index: usize| sums[index].get(metered);
        if index >= steps {
            sum(index - steps)
        } else {
            sum(index + STEPS - steps) - sum(STEPS)
        }
    };
    let steps = (window / STEP) as usize;
    let part = f64::from(window % STEP) / f64::from(STEP);
    steps_before(steps) * (1.0 - part) + steps_before(steps + 1) * part
}
