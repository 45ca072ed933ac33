//! What is about to be written, for people.

use super::columns::columns;
use super::escape;
use crate::profile::Value;
use crate::profile::point::Point;
use crate::readings::Fault;

/// One change that is about to be made.
#[derive(Debug)]
pub struct Line<'a> {
    /// The point.
    pub point: &'a Point,
    /// What it holds now; `None` for one that can only be written.
    pub old: Option<&'a Result<Value, Fault>>,
    /// What it is to hold, as it will read.
    pub new: String,
}

/// A table of changes: what each point holds, and what it is to hold.
pub fn table(lines: &[Line<'_>]) -> String {
    let rows = lines.iter().map(|line| {
        let old = match line.old {
            None => "-".to_owned(),
            Some(Ok(value)) => value.to_string(),
            Some(Err(fault)) => format!("? ({fault})"),
        };
        let unit = line.point.unit.as_deref().unwrap_or_default();
        let cells = [&line.point.name, &old, &line.new, unit];
        cells.map(escape).to_vec()
    });
    columns(&["POINT", "NOW", "NEW", "UNIT"], &[1, 2], rows)
}
