//! Reads and writes electricity meters over Modbus RTU: in points and units, and never a wrong number.
//!
//! The layers, each importing only those below it:
//!
//! ```text
//! main → commands → cli        what can be typed
//!                 → output     readings, and what a meter is, to table, CSV, JSON
//!                   → append   rows to files that others append to as well
//!                 → polling    when which meter is read, over and over
//!                 → writing    points written, once, and what became of it
//!                 → readings   a read plan carried out: a value or a fault for each point
//!                 → sim        a simulated meter and its line
//!                 → client     one request and its one answer; what is believed
//!                 → profile    what a meter is: points, scales, limits, read planning
//!                   → transport  moves bytes and keeps the line's time
//!                   → codec      bytes ↔ typed values, pure
//!                   → words      plurals
//! ```
//!
//! A register address is the 0-based protocol address everywhere; other notations are parsed where
//! they are typed.

// The library reports and does not stop the program; where it cannot come to that, an `expect`
// gives the proof. Tests may stop as they like.
#![warn(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::unreachable,
    clippy::todo,
    clippy::unimplemented
)]

pub mod append;
pub mod cli;
pub mod client;
pub mod codec;
pub mod commands;
pub mod output;
pub mod polling;
pub mod profile;
pub mod readings;
pub mod sim;
pub mod transport;
pub mod words;
pub mod writing;
