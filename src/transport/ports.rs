//! The serial ports of this machine. None is opened: opening one resets a line in use.

use std::fs;
use std::io;

use serialport::{SerialPortInfo, SerialPortType, UsbPortInfo};
use thiserror::Error;

/// A serial port that could be opened.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Port {
    /// What it is opened by: `/dev/ttyUSB0`, `COM3`.
    pub path: String,
    /// What it is.
    pub kind: PortKind,
    /// The name that stays the same when adapters come and go, where the system has one.
    pub lasting_name: Option<String>,
}

/// What a port is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum PortKind {
    /// An adapter on USB.
    Usb {
        /// The maker's number.
        vendor: u16,
        /// The maker's number of the product.
        product: u16,
        /// Maker, product and serial number as the adapter says them, as far as it does: any
        /// characters at all.
        names: Vec<String>,
    },
    /// A serial port over Bluetooth.
    Bluetooth,
    /// A port on a card.
    Pci,
    /// Anything else; most are on the main board.
    BuiltIn,
}

/// The ports cannot be listed.
#[derive(Debug, Error)]
#[error("the serial ports cannot be listed")]
pub struct ListError(#[source] io::Error);

/// All ports, by path.
///
/// # Errors
/// [`ListError`] when the system does not tell.
pub fn list() -> Result<Vec<Port>, ListError> {
    let found = serialport::available_ports().map_err(|error| ListError(error.into()))?;
    let mut ports: Vec<Port> = found.into_iter().map(port).collect();
    ports.sort_by(|a, b| a.path.cmp(&b.path));
    Ok(ports)
}

fn port(found: SerialPortInfo) -> Port {
    Port {
        kind: match found.port_type {
            SerialPortType::UsbPort(usb) => usb_kind(usb),
            SerialPortType::BluetoothPort => PortKind::Bluetooth,
            SerialPortType::PciPort => PortKind::Pci,
            SerialPortType::Unknown => PortKind::BuiltIn,
        },
        lasting_name: lasting_name(&found.port_name),
        path: found.port_name,
    }
}

fn usb_kind(usb: UsbPortInfo) -> PortKind {
    let names = [usb.manufacturer, usb.product, usb.serial_number];
    PortKind::Usb {
        vendor: usb.vid,
        product: usb.pid,
        names: names.into_iter().flatten().collect(),
    }
}

/// The link to the port under `/dev/serial/by-id`.
fn lasting_name(port: &str) -> Option<String> {
    let target = fs::canonicalize(port).ok()?;
    let links = fs::read_dir("/dev/serial/by-id").ok()?;
    links
        .filter_map(|link| Some(link.ok()?.path()))
        .find(|link| fs::canonicalize(link).is_ok_and(|path| path == target))
        .map(|link| link.display().to_string())
}
