//! Prepares the built-in meters.

fn main() {}
