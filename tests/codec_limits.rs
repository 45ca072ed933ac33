//! The limits of counts, addresses, units and values, typed from the standard and compared with the
//! codec.
//!
//! "AP" is the Modbus Application Protocol Specification V1.1b3, "SL" Modbus over Serial Line
//! V1.02.

#[path = "support/refused.rs"]
mod refused;

use meterpoll::codec::rtu::{decode_reply, decode_request, encode_reply, encode_request};
use meterpoll::codec::{
    AddressError, DecodeError, Destination, FunctionCode, ReadFunction, ReadValues, RegisterBlock,
    RegisterRange, Reply, Request, Response, Unit, UnitRange, Write, WrittenRange,
};

use self::refused::{padded, reply, request, sealed};

const fn count(what: &'static str, found: usize, most: u16) -> AddressError {
    AddressError::Count { what, found, most }
}

#[test]
fn a_read_is_of_1_to_125_registers() {
    // AP 6.3 and 6.4: 0001 to 007D.
    assert_eq!(RegisterRange::new(0, 0), Err(count("read", 0, 125)));
    assert_eq!(RegisterRange::new(0, 126), Err(count("read", 126, 125)));
    assert_eq!(RegisterRange::new(0, 1).unwrap().count(), 1);
    assert_eq!(RegisterRange::new(0, 125).unwrap().count(), 125);
    for registers in [0, 126, 65_536, 65_537] {
        assert_eq!(
            ReadValues::new(vec![0; registers]),
            Err(count("read", registers, 125))
        );
    }
    assert_eq!(ReadValues::new(vec![7]).unwrap().count(), 1);
    assert_eq!(ReadValues::new(vec![7; 125]).unwrap().count(), 125);
    for function in [3, 4] {
        assert!(Request::decode(&[function, 0, 0, 0, 1]).is_ok());
        assert!(Request::decode(&[function, 0, 0, 0, 125]).is_ok());
        assert_eq!(
            request(&[function, 0, 0, 0, 0]),
            count("read", 0, 125).into()
        );
        assert_eq!(
            request(&[function, 0, 0, 0, 126]),
            count("read", 126, 125).into()
        );
        assert_eq!(
            request(&[function, 0, 0, 1, 1]),
            count("read", 257, 125).into()
        );
        assert!(Reply::decode(&padded(&[function, 2], 2)).is_ok());
        assert!(Reply::decode(&padded(&[function, 250], 250)).is_ok());
        assert_eq!(reply(&[function, 0]), count("read", 0, 125).into());
        assert_eq!(
            reply(&padded(&[function, 252], 252)),
            count("read", 126, 125).into()
        );
    }
}

#[test]
fn a_write_is_of_1_to_123_registers() {
    // AP 6.12: 0001 to 007B, in the request and in the response.
    let block = |count| RegisterBlock::new(0, vec![0; count]);
    for (registers, given) in [(0, 0), (124, 124), (125, 125), (65_535, u16::MAX)] {
        let error = count("write", registers, 123);
        assert_eq!(block(registers), Err(error));
        assert_eq!(WrittenRange::new(0, given), Err(error));
    }
    // 65536 must not wrap around to 0.
    for registers in [65_536, 65_537] {
        assert_eq!(block(registers), Err(count("write", registers, 123)));
    }
    for (registers, given) in [(1, 1), (123, 123)] {
        assert_eq!(block(registers).unwrap().count(), given);
        assert_eq!(WrittenRange::new(0, given).unwrap().count(), given);
    }
    assert!(Request::decode(&padded(&[16, 0, 0, 0, 1, 2], 2)).is_ok());
    assert!(Request::decode(&padded(&[16, 0, 0, 0, 123, 246], 246)).is_ok());
    for (registers, bytes) in [(0, 0), (124, 248), (125, 250), (126, 252)] {
        let unit = padded(&[16, 0, 0, 0, registers, bytes], usize::from(bytes));
        let error = count("write", usize::from(registers), 123);
        assert_eq!(request(&unit), error.into(), "request of {registers}");
        assert_eq!(
            reply(&[16, 0, 0, 0, registers]),
            error.into(),
            "response of {registers}"
        );
    }
    assert!(Reply::decode(&[16, 0, 0, 0, 1]).is_ok());
    assert!(Reply::decode(&[16, 0, 0, 0, 123]).is_ok());
}

#[test]
fn a_count_out_of_bounds_is_reported_for_the_kind_of_message_it_is_in() {
    assert_eq!(
        request(&[3, 0, 0, 0, 0]).to_string(),
        "0 registers: a read carries 1 to 125"
    );
    assert_eq!(
        request(&[16, 0, 0, 0, 0, 0]).to_string(),
        "0 registers: a write carries 1 to 123"
    );
    assert_eq!(
        reply(&[16, 0, 0, 0, 0]).to_string(),
        "0 registers: a write carries 1 to 123"
    );
}

