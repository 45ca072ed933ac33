//! Satec PM290, unit 1. The guide prints no frames: these follow its layouts (RG 14, 15).
//!
//! The two address bytes are a table and an offset in it.

/// Table 1 (RG 21): the four energies.
pub(crate) const ENERGIES_REQUEST: &[u8] = &[
    0x01, // unit 1
    0x03, // 03 Read Holding Registers
    0x01, 0x1F, // table 1, offset 31
    0x00, 0x08, // 8 registers
    0x74, 0x36, // CRC
];

/// Table 1 (RG 21): pairs of 0 to 9999, low word first.
pub(crate) const ENERGIES_RESPONSE: &[u8] = &[
    0x01, // unit 1
    0x03, // 03 Read Holding Registers
    0x10, // 16 bytes
    0x10, 0xE1, 0x00, 0x03, // 4321 + 3 * 10000 kWh consumed
    0x00, 0x00, 0x00, 0x00, // 0 kWh returned
    0x07, 0xD0, 0x00, 0x00, // 2000 kvarh positive
    0x00, 0x00, 0x00, 0x00, // 0 kvarh negative
    0x5D, 0x35, // CRC
];

/// Table 9 (RG 25): the system configuration.
pub(crate) const SETUP_REQUEST: &[u8] = &[
    0x01, // unit 1
    0x04, // 04 Read Input Registers
    0x09, 0x00, // table 9, offset 0
    0x00, 0x07, // 7 registers
    0xB2, 0x54, // CRC
];

/// Table 9 (RG 25).
pub(crate) const SETUP_RESPONSE: &[u8] = &[
    0x01, // unit 1
    0x04, // 04 Read Input Registers
    0x0E, // 14 bytes
    0x00, 0x01, // wiring: 4-wire, line to neutral
    0x00, 0x0A, // PT ratio 1.0
    0x00, 0xC8, // CT primary 200 A
    0x00, 0x14, // power demand period 20 min
    0x03, 0x84, // ampere demand period 900 s
    0x00, 0x08, // 8
    0x00, 0x00, // resets allowed
    0x9C, 0x55, // CRC
];

/// Table 10 (RG 26): the status.
pub(crate) const STATUS_REQUEST: &[u8] = &[
    0x01, // unit 1
    0x03, // 03 Read Holding Registers
    0x0A, 0x00, // table 10, offset 0
    0x00, 0x06, // 6 registers
    0xC6, 0x10, // CRC
];

/// Table 9 (RG 25), and the same back.
pub(crate) const SET_CT: &[u8] = &[
    0x01, // unit 1
    0x06, // 06 Write Single Register
    0x09, 0x02, // table 9, offset 2
    0x00, 0xC8, // 200 A
    0x2A, 0x00, // CRC
];

/// Table 9 (RG 25).
pub(crate) const SET_PT_AND_CT_REQUEST: &[u8] = &[
    0x01, // unit 1
    0x10, // 16 Write Multiple Registers
    0x09, 0x01, // table 9, offset 1
    0x00, 0x02, // 2 registers
    0x04, // 4 bytes
    0x00, 0x0A, // PT ratio 1.0
    0x00, 0xC8, // CT primary 200 A
    0x79, 0xA7, // CRC
];

/// Table 9 (RG 25).
pub(crate) const SET_PT_AND_CT_RESPONSE: &[u8] = &[
    0x01, // unit 1
    0x10, // 16 Write Multiple Registers
    0x09, 0x01, // table 9, offset 1
    0x00, 0x02, // 2 registers
    0x13, 0x94, // CRC
];

/// Note to table 1 (RG 21), and the same back.
pub(crate) const RESET_DEMANDS: &[u8] = &[
    0x01, // unit 1
    0x06, // 06 Write Single Register
    0x01, 0x18, // table 1, offset 24
    0x00, 0x00, // any value
    0x08, 0x31, // CRC
];

/// Note to table 1 (RG 21), and the same back.
pub(crate) const RESET_CONSUMPTION: &[u8] = &[
    0x01, // unit 1
    0x06, // 06 Write Single Register
    0x01, 0x1F, // table 1, offset 31
    0x00, 0x00, // 0
    0xB9, 0xF0, // CRC
];

/// Note to table 1 (RG 21), to everybody (RG 12).
pub(crate) const RESET_CONSUMPTION_BROADCAST: &[u8] = &[
    0x00, // broadcast
    0x06, // 06 Write Single Register
    0x01, 0x1F, // table 1, offset 31
    0x00, 0x00, // 0
    0xB8, 0x21, // CRC
];

/// Table 10 (RG 26), and the same back.
pub(crate) const RESTART: &[u8] = &[
    0x01, // unit 1
    0x06, // 06 Write Single Register
    0x0A, 0x00, // table 10, offset 0
    0xFF, 0xFF, // restart
    0x8B, 0xA2, // CRC
];

/// Exception 06 (RG 18): the meter is being set up at its keys. To a read.
pub(crate) const BUSY_TO_A_READ: &[u8] = &[
    0x01, // unit 1
    0x83, // 03 Read Holding Registers, refused
    0x06, // SERVER DEVICE BUSY
    0xC1, 0x32, // CRC
];

/// Exception 06 (RG 18), to a write.
pub(crate) const BUSY_TO_A_WRITE: &[u8] = &[
    0x01, // unit 1
    0x86, // 06 Write Single Register, refused
    0x06, // SERVER DEVICE BUSY
    0xC2, 0x62, // CRC
];

/// Function 20 (RG 14): two words of table 1. Not spoken here.
pub(crate) const FUNCTION_20_REQUEST: &[u8] = &[
    0x01, // unit 1
    0x14, // 20
    0x07, // 7 bytes
    0x06, // reference type
    0x00, 0x01, // table 1
    0x00, 0x1F, // offset 31
    0x00, 0x02, // 2 words
    0x74, 0xE3, // CRC
];

/// Function 20 (RG 14). Not spoken here.
pub(crate) const FUNCTION_20_RESPONSE: &[u8] = &[
    0x01, // unit 1
    0x14, // 20
    0x06, // 6 bytes
    0x05, // 5 of them in the first answer
    0x06, // reference type
    0x10, 0xE1, // 4321
    0x00, 0x03, // 3
    0xFD, 0x3D, // CRC
];

/// Function 21 (RG 15): CT primary 200 A, and the same back. Not spoken here.
pub(crate) const FUNCTION_21: &[u8] = &[
    0x01, // unit 1
    0x15, // 21
    0x09, // 9 bytes
    0x06, // reference type
    0x00, 0x09, // table 9
    0x00, 0x02, // offset 2
    0x00, 0x01, // 1 word
    0x00, 0xC8, // 200 A
    0x97, 0xD4, // CRC
];
