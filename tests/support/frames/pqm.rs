//! GE PQM: the examples the manual prints, tables 7-1 to 7-9, unit 17 (11h).

/// Table 7-1 (N 186, O 170): the manual prints the CRC of table 7-9.
pub(crate) const READ_REQUEST: &[u8] = &[
    0x11, // unit 17
    0x03, // 03 Read Holding Registers
    0x00, 0x6B, // from 006B
    0x00, 0x03, // 3 registers
    0x76, 0x87, // CRC
];

/// Table 7-1 (N 186): the printed CRC is wrong in its second byte.
pub(crate) const READ_RESPONSE: &[u8] = &[
    0x11, // unit 17
    0x03, // 03 Read Holding Registers
    0x06, // 6 bytes
    0x02, 0x2B, // 555
    0x00, 0x00, // 0
    0x00, 0x64, // 100
    0xC8, 0xBA, // CRC
];

/// Table 7-2 (O 171): reset, and the same back. CRC as printed.
pub(crate) const OPERATION: &[u8] = &[
    0x11, // unit 17
    0x05, // 05 Write Single Coil: execute operation
    0x00, 0x01, // operation 1, reset
    0xFF, 0x00, // perform
    0xDF, 0x6A, // CRC
];

/// Table 7-3 (N 188): clear all demand, to everybody. CRC as printed.
pub(crate) const OPERATION_BROADCAST: &[u8] = &[
    0x00, // broadcast
    0x05, // 05 Write Single Coil: execute operation
    0x00, 0x22, // operation 34, clear all demand
    0xFF, 0x00, // perform
    0x2D, 0xE1, // CRC
];

/// Table 7-3 (O 172): the same to unit 17, with the CRC it should have then.
pub(crate) const OPERATION_TO_UNIT_17: &[u8] = &[
    0x11, // unit 17
    0x05, // 05 Write Single Coil: execute operation
    0x00, 0x22, // operation 34, clear all demand
    0xFF, 0x00, // perform
    0x2E, 0xA0, // CRC
];

/// Table 7-4 (N 189, O 173), and the same back. The printed CRC belongs to the value 01F4.
pub(crate) const STORE: &[u8] = &[
    0x11, // unit 17
    0x06, // 06 Write Single Register
    0x10, 0x20, // register 1020
    0x01, 0xE4, // 484
    0x8F, 0x8B, // CRC
];

/// Table 7-4 (N 189) with the value its printed CRC is right for.
pub(crate) const STORE_01F4: &[u8] = &[
    0x11, // unit 17
    0x06, // 06 Write Single Register
    0x10, 0x20, // register 1020
    0x01, 0xF4, // 500
    0x8E, 0x47, // CRC
];

/// Table 7-5 (N 190, O 174). CRC as printed.
pub(crate) const STATUS_REQUEST: &[u8] = &[
    0x11, // unit 17
    0x07, // 07 Read Exception Status: read device status
    0x4C, 0x22, // CRC
];

/// Table 7-5 (N 190, O 174). CRC as printed.
pub(crate) const STATUS_RESPONSE: &[u8] = &[
    0x11, // unit 17
    0x07, // 07 Read Exception Status: read device status
    0x2C, // alarm relay, aux 1 and aux 3 energised
    0x22, 0x28, // CRC
];

/// Table 7-6 (N 191, O 175), and the same back. The printed CRC belongs to unit 1.
pub(crate) const LOOPBACK: &[u8] = &[
    0x11, // unit 17
    0x08, // 08 Diagnostics
    0x00, 0x00, // sub-function 0, Return Query Data
    0x00, 0x00, // data
    0xE2, 0x9B, // CRC
];

/// Table 7-6 (N 191) with the unit its printed CRC is right for.
pub(crate) const LOOPBACK_OF_UNIT_1: &[u8] = &[
    0x01, // unit 1
    0x08, // 08 Diagnostics
    0x00, 0x00, // sub-function 0, Return Query Data
    0x00, 0x00, // data
    0xE0, 0x0B, // CRC
];

/// Table 7-7 (N 192, O 176). CRC as printed.
pub(crate) const STORE_MANY_REQUEST: &[u8] = &[
    0x11, // unit 17
    0x10, // 16 Write Multiple Registers
    0x10, 0x28, // from 1028
    0x00, 0x02, // 2 registers
    0x04, // 4 bytes
    0x01, 0xF4, // 500
    0x27, 0x10, // 10000
    0x33, 0x23, // CRC
];

/// Table 7-7 (N 192, O 176). CRC as printed.
pub(crate) const STORE_MANY_RESPONSE: &[u8] = &[
    0x11, // unit 17
    0x10, // 16 Write Multiple Registers
    0x10, 0x28, // from 1028
    0x00, 0x02, // 2 registers
    0xC7, 0x90, // CRC
];

/// Table 7-8 (N 193): reset through the command area. The printed CRC fits no unit.
pub(crate) const COMMAND_REQUEST: &[u8] = &[
    0x11, // unit 17
    0x10, // 16 Write Multiple Registers
    0x00, 0x80, // from 0080, the command area
    0x00, 0x02, // 2 registers
    0x04, // 4 bytes
    0x00, 0x05, // execute operation
    0x00, 0x01, // operation 1, reset
    0x7E, 0xCE, // CRC
];

/// Table 7-8 (N 193): the printed CRC is wrong.
pub(crate) const COMMAND_RESPONSE: &[u8] = &[
    0x11, // unit 17
    0x10, // 16 Write Multiple Registers
    0x00, 0x80, // from 0080
    0x00, 0x02, // 2 registers
    0x42, 0xB0, // CRC
];

/// Table 7-9 (N 194): sets every clock. CRC as printed.
pub(crate) const CLOCK_BROADCAST: &[u8] = &[
    0x00, // broadcast
    0x10, // 16 Write Multiple Registers
    0x00, 0xF0, // from 00F0, the clock
    0x00, 0x04, // 4 registers
    0x08, // 8 bytes
    0x0D, 0x1B, // 13:27
    0x27, 0x1F, // 10015 ms into the minute
    0x0A, 0x1D, // October 29
    0x07, 0xCD, // 1997
    0x9D, 0x8D, // CRC
];

/// Table 7-9 (O 178): the same to unit 17, with the CRC it should have then.
pub(crate) const CLOCK_TO_UNIT_17: &[u8] = &[
    0x11, // unit 17
    0x10, // 16 Write Multiple Registers
    0x00, 0xF0, // from 00F0, the clock
    0x00, 0x04, // 4 registers
    0x08, // 8 bytes
    0x0D, 0x1B, // 13:27
    0x27, 0x1F, // 10015 ms into the minute
    0x0A, 0x1D, // October 29
    0x07, 0xCD, // 1997
    0x4C, 0x81, // CRC
];
