//! Takes numbers out of bytes, one after the other.

/// The bytes that are left. Where they end, all numbers are 0.
#[derive(Debug, Clone)]
pub(crate) struct Cursor {
    bytes: Vec<u8>,
    at: usize,
}

impl Cursor {
    pub(crate) fn new(bytes: &[u8]) -> Self {
        Self {
            bytes: bytes.to_vec(),
            at: 0,
        }
    }

    pub(crate) fn is_over(&self) -> bool {
        self.at >= self.bytes.len()
    }

    pub(crate) fn byte(&mut self) -> u8 {
        let byte = self.bytes.get(self.at).copied().unwrap_or_default();
        self.at += 1;
        byte
    }

    pub(crate) fn word(&mut self) -> u16 {
        u16::from_be_bytes([self.byte(), self.byte()])
    }

    /// A number below `limit`, at most 65536.
    pub(crate) fn below(&mut self, limit: usize) -> usize {
        if limit <= 256 {
            usize::from(self.byte()) % limit
        } else {
            usize::from(self.word()) % limit
        }
    }

    pub(crate) fn chance(&mut self) -> bool {
        self.byte() % 2 == 1
    }

    pub(crate) fn pick<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len())]
    }

    /// So many bytes, or what is left.
    pub(crate) fn take(&mut self, count: usize) -> Vec<u8> {
        let start = self.at.min(self.bytes.len());
        let end = (start + count).min(self.bytes.len());
        self.at = end;
        self.bytes[start..end].to_vec()
    }

    /// All that is left.
    pub(crate) fn rest(&mut self) -> Vec<u8> {
        self.take(usize::MAX - self.bytes.len())
    }
}