#[test]
fn no_range_runs_past_ffff() {
    let past = AddressError::PastEnd {
        start: 0xFFFF,
        count: 2,
    };
    assert_eq!(
        past.to_string(),
        "2 registers from 0xFFFF run past 0xFFFF, the last address"
    );
    assert_eq!(RegisterRange::new(0xFFFF, 1).unwrap().end(), 0x1_0000);
    assert_eq!(RegisterRange::new(0xFFFF, 2), Err(past));
    assert_eq!(RegisterRange::new(0xFF83, 125).unwrap().end(), 0x1_0000);
    let start = 0xFF84;
    assert_eq!(
        RegisterRange::new(start, 125),
        Err(AddressError::PastEnd { start, count: 125 })
    );
    assert_eq!(WrittenRange::new(0xFFFF, 2), Err(past));
    assert_eq!(RegisterBlock::new(0xFFFF, vec![0; 2]), Err(past));
    assert!(WrittenRange::new(0xFFFF, 1).is_ok());
    assert!(RegisterBlock::new(0xFF85, vec![0; 123]).is_ok());
    assert_eq!(request(&[3, 0xFF, 0xFF, 0, 2]), past.into());
    assert_eq!(request(&[4, 0xFF, 0xFF, 0, 2]), past.into());
    assert_eq!(request(&[16, 0xFF, 0xFF, 0, 2, 4, 0, 0, 0, 0]), past.into());
    assert_eq!(reply(&[16, 0xFF, 0xFF, 0, 2]), past.into());
}

#[test]
fn a_range_that_was_stored_is_checked_as_a_new_one_is() {
    let read = |stored: (u16, u16)| {
        let bytes = postcard::to_stdvec(&stored).unwrap();
        postcard::from_bytes::<RegisterRange>(&bytes)
    };
    let range = RegisterRange::new(0xFFF0, 16).unwrap();
    assert_eq!(read((0xFFF0, 16)), Ok(range));
    assert_eq!(
        postcard::from_bytes(&postcard::to_stdvec(&range).unwrap()),
        Ok(range)
    );
    for stored in [(0, 0), (0, 126), (0xFFFF, 2)] {
        assert!(read(stored).is_err(), "{stored:?}");
    }
}

#[test]
fn the_longest_request_and_the_longest_reply_fit_a_frame() {
    // SL 2.3: 256 bytes.
    let unit = Unit::new(1, UnitRange::Standard).unwrap();
    let write = Write::Registers(RegisterBlock::new(0, vec![0; 123]).unwrap());
    let request = encode_request(unit, &Request::Write(write));
    assert_eq!(request.as_bytes().len(), 255);
    let reply = encode_reply(
        unit,
        &Reply::Normal(Response::Registers {
            function: ReadFunction::HoldingRegisters,
            values: ReadValues::new(vec![0; 125]).unwrap(),
        }),
    );
    assert_eq!(reply.as_bytes().len(), 255);
}

#[test]
fn a_range_contains_what_lies_within_it_to_the_last_register() {
    let range = |start, count| RegisterRange::new(start, count).unwrap();
    assert!(range(0xFFF0, 16).contains(range(0xFFF0, 16)));
    assert!(range(0xFFF0, 16).contains(range(0xFFFF, 1)));
    assert!(!range(0xFFF0, 15).contains(range(0xFFFF, 1)));
    assert!(!range(0xFFF0, 16).contains(range(0xFFEF, 2)));
}

#[test]
fn a_unit_is_1_to_247_and_to_255_where_the_meter_allows_it() {
    // SL 2.2; 255 by the PQM's manual, 3.6x edition page 232.
    let table = [
        (0, Err(AddressError::UnitZero), Err(AddressError::UnitZero)),
        (1, Ok(1), Ok(1)),
        (247, Ok(247), Ok(247)),
        (
            248,
            Err(AddressError::UnitTooHigh {
                found: 248,
                highest: 247,
            }),
            Ok(248),
        ),
        (
            255,
            Err(AddressError::UnitTooHigh {
                found: 255,
                highest: 247,
            }),
            Ok(255),
        ),
        (
            256,
            Err(AddressError::UnitTooHigh {
                found: 256,
                highest: 247,
            }),
            Err(AddressError::UnitTooHigh {
                found: 256,
                highest: 255,
            }),
        ),
        // 65535 must not wrap around to 255.
        (
            65_535,
            Err(AddressError::UnitTooHigh {
                found: 65_535,
                highest: 247,
            }),
            Err(AddressError::UnitTooHigh {
                found: 65_535,
                highest: 255,
            }),
        ),
    ];
    for (number, standard, extended) in table {
        assert_eq!(
            Unit::new(number, UnitRange::Standard).map(Unit::get),
            standard
        );
        assert_eq!(
            Unit::new(number, UnitRange::Extended).map(Unit::get),
            extended
        );
    }
}

