//! Reads, writes and logs electricity meters over Modbus RTU.

pub mod client;
pub mod codec;
pub mod profile;
pub mod sim;
pub mod transport;
