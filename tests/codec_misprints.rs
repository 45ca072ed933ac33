//! The PQM manual's misprinted CRCs: what a client that copied them would send is no frame.
//!
//! "N" is the manual's 3.6x edition, "O" its 3.5x edition; numbers behind them are pages.

use meterpoll::codec::DecodeError;
use meterpoll::codec::rtu::{Hex, decode_reply, decode_request, open};

/// A frame as printed, and the CRC its bytes ask for.
struct Misprint {
    frame: &'static [u8],
    computed: [u8; 2],
}

const MISPRINTS: [Misprint; 9] = [
    // Table 7-1 request (N 186): the CRC is the one of table 7-9.
    Misprint {
        frame: &[0x11, 0x03, 0x00, 0x6B, 0x00, 0x03, 0x9D, 0x8D],
        computed: [0x76, 0x87],
    },
    // Table 7-1 response (N 186): the second byte of the CRC is wrong, BA printed as B8.
    Misprint {
        frame: &[
            0x11, 0x03, 0x06, 0x02, 0x2B, 0x00, 0x00, 0x00, 0x64, 0xC8, 0xB8,
        ],
        computed: [0xC8, 0xBA],
    },
    // Table 7-4 (N 189): the CRC is right for the value 01F4, but 01E4 is printed.
    Misprint {
        frame: &[0x11, 0x06, 0x10, 0x20, 0x01, 0xE4, 0x8E, 0x47],
        computed: [0x8F, 0x8B],
    },
    // Table 7-6 (N 191): the CRC is right for unit 1, but unit 17 is printed.
    Misprint {
        frame: &[0x11, 0x08, 0x00, 0x00, 0x00, 0x00, 0xE0, 0x0B],
        computed: [0xE2, 0x9B],
    },
    // Table 7-8 request (N 193): close to 0B D6, which would be right for unit 11 (0Bh).
    Misprint {
        frame: &[
            0x11, 0x10, 0x00, 0x80, 0x00, 0x02, 0x04, 0x00, 0x05, 0x00, 0x01, 0xB0, 0xD6,
        ],
        computed: [0x7E, 0xCE],
    },
    // Table 7-8 response (N 193): the CRC fits neither these bytes nor those of the request.
    Misprint {
        frame: &[0x11, 0x10, 0x00, 0x80, 0x00, 0x02, 0x46, 0x7A],
        computed: [0x42, 0xB0],
    },
    // Table 7-3 (O 172): unit 17 is printed with the CRC of the broadcast.
    Misprint {
        frame: &[0x11, 0x05, 0x00, 0x22, 0xFF, 0x00, 0x2D, 0xE1],
        computed: [0x2E, 0xA0],
    },
    // Table 7-9 (O 178): unit 17 is printed with the CRC of the broadcast.
    Misprint {
        frame: &[
            0x11, 0x10, 0x00, 0xF0, 0x00, 0x04, 0x08, 0x0D, 0x1B, 0x27, 0x1F, 0x0A, 0x1D, 0x07,
            0xCD, 0x9D, 0x8D,
        ],
        computed: [0x4C, 0x81],
    },
    // Table 7-8 request with that CRC: right for unit 11, not for unit 17.
    Misprint {
        frame: &[
            0x11, 0x10, 0x00, 0x80, 0x00, 0x02, 0x04, 0x00, 0x05, 0x00, 0x01, 0x0B, 0xD6,
        ],
        computed: [0x7E, 0xCE],
    },
];

#[test]
fn every_misprinted_frame_is_rejected_for_its_crc() {
    for Misprint { frame, computed } in MISPRINTS {
        let (_, found) = frame.split_last_chunk::<2>().unwrap();
        let error = DecodeError::Crc {
            found: *found,
            computed,
        };
        assert_eq!(open(frame), Err(error), "{}", Hex(frame));
        assert_eq!(decode_request(frame), Err(error), "{}", Hex(frame));
        assert_eq!(decode_reply(frame), Err(error), "{}", Hex(frame));
    }
}

#[test]
fn every_misprinted_frame_opens_with_the_computed_crc() {
    for Misprint { frame, computed } in MISPRINTS {
        let (body, _) = frame.split_last_chunk::<2>().unwrap();
        let right = [body, &computed].concat();
        let (address, unit) = open(&right).unwrap();
        assert_eq!(address, 17);
        assert_eq!(Some(unit), body.get(1..));
    }
}

#[test]
fn a_wrong_crc_is_reported_with_both_checks_in_wire_order() {
    let frame = [0x11, 0x06, 0x10, 0x20, 0x01, 0xE4, 0x8E, 0x47];
    let error = decode_request(&frame).unwrap_err();
    assert_eq!(error.to_string(), "CRC is [8E, 47], computed [8F, 8B]");
}