#[test]
fn every_unit_to_255_decodes_in_both_directions() {
    for number in 1..=0xFF {
        let (destination, _) = decode_request(&sealed(&[number, 7])).unwrap();
        let unit = Unit::new(u16::from(number), UnitRange::Extended).unwrap();
        assert_eq!(destination, Destination::Unit(unit));
        assert_eq!(decode_reply(&sealed(&[number, 7, 0])).unwrap().0, unit);
    }
}

#[test]
fn a_broadcast_of_anything_but_a_write_is_rejected() {
    // SL 2.1: what is broadcast is a write.
    let table: [(&[u8], FunctionCode); 4] = [
        (&[0, 3, 0, 0, 0, 1], FunctionCode::ReadHoldingRegisters),
        (&[0, 4, 0, 0, 0, 1], FunctionCode::ReadInputRegisters),
        (&[0, 7], FunctionCode::ReadExceptionStatus),
        (&[0, 8, 0, 0, 0, 0], FunctionCode::Diagnostics),
    ];
    for (body, function) in table {
        let error = DecodeError::Broadcast(function);
        assert_eq!(decode_request(&sealed(body)), Err(error));
    }
    let writes: [&[u8]; 4] = [
        &[0, 5, 0, 1, 0xFF, 0],
        &[0, 5, 0, 1, 0, 0],
        &[0, 6, 0, 1, 0, 2],
        &[0, 16, 0, 0, 0, 1, 2, 0, 0],
    ];
    for body in writes {
        assert_eq!(
            decode_request(&sealed(body)).unwrap().0,
            Destination::Broadcast
        );
    }
}

#[test]
fn a_reply_from_address_0_is_rejected() {
    let bodies: [&[u8]; 8] = [
        &[0, 3, 2, 0, 0],
        &[0, 4, 2, 0, 0],
        &[0, 5, 0, 1, 0xFF, 0],
        &[0, 6, 0, 1, 0, 2],
        &[0, 7, 0],
        &[0, 8, 0, 0, 0, 0],
        &[0, 16, 0, 0, 0, 1],
        &[0, 0x83, 2],
    ];
    for body in bodies {
        let error = DecodeError::Address(AddressError::UnitZero);
        assert_eq!(decode_reply(&sealed(body)), Err(error), "{body:02X?}");
    }
}

#[test]
fn a_coil_is_ff00_or_0000_and_nothing_else() {
    // AP 6.5.
    for value in 0..=u16::MAX {
        let [high, low] = value.to_be_bytes();
        let unit = [5, 0, 1, high, low];
        let on = match value {
            0xFF00 => Some(true),
            0x0000 => Some(false),
            _ => None,
        };
        let decoded = Reply::decode(&unit);
        if let Some(on) = on {
            let Ok(Reply::Normal(Response::Coil { address, on: found })) = decoded else {
                panic!("{value:04X}: {decoded:?}");
            };
            assert_eq!((address.get(), found), (1, on));
            assert!(Request::decode(&unit).is_ok());
        } else {
            let error = DecodeError::Field {
                field: "output value",
                found: value,
            };
            assert_eq!(decoded, Err(error));
            assert_eq!(Request::decode(&unit), Err(error));
        }
    }
}

#[test]
fn function_08_is_spoken_with_sub_function_0_only() {
    for sub in [1_u16, 2, 0x0A, 0x0100, 0xFFFF] {
        let [high, low] = sub.to_be_bytes();
        let error = DecodeError::Field {
            field: "sub-function",
            found: sub,
        };
        assert_eq!(request(&[8, high, low, 0, 0]), error);
        assert_eq!(reply(&[8, high, low, 0, 0]), error);
    }
}

#[test]
fn ranges_overlap_when_they_share_a_register() {
    let range = |start, count| RegisterRange::new(start, count).expect("a range");
    assert!(range(10, 2).overlaps(range(11, 5)));
    assert!(range(11, 5).overlaps(range(10, 2)));
    assert!(range(10, 9).overlaps(range(12, 1)));
    assert!(!range(10, 2).overlaps(range(12, 1)));
    assert!(!range(12, 1).overlaps(range(10, 2)));
    assert!(range(0xFFFF, 1).overlaps(range(0xFFF0, 16)));
}
