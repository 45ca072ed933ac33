#![no_main]

#[path = "../../support/fuzz/mod.rs"]
mod fuzz;

libfuzzer_sys::fuzz_target!(|data: &[u8]| fuzz::codec::codec(data));
