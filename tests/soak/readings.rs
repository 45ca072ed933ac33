//! Points of a profile: reads that are merged and split, types, orders, scales, and a scale that
//! follows from a register of the meter's setup.

use std::fmt::Write;
use std::time::Duration;

use fastrand::Rng;
use meterpoll::client::{Client, Ways};
use meterpoll::codec::ReadFunction;
use meterpoll::profile::plan::{Cost, Rules};
use meterpoll::profile::{Point, Profile, Setup, Value, load};
use meterpoll::readings::{Inquiry, Memory, take};
use meterpoll::transport::LineSettings;
use rust_decimal::Decimal;

use crate::check::{Outcome, patience};
use crate::truth::{Registers, UNITS, unit};

/// Functions 03 and 04 read the same of this meter.
pub(crate) const REGISTERS: Registers = Registers::Shared;

pub(crate) const WAYS: Ways = Ways {
    interchangeable_reads: true,
    loopback: None,
};

/// Where the setup register is that the scale of some points follows from.
const RATIO: u16 = 0x0100;

/// So many points of each kind.
const EACH: u16 = 8;

/// What a point is, beside where it is.
struct Sort {
    name: &'static str,
    start: u16,
    /// From one to the next: those in between are holes.
    step: u16,
    lines: &'static str,
    read: fn(&[u16]) -> i64,
    /// Digits behind the point.
    digits: u32,
    /// Whether it is multiplied by what is at [`RATIO`].
    is_part: bool,
}

const SORTS: [Sort; 4] = [
    Sort {
        name: "word",
        start: 0x0000,
        step: 1,
        lines: "type = \"u16\"",
        read: |held| i64::from(held[0]),
        digits: 0,
        is_part: false,
    },
    Sort {
        name: "signed",
        start: 0x0010,
        step: 3,
        lines: "type = \"i16\"\nscale = 0.01",
        read: |held| i64::from(held[0].cast_signed()),
        digits: 2,
        is_part: false,
    },
    Sort {
        name: "long",
        start: 0x0030,
        step: 2,
        lines: "type = \"u32\"\norder = \"CDAB\"\nscale = 0.1",
        read: |held| i64::from(held[1]) << 16 | i64::from(held[0]),
        digits: 1,
        is_part: false,
    },
    Sort {
        name: "part",
        start: 0x0060,
        step: 5,
        lines: "type = \"u16\"\nscale = \"ratio\"",
        read: |held| i64::from(held[0]),
        digits: 3,
        is_part: true,
    },
];

impl Sort {
    const fn address(&self, number: u16) -> u16 {
        self.start + self.step * number
    }

    /// What a point reads as, worked out by other means than the library's.
    fn truth(&self, number: u16, of_unit: u16) -> Option<Decimal> {
        let function = ReadFunction::HoldingRegisters;
        let held = REGISTERS.read(of_unit, function, self.address(number), 2)?;
        let ratio = REGISTERS.held(of_unit, function, RATIO)?;
        let factor = if self.is_part { i64::from(ratio) } else { 1 };
        Some(Decimal::new((self.read)(&held) * factor, self.digits))
    }
}

/// Reads some points of any unit.
pub(crate) struct Readings {
    profile: Profile,
    /// What each unit has taught since its line was opened.
    memories: Vec<Memory>,
}

impl Readings {
    pub(crate) fn new() -> Self {
        let profile = load::load("soak.toml", &profile()).expect("a profile that loads");
        for number in UNITS {
            let ratio = REGISTERS.held(number, ReadFunction::HoldingRegisters, RATIO);
            assert!(ratio > Some(0), "a scale of 0 gives no figure");
        }
        let mut readings = Self {
            profile,
            memories: Vec::new(),
        };
        readings.forget();
        readings
    }

    /// As when a line is opened.
    pub(crate) fn forget(&mut self) {
        let rules = Rules::of(&self.profile);
        self.memories = UNITS.map(|_| Memory::new(rules.clone())).into();
    }

    /// Reads some points, or all of them.
    pub(crate) fn ask(
        &mut self,
        client: &mut Client,
        chance: &mut Rng,
        is_all: bool,
    ) -> Vec<Outcome> {
        let share = if is_all { 1.0 } else { chance.f64() * 0.5 };
        let all = SORTS
            .iter()
            .flat_map(|sort| (0..EACH).map(move |number| (sort, number)));
        let wanted: Vec<(&Sort, u16)> = all.filter(|_| chance.f64() < share).collect();
        let point = |(sort, number): &(&Sort, u16)| {
            let name = format!("{}_{}", sort.name, number + 1);
            let mut points = self.profile.points.iter();
            points.find(|point| *point.name == name).cloned()
        };
        let points: Vec<Point> = wanted.iter().filter_map(point).collect();
        assert_eq!(points.len(), wanted.len(), "the profile has all points");
        let index = chance.usize(..UNITS.len());
        let setup = Setup::of(&points, Some(&self.profile));
        let inquiry = Inquiry {
            unit: unit(UNITS[index]),
            meter: "soak",
            points: &points,
            setup: &setup,
            function: ReadFunction::HoldingRegisters,
            cost: Cost::new(LineSettings::default(), Duration::ZERO, Duration::ZERO),
            patience: patience(WAYS),
        };
        let taken = take(client, &inquiry, &mut self.memories[index]);
        let readings = taken.row.readings.iter().zip(&wanted);
        readings
            .map(|(reading, (sort, number))| {
                let truth = sort.truth(*number, UNITS[index]).map(Value::Decimal);
                match reading {
                    Err(fault) => Outcome::Missing(*fault),
                    Ok(value) if Some(value) == truth.as_ref() => Outcome::Right,
                    Ok(value) => Outcome::Wrong {
                        place: format!("unit {}, point {}_{}", UNITS[index], sort.name, number + 1),
                        expected: format!("{truth:?}"),
                        found: format!("{value:?}"),
                    },
                }
            })
            .collect()
    }
}

/// The profile as a file.
fn profile() -> String {
    let mut text = format!(
        "name = \"soak\"\ntitle = \"Soak\"\nmanual = \"none\"\n\
         [limits]\nread_registers = 20\nread_holes = true\ninterchangeable_reads = true\n\
         [factors]\nratio = {{ product = [0.001, \"ratio_raw\"] }}\n\
         [groups]\ndefault = [\"word_*\"]\n\
         [[points]]\nname = \"ratio_raw\"\naddress = {RATIO}\ntype = \"u16\"\n"
    );
    for sort in &SORTS {
        for number in 0..EACH {
            let address = sort.address(number);
            let Sort { name, lines, .. } = sort;
            // Writing into a text cannot fail.
            let _ = writeln!(
                text,
                "[[points]]\nname = \"{name}_{}\"\naddress = {address}\n{lines}",
                number + 1
            );
        }
    }
    text
}
