//! What the meters hold: in each register of each unit something else.

use std::sync::OnceLock;

use meterpoll::codec::{
    Destination, ExceptionCode, ReadFunction, ReadValues, Reply, Request, Response, Unit,
    UnitRange, rtu,
};

/// The units on each line.
pub(crate) const UNITS: [u16; 4] = [1, 2, 17, 247];

/// Which registers there are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Registers {
    /// Functions 03 and 04 read the same 16384 registers.
    Shared,
    /// Each of the two functions reads 8192 registers of its own.
    Apart,
}

/// Where a number is held.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Place {
    pub(crate) unit: u16,
    /// `None` where both functions read it.
    pub(crate) function: Option<ReadFunction>,
    pub(crate) address: u16,
}

impl Registers {
    /// How many registers a function reads.
    pub(crate) const fn count(self) -> u16 {
        match self {
            Self::Shared => 1 << 14,
            Self::Apart => 1 << 13,
        }
    }

    /// What a register holds; `None` when there is no such register or unit.
    pub(crate) fn held(self, unit: u16, function: ReadFunction, address: u16) -> Option<u16> {
        let index = UNITS.iter().position(|known| *known == unit)?;
        let unit = u16::try_from(index).ok()? << 14;
        if address >= self.count() {
            return None;
        }
        let function = match (self, function) {
            (Self::Apart, ReadFunction::InputRegisters) => 1 << 13,
            _ => 0,
        };
        Some(scramble(unit | function | address))
    }

    /// What a read gives; `None` when a register of it is not there.
    pub(crate) fn read(
        self,
        unit: u16,
        function: ReadFunction,
        start: u16,
        count: u16,
    ) -> Option<Vec<u16>> {
        (0..count)
            .map(|offset| self.held(unit, function, start.checked_add(offset)?))
            .collect()
    }

    /// Where a number is held: in one place only.
    pub(crate) fn place(self, number: u16) -> Place {
        let index = unscramble(number);
        let function = match index & (1 << 13) {
            0 => ReadFunction::HoldingRegisters,
            _ => ReadFunction::InputRegisters,
        };
        Place {
            unit: UNITS[usize::from(index >> 14)],
            function: (self == Self::Apart).then_some(function),
            address: index & (self.count() - 1),
        }
    }

    /// The true answer to a request; `None` when no unit here is asked.
    pub(crate) fn answer(self, frame: &[u8]) -> Option<Vec<u8>> {
        let (Destination::Unit(unit), request) = rtu::decode_request(frame).ok()? else {
            return None;
        };
        if !UNITS.contains(&u16::from(unit.get())) {
            return None;
        }
        let response = match request {
            Request::Read { function, range } => self
                .read(
                    unit.get().into(),
                    function,
                    range.start().get(),
                    range.count(),
                )
                .and_then(|values| ReadValues::new(values).ok())
                .map(|values| Response::Registers { function, values }),
            Request::ReturnQueryData(word) => Some(Response::QueryData(word)),
            _ => None,
        };
        let reply = response.map_or_else(
            || Reply::Exception {
                function: request.function(),
                code: ExceptionCode::ILLEGAL_DATA_ADDRESS,
            },
            Reply::Normal,
        );
        Some(rtu::encode_reply(unit, &reply).as_bytes().to_vec())
    }
}

/// One of [`UNITS`].
pub(crate) fn unit(number: u16) -> Unit {
    Unit::new(number, UnitRange::Standard).expect("1 to 247")
}

/// Neighbours become unlike, and no two become the same: each step can be undone.
const fn scramble(index: u16) -> u16 {
    let number = index.wrapping_mul(0x9E6D);
    let number = number ^ (number >> 7);
    let number = number.wrapping_mul(0x4B35);
    number ^ (number >> 9)
}

fn unscramble(number: u16) -> u16 {
    static INDICES: OnceLock<Vec<u16>> = OnceLock::new();
    let indices = INDICES.get_or_init(|| {
        let mut indices = vec![0; 1 << 16];
        for index in 0..=u16::MAX {
            indices[usize::from(scramble(index))] = index;
        }
        indices
    });
    indices[usize::from(number)]
}
