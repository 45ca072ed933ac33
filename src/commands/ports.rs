//! `ports`: the serial ports of this machine.

use super::report::Report;
use super::{CommandError, ExitCode, print};
use crate::output::columns::columns;
use crate::output::escape;
use crate::transport::ports::{self, PortKind};

/// Prints the ports, each with what it is and its lasting name.
pub(super) fn list(report: &Report) -> Result<ExitCode, CommandError> {
    let ports = ports::list()?;
    if ports.is_empty() {
        report.remark("no serial ports; sim: is a simulated line inside the program");
        return Ok(ExitCode::Done);
    }
    let lines = ports.into_iter().map(|port| {
        vec![
            port.path,
            describe(&port.kind),
            port.lasting_name.unwrap_or_default(),
        ]
    });
    print(columns(&["PORT", "KIND", "LASTING NAME"], &[], lines).as_bytes())
}

fn describe(kind: &PortKind) -> String {
    match kind {
        PortKind::Usb {
            vendor,
            product,
            names,
        } => {
            let names: Vec<String> = names.iter().map(|name| escape(name)).collect();
            format!("USB {vendor:04x}:{product:04x} {}", names.join(" "))
                .trim_end()
                .to_owned()
        }
        PortKind::Bluetooth => "Bluetooth".to_owned(),
        PortKind::Pci => "PCI".to_owned(),
        PortKind::BuiltIn => "built in".to_owned(),
    }
}
