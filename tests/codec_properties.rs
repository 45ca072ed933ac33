//! What holds for every message, tried on random ones.

use meterpoll::codec::length::{Direction, of_frame};
use meterpoll::codec::rtu::{
    check, decode_reply, decode_request, encode_broadcast, encode_reply, encode_request,
};
use meterpoll::codec::{
    Broadcast, DecodeError, Destination, ExceptionCode, Frame, FunctionCode, ReadFunction,
    ReadValues, RegisterAddress, RegisterBlock, RegisterRange, Reply, Request, Response, Unit,
    UnitRange, Write, WrittenRange,
};
use proptest::prelude::*;
use proptest::sample::{Index, select};

fn cases(cases: u32) -> ProptestConfig {
    ProptestConfig {
        failure_persistence: None,
        ..ProptestConfig::with_cases(cases)
    }
}

fn units() -> impl Strategy<Value = Unit> {
    (1_u16..=255).prop_map(|number| Unit::new(number, UnitRange::Extended).unwrap())
}

fn addresses() -> impl Strategy<Value = RegisterAddress> {
    any::<u16>().prop_map(RegisterAddress)
}

fn functions() -> impl Strategy<Value = ReadFunction> {
    select(vec![
        ReadFunction::HoldingRegisters,
        ReadFunction::InputRegisters,
    ])
}

/// A range of up to `most` registers, anywhere up to the last address.
fn ranges(most: u16) -> impl Strategy<Value = RegisterRange> {
    (1..=most, any::<u16>()).prop_map(|(count, start)| {
        let last_start = u16::MAX - (count - 1);
        RegisterRange::new(start.min(last_start), count).unwrap()
    })
}

fn written(start: u16, count: u16) -> WrittenRange {
    WrittenRange::new(start, count).unwrap()
}

fn registers(most: usize) -> impl Strategy<Value = Vec<u16>> {
    prop::collection::vec(any::<u16>(), 1..=most)
}

fn writes() -> impl Strategy<Value = Write> {
    prop_oneof![
        (addresses(), any::<bool>()).prop_map(|(address, on)| Write::Coil { address, on }),
        (addresses(), any::<u16>()).prop_map(|(address, value)| Write::Register { address, value }),
        (ranges(123), registers(123)).prop_map(|(range, values)| {
            let count = usize::from(range.count());
            let values = values.into_iter().take(count).collect();
            Write::Registers(RegisterBlock::new(range.start().get(), values).unwrap())
        }),
    ]
}

fn requests() -> impl Strategy<Value = Request> {
    prop_oneof![
        (functions(), ranges(125)).prop_map(|(function, range)| Request::Read { function, range }),
        writes().prop_map(Request::Write),
        Just(Request::ReadExceptionStatus),
        any::<u16>().prop_map(Request::ReturnQueryData),
    ]
}

fn replies() -> impl Strategy<Value = Reply> {
    let exceptions = (0_u8..=0x7F, any::<u8>()).prop_map(|(function, code)| Reply::Exception {
        function: FunctionCode::try_from(function).unwrap(),
        code: ExceptionCode(code),
    });
    let responses = prop_oneof![
        (functions(), registers(125)).prop_map(|(function, values)| Response::Registers {
            function,
            values: ReadValues::new(values).unwrap(),
        }),
        (addresses(), any::<bool>()).prop_map(|(address, on)| Response::Coil { address, on }),
        (addresses(), any::<u16>())
            .prop_map(|(address, value)| Response::Register { address, value }),
        any::<u8>().prop_map(Response::ExceptionStatus),
        any::<u16>().prop_map(Response::QueryData),
        ranges(123)
            .prop_map(|range| written(range.start().get(), range.count()))
            .prop_map(Response::RegistersWritten),
    ];
    prop_oneof![1 => exceptions, 6 => responses.prop_map(Reply::Normal)]
}

/// The bytes of a message in one direction.
#[derive(Debug, Clone)]
struct Message {
    bytes: Vec<u8>,
    direction: Direction,
}

impl Message {
    fn new(frame: &Frame, direction: Direction) -> Self {
        Self {
            bytes: frame.as_bytes().to_vec(),
            direction,
        }
    }

