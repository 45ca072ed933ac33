//! How long frames and their parts are, typed from the standard and compared with the codec.
//!
//! "AP" is the Modbus Application Protocol Specification V1.1b3, "SL" Modbus over Serial Line
//! V1.02.

#[path = "support/refused.rs"]
mod refused;

use meterpoll::codec::length::{Direction, of_frame};
use meterpoll::codec::rtu::{decode_reply, decode_request, open};
use meterpoll::codec::{DecodeError, Reply, Request};

use self::refused::{padded, reply, request, sealed};

#[test]
fn frame_lengths_are_those_of_the_standard() {
    use Direction::{Request, Response};
    // Unit, function, fields, CRC. The start of a frame, its direction, and the bytes in all.
    let table: [(&[u8], Direction, usize); 24] = [
        (&[1, 3], Request, 1 + 1 + 2 + 2 + 2),           // AP 6.3
        (&[1, 3, 2], Response, 1 + 1 + 1 + 2 + 2),       // AP 6.3, 1 register
        (&[1, 3, 250], Response, 1 + 1 + 1 + 250 + 2),   // AP 6.3, 125 registers
        (&[1, 4], Request, 1 + 1 + 2 + 2 + 2),           // AP 6.4
        (&[1, 4, 2], Response, 1 + 1 + 1 + 2 + 2),       // AP 6.4, 1 register
        (&[1, 4, 250], Response, 1 + 1 + 1 + 250 + 2),   // AP 6.4, 125 registers
        (&[1, 5], Request, 1 + 1 + 2 + 2 + 2),           // AP 6.5
        (&[1, 5], Response, 1 + 1 + 2 + 2 + 2),          // AP 6.5
        (&[1, 6], Request, 1 + 1 + 2 + 2 + 2),           // AP 6.6
        (&[1, 6], Response, 1 + 1 + 2 + 2 + 2),          // AP 6.6
        (&[1, 7], Request, 1 + 1 + 2),                   // AP 6.7
        (&[1, 7], Response, 1 + 1 + 1 + 2),              // AP 6.7
        (&[1, 8], Request, 1 + 1 + 2 + 2 + 2),           // AP 6.8, one word of data
        (&[1, 8], Response, 1 + 1 + 2 + 2 + 2),          // AP 6.8, one word of data
        (&[1, 16, 0, 0, 0, 1, 2], Request, 9 + 2),       // AP 6.12, 1 register
        (&[1, 16, 0, 0, 0, 123, 246], Request, 9 + 246), // AP 6.12, 123 registers
        (&[1, 16], Response, 1 + 1 + 2 + 2 + 2),         // AP 6.12
        (&[1, 0x83], Response, 1 + 1 + 1 + 2),           // AP 7
        (&[1, 0x84], Response, 1 + 1 + 1 + 2),           // AP 7
        (&[1, 0x85], Response, 1 + 1 + 1 + 2),           // AP 7
        (&[1, 0x86], Response, 1 + 1 + 1 + 2),           // AP 7
        (&[1, 0x87], Response, 1 + 1 + 1 + 2),           // AP 7
        (&[1, 0x88], Response, 1 + 1 + 1 + 2),           // AP 7
        (&[1, 0x90], Response, 1 + 1 + 1 + 2),           // AP 7
    ];
    for (start, direction, bytes) in table {
        let length = of_frame(start, direction);
        assert_eq!(length, Some(bytes), "{direction:?} {start:02X?}");
    }
}

#[test]
fn a_frame_length_is_unknown_until_the_byte_that_tells_it() {
    use Direction::{Request, Response};
    let table: [(&[u8], Direction); 11] = [
        (&[], Request),
        (&[], Response),
        (&[1], Request),
        (&[1], Response),
        (&[1, 3], Response),
        (&[1, 4], Response),
        (&[1, 16], Request),
        (&[1, 16, 0], Request),
        (&[1, 16, 0, 0], Request),
        (&[1, 16, 0, 0, 0], Request),
        (&[1, 16, 0, 0, 0, 1], Request),
    ];
    for (start, direction) in table {
        assert_eq!(of_frame(start, direction), None, "{direction:?} {start:?}");
    }
}

#[test]
fn a_frame_length_is_unknown_for_every_function_not_spoken() {
    for function in 0..=0xFF {
        let start = [1, function, 0, 0, 0, 0, 0, 0];
        let spoken = matches!(function, 3..=8 | 16);
        let known = of_frame(&start, Direction::Request).is_some();
        assert_eq!(known, spoken, "request {function:02X}");
        let known = of_frame(&start, Direction::Response).is_some();
        assert_eq!(known, spoken || function >= 0x80, "response {function:02X}");
    }
}

#[test]
fn a_frame_is_at_most_256_bytes() {
    // SL 2.3.
    let longest = sealed(&[1; 254]);
    assert_eq!(longest.len(), 256);
    assert_eq!(open(&longest).unwrap().1.len(), 253);
    let over = sealed(&[1; 255]);
    let error = DecodeError::TooLong { found: 257 };
    assert_eq!(open(&over), Err(error));
    assert_eq!(decode_request(&over), Err(error));
    assert_eq!(decode_reply(&over), Err(error));
}

