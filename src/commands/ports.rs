//! `ports`: the serial ports of this machine. None is opened: opening one resets a line in use.

use serialport::{SerialPortInfo, SerialPortType};

use super::report::Report;
use super::{CommandError, ExitCode, print};
use crate::output::columns::columns;
use crate::output::escape;

/// Lists the ports, each with what it is and its lasting name.
pub(super) fn list(report: &Report) -> Result<ExitCode, CommandError> {
    let mut ports = serialport::available_ports().map_err(CommandError::Ports)?;
    ports.sort_by(|a, b| a.port_name.cmp(&b.port_name));
    if ports.is_empty() {
        report.remark("no serial ports; sim: is a simulated line inside the program");
        return Ok(ExitCode::Done);
    }
    let lines = ports.iter().map(|port| {
        vec![
            port.port_name.clone(),
            kind(port),
            lasting_name(&port.port_name).unwrap_or_default(),
        ]
    });
    print(columns(&["PORT", "KIND", "LASTING NAME"], &[], lines).as_bytes())
}

fn kind(port: &SerialPortInfo) -> String {
    match &port.port_type {
        SerialPortType::UsbPort(usb) => {
            let names = [&usb.manufacturer, &usb.product, &usb.serial_number];
            let names: Vec<String> = names
                .iter()
                .filter_map(|name| name.as_deref().map(escape))
                .collect();
            format!("USB {:04x}:{:04x} {}", usb.vid, usb.pid, names.join(" "))
                .trim_end()
                .to_owned()
        }
        SerialPortType::BluetoothPort => "Bluetooth".to_owned(),
        SerialPortType::PciPort => "PCI".to_owned(),
        SerialPortType::Unknown => "built in".to_owned(),
    }
}

/// The name under `/dev/serial/by-id` that stays the same when adapters come and go.
fn lasting_name(port: &str) -> Option<String> {
    let target = std::fs::canonicalize(port).ok()?;
    let links = std::fs::read_dir("/dev/serial/by-id").ok()?;
    links
        .filter_map(|link| Some(link.ok()?.path()))
        .find(|link| std::fs::canonicalize(link).is_ok_and(|path| path == target))
        .map(|link| link.display().to_string())
}
