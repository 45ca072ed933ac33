//! The header of Modbus TCP, against frames typed from the standards.

use meterpoll::codec::DecodeError;
use meterpoll::codec::mbap::{Header, encode, of_frame, open};
use proptest::prelude::*;

/// "Modbus Messaging on TCP/IP Implementation Guide V1.0b", 4.4.2.1: a read of one register, of
/// transaction 0x1501 to unit 0xFF.
const READ: [u8; 12] = [
    0x15, 0x01, // transaction
    0x00, 0x00, // protocol
    0x00, 0x06, // length
    0xFF, // unit
    0x03, 0x00, 0x04, 0x00, 0x01, // function, address, count
];

const HEADER: Header = Header {
    transaction: 0x1501,
    unit: 0xFF,
};

fn field(field: &'static str, found: u16) -> DecodeError {
    DecodeError::Field { field, found }
}

#[test]
fn the_frame_of_the_guide_reads_and_writes() {
    assert_eq!(open(&READ), Ok((HEADER, &READ[7..])));
    assert_eq!(encode(HEADER, &READ[7..]), READ);
    assert_eq!(of_frame(&READ), Ok(Some(12)));
}

#[test]
fn the_length_is_told_from_six_bytes_on() {
    for cut in 0..6 {
        assert_eq!(of_frame(&READ[..cut]), Ok(None), "{cut}");
    }
    for cut in 6..12 {
        assert_eq!(of_frame(&READ[..cut]), Ok(Some(12)), "{cut}");
    }
}

#[test]
fn a_cut_frame_names_the_field_that_is_missing() {
    let names = ["transaction", "protocol", "length"];
    for cut in 0..12 {
        let field = match cut {
            0..6 => names[cut / 2],
            6 => "unit",
            _ => "data unit",
        };
        let error = Err(DecodeError::Truncated { field });
        assert_eq!(open(&READ[..cut]), error, "{cut}");
    }
}

#[test]
fn bytes_behind_the_frame_are_an_error() {
    let frame = [&READ[..], &[0, 0]].concat();
    assert_eq!(open(&frame), Err(DecodeError::Trailing { extra: 2 }));
}

#[test]
fn another_protocol_and_impossible_lengths_are_errors() {
    let with = |place: usize, bytes: [u8; 2]| {
        let mut frame = READ;
        frame[place..place + 2].copy_from_slice(&bytes);
        frame
    };
    for (frame, error) in [
        (with(2, [0, 1]), field("protocol", 1)),
        (with(4, [0, 0]), field("length", 0)),
        (with(4, [0, 1]), field("length", 1)),
        (with(4, [0, 255]), field("length", 255)),
        (with(4, [255, 255]), field("length", 65_535)),
    ] {
        assert_eq!(of_frame(&frame), Err(error));
        assert_eq!(open(&frame), Err(error));
    }
    assert_eq!(of_frame(&with(4, [0, 2])), Ok(Some(8)));
    assert_eq!(of_frame(&with(4, [0, 254])), Ok(Some(260)));
}

proptest! {
    #[test]
    fn what_is_written_reads_the_same(
        transaction: u16,
        unit: u8,
        data_unit in proptest::collection::vec(any::<u8>(), 1..=253),
    ) {
        let header = Header { transaction, unit };
        let frame = encode(header, &data_unit);
        prop_assert_eq!(of_frame(&frame), Ok(Some(frame.len())));
        prop_assert_eq!(open(&frame), Ok((header, &data_unit[..])));
    }

    #[test]
    fn no_bytes_stop_the_reader(bytes: Vec<u8>) {
        let length = of_frame(&bytes);
        if open(&bytes).is_ok() {
            prop_assert_eq!(length, Ok(Some(bytes.len())));
        }
    }
}