    /// What reading these bytes in this message's direction finds, encoded again.
    fn reencode(&self, bytes: &[u8]) -> Result<Frame, DecodeError> {
        match self.direction {
            Direction::Request => reencode_request(bytes),
            Direction::Response => reencode_reply(bytes),
        }
    }
}

fn reencode_request(bytes: &[u8]) -> Result<Frame, DecodeError> {
    Ok(match decode_request(bytes)? {
        (Destination::Unit(unit), request) => encode_request(unit, &request),
        (Destination::Broadcast, Request::Write(write)) => encode_broadcast(Broadcast, &write),
        (Destination::Broadcast, request) => panic!("broadcast of {request:?}"),
    })
}

fn reencode_reply(bytes: &[u8]) -> Result<Frame, DecodeError> {
    decode_reply(bytes).map(|(unit, reply)| encode_reply(unit, &reply))
}

fn messages() -> impl Strategy<Value = Message> {
    prop_oneof![
        (units(), requests()).prop_map(|(unit, request)| Message::new(
            &encode_request(unit, &request),
            Direction::Request
        )),
        writes().prop_map(|write| Message::new(
            &encode_broadcast(Broadcast, &write),
            Direction::Request
        )),
        (units(), replies()).prop_map(|(unit, reply)| Message::new(
            &encode_reply(unit, &reply),
            Direction::Response
        )),
    ]
}

/// Bytes that look like a frame up to any point: likely functions, small fields, right CRC.
fn likely_frames() -> impl Strategy<Value = Vec<u8>> {
    let function = prop_oneof![
        select(vec![3_u8, 4, 5, 6, 7, 8, 16, 20, 0x83, 0x90]),
        any::<u8>()
    ];
    let field = prop_oneof![0_u8..=4, Just(0xFF), any::<u8>()];
    let fields = prop_oneof![
        prop::collection::vec(field, 0..=9),
        prop::collection::vec(any::<u8>(), 0..=252)
    ];
    (0_u8..=2, function, fields).prop_map(|(address, function, fields)| {
        let body = [&[address, function], fields.as_slice()].concat();
        [body.as_slice(), &check(&body)].concat()
    })
}

/// The bytes accepted in either direction encode to themselves, and have the length foretold.
fn accepted_bytes_encode_to_themselves(bytes: &[u8]) -> Result<(), TestCaseError> {
    if let Ok(frame) = reencode_request(bytes) {
        prop_assert_eq!(frame.as_bytes(), bytes);
        prop_assert_eq!(of_frame(bytes, Direction::Request), Some(bytes.len()));
    }
    if let Ok(frame) = reencode_reply(bytes) {
        prop_assert_eq!(frame.as_bytes(), bytes);
        prop_assert_eq!(of_frame(bytes, Direction::Response), Some(bytes.len()));
    }
    Ok(())
}

fn flip(bytes: &mut [u8], bit: usize) {
    if let Some(byte) = bytes.get_mut(bit / 8) {
        *byte ^= 1 << (bit % 8);
    }
}

