//! Slow signals that repeat every week: sums of sines with phases from a seed.
//!
//! The common period is what keeps the model pure: what adds up over one week adds up over every
//! other, so a counter's state at any moment is a product and a remainder.

use std::f64::consts::TAU;

use jiff::Timestamp;

/// The moment from which everything counts: 2020-01-01 00:00 UTC, in Unix seconds.
const EPOCH_SECONDS: i64 = 1_577_836_800;

/// Seconds after which every signal repeats: a week.
pub const PERIOD_SECONDS: u32 = 7 * 24 * 3600;

/// A moment as a number of whole weeks since 2020 and a position in the week.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moment {
    /// Whole weeks since 2020-01-01 00:00 UTC; negative before.
    pub week: i32,
    /// Whole seconds into that week, below [`PERIOD_SECONDS`].
    pub second: u32,
    /// The rest of a second, 0 to below 1.
    pub fraction: f64,
}

impl Moment {
    /// Where a time of day lies.
    pub fn of(time: Timestamp) -> Self {
        let nanoseconds = time.as_nanosecond();
        let seconds = nanoseconds.div_euclid(1_000_000_000) - i128::from(EPOCH_SECONDS);
        let period = i128::from(PERIOD_SECONDS);
        // The years -9999 to 9999 that a time of day can have are about 627 000 weeks either way;
        // the remainders are below their divisors. All three fit.
        Self {
            week: i32::try_from(seconds.div_euclid(period)).unwrap_or_default(),
            second: u32::try_from(seconds.rem_euclid(period)).unwrap_or_default(),
            fraction: f64::from(
                u32::try_from(nanoseconds.rem_euclid(1_000_000_000)).unwrap_or_default(),
            ) / 1e9,
        }
    }

    /// The time of day this many seconds into the first week of 2020.
    pub fn in_first_week(second: u32) -> Timestamp {
        // A constant of this century plus a week is far inside the range.
        Timestamp::from_second(EPOCH_SECONDS + i64::from(second)).unwrap_or_default()
    }

    /// This many whole seconds into the first week of 2020; up to a week.
    pub const fn in_week(second: u32) -> Self {
        Self {
            // Its end is the beginning of the next one, which was the same.
            week: if second < PERIOD_SECONDS { 0 } else { 1 },
            second: second % PERIOD_SECONDS,
            fraction: 0.0,
        }
    }

    /// Whole seconds since 2020; 0 before.
    pub fn since_2020(self) -> u64 {
        match u64::try_from(self.week) {
            Ok(weeks) => weeks * u64::from(PERIOD_SECONDS) + u64::from(self.second),
            Err(_) => 0,
        }
    }

    /// The position in the week, in seconds.
    pub fn seconds(self) -> f64 {
        f64::from(self.second) + self.fraction
    }

    /// This many seconds before, less than a week.
    #[must_use]
    pub const fn earlier(self, seconds: u32) -> Self {
        if seconds <= self.second {
            return Self {
                second: self.second - seconds,
                ..self
            };
        }
        Self {
            week: self.week - 1,
            second: self.second + PERIOD_SECONDS - seconds,
            fraction: self.fraction,
        }
    }
}

/// A mean and a few sines around it.
#[derive(Debug, Clone)]
pub struct Wave {
    mean: f64,
    sines: Vec<Sine>,
}

#[derive(Debug, Clone, Copy)]
struct Sine {
    amplitude: f64,
    /// Radians a second.
    speed: f64,
    phase: f64,
}

impl Wave {
    /// A signal around `mean`; each sine is an amplitude and how often it repeats in a week, a
    /// whole number. Their phases come from `random`.
    pub fn new(mean: f64, sines: &[(f64, u16)], random: &mut Random) -> Self {
        Self::scaled(mean, 1.0, sines, random)
    }

    /// As [`Self::new`], with amplitudes in parts of `scale`.
    pub fn scaled(mean: f64, scale: f64, sines: &[(f64, u16)], random: &mut Random) -> Self {
        let sines = sines
            .iter()
            .map(|(amplitude, cycles)| Sine {
                amplitude: amplitude * scale,
                speed: TAU * f64::from(*cycles) / f64::from(PERIOD_SECONDS),
                phase: TAU * random.fraction(),
            })
            .collect();
        Self { mean, sines }
    }

    /// The value this many seconds into the week.
    pub fn at(&self, second: f64) -> f64 {
        self.sines.iter().fold(self.mean, |sum, sine| {
            sum + sine.amplitude * (sine.speed * second + sine.phase).sin()
        })
    }
}

/// Numbers from a seed: `SplitMix64`, by Steele, Lea and Flood ("Fast splittable pseudorandom
/// number generators", 2014).
#[derive(Debug, Clone)]
pub struct Random(u64);

impl Random {
    /// Starts the row of numbers that belongs to `seed`.
    pub const fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// The next number, any of 64 bits.
    pub const fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^ (mixed >> 31)
    }

    /// The next number as a fraction, 0 to below 1.
    pub fn fraction(&mut self) -> f64 {
        f64::from((self.next() >> 32) as u32) / (f64::from(u32::MAX) + 1.0)
    }
}
