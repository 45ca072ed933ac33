//! What fetched registers mean, together with the setup that they depend on.

use std::collections::{BTreeMap, BTreeSet};

use super::{Fault, Trouble};
use crate::profile::scaling::Scaling;
use crate::profile::{Missing, Point, Scales, Setup, Value};

/// The setup of one unit as it was read just now.
#[derive(Debug)]
pub(super) struct Held {
    /// What there is to scale with.
    pub(super) scales: Scales,
    /// Why a setting is not there, by the name of its point.
    missing: BTreeMap<String, Fault>,
}

impl Held {
    /// The setup among the registers of points that were read.
    pub(super) fn new(
        setup: &Setup,
        points: &[Point],
        registers: &[Result<Vec<u16>, Fault>],
        troubles: &mut Vec<Trouble>,
    ) -> Self {
        let mut good: BTreeMap<String, Vec<u16>> = BTreeMap::new();
        let mut missing: BTreeMap<String, Fault> = BTreeMap::new();
        for needed in setup.points() {
            let name = needed.name.clone();
            let index = points.iter().position(|point| point.name == name);
            match index.and_then(|index| registers.get(index)) {
                Some(Ok(registers)) => drop(good.insert(name, registers.clone())),
                Some(Err(fault)) => drop(missing.insert(name, *fault)),
                None => {}
            }
        }
        let scales = setup.scales(&good);
        for (name, registers) in good {
            let Err(reason) = scales.setting(&name) else {
                continue;
            };
            missing.insert(name.clone(), reason.into());
            if reason == Missing::Mismatch {
                troubles.push(Trouble::NoSetting {
                    point: name,
                    registers,
                });
            }
        }
        Self { scales, missing }
    }

    /// Why one of these is not there.
    fn fault(&self, needed: &BTreeSet<&str>) -> Option<Fault> {
        let faults = needed.iter().filter_map(|name| self.missing.get(*name));
        faults.max().copied()
    }
}

/// What the registers of points mean, each in its place.
pub(super) fn interpret(
    points: &[Point],
    registers: &[Result<Vec<u16>, Fault>],
    setup: &Setup,
    held: &Held,
    troubles: &mut Vec<Trouble>,
) -> Vec<Result<Value, Fault>> {
    let mut value = |(point, registers): (&Point, &Result<Vec<u16>, Fault>)| {
        let registers = registers.as_deref().map_err(|fault| *fault)?;
        if let Some(fault) = held.fault(&setup.needed_by(point)) {
            return Err(fault);
        }
        point.interpret(registers, &held.scales).map_err(|missing| {
            if missing == Missing::Mismatch {
                troubles.push(impossible(point, registers, &held.scales));
            }
            Fault::from(missing)
        })
    };
    points.iter().zip(registers).map(&mut value).collect()
}

/// Why registers make no figure: for want of a scale, or for what they hold themselves.
fn impossible(point: &Point, registers: &[u16], scales: &Scales) -> Trouble {
    let name = point.name.clone();
    if let Some(factor) = scales.lacking(point) {
        return Trouble::NoScale {
            point: name,
            factor: factor.to_owned(),
        };
    }
    let expected = match &point.scaling {
        Scaling::TimesByRaw(_) => format!("{} that there is a scale for", point.kind),
        Scaling::Span { full, .. } => format!("{} from 0 to {full}", point.kind),
        Scaling::Times(_) | Scaling::TimesFactor(_) => point.kind.to_string(),
    };
    Trouble::Impossible {
        point: name,
        expected,
        registers: registers.to_vec(),
    }
}
