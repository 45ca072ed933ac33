//! Every message of the four meters: what it means, and that nothing but itself means it.

mod support {
    pub(crate) mod frames;
    pub(crate) mod messages;
}

use meterpoll::codec::length::{Direction, of_frame};
use meterpoll::codec::rtu::{
    Hex, checked_window, decode_reply, decode_request, encode_broadcast, encode_reply,
    encode_request, open,
};
use meterpoll::codec::{
    Broadcast, DecodeError, Destination, FunctionCode, Reply, Request, Response,
};
use support::frames::{pm290, pqm};
use support::messages::{Message, messages};

fn directions(message: &Message) -> impl Iterator<Item = Direction> {
    let request = message.request.as_ref().map(|_| Direction::Request);
    let response = message.reply.as_ref().map(|_| Direction::Response);
    request.into_iter().chain(response)
}

#[test]
fn every_message_decodes_to_what_it_says_and_to_nothing_the_other_way() {
    for message in messages() {
        let (frame, shown) = (message.frame, Hex(message.frame));
        match message.request {
            Some(request) => assert_eq!(decode_request(frame), Ok(request), "{shown}"),
            None => assert!(decode_request(frame).is_err(), "{shown}"),
        }
        match message.reply {
            Some(reply) => assert_eq!(decode_reply(frame), Ok(reply), "{shown}"),
            None => assert!(decode_reply(frame).is_err(), "{shown}"),
        }
    }
}

#[test]
fn every_message_encodes_to_its_bytes() {
    for message in messages() {
        if let Some((destination, request)) = message.request {
            let frame = match (destination, &request) {
                (Destination::Unit(unit), _) => encode_request(unit, &request),
                (Destination::Broadcast, Request::Write(write)) => {
                    encode_broadcast(Broadcast, write)
                }
                (Destination::Broadcast, _) => panic!("only a write is broadcast: {request:?}"),
            };
            assert_eq!(frame.to_string(), Hex(message.frame).to_string());
        }
        if let Some((unit, reply)) = message.reply {
            let frame = encode_reply(unit, &reply);
            assert_eq!(frame.to_string(), Hex(message.frame).to_string());
        }
    }
}

#[test]
fn every_message_is_rejected_when_cut_at_any_length() {
    for message in messages() {
        for length in 0..message.frame.len() {
            let cut = message.frame.get(..length).unwrap();
            let (request, reply) = (decode_request(cut), decode_reply(cut));
            if length < 4 {
                let short = DecodeError::Truncated { field: "CRC" };
                assert_eq!(request, Err(short), "{}", Hex(cut));
                assert_eq!(reply, Err(short), "{}", Hex(cut));
            } else {
                assert!(request.is_err(), "{}", Hex(cut));
                assert!(reply.is_err(), "{}", Hex(cut));
            }
        }
    }
}

#[test]
fn every_message_is_rejected_with_any_byte_trailing() {
    for message in messages() {
        for extra in 0..=0xFF {
            let long = [message.frame, &[extra]].concat();
            for direction in directions(&message) {
                let rejected = match direction {
                    Direction::Request => decode_request(&long).is_err(),
                    Direction::Response => decode_reply(&long).is_err(),
                };
                assert!(rejected, "{}", Hex(&long));
            }
        }
    }
}

#[test]
fn every_message_is_rejected_with_any_bit_flipped() {
    for message in messages() {
        for bit in 0..8 * message.frame.len() {
            let mut flipped = message.frame.to_vec();
            *flipped.get_mut(bit / 8).unwrap() ^= 1 << (bit % 8);
            let (request, reply) = (decode_request(&flipped), decode_reply(&flipped));
            let shown = Hex(&flipped);
            assert!(matches!(request, Err(DecodeError::Crc { .. })), "{shown}");
            assert!(matches!(reply, Err(DecodeError::Crc { .. })), "{shown}");
        }
    }
}

#[test]
fn the_length_of_every_message_is_known_before_its_end_and_never_wrong() {
    for message in messages() {
        for direction in directions(&message) {
            let known: Vec<_> = (0..=message.frame.len())
                .filter_map(|length| of_frame(message.frame.get(..length).unwrap(), direction))
                .collect();
            let shown = Hex(message.frame);
            assert!(known.len() > 2, "{shown}: known too late");
            assert!(
                known.iter().all(|length| *length == message.frame.len()),
                "{shown}: {known:?}"
            );
        }
    }
}

#[test]
fn two_messages_back_to_back_are_each_found_in_their_place_and_nowhere_else() {
    let messages = messages();
    for pair in messages.windows(2) {
        let [first, second] = pair else {
            panic!("a window of two");
        };
        let line = [first.frame, second.frame].concat();
        let length = second.frame.len();
        let found: Vec<_> = (0..line.len())
            .filter(|start| checked_window(&line, *start, length).is_some())
            .collect();
        let mut expected = vec![first.frame.len()];
        if first.frame.len() == length {
            expected.insert(0, 0);
        }
        assert_eq!(found, expected, "{}", Hex(&line));
        assert_eq!(checked_window(&line, usize::MAX, length), None);
    }
}

#[test]
fn a_zero_behind_a_frame_passes_the_crc_and_is_rejected_for_its_place() {
    // The CRC over a frame with its own CRC is 0, and stays 0 for zeros behind it.
    for message in messages() {
        let long = [message.frame, &[0]].concat();
        assert!(open(&long).is_ok(), "{}", Hex(&long));
        for direction in directions(&message) {
            let error = match direction {
                Direction::Request => decode_request(&long).unwrap_err(),
                Direction::Response => decode_reply(&long).unwrap_err(),
            };
            let placed = matches!(
                error,
                DecodeError::Trailing { extra: 1 } | DecodeError::ByteCount { .. }
            );
            assert!(placed, "{}: {error}", Hex(&long));
        }
    }
}

#[test]
fn a_function_07_request_with_a_zero_behind_it_is_a_response_to_itself() {
    // Nothing in the bytes tells the two apart: who believes a response must know the echo.
    let echo = [pqm::STATUS_REQUEST, &[0]].concat();
    let (unit, reply) = decode_reply(&echo).unwrap();
    assert_eq!(unit.get(), 17);
    assert_eq!(reply, Reply::Normal(Response::ExceptionStatus(0x4C)));
}

#[test]
fn functions_20_and_21_are_named_as_not_handled_once_their_crc_holds() {
    for (frame, code) in [
        (pm290::FUNCTION_20_REQUEST, 0x14),
        (pm290::FUNCTION_20_RESPONSE, 0x14),
        (pm290::FUNCTION_21, 0x15),
    ] {
        let (address, unit) = open(frame).unwrap();
        assert_eq!((address, unit.first()), (1, Some(&code)));
        let unknown = DecodeError::Function(FunctionCode::try_from(code).unwrap());
        assert_eq!(decode_request(frame), Err(unknown));
        assert_eq!(decode_reply(frame), Err(unknown));
        assert_eq!(
            unknown.to_string(),
            format!("function 0x{code:02X} is not handled")
        );
        assert_eq!(of_frame(frame, Direction::Request), None);
        assert_eq!(of_frame(frame, Direction::Response), None);
        for bit in 0..8 * frame.len() {
            let mut flipped = frame.to_vec();
            *flipped.get_mut(bit / 8).unwrap() ^= 1 << (bit % 8);
            let reply = decode_reply(&flipped);
            assert!(matches!(reply, Err(DecodeError::Crc { .. })));
        }
    }
}