proptest! {
    #![proptest_config(cases(512))]

    #[test]
    fn a_request_survives_its_frame(unit in units(), request in requests()) {
        let frame = encode_request(unit, &request);
        let decoded = decode_request(frame.as_bytes());
        prop_assert_eq!(decoded, Ok((Destination::Unit(unit), request)));
    }

    #[test]
    fn a_broadcast_survives_its_frame(write in writes()) {
        let frame = encode_broadcast(Broadcast, &write);
        let decoded = decode_request(frame.as_bytes());
        prop_assert_eq!(decoded, Ok((Destination::Broadcast, Request::Write(write))));
    }

    #[test]
    fn a_reply_survives_its_frame(unit in units(), reply in replies()) {
        let frame = encode_reply(unit, &reply);
        prop_assert_eq!(decode_reply(frame.as_bytes()), Ok((unit, reply)));
    }

    #[test]
    fn a_frame_has_4_to_256_bytes_and_the_length_foretold(message in messages()) {
        let length = message.bytes.len();
        prop_assert!((4..=256).contains(&length));
        for shown in 0..=length {
            let start = message.bytes.get(..shown).unwrap();
            if let Some(foretold) = of_frame(start, message.direction) {
                prop_assert_eq!(foretold, length);
            }
        }
        prop_assert_eq!(of_frame(&message.bytes, message.direction), Some(length));
    }

    #[test]
    fn a_frame_ends_in_the_check_of_the_rest(message in messages()) {
        let (body, found) = message.bytes.split_last_chunk::<2>().unwrap();
        prop_assert_eq!(&check(body), found);
    }

    #[test]
    fn a_frame_cut_anywhere_is_rejected(message in messages()) {
        for length in 0..message.bytes.len() {
            let cut = message.bytes.get(..length).unwrap();
            prop_assert!(message.reencode(cut).is_err(), "{} bytes", length);
        }
    }

    #[test]
    fn a_frame_cut_anywhere_is_rejected_with_a_right_crc_too(message in messages()) {
        let (body, _) = message.bytes.split_last_chunk::<2>().unwrap();
        for length in 0..body.len() {
            let cut = body.get(..length).unwrap();
            let sealed = [cut, &check(cut)].concat();
            prop_assert!(message.reencode(&sealed).is_err(), "{} bytes", length);
        }
    }

    #[test]
    fn a_frame_with_bytes_trailing_is_rejected(
        message in messages(),
        extra in prop::collection::vec(prop_oneof![Just(0), any::<u8>()], 1..=8),
    ) {
        let long = [message.bytes.as_slice(), &extra].concat();
        prop_assert!(message.reencode(&long).is_err());
    }

    #[test]
    fn one_to_three_flipped_bits_are_found_by_the_crc(
        message in messages(),
        picks in prop::collection::vec(any::<Index>(), 1..=3),
    ) {
        let mut bits: Vec<_> = picks
            .iter()
            .map(|pick| pick.index(8 * message.bytes.len()))
            .collect();
        bits.sort_unstable();
        bits.dedup();
        let mut flipped = message.bytes.clone();
        for bit in bits {
            flip(&mut flipped, bit);
        }
        let error = message.reencode(&flipped).unwrap_err();
        prop_assert!(matches!(error, DecodeError::Crc { .. }), "{}", error);
    }

    #[test]
    fn a_burst_of_up_to_16_bits_is_found_by_the_crc(
        message in messages(),
        pattern in 1..=u16::MAX,
        pick in any::<Index>(),
    ) {
        // The line carries each byte with its low bit first, which is how `flip` counts.
        let first = pick.index(8 * message.bytes.len() - 15);
        let mut flipped = message.bytes.clone();
        for bit in (0..16).filter(|bit| pattern & (1 << bit) != 0) {
            flip(&mut flipped, first + bit);
        }
        let error = message.reencode(&flipped).unwrap_err();
        prop_assert!(matches!(error, DecodeError::Crc { .. }), "{}", error);
    }

    #[test]
    fn a_byte_replaced_under_a_right_crc_is_read_as_it_stands_or_rejected(
        message in messages(),
        pick in any::<Index>(),
        byte in any::<u8>(),
    ) {
        let (body, _) = message.bytes.split_last_chunk::<2>().unwrap();
        let mut body = body.to_vec();
        let index = pick.index(body.len().min(8));
        *body.get_mut(index).unwrap() = byte;
        let sealed = [body.as_slice(), &check(&body)].concat();
        accepted_bytes_encode_to_themselves(&sealed)?;
    }
}

proptest! {
    #![proptest_config(cases(2048))]

    #[test]
    fn likely_bytes_are_read_as_they_stand_or_rejected(bytes in likely_frames()) {
        accepted_bytes_encode_to_themselves(&bytes)?;
    }

    #[test]
    fn random_bytes_are_read_as_they_stand_or_rejected(
        bytes in prop::collection::vec(any::<u8>(), 0..=300),
    ) {
        accepted_bytes_encode_to_themselves(&bytes)?;
        for direction in [Direction::Request, Direction::Response] {
            if let Some(length) = of_frame(&bytes, direction) {
                prop_assert!((4..=264).contains(&length));
            }
        }
    }
}
