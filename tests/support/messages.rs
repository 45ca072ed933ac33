//! What each frame of the four meters says, in one direction or in both.

use meterpoll::codec::{
    Destination, ExceptionCode, FunctionCode, ReadFunction, ReadValues, RegisterAddress,
    RegisterBlock, RegisterRange, Reply, Request, Response, Unit, UnitRange, Write, WrittenRange,
};

use super::frames::{em2x, pm290, pqm};

/// A message and what it says, in one direction or in both.
pub(crate) struct Message {
    pub(crate) frame: &'static [u8],
    pub(crate) request: Option<(Destination, Request)>,
    pub(crate) reply: Option<(Unit, Reply)>,
}

const HOLDING: ReadFunction = ReadFunction::HoldingRegisters;
const INPUT: ReadFunction = ReadFunction::InputRegisters;

fn unit(number: u16) -> Unit {
    Unit::new(number, UnitRange::Standard).unwrap()
}

fn range(start: u16, count: u16) -> RegisterRange {
    RegisterRange::new(start, count).unwrap()
}

fn asks(frame: &'static [u8], number: u16, request: Request) -> Message {
    Message {
        frame,
        request: Some((Destination::Unit(unit(number)), request)),
        reply: None,
    }
}

fn broadcasts(frame: &'static [u8], write: Write) -> Message {
    Message {
        frame,
        request: Some((Destination::Broadcast, Request::Write(write))),
        reply: None,
    }
}

fn answers(frame: &'static [u8], number: u16, response: Response) -> Message {
    Message {
        frame,
        request: None,
        reply: Some((unit(number), Reply::Normal(response))),
    }
}

fn refuses(
    frame: &'static [u8],
    number: u16,
    function: FunctionCode,
    code: ExceptionCode,
) -> Message {
    Message {
        frame,
        request: None,
        reply: Some((unit(number), Reply::Exception { function, code })),
    }
}

/// The same bytes both ways.
fn echoes(frame: &'static [u8], number: u16, request: Request, response: Response) -> Message {
    Message {
        reply: answers(frame, number, response).reply,
        ..asks(frame, number, request)
    }
}

fn read(function: ReadFunction, start: u16, count: u16) -> Request {
    Request::Read {
        function,
        range: range(start, count),
    }
}

fn registers(function: ReadFunction, values: &[u16]) -> Response {
    Response::Registers {
        function,
        values: ReadValues::new(values.to_vec()).unwrap(),
    }
}

fn coil(address: u16) -> Write {
    Write::Coil {
        address: RegisterAddress(address),
        on: true,
    }
}

fn register(address: u16, value: u16) -> Write {
    Write::Register {
        address: RegisterAddress(address),
        value,
    }
}

fn many(start: u16, values: &[u16]) -> Write {
    Write::Registers(RegisterBlock::new(start, values.to_vec()).unwrap())
}

fn operates(frame: &'static [u8], number: u16, operation: u16) -> Message {
    let response = Response::Coil {
        address: RegisterAddress(operation),
        on: true,
    };
    echoes(frame, number, Request::Write(coil(operation)), response)
}

fn stores(frame: &'static [u8], number: u16, address: u16, value: u16) -> Message {
    let response = Response::Register {
        address: RegisterAddress(address),
        value,
    };
    echoes(
        frame,
        number,
        Request::Write(register(address, value)),
        response,
    )
}

fn loops(frame: &'static [u8], number: u16, word: u16) -> Message {
    echoes(
        frame,
        number,
        Request::ReturnQueryData(word),
        Response::QueryData(word),
    )
}

fn stores_many(frame: &'static [u8], number: u16, start: u16, values: &[u16]) -> Message {
    asks(frame, number, Request::Write(many(start, values)))
}

fn stored_many(frame: &'static [u8], number: u16, start: u16, count: u16) -> Message {
    answers(
        frame,
        number,
        Response::RegistersWritten(WrittenRange::new(start, count).unwrap()),
    )
}

fn pqm_messages() -> Vec<Message> {
    // 13:27, 10015 ms, October 29, 1997.
    let clock = [0x0D1B, 0x271F, 0x0A1D, 0x07CD];
    vec![
        asks(pqm::READ_REQUEST, 17, read(HOLDING, 0x006B, 3)),
        answers(pqm::READ_RESPONSE, 17, registers(HOLDING, &[555, 0, 100])),
        operates(pqm::OPERATION, 17, 1),
        broadcasts(pqm::OPERATION_BROADCAST, coil(34)),
        operates(pqm::OPERATION_TO_UNIT_17, 17, 34),
        stores(pqm::STORE, 17, 0x1020, 484),
        stores(pqm::STORE_01F4, 17, 0x1020, 500),
        asks(pqm::STATUS_REQUEST, 17, Request::ReadExceptionStatus),
        answers(pqm::STATUS_RESPONSE, 17, Response::ExceptionStatus(0x2C)),
        loops(pqm::LOOPBACK, 17, 0),
        loops(pqm::LOOPBACK_OF_UNIT_1, 1, 0),
        stores_many(pqm::STORE_MANY_REQUEST, 17, 0x1028, &[500, 10_000]),
        stored_many(pqm::STORE_MANY_RESPONSE, 17, 0x1028, 2),
        stores_many(pqm::COMMAND_REQUEST, 17, 0x0080, &[5, 1]),
        stored_many(pqm::COMMAND_RESPONSE, 17, 0x0080, 2),
        broadcasts(pqm::CLOCK_BROADCAST, many(0x00F0, &clock)),
        stores_many(pqm::CLOCK_TO_UNIT_17, 17, 0x00F0, &clock),
    ]
}

