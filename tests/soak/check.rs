//! Raw registers: what is asked, and whether what comes is true.

use std::time::Duration;

use fastrand::Rng;
use meterpoll::client::{Client, Patience, Ways};
use meterpoll::codec::rtu::Hex;
use meterpoll::codec::{ReadFunction, RegisterRange, Request, Response};
use meterpoll::readings::Fault;

use crate::truth::{Registers, UNITS, unit};

/// How long an answer may take to begin; the meter reckons with it as well.
pub(crate) const TIMEOUT: Duration = Duration::from_millis(20);

/// How many registers a read is about. Few different numbers: a late answer has to have the right
/// shape to be mistaken.
const COUNTS: [u16; 8] = [1, 1, 2, 2, 2, 3, 10, 20];

/// What became of a value.
#[derive(Debug)]
pub(crate) enum Outcome {
    Right,
    Missing(Fault),
    Wrong {
        /// Unit and place.
        place: String,
        expected: String,
        found: String,
    },
}

/// Reads any registers of any unit.
pub(crate) struct Raw {
    pub(crate) registers: Registers,
    pub(crate) ways: Ways,
    last: Question,
}

#[derive(Debug, Clone, Copy)]
struct Question {
    unit: u16,
    function: ReadFunction,
    count: u16,
}

impl Raw {
    pub(crate) const fn new(registers: Registers, ways: Ways) -> Self {
        let last = Question {
            unit: UNITS[0],
            function: ReadFunction::HoldingRegisters,
            count: 1,
        };
        Self {
            registers,
            ways,
            last,
        }
    }

    /// Asks something. Every other question has the shape of the one before.
    pub(crate) fn ask(&mut self, client: &mut Client, chance: &mut Rng) -> Outcome {
        if chance.bool() {
            let function = if chance.bool() {
                ReadFunction::HoldingRegisters
            } else {
                ReadFunction::InputRegisters
            };
            self.last = Question {
                unit: UNITS[chance.usize(..UNITS.len())],
                function,
                count: COUNTS[chance.usize(..COUNTS.len())],
            };
        }
        let Question {
            unit: number,
            function,
            count,
        } = self.last;
        let start = chance.u16(..=self.registers.count() - count);
        let range = RegisterRange::new(start, count).expect("inside of the meter");
        let request = Request::Read { function, range };
        let values = match client.request(unit(number), &request, patience(self.ways)) {
            Ok(Response::Registers { values, .. }) => values.into_vec(),
            Ok(_) => Vec::new(),
            Err(failure) => return Outcome::Missing(Fault::from(&failure)),
        };
        let truth = self.registers.read(number, function, start, count);
        let truth = truth.unwrap_or_default();
        if values == truth {
            return Outcome::Right;
        }
        let source = values.first().map(|value| self.registers.place(*value));
        Outcome::Wrong {
            place: format!("unit {number}, {function:?}, {range}"),
            expected: hex(&truth),
            found: format!("{}, the first as at {source:?}", hex(&values)),
        }
    }
}

/// How patient the client is.
pub(crate) fn patience(ways: Ways) -> Patience {
    Patience {
        timeout: TIMEOUT,
        longest_answer: TIMEOUT,
        ways,
        ..Patience::default()
    }
}

fn hex(values: &[u16]) -> String {
    let bytes: Vec<u8> = values
        .iter()
        .flat_map(|value| value.to_be_bytes())
        .collect();
    Hex(&bytes).to_string()
}
