//! Which meters are simulated, at which units.

use jiff::Timestamp;

use crate::cli::{MeterUnits, Simulate};
use crate::codec::Unit;
use crate::commands::CommandError;
use crate::profile::{Profile, find};
use crate::sim::{Meter, kinds, values};
use crate::transport::LineSettings;

/// Meters and their units, each unit once.
pub(super) struct Wanted(Vec<(Profile, Vec<Unit>)>);

/// The meters that were typed, else those of the simulated line.
pub(super) fn wanted(arguments: &Simulate) -> Result<Wanted, CommandError> {
    let usual = || {
        kinds::names().map(|name| MeterUnits {
            meter: name.to_owned(),
            units: None,
        })
    };
    let typed = match &*arguments.meter {
        [] => usual().collect(),
        typed => typed.to_vec(),
    };
    let mut wanted: Vec<(Profile, Vec<Unit>)> = Vec::new();
    for MeterUnits { meter, units } in typed {
        let profile = find::find(&meter)?;
        let numbers = units.unwrap_or_else(|| vec![kinds::usual_unit(&profile.name)]);
        let units: Vec<Unit> = numbers
            .into_iter()
            .map(|number| Unit::new(number, profile.limits.units).map_err(CommandError::Unit))
            .collect::<Result<_, _>>()?;
        for (place, unit) in units.iter().enumerate() {
            let mut others = wanted.iter().filter(|(_, taken)| taken.contains(unit));
            let other = others.next().map(|(other, _)| &other.name);
            let is_again = units.iter().take(place).any(|earlier| earlier == unit);
            if let Some(first) = other.or(is_again.then_some(&profile.name)) {
                return Err(CommandError::UnitTwice {
                    unit: *unit,
                    first: first.clone(),
                    second: profile.name,
                });
            }
        }
        wanted.push((profile, units));
    }
    Ok(Wanted(wanted))
}

impl Wanted {
    /// The factory setting of the first of them.
    pub(super) fn factory_setting(&self) -> LineSettings {
        let first = self.0.first();
        first.map_or_else(LineSettings::default, |(profile, _)| profile.line)
    }

    /// The last meter and its last unit.
    pub(super) fn last(&self) -> Option<(&str, Unit)> {
        let (profile, units) = self.0.last()?;
        Some((&profile.name, *units.last()?))
    }

    /// `em24 at unit 1; pqm at units 17, 18`.
    pub(super) fn told(&self) -> String {
        let meters = self.0.iter().map(|(profile, units)| {
            let numbers: Vec<String> = units.iter().map(Unit::to_string).collect();
            let units = if numbers.len() == 1 { "unit" } else { "units" };
            format!("{} at {units} {}", profile.name, numbers.join(", "))
        });
        meters.collect::<Vec<_>>().join("; ")
    }

    /// Makes them, with the values of a file where there is one.
    pub(super) fn make(
        &self,
        arguments: &Simulate,
        now: Timestamp,
    ) -> Result<Vec<Meter>, CommandError> {
        let mut meters: Vec<Meter> = Vec::new();
        for (profile, units) in &self.0 {
            let made = units
                .iter()
                .map(|unit| kinds::meter(profile.clone(), *unit, arguments.seed));
            meters.extend(made);
        }
        if let Some(file) = &arguments.values {
            values::apply(file, &mut meters, now)?;
        }
        Ok(meters)
    }
}