fn pm290_messages() -> Vec<Message> {
    let busy = ExceptionCode::SERVER_DEVICE_BUSY;
    let energies = [4321, 3, 0, 0, 2000, 0, 0, 0];
    let setup = [1, 10, 200, 20, 900, 8, 0];
    vec![
        asks(pm290::ENERGIES_REQUEST, 1, read(HOLDING, 0x011F, 8)),
        answers(pm290::ENERGIES_RESPONSE, 1, registers(HOLDING, &energies)),
        asks(pm290::SETUP_REQUEST, 1, read(INPUT, 0x0900, 7)),
        answers(pm290::SETUP_RESPONSE, 1, registers(INPUT, &setup)),
        asks(pm290::STATUS_REQUEST, 1, read(HOLDING, 0x0A00, 6)),
        stores(pm290::SET_CT, 1, 0x0902, 200),
        stores_many(pm290::SET_PT_AND_CT_REQUEST, 1, 0x0901, &[10, 200]),
        stored_many(pm290::SET_PT_AND_CT_RESPONSE, 1, 0x0901, 2),
        stores(pm290::RESET_DEMANDS, 1, 0x0118, 0),
        stores(pm290::RESET_CONSUMPTION, 1, 0x011F, 0),
        broadcasts(pm290::RESET_CONSUMPTION_BROADCAST, register(0x011F, 0)),
        stores(pm290::RESTART, 1, 0x0A00, 0xFFFF),
        refuses(
            pm290::BUSY_TO_A_READ,
            1,
            FunctionCode::ReadHoldingRegisters,
            busy,
        ),
        refuses(
            pm290::BUSY_TO_A_WRITE,
            1,
            FunctionCode::WriteSingleRegister,
            busy,
        ),
    ]
}

fn em2x_messages() -> Vec<Message> {
    let refused = FunctionCode::ReadInputRegisters;
    vec![
        asks(em2x::IDENTIFICATION_REQUEST, 1, read(INPUT, 0x000B, 1)),
        answers(em2x::IDENTIFICATION_EM21, 1, registers(INPUT, &[57])),
        answers(em2x::IDENTIFICATION_EM24, 1, registers(INPUT, &[72])),
        asks(em2x::VOLTAGE_REQUEST, 1, read(INPUT, 0, 2)),
        answers(em2x::VOLTAGE_RESPONSE, 1, registers(INPUT, &[2301, 0])),
        answers(em2x::POWER_RESPONSE, 1, registers(INPUT, &[0xC568, 0xFFFF])),
        asks(em2x::TEN_REGISTERS_REQUEST, 1, read(INPUT, 0, 10)),
        asks(em2x::ELEVEN_REGISTERS_REQUEST, 1, read(INPUT, 0x0028, 11)),
        asks(em2x::TWELVE_REGISTERS_REQUEST, 1, read(INPUT, 0, 12)),
        refuses(
            em2x::REFUSED_VALUE,
            1,
            refused,
            ExceptionCode::ILLEGAL_DATA_VALUE,
        ),
        refuses(
            em2x::REFUSED_ADDRESS,
            1,
            refused,
            ExceptionCode::ILLEGAL_DATA_ADDRESS,
        ),
        asks(em2x::EM21_ENERGIES_REQUEST, 1, read(INPUT, 0x0034, 4)),
        answers(
            em2x::EM21_ENERGIES_RESPONSE,
            1,
            registers(INPUT, &[0xD687, 0x0012, 890, 0]),
        ),
        asks(em2x::EM24_ENERGIES_REQUEST, 1, read(INPUT, 0x003E, 4)),
        stores(em2x::EM21_CT_LOW, 1, 0x1003, 400),
        stores(em2x::EM21_CT_HIGH, 1, 0x1004, 0),
        stores(em2x::EM21_RESET, 1, 0x3000, 1),
        stores(em2x::EM24_APPLICATION_H, 1, 0x1101, 7),
        asks(em2x::EM24_SERIAL_REQUEST, 1, read(HOLDING, 0x1300, 7)),
        stores(em2x::EM24_RESET_DEMANDS, 1, 0x3005, 1),
        broadcasts(em2x::EM24_RESET_DEMANDS_BROADCAST, register(0x3005, 1)),
        loops(em2x::LOOPBACK, 1, 0xA537),
    ]
}

/// Every message whose function the codec speaks.
pub(crate) fn messages() -> Vec<Message> {
    let mut all = pqm_messages();
    all.extend(pm290_messages());
    all.extend(em2x_messages());
    all
}
