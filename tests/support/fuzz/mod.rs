//! What holds whatever bytes come: each property is a function of bytes, so that `cargo test` runs
//! it on random ones and the fuzzer (`tests/fuzz`) on those it finds worth trying.

#![allow(dead_code, reason = "each fuzz target uses one property")]

#[path = "../clock.rs"]
mod clock;
#[path = "../script.rs"]
mod script;

pub(crate) mod chunks;
pub(crate) mod codec;
mod cursor;
mod model;
mod pieces;
pub(crate) mod profile;
pub(crate) mod reply;
pub(crate) mod session;
