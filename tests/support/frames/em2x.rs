//! Carlo Gavazzi EM21 and EM24-DIN, unit 1. Their protocol documents print no frames: these
//! follow the layouts on page 3 to 5 of both. "EM21" and "EM24" are the documents.

/// EM21 table 2.6-1, page 9: the identification code, alone.
pub(crate) const IDENTIFICATION_REQUEST: &[u8] = &[
    0x01, // unit 1
    0x04, // 04 Read Input Registers
    0x00, 0x0B, // from 000B
    0x00, 0x01, // 1 register
    0x40, 0x08, // CRC
];

/// EM21 table 2.6-1, page 9: an EM21 AV5.
pub(crate) const IDENTIFICATION_EM21: &[u8] = &[
    0x01, // unit 1
    0x04, // 04 Read Input Registers
    0x02, // 2 bytes
    0x00, 0x39, // 57
    0x79, 0x22, // CRC
];

/// An EM24-DIN AV5; the code is known from open-source drivers only.
pub(crate) const IDENTIFICATION_EM24: &[u8] = &[
    0x01, // unit 1
    0x04, // 04 Read Input Registers
    0x02, // 2 bytes
    0x00, 0x48, // 72
    0xB9, 0x06, // CRC
];

/// EM21 and EM24 table 2.3-1, page 8: the voltage L1-N.
pub(crate) const VOLTAGE_REQUEST: &[u8] = &[
    0x01, // unit 1
    0x04, // 04 Read Input Registers
    0x00, 0x00, // from 0000
    0x00, 0x02, // 2 registers
    0x71, 0xCB, // CRC
];

/// EM21 and EM24 table 2.3-1, page 8.
pub(crate) const VOLTAGE_RESPONSE: &[u8] = &[
    0x01, // unit 1
    0x04, // 04 Read Input Registers
    0x04, // 4 bytes
    0x08, 0xFD, 0x00, 0x00, // 2301, low word first: 230.1 V
    0x68, 0x14, // CRC
];

/// EM21 and EM24 table 2.3-1, page 8: a power below zero.
pub(crate) const POWER_RESPONSE: &[u8] = &[
    0x01, // unit 1
    0x04, // 04 Read Input Registers
    0x04, // 4 bytes
    0xC5, 0x68, 0xFF, 0xFF, // -15000, low word first: -1500.0 W
    0x47, 0x24, // CRC
];

/// EM21 and EM24 table 2.3-1, page 8: the first ten registers.
pub(crate) const TEN_REGISTERS_REQUEST: &[u8] = &[
    0x01, // unit 1
    0x04, // 04 Read Input Registers
    0x00, 0x00, // from 0000
    0x00, 0x0A, // 10 registers
    0x70, 0x0D, // CRC
];

/// EM21 table 2.3-1, page 8: eleven registers, the most it gives.
pub(crate) const ELEVEN_REGISTERS_REQUEST: &[u8] = &[
    0x01, // unit 1
    0x04, // 04 Read Input Registers
    0x00, 0x28, // from 0028
    0x00, 0x0B, // 11 registers
    0x31, 0xC5, // CRC
];

/// EM21 page 3: one register more than it gives. A right request all the same.
pub(crate) const TWELVE_REGISTERS_REQUEST: &[u8] = &[
    0x01, // unit 1
    0x04, // 04 Read Input Registers
    0x00, 0x00, // from 0000
    0x00, 0x0C, // 12 registers
    0xF0, 0x0F, // CRC
];

/// EM21 page 3 to 5: one of the two answers that too many registers can get.
pub(crate) const REFUSED_VALUE: &[u8] = &[
    0x01, // unit 1
    0x84, // 04 Read Input Registers, refused
    0x03, // ILLEGAL DATA VALUE
    0x03, 0x01, // CRC
];

/// EM21 page 3 to 5: the other answer.
pub(crate) const REFUSED_ADDRESS: &[u8] = &[
    0x01, // unit 1
    0x84, // 04 Read Input Registers, refused
    0x02, // ILLEGAL DATA ADDRESS
    0xC2, 0xC1, // CRC
];

