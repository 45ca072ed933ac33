//! The end of a file: a line that was never finished, and what a power cut leaves.

use std::fmt;
use std::io;

use super::store::{Store, bytes};

/// So much of a file is looked at in one go.
pub(super) const CHUNK: u64 = 64 * 1024;

/// So much of what was removed is shown.
const SHOWN: u64 = 80;

/// A tail that was cut off. Prints as a clause.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Removed {
    /// How many bytes.
    pub bytes: u64,
    /// The first of them, at most 80.
    pub beginning: Vec<u8>,
}

impl fmt::Display for Removed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { bytes, beginning } = self;
        let zeros = beginning.iter().rev().take_while(|byte| **byte == 0);
        let shown = beginning.len() - zeros.count();
        // Never more than there are.
        let shown = beginning.get(..shown).unwrap_or_default();
        let more = if *bytes > shown.len() as u64 {
            "..."
        } else {
            ""
        };
        let unit = if *bytes == 1 { "byte" } else { "bytes" };
        if shown.is_empty() {
            return write!(f, "removed {bytes} {unit} at its end that were zero");
        }
        let shown = shown.escape_ascii();
        write!(
            f,
            "removed {bytes} {unit} of a last line that was not whole: '{shown}{more}'"
        )
    }
}

impl Removed {
    /// What stands from `from` on, before it is removed.
    pub(super) fn of(store: &mut dyn Store, from: u64, size: u64) -> io::Result<Self> {
        Ok(Self {
            bytes: size - from,
            beginning: bytes(store, from, size.min(from + SHOWN))?,
        })
    }
}

/// Where the whole lines end, the last of which has no zero byte: where a power cut comes before
/// the data, zeros stand in its place, and whoever appended later did so behind them.
pub(super) fn end_of_whole_lines(store: &mut dyn Store, size: u64) -> io::Result<u64> {
    // What is behind the last line end was never finished.
    let mut end = line_start(store, size)?;
    while end > 0 {
        // A line end is the byte before, so this is the line that it ends.
        let start = line_start(store, end - 1)?;
        if !has_zero(store, start, end)? {
            break;
        }
        end = start;
    }
    Ok(end)
}

/// Where the line begins that `end` is in, or is the end of.
pub(super) fn line_start(store: &mut dyn Store, end: u64) -> io::Result<u64> {
    let mut end = end;
    while end > 0 {
        let from = end.saturating_sub(CHUNK);
        let chunk = bytes(store, from, end)?;
        if let Some(place) = chunk.iter().rposition(|byte| *byte == b'\n') {
            return Ok(from + place as u64 + 1);
        }
        end = from;
    }
    Ok(0)
}

/// Where the zeros at the end begin.
pub(super) fn end_without_zeros(store: &mut dyn Store, size: u64) -> io::Result<u64> {
    let mut end = size;
    while end > 0 {
        let from = end.saturating_sub(CHUNK);
        let chunk = bytes(store, from, end)?;
        if let Some(place) = chunk.iter().rposition(|byte| *byte != 0) {
            return Ok(from + place as u64 + 1);
        }
        end = from;
    }
    Ok(0)
}

fn has_zero(store: &mut dyn Store, from: u64, to: u64) -> io::Result<bool> {
    let mut from = from;
    while from < to {
        let next = to.min(from + CHUNK);
        if bytes(store, from, next)?.contains(&0) {
            return Ok(true);
        }
        from = next;
    }
    Ok(false)
}
