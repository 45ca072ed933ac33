//! What a [`Load`] has added up to, its demand, and how low and high it has been.
//!
//! One week is worked through in steps of three minutes; every other week is the same again.

use jiff::Timestamp;

use super::load::{Load, Quantity, Values};
use super::wave::{Moment, PERIOD_SECONDS, Wave};

/// Seconds between two samples.
const STEP: u32 = 180;
/// Samples in a week.
const STEPS: usize = (PERIOD_SECONDS / STEP) as usize;
/// Samples between two sums that are kept, and in the window of the demand: a quarter of an hour.
const STEPS_KEPT: usize = 5;
/// Seconds in the window of the demand.
const WINDOW: u32 = 15 * 60;

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
}

/// What each [`Metered`] sums, in its order.
const SUMMED: [Quantity; Metered::CurrentN as usize + 1] = [
    Quantity::RealPowerTotal,
    Quantity::ReactivePowerTotal,
    Quantity::ApparentPowerTotal,
    Quantity::CurrentA,
    Quantity::CurrentB,
    Quantity::CurrentC,
    Quantity::CurrentN,
];

/// A sum of each [`Metered`], in its unit times seconds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sums([f64; SUMMED.len()]);

impl Sums {
    const ZERO: Self = Self([0.0; SUMMED.len()]);

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

    fn since(&self, earlier: &Self) -> Self {
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
            demands: demands(&sums, &sum),
            kept: sums.into_iter().step_by(STEPS_KEPT).collect(),
            whole_week: sum,
            values: finders.iter().map(Finder::extremes).collect(),
        }
    }

    /// What has added up since 2020; nothing before.
    pub fn sums(&self, load: &Load, moment: Moment) -> Sums {
        let index = moment.second / WINDOW;
        // One sum for every quarter of the week that a moment can lie in.
        let mut sums = self.kept[index as usize];
        let mut second = index * WINDOW;
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

    /// The mean of each [`Metered`] over the last quarter of an hour, in its unit.
    pub fn demand(&self, load: &Load, moment: Moment) -> Sums {
        let earlier = self.sums(load, moment.earlier(WINDOW));
        let mut means = self.sums(load, moment).since(&earlier);
        for mean in &mut means.0 {
            *mean /= f64::from(WINDOW);
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
        // `demands` finds one for every metered quantity.
        &self.demands[metered as usize]
    }
}

/// The extremes of all demands over a week of `sums`, from 0 to the whole week's sum.
fn demands(sums: &[Sums], whole_week: &Sums) -> Vec<Extremes> {
    let mut finders: Vec<Finder> = Vec::new();
    let mut second = 0;
    for (index, sum) in sums.iter().enumerate() {
        // The window reaches back into the week before, which was the same.
        let means = if index >= STEPS_KEPT {
            sum.since(&sums[index - STEPS_KEPT])
        } else {
            let left = whole_week.since(&sums[index + STEPS - STEPS_KEPT]);
            sum.since(&Sums::ZERO.since(&left))
        };
        let means = means.0.map(|sum| sum / f64::from(WINDOW));
        if finders.is_empty() {
            finders = means.into_iter().map(Finder::new).collect();
        }
        for (finder, mean) in finders.iter_mut().zip(means) {
            finder.see(mean, second);
        }
        second += STEP;
    }
    finders.iter().map(Finder::extremes).collect()
}
