//! Reads a unit: fetches the registers of all points, then says what they mean.

use std::borrow::Cow;

use super::gather::gather;
use super::meaning::{Held, interpret};
use super::{Memory, Row};
use crate::client::{Client, Failure, Patience};
use crate::codec::{ExceptionCode, ReadFunction, Unit};
use crate::profile::plan::{Cost, PlannedRead};
use crate::profile::{Point, Scales, Setup};

/// What is asked of a unit.
#[derive(Debug, Clone, Copy)]
pub struct Inquiry<'a, 's> {
    /// The unit.
    pub unit: Unit,
    /// The meter's name; empty for raw registers of an unknown one.
    pub meter: &'a str,
    /// What is read.
    pub points: &'a [Point],
    /// What these points depend on.
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
        /// Whether the unit has answered other reads.
        is_alive: bool,
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
    /// A point that others depend on arrived and holds no value that it can have.
    NoSetting {
        /// The name of its point.
        point: String,
        /// The registers.
        registers: Vec<u16>,
    },
    /// The setup gives no number to scale a point by.
    NoScale {
        /// The point's name.
        point: String,
        /// The factor or setup point there is no number of.
        factor: String,
    },
    /// Registers arrived and hold what the point's type cannot.
    Impossible {
        /// The point's name.
        point: String,
        /// What they should hold.
        expected: String,
        /// The registers.
        registers: Vec<u16>,
    },
}

/// A unit read once.
#[derive(Debug)]
pub struct Taken<'a> {
    /// The readings of what was asked for.
    pub row: Row,
    /// What the setup of the unit gives to scale with.
    pub scales: Scales,
    /// What was asked for, and behind it what had to be read besides.
    pub points: Cow<'a, [Point]>,
    /// What went wrong.
    pub troubles: Vec<Trouble>,
}

impl Taken<'_> {
    /// Whether nothing could be asked because the port was lost before and did not come back.
    pub fn is_port_away(&self) -> bool {
        let mut troubles = self.troubles.iter();
        troubles.any(
            |trouble| matches!(trouble, Trouble::Unread { failure, .. } if failure.is_port_away()),
        )
    }
}

/// Reads the points of one unit, in as few requests as it is known to allow, and with them the
/// points that they depend on: each time, for somebody may have changed the setup since. A unit that
/// does not answer at all, or stops answering, is not asked further: every other read would cost a
/// time-out as well.
pub fn take<'a>(client: &mut Client, inquiry: &Inquiry<'a, '_>, memory: &mut Memory) -> Taken<'a> {
    client.let_others_finish(inquiry.unit);
    let time = client.utc_now();
    let asked = inquiry.points;
    let besides: Vec<Point> = inquiry.setup.besides(asked).cloned().collect();
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
    let held = Held::new(inquiry.setup, &points, &registers, &mut troubles);
    let row = Row {
        time,
        meter: inquiry.meter.to_owned(),
        unit: inquiry.unit,
        readings: interpret(asked, &registers, inquiry.setup, &held, &mut troubles),
    };
    Taken {
        row,
        scales: held.scales,
        points,
        troubles,
    }
}
