//! What fetched registers mean, together with the setup that scales depend on.

use std::collections::{BTreeMap, BTreeSet};

use super::{Fault, Memory, Trouble};
use crate::profile::scaling::Scaling;
use crate::profile::{Missing, Point, Scales, Setup, Value};

/// The setup registers of one unit: what came of each, by the names of their points.
#[derive(Debug, Default)]
pub(super) struct Held {
    good: BTreeMap<String, Vec<u16>>,
    bad: BTreeMap<String, Fault>,
}

impl Held {
    /// What was read now, and what is remembered of the rest. What is no setting, or was not to be
    /// had, is not remembered.
    pub(super) fn new(
        setup: &Setup,
        points: &[Point],
        registers: &[Result<Vec<u16>, Fault>],
        memory: &mut Memory,
        troubles: &mut Vec<Trouble>,
    ) -> Self {
        let mut held = Self::default();
        for needed in setup.points() {
            let read = points.iter().position(|point| point.name == needed.name);
            let found = match read.and_then(|index| registers.get(index)) {
                Some(Ok(registers)) => registers.clone(),
                Some(Err(fault)) => {
                    held.bad.insert(needed.name.clone(), *fault);
                    continue;
                }
                None => match memory.setup(&needed.name) {
                    Some(registers) => registers.to_vec(),
                    None => continue,
                },
            };
            held.good.insert(needed.name.clone(), found);
        }
        let impossible: Vec<String> = held
            .good
            .keys()
            .filter(|name| !setup.scales(&held.good).has(name))
            .cloned()
            .collect();
        for name in impossible {
            let registers = held.good.remove(&name).unwrap_or_default();
            held.bad.insert(name.clone(), Fault::Mismatch);
            troubles.push(Trouble::NoSetting {
                point: name,
                registers,
            });
        }
        memory.keep_setup(&held.good);
        held
    }

    /// The registers to scale with.
    pub(super) const fn registers(&self) -> &BTreeMap<String, Vec<u16>> {
        &self.good
    }

    /// Why one of these is not there.
    fn fault(&self, needed: &BTreeSet<&str>) -> Option<Fault> {
        let faults = needed.iter().filter_map(|name| self.bad.get(*name));
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
    let scales = setup.scales(held.registers());
    let mut value = |(point, registers): (&Point, &Result<Vec<u16>, Fault>)| {
        let registers = registers.as_deref().map_err(|fault| *fault)?;
        if let Some(fault) = held.fault(&setup.needed_by(point)) {
            return Err(fault);
        }
        one(point, registers, scales, troubles)
    };
    points.iter().zip(registers).map(&mut value).collect()
}

fn one(
    point: &Point,
    registers: &[u16],
    scales: Scales<'_>,
    troubles: &mut Vec<Trouble>,
) -> Result<Value, Fault> {
    point.interpret(registers, scales).map_err(|missing| {
        if missing == Missing::Mismatch {
            troubles.push(Trouble::Impossible {
                point: point.name.clone(),
                kind: expected(point),
                registers: registers.to_vec(),
            });
        }
        Fault::from(missing)
    })
}

/// What the registers of a point should have held.
fn expected(point: &Point) -> String {
    match &point.scaling {
        Scaling::Times(_) => point.kind.to_string(),
        Scaling::TimesFactor(name) => format!("{} that {name} gives a figure for", point.kind),
        Scaling::TimesByRaw(_) => format!("{} that there is a scale for", point.kind),
        Scaling::Span { full, .. } => format!("{} from 0 to {full}", point.kind),
    }
}
