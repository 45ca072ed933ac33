//! Which model stands behind a profile: the meters that can be simulated, and the units that they
//! have on the simulated line.

use super::em2x::Em2x;
use super::meter::Meter;
use super::model::{Blank, Model};
use super::pm290::Pm290;
use super::pqm::Pqm;
use crate::codec::{Unit, UnitRange};
use crate::profile::Profile;

/// A kind of meter with a model of its own.
struct Kind {
    /// The name of its profile.
    name: &'static str,
    /// The unit of the one on [`super::SimulatedLine::new`].
    usual_unit: u16,
    /// What is added to the line's seed for that one.
    seed: u64,
    model: fn(Unit, u64) -> Box<dyn Model>,
}

const KINDS: [Kind; 4] = [
    Kind {
        name: "em24",
        usual_unit: 1,
        seed: 1,
        model: |unit, seed| Box::new(Em2x::em24(unit, seed)),
    },
    Kind {
        name: "pm290",
        usual_unit: 2,
        seed: 2,
        model: |_, seed| Box::new(Pm290::new(seed)),
    },
    Kind {
        name: "em21",
        usual_unit: 3,
        seed: 3,
        model: |unit, seed| Box::new(Em2x::em21(unit, seed)),
    },
    Kind {
        name: "pqm",
        usual_unit: 17,
        seed: 0,
        model: |unit, seed| Box::new(Pqm::new(seed).with_unit(unit)),
    },
];

fn kind(profile: &str) -> Option<&'static Kind> {
    KINDS.iter().find(|kind| kind.name == profile)
}

/// The names of the meters on [`super::SimulatedLine::new`], by unit.
pub fn names() -> impl Iterator<Item = &'static str> {
    KINDS.iter().map(|kind| kind.name)
}

/// The unit that a meter of this name has when none is given: the one it has on
/// [`super::SimulatedLine::new`], 1 for a meter that is not on it.
pub fn usual_unit(profile: &str) -> u16 {
    kind(profile).map_or(1, |kind| kind.usual_unit)
}

/// The meters on [`super::SimulatedLine::new`], by unit.
///
/// # Panics
/// Never: the units are from 1 to 247.
pub fn usual_meters(seed: u64) -> Vec<Meter> {
    let meters = KINDS.iter().map(|kind| {
        #[expect(clippy::expect_used, reason = "constants in range")]
        let unit = Unit::new(kind.usual_unit, UnitRange::Standard).expect("1 to 247");
        let seed = seed.wrapping_add(kind.seed);
        Meter::builtin(unit, kind.name, move || (kind.model)(unit, seed))
    });
    meters.collect()
}

/// A meter of this profile with a load of its own that comes from `seed`; as on
/// [`super::SimulatedLine::new`] where it has the unit of the one there. A meter without a model, of a
/// profile of the user's own, holds 0 in all its registers.
pub fn meter(profile: Profile, unit: Unit, seed: u64) -> Meter {
    let model = match kind(&profile.name) {
        None => Box::new(Blank),
        Some(kind) => {
            // The usual unit keeps the line's own load.
            let distance = u64::from(unit.get()) ^ u64::from(kind.usual_unit);
            let seed = seed.wrapping_add(kind.seed);
            (kind.model)(unit, seed.wrapping_add(distance << 8))
        }
    };
    Meter::new(unit, move || (profile, model))
}
