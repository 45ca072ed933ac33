//! What a meter can do, for people.

use super::columns::columns;
use super::escape;
use crate::profile::writing::{Action, Operation};

/// A table of operations, with what is hazardous about them.
pub fn table(operations: &[Operation]) -> String {
    let rows = operations.iter().map(|operation| {
        let (how, takes) = match &operation.action {
            Action::Number { number, data } => {
                let data = data.as_deref();
                let takes = data.map(|data| data.about.clone());
                (format!("number {number}"), takes.unwrap_or_default())
            }
            Action::Register { address, value } => (format!("{address}={value}"), String::new()),
        };
        let hazard = operation.hazard.clone().unwrap_or_default();
        let cells = [operation.name.clone(), how, takes, hazard];
        cells.iter().map(|cell| escape(cell)).collect()
    });
    columns(&["OPERATION", "TOLD BY", "TAKES", "HAZARD"], &[], rows)
}
