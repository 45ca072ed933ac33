//! How low and how high something has been since it was cleared.

use jiff::{SignedDuration, Timestamp};

use super::Extremes;
use crate::sim::wave::PERIOD_SECONDS;

/// Seconds between two looks. What a signal does in between is not seen: the fastest take twenty
/// minutes for a turn.
const STEP: i64 = 60;

/// The extremes of rows of values between two moments, both of them included: `values` gives the
/// rows at one. What was more than a week ago has been again since.
pub(in crate::sim) fn extremes<const N: usize>(
    since: Timestamp,
    now: Timestamp,
    values: impl Fn(Timestamp) -> [f64; N],
) -> [Extremes; N] {
    let week = SignedDuration::from_secs(PERIOD_SECONDS.into());
    let first = since
        .max(now.saturating_sub(week).unwrap_or(since))
        .min(now);
    let mut found = values(first).map(|value| Extremes {
        lowest: value,
        lowest_at: first,
        highest: value,
        highest_at: first,
    });
    let mut see = |at: Timestamp| {
        for (extremes, value) in found.iter_mut().zip(values(at)) {
            if value < extremes.lowest {
                (extremes.lowest, extremes.lowest_at) = (value, at);
            }
            if value > extremes.highest {
                (extremes.highest, extremes.highest_at) = (value, at);
            }
        }
    };
    let seconds = now.duration_since(first).as_secs();
    // The moments lie between two that there are.
    let later = |second: i64| first.saturating_add(SignedDuration::from_secs(second));
    for second in (1..=seconds / STEP).map(|step| step * STEP) {
        see(later(second).unwrap_or(now));
    }
    see(now);
    found
}