/// EM21 table 2.3-1, page 8: both energies.
pub(crate) const EM21_ENERGIES_REQUEST: &[u8] = &[
    0x01, // unit 1
    0x04, // 04 Read Input Registers
    0x00, 0x34, // from 0034
    0x00, 0x04, // 4 registers
    0xB0, 0x07, // CRC
];

/// EM21 table 2.3-1, page 8.
pub(crate) const EM21_ENERGIES_RESPONSE: &[u8] = &[
    0x01, // unit 1
    0x04, // 04 Read Input Registers
    0x08, // 8 bytes
    0xD6, 0x87, 0x00, 0x12, // 1234567, low word first: 123456.7 kWh
    0x03, 0x7A, 0x00, 0x00, // 890, low word first: 89.0 kvarh
    0xC7, 0xED, // CRC
];

/// EM24 table 2.3-1, page 8: both total energies.
pub(crate) const EM24_ENERGIES_REQUEST: &[u8] = &[
    0x01, // unit 1
    0x04, // 04 Read Input Registers
    0x00, 0x3E, // from 003E
    0x00, 0x04, // 4 registers
    0x90, 0x05, // CRC
];

/// EM21 table 2.7-4, page 9, and the same back: the CT ratio's low word.
pub(crate) const EM21_CT_LOW: &[u8] = &[
    0x01, // unit 1
    0x06, // 06 Write Single Register
    0x10, 0x03, // register 1003
    0x01, 0x90, // 400, low word: 40.0
    0x7C, 0xF6, // CRC
];

/// EM21 table 2.7-4, page 9, and the same back: the CT ratio's high word.
pub(crate) const EM21_CT_HIGH: &[u8] = &[
    0x01, // unit 1
    0x06, // 06 Write Single Register
    0x10, 0x04, // register 1004
    0x00, 0x00, // high word
    0xCC, 0xCB, // CRC
];

/// EM21 table 2.7-12, page 10, and the same back: all meters to zero.
pub(crate) const EM21_RESET: &[u8] = &[
    0x01, // unit 1
    0x06, // 06 Write Single Register
    0x30, 0x00, // register 3000
    0x00, 0x01, // do it
    0x47, 0x0A, // CRC
];

/// EM24 table 2.9-2, page 10, and the same back.
pub(crate) const EM24_APPLICATION_H: &[u8] = &[
    0x01, // unit 1
    0x06, // 06 Write Single Register
    0x11, 0x01, // register 1101
    0x00, 0x07, // application H
    0x9C, 0xF4, // CRC
];

/// EM24 table 2.9-12, page 13.
pub(crate) const EM24_SERIAL_REQUEST: &[u8] = &[
    0x01, // unit 1
    0x03, // 03 Read Holding Registers
    0x13, 0x00, // from 1300
    0x00, 0x07, // 7 registers
    0x00, 0x8C, // CRC
];

/// EM24 table 2.9-13, page 13, and the same back.
pub(crate) const EM24_RESET_DEMANDS: &[u8] = &[
    0x01, // unit 1
    0x06, // 06 Write Single Register
    0x30, 0x05, // register 3005
    0x00, 0x01, // do it
    0x57, 0x0B, // CRC
];

/// EM24 table 2.9-13, page 13, to everybody (EM24 page 5).
pub(crate) const EM24_RESET_DEMANDS_BROADCAST: &[u8] = &[
    0x00, // broadcast
    0x06, // 06 Write Single Register
    0x30, 0x05, // register 3005
    0x00, 0x01, // do it
    0x56, 0xDA, // CRC
];

/// Function 08 as the PM290 (RG 14), the EM21 and the EM24 (page 5) take it, and the same back.
pub(crate) const LOOPBACK: &[u8] = &[
    0x01, // unit 1
    0x08, // 08 Diagnostics
    0x00, 0x00, // sub-function 0, Return Query Data
    0xA5, 0x37, // data
    0xDA, 0x8D, // CRC
];
