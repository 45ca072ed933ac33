//! Reads, writes and logs electricity meters over Modbus RTU.
#![doc = ""]
pub mod codec;
