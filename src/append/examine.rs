//! What a file holds: whether rows belong into it, and how much of it is whole.

use std::io;

use super::cells::{Place, cells};
use super::error::Problem;
use super::start::{Misfit, Start};
use super::store::{Store, bytes};
use super::tail::{CHUNK, end_of_whole_lines, end_without_zeros, line_start};

/// The longest last line that is taken for a row.
const LONGEST_ROW: u64 = 16 * 1024 * 1024;

/// How many bytes of a file that rows belong into are whole lines; what is behind them was never
/// finished.
pub(super) fn whole_lines(store: &mut dyn Store, start: &Start) -> Result<u64, Problem> {
    let size = store.size().map_err(Problem::Read)?;
    if size == 0 {
        return Ok(0);
    }
    let Some(line_end) = first_line_end(store, size).map_err(Problem::Read)? else {
        return torn_from_the_start(store, start, size);
    };
    let line = beginning(store, line_end)?;
    start.fits(&line).map_err(Problem::Misfit)?;
    let end = end_of_whole_lines(store, size).map_err(Problem::Read)?;
    match open_quote(store, start, end).map_err(Problem::Read)? {
        Some(line) => Err(Problem::Misfit(Misfit::OpenQuote { line })),
        None => Ok(end),
    }
}

/// A first line, or of an endless one as much as tells that it is none of ours.
fn beginning(store: &mut dyn Store, end: u64) -> Result<Vec<u8>, Problem> {
    bytes(store, 0, end.min(LONGEST_ROW)).map_err(Problem::Read)
}

fn first_line_end(store: &mut dyn Store, size: u64) -> io::Result<Option<u64>> {
    let mut from = 0;
    while from < size {
        let next = size.min(from + CHUNK);
        let chunk = bytes(store, from, next)?;
        if let Some(place) = chunk.iter().position(|byte| *byte == b'\n') {
            return Ok(Some(from + place as u64));
        }
        from = next;
    }
    Ok(None)
}

/// A file without any line end is what is left of our first line, or none of ours. Zeros are what a
/// power cut leaves of anything.
fn torn_from_the_start(store: &mut dyn Store, start: &Start, size: u64) -> Result<u64, Problem> {
    let end = end_without_zeros(store, size).map_err(Problem::Read)?;
    let line = beginning(store, end)?;
    if start.can_be_torn(&line) {
        return Ok(0);
    }
    start.fits(&line).map(|()| 0).map_err(Problem::Misfit)
}

/// The line in which a quote is opened that is still open at `end`. Our own rows have none, for
/// they are one line each; but others may have edited the file. A last line that is by itself a row
/// is taken for one, so that a large file is not read whole for each row.
fn open_quote(store: &mut dyn Store, start: &Start, end: u64) -> io::Result<Option<u64>> {
    let Some(width) = start.width() else {
        return Ok(None);
    };
    let last = line_start(store, end.saturating_sub(1))?;
    if end - last <= LONGEST_ROW {
        let line = bytes(store, last, end)?;
        if cells(&line).is_some_and(|cells| cells.len() == width) {
            return Ok(None);
        }
    }
    let (mut place, mut line, mut opened) = (Place::Start, 1, 1);
    let mut from = 0;
    while from < end {
        let next = end.min(from + CHUNK);
        for byte in bytes(store, from, next)? {
            let behind = place.behind(byte);
            if place == Place::Start && behind == Place::Quoted {
                opened = line;
            }
            line += u64::from(byte == b'\n');
            place = behind;
        }
        from = next;
    }
    Ok((place == Place::Quoted).then_some(opened))
}
