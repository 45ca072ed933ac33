//! Reads, writes and logs electricity meters.

fn main() {}
