//! What is appended to: a file, or in tests anything that behaves as one.

use std::fs::File;
use std::io::{self, ErrorKind, Read, Seek, SeekFrom, Write};

/// An open file that nobody else appends to for the time being.
pub trait Store {
    /// How many bytes it holds.
    ///
    /// # Errors
    /// What the system says.
    fn size(&self) -> io::Result<u64>;

    /// Reads what is there from `offset` on, at most as much as fits; 0 at the end.
    ///
    /// # Errors
    /// What the system says.
    fn read_at(&mut self, offset: u64, buffer: &mut [u8]) -> io::Result<usize>;

    /// Writes behind the last byte, and returns how many bytes were taken.
    ///
    /// # Errors
    /// What the system says; nothing was taken then.
    fn append(&mut self, bytes: &[u8]) -> io::Result<usize>;

    /// Cuts it to so many bytes.
    ///
    /// # Errors
    /// What the system says.
    fn cut(&mut self, size: u64) -> io::Result<()>;

    /// Returns when what was written would survive a power cut.
    ///
    /// # Errors
    /// What the system says; what became of the bytes is not known.
    fn sync(&mut self) -> io::Result<()>;
}

/// A file that was opened for reading and appending.
impl Store for File {
    fn size(&self) -> io::Result<u64> {
        Ok(self.metadata()?.len())
    }

    fn read_at(&mut self, offset: u64, buffer: &mut [u8]) -> io::Result<usize> {
        self.seek(SeekFrom::Start(offset))?;
        self.read(buffer)
    }

    fn append(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.write(bytes)
    }

    fn cut(&mut self, size: u64) -> io::Result<()> {
        self.set_len(size)
    }

    fn sync(&mut self) -> io::Result<()> {
        self.sync_data()
    }
}

/// The bytes from `from` to `to`, or to the end where that comes first.
pub(super) fn bytes(store: &mut dyn Store, from: u64, to: u64) -> io::Result<Vec<u8>> {
    let length = usize::try_from(to.saturating_sub(from)).map_err(io::Error::other)?;
    let mut bytes = vec![0; length];
    let mut filled = 0;
    while let Some(rest) = bytes.get_mut(filled..).filter(|rest| !rest.is_empty()) {
        match store.read_at(from + filled as u64, rest) {
            Ok(0) => break,
            Ok(count) => filled += count,
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    bytes.truncate(filled);
    Ok(bytes)
}
