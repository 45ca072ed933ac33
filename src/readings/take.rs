//! Reads a unit: fetches the registers of all points, then says what they mean.

use std::borrow::Cow;

use super::gather::gather;
use super::meaning::{Held, interpret};
use super::{Memory, Row};
use crate::client::{Client, Failure, Patience};
use crate::codec::{ExceptionCode, ReadFunction, Unit};
use crate::profile::plan::{Cost, PlannedRead};
use crate::profile::{Point, Setup};

/// What is asked of a unit.
#[derive(Debug, Clone, Copy)]
pub struct Inquiry<'a, 's> {
    /// The unit.
    pub unit: Unit,
    /// The meter's name; empty for raw registers of an unknown one.
    pub meter: &'a str,
    /// What is read.
    pub points: &'a [Point],
    /// What the scales of these points depend on.
    pub setup: &'s Setup,
    /// The function for points that have none of their own.
    pub function: ReadFunction,
    /// What reads cost on this line while the meter's answer time has not been measured.
    pub cost: Cost,
    /// How patient to be.
    pub patience: Patience,
}

/// Something that went wrong while points were read.
#[derive(Debug)]
pub enum Trouble {
    /// A read brought nothing.
    Unread {
        /// The read.
        read: PlannedRead,
        /// Why.
        failure: Failure,
        /// How many further reads were not tried because the unit was silent or the port gone.
        untried: usize,
    },
    /// The meter refused points, each of them when it was asked for by itself, or all of them for
    /// another reason than their registers.
    Refused {
        /// Which, as indices into [`Taken::points`].
        points: Vec<usize>,
        /// What it said.
        code: ExceptionCode,
    },
    /// A setup register arrived and holds what is no setting: nothing can be scaled by it.
    NoSetting {
        /// The name of its point.
        point: String,
        /// The registers.
        registers: Vec<u16>,
    },
    /// Registers arrived and hold what the point's type cannot.
    Impossible {
        /// The point's name.
        point: String,
        /// Its type.
        kind: String,
        /// The registers.
        registers: Vec<u16>,
    },
}

/// A unit read once.
#[derive(Debug)]
pub struct Taken<'a> {
    /// The readings of what was asked for.
    pub row: Row,
    /// The difference that one raw step of each reading makes; 0 where there are no steps.
    pub steps: Vec<f64>,
    /// What was asked for, and behind it what had to be read besides.
    pub points: Cow<'a, [Point]>,
    /// What went wrong.
    pub troubles: Vec<Trouble>,
}

/// Reads the points of one unit, in as few requests as it is known to allow, and with them the
/// setup registers that their scales depend on, unless they are known. A unit that does not answer
/// at all, or stops answering, is not asked further: every other read would cost a time-out as
/// well.
pub fn take<'a>(client: &mut Client, inquiry: &Inquiry<'a, '_>, memory: &mut Memory) -> Taken<'a> {
    let time = client.utc_now();
    let asked = inquiry.points;
    let is_known = |needed: &&Point| memory.setup(&needed.name).is_some();
    let besides = inquiry
        .setup
        .besides(asked)
        .filter(|needed| !is_known(needed));
    let besides: Vec<Point> = besides.cloned().collect();
    let points = if besides.is_empty() {
        Cow::Borrowed(asked)
    } else {
        Cow::Owned([asked, &besides].concat())
    };
    let all = Inquiry {
        points: &points,
        ..*inquiry
    };
    let (registers, mut troubles) = gather(client, &all, memory);
    let held = Held::new(inquiry.setup, &points, &registers, memory, &mut troubles);
    let scales = inquiry.setup.scales(held.registers());
    let row = Row {
        time,
        meter: inquiry.meter.to_owned(),
        unit: inquiry.unit,
        readings: interpret(asked, &registers, inquiry.setup, &held, &mut troubles),
    };
    Taken {
        row,
        steps: asked.iter().map(|point| point.step(scales)).collect(),
        points,
        troubles,
    }
}
