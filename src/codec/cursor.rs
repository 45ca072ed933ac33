//! The one place where bytes are sliced: a bounds-checked reader.

use super::error::DecodeError;

/// The byte at `index`, if there is one.
pub(crate) fn byte(bytes: &[u8], index: usize) -> Option<u8> {
    bytes.get(index).copied()
}

/// The bytes without the last two, and those two; `None` when there are fewer than two.
pub(crate) fn split_check(bytes: &[u8]) -> Option<(&[u8], [u8; 2])> {
    bytes
        .split_last_chunk::<2>()
        .map(|(body, check)| (body, *check))
}

/// `length` bytes from `start`, or `None` when they are not all there.
pub(crate) fn window(bytes: &[u8], start: usize, length: usize) -> Option<&[u8]> {
    bytes.get(start..start.checked_add(length)?)
}

/// Reads fields front to back; every read names its field for the error.
pub(crate) struct Cursor<'a> {
    rest: &'a [u8],
}

impl<'a> Cursor<'a> {
    pub(crate) const fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes }
    }

    pub(crate) fn u8(&mut self, field: &'static str) -> Result<u8, DecodeError> {
        let (first, rest) = self
            .rest
            .split_first()
            .ok_or(DecodeError::Truncated { field })?;
        self.rest = rest;
        Ok(*first)
    }

    /// A 16-bit field, high byte first.
    pub(crate) fn u16(&mut self, field: &'static str) -> Result<u16, DecodeError> {
        let (pair, rest) = self
            .rest
            .split_first_chunk::<2>()
            .ok_or(DecodeError::Truncated { field })?;
        self.rest = rest;
        Ok(u16::from_be_bytes(*pair))
    }

    /// Bytes not read yet.
    pub(crate) const fn remaining(&self) -> usize {
        self.rest.len()
    }

    /// Everything has been read: anything left is an error.
    pub(crate) const fn finish(self) -> Result<(), DecodeError> {
        if self.rest.is_empty() {
            Ok(())
        } else {
            Err(DecodeError::Trailing {
                extra: self.rest.len(),
            })
        }
    }
}
