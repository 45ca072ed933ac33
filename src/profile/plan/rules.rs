//! What reads of one unit must keep to.

use super::areas::{Areas, Stretch, stretch};
use super::fence::{Fence, cuts};
use crate::codec::{ReadFunction, RegisterRange};
use crate::profile::model::{Limits, Profile};
use crate::profile::point::Point;

/// What a read of several points of one unit must keep to: what the profile says of the meter, and
/// what the unit was found to refuse. None of it forbids to read a single point: the loader has
/// checked points against the limits, and of raw registers the meter has the last word.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Rules {
    /// The most registers in one read.
    most: u16,
    /// What a read may cover besides the registers of its points.
    holes: Holes,
    /// A read must not cross a multiple of this.
    table_registers: Option<u16>,
    /// Whether functions 03 and 04 read the same registers: then all of them are in `holding`.
    interchangeable: bool,
    holding: Registers,
    input: Registers,
}

/// What a read may cover besides the registers of its points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Holes {
    /// Anything.
    Any,
    /// Registers of other points that can be read.
    Known,
}

/// What is special about some registers of one function.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
struct Registers {
    /// Those that no read of other points may touch: they do harm in company, or mean something
    /// else.
    barriers: Vec<Stretch>,
    /// Points of which a part means something else when it is read alone: no read begins or ends
    /// inside them, but for one of that part.
    whole: Areas,
    /// Those of ordinary points, which a read may cover for the sake of its neighbours.
    known: Areas,
    /// Those that the unit does not give in one request.
    refused: Vec<Stretch>,
}

impl Rules {
    /// The rules of a meter of which these limits are all that is known.
    pub fn new(limits: &Limits) -> Self {
        Self {
            most: limits.read_registers,
            holes: if limits.read_holes {
                Holes::Any
            } else {
                Holes::Known
            },
            table_registers: limits.table_registers,
            interchangeable: limits.interchangeable_reads,
            holding: Registers::default(),
            input: Registers::default(),
        }
    }

    /// The rules of a meter with this profile: its limits, and its points that others must be kept
    /// from, whether they are read or not.
    pub fn of(profile: &Profile) -> Self {
        let rules = Self::new(&profile.limits);
        let registers = |function: ReadFunction| {
            let own = profile.limits.read_function();
            let points = profile.points.iter().filter(|point| {
                rules.table(point.function.unwrap_or(own)) == rules.table(function)
            });
            Registers::of(points)
        };
        Self {
            holding: registers(ReadFunction::HoldingRegisters),
            input: registers(ReadFunction::InputRegisters),
            ..rules
        }
    }

    /// Whether all of these registers belong to ordinary points of the profile.
    pub fn knows(&self, function: ReadFunction, range: RegisterRange) -> bool {
        self.registers(function).known.hold(stretch(range))
    }

    /// From now on no read has more registers than this.
    pub fn limit(&mut self, most: u16) {
        self.most = self.most.min(most);
    }

    /// From now on no read covers registers that no point of the profile names.
    pub const fn forbid_holes(&mut self) {
        self.holes = Holes::Known;
    }

    /// From now on no read of several points covers all of these registers.
    pub fn refuse(&mut self, function: ReadFunction, range: RegisterRange) {
        let registers = match self.table(function) {
            ReadFunction::HoldingRegisters => &mut self.holding,
            ReadFunction::InputRegisters => &mut self.input,
        };
        let refused = stretch(range);
        // A part that means something else when it is alone was refused as that.
        if !cuts(&registers.whole, refused) && !registers.refused.contains(&refused) {
            registers.refused.push(refused);
        }
    }

    /// Whether a read of several points may be one of just these registers, with these holes between
    /// the points.
    pub fn allow(
        &self,
        function: ReadFunction,
        range: RegisterRange,
        holes: &[RegisterRange],
    ) -> bool {
        let fence = self.fence(function, []);
        let mut holes = holes.iter();
        fence.allows(range) && holes.all(|hole| fence.allows_hole(stretch(*hole)))
    }

    /// What stands in the way of reads with this function, these points that must be read alone
    /// included.
    pub(super) fn fence(
        &self,
        function: ReadFunction,
        alone: impl IntoIterator<Item = RegisterRange>,
    ) -> Fence<'_> {
        let registers = self.registers(function);
        let alone = alone.into_iter().map(stretch);
        let alone = alone.filter(|alone| !registers.whole.hold(*alone));
        Fence::new(
            (self.most, self.table_registers),
            (self.holes, &registers.known),
            registers.barriers.iter().copied().chain(alone).collect(),
            &registers.whole,
            registers.refused.clone(),
        )
    }

    fn registers(&self, function: ReadFunction) -> &Registers {
        match self.table(function) {
            ReadFunction::HoldingRegisters => &self.holding,
            ReadFunction::InputRegisters => &self.input,
        }
    }

    /// The function that stands for all that read the same registers.
    const fn table(&self, function: ReadFunction) -> ReadFunction {
        if self.interchangeable {
            ReadFunction::HoldingRegisters
        } else {
            function
        }
    }
}

impl Registers {
    /// What these points, all of one function, make special.
    fn of<'a>(points: impl Iterator<Item = &'a Point>) -> Self {
        let is_ordinary = |point: &&Point| point.access.readable() && !point.alone;
        let (ordinary, apart): (Vec<&Point>, Vec<&Point>) = points.partition(is_ordinary);
        let ordinary: Vec<Stretch> = ordinary.iter().map(|point| stretch(point.range)).collect();
        let readable: Areas = ordinary.iter().copied().collect();
        // Registers that belong to an ordinary point as well mean that in company, and do no harm.
        let (shared, barriers): (Vec<Stretch>, Vec<Stretch>) = apart
            .iter()
            .map(|point| stretch(point.range))
            .partition(|apart| readable.hold(*apart));
        let shared: Areas = shared.into_iter().collect();
        let whole = ordinary.into_iter().filter(|point| shared.overlap(*point));
        Self {
            barriers,
            whole: whole.collect(),
            known: readable.joined(),
            refused: Vec::new(),
        }
    }
}
