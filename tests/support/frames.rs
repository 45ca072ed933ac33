//! Frames of the four meters, one constant a message.
//!
//! "N" is the PQM manual's 3.6x edition, "O" its 3.5x edition, "RG" the PM290 Reference Guide;
//! numbers behind them are pages. Every CRC is the one that the bytes before it ask for; where a
//! manual prints another, `codec_misprints.rs` holds it.

pub(crate) mod em2x;
pub(crate) mod pm290;
pub(crate) mod pqm;