#[test]
fn the_longest_messages_fit_a_frame_and_one_register_more_does_not() {
    let response =
        |registers: u8| sealed(&padded(&[1, 3, 2 * registers], 2 * usize::from(registers)));
    assert_eq!(response(125).len(), 255);
    assert!(decode_reply(&response(125)).is_ok());
    assert_eq!(
        decode_reply(&response(126)),
        Err(DecodeError::TooLong { found: 257 })
    );
    let write = |registers: u8| {
        let head = [1, 16, 0, 0, 0, registers, 2 * registers];
        sealed(&padded(&head, 2 * usize::from(registers)))
    };
    assert_eq!(write(123).len(), 255);
    assert!(decode_request(&write(123)).is_ok());
    assert_eq!(
        decode_request(&write(124)),
        Err(DecodeError::TooLong { found: 257 })
    );
}

#[test]
fn three_bytes_are_too_few_for_a_frame_even_with_a_right_crc() {
    let error = Err(DecodeError::Truncated { field: "CRC" });
    assert_eq!(open(&sealed(&[17])), error);
    assert_eq!(open(&sealed(&[])), error);
    assert_eq!(open(&[]), error);
}

#[test]
fn a_byte_count_that_contradicts_the_rest_is_rejected() {
    let wrong = |found, expected| DecodeError::ByteCount { found, expected };
    for function in [3, 4] {
        assert_eq!(reply(&[function, 4, 0, 1]), wrong(4, 2));
        assert_eq!(reply(&[function, 2, 0, 1, 0, 2]), wrong(2, 4));
        assert_eq!(reply(&[function, 0, 0, 1]), wrong(0, 2));
        assert_eq!(reply(&[function, 4, 0, 1, 2]), wrong(4, 3));
        assert_eq!(reply(&[function, 255, 0, 1]), wrong(255, 2));
    }
    assert_eq!(request(&[16, 0, 0, 0, 1, 4, 0, 1]), wrong(4, 2));
    assert_eq!(request(&[16, 0, 0, 0, 1, 2, 0, 1, 2]), wrong(2, 3));
    assert_eq!(wrong(4, 2).to_string(), "byte count is 4, expected 2");
}

#[test]
fn a_byte_count_that_is_odd_is_rejected_as_such() {
    // Not as "3, expected 3".
    let odd = DecodeError::Field {
        field: "byte count",
        found: 3,
    };
    for function in [3, 4] {
        assert_eq!(reply(&[function, 3, 0, 1, 2]), odd);
    }
    assert_eq!(request(&[16, 0, 0, 0, 1, 3, 0, 1, 2]), odd);
    assert_eq!(odd.to_string(), "byte count is 0x0003");
}

#[test]
fn a_quantity_that_contradicts_the_byte_count_is_rejected() {
    for quantity in [0, 1, 3, 123, 255] {
        let error = DecodeError::Field {
            field: "quantity of registers",
            found: u16::from(quantity),
        };
        assert_eq!(request(&[16, 0, 0, 0, quantity, 4, 0, 1, 0, 2]), error);
    }
}

#[test]
fn a_data_unit_cut_or_lengthened_is_rejected_with_a_right_crc_too() {
    let requests: [&[u8]; 7] = [
        &[3, 0, 0, 0, 1],
        &[4, 0, 0, 0, 1],
        &[5, 0, 1, 0xFF, 0],
        &[6, 0, 1, 0, 2],
        &[7],
        &[8, 0, 0, 0, 0],
        &[16, 0, 0, 0, 1, 2, 0, 0],
    ];
    let replies: [&[u8]; 8] = [
        &[3, 2, 0, 1],
        &[4, 2, 0, 1],
        &[5, 0, 1, 0xFF, 0],
        &[6, 0, 1, 0, 2],
        &[7, 0],
        &[8, 0, 0, 0, 0],
        &[16, 0, 0, 0, 1],
        &[0x83, 2],
    ];
    for unit in requests {
        assert!(Request::decode(unit).is_ok(), "{unit:02X?}");
        for length in 0..unit.len() {
            let cut = unit.get(..length).unwrap();
            assert!(Request::decode(cut).is_err(), "{cut:02X?}");
        }
        assert!(Request::decode(&padded(unit, 1)).is_err(), "{unit:02X?}");
    }
    for unit in replies {
        assert!(Reply::decode(unit).is_ok(), "{unit:02X?}");
        for length in 0..unit.len() {
            let cut = unit.get(..length).unwrap();
            assert!(Reply::decode(cut).is_err(), "{cut:02X?}");
        }
        assert!(Reply::decode(&padded(unit, 1)).is_err(), "{unit:02X?}");
    }
    let extra = DecodeError::Trailing { extra: 1 };
    assert_eq!(request(&[7, 0]), extra);
    assert_eq!(request(&[3, 0, 0, 0, 1, 0]), extra);
    assert_eq!(reply(&[0x83, 2, 0]), extra);
    let field = "function code";
    assert_eq!(request(&[]), DecodeError::Truncated { field });
    let field = "exception code";
    assert_eq!(reply(&[0x83]), DecodeError::Truncated { field });
}
