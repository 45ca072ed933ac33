//! What happens under the lock.

use std::io::{self, ErrorKind};

use super::Syncing;
use super::error::{Kept, Problem};
use super::examine::whole_lines;
use super::start::Start;
use super::store::{Store, bytes};
use super::tail::Removed;

/// Appends whole lines, all or none, in one write; in an empty file the header goes before them in
/// the same. A tail that was never finished is cut off first; `tell` is told. A last line that has
/// no end gets one.
///
/// # Errors
/// Where the file is none that rows belong into, it is untouched. Where they could not be written,
/// it is as it was before, apart from the tail and unless [`Kept::Unknown`] says otherwise.
pub fn commit(
    store: &mut dyn Store,
    start: &Start,
    lines: &[u8],
    syncing: Syncing,
    tell: &mut dyn FnMut(&Removed),
) -> Result<(), Problem> {
    let whole = whole_lines(store, start)?;
    let size = store.size().map_err(Problem::Read)?;
    if size > whole {
        let removed = Removed::of(store, whole, size).map_err(Problem::Read)?;
        store.cut(whole).map_err(Problem::Cut)?;
        tell(&removed);
    }
    let bytes = written(start, whole, lines);
    let taken = match append(store, &bytes) {
        Ok(taken) => taken,
        Err(source) => {
            let kept = restore(store, whole);
            return Err(Problem::Write { kept, source });
        }
    };
    if taken < bytes.len() {
        return Err(Problem::Short {
            written: taken,
            length: bytes.len(),
            kept: restore(store, whole),
        });
    }
    // A file server may say only now that there is no room.
    if syncing == Syncing::Each
        && let Err(source) = store.sync()
    {
        let kept = restore(store, whole);
        return Err(Problem::Sync { kept, source });
    }
    Ok(())
}

/// Removes what an earlier [`commit`] of these lines has left from `from` on, so that they can be
/// appended again and stand there once.
///
/// # Errors
/// [`Problem::Changed`] where something else is there now: what became of them is not known then.
pub fn undo(store: &mut dyn Store, start: &Start, lines: &[u8], from: u64) -> Result<(), Problem> {
    let size = store.size().map_err(Problem::Read)?;
    let expected = written(start, from, lines);
    let is_longer = size.saturating_sub(from) > expected.len() as u64;
    if size < from || is_longer {
        return Err(Problem::Changed);
    }
    let left = bytes(store, from, size).map_err(Problem::Read)?;
    if !expected.starts_with(&left) {
        return Err(Problem::Changed);
    }
    if left.is_empty() {
        return Ok(());
    }
    store.cut(from).map_err(Problem::Cut)
}

/// What is written for these lines behind so many bytes.
fn written(start: &Start, whole: u64, lines: &[u8]) -> Vec<u8> {
    let mut bytes = if whole == 0 { start.head() } else { Vec::new() };
    bytes.extend_from_slice(lines);
    if !bytes.ends_with(b"\n") {
        bytes.push(b'\n');
    }
    bytes
}

/// One write; one that a signal came before has taken nothing.
fn append(store: &mut dyn Store, bytes: &[u8]) -> io::Result<usize> {
    loop {
        match store.append(bytes) {
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            result => return result,
        }
    }
}

fn restore(store: &mut dyn Store, size: u64) -> Kept {
    match store.cut(size) {
        Ok(()) => Kept::Before,
        Err(_) => Kept::Unknown { from: size },
    }
}
