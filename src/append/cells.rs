//! CSV as far as one has to know it to append to it: where cells end, and whether a quote is open.
//!
//! It is taken as RFC 4180 has it, and what that leaves open as most readers take it: a quote is
//! one at the beginning of a cell only.

/// Where in a cell one is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) enum Place {
    /// At its beginning.
    #[default]
    Start,
    /// In text without quotes, or behind them.
    Plain,
    /// Between quotes.
    Quoted,
    /// Behind a quote that ends the cell, or is the first of two that stand for one.
    Quote,
}

impl Place {
    /// Where one is behind this byte.
    pub(super) const fn behind(self, byte: u8) -> Self {
        match (self, byte) {
            (Self::Quoted, b'"') => Self::Quote,
            (Self::Start | Self::Quote, b'"') | (Self::Quoted, _) => Self::Quoted,
            (_, b',' | b'\n' | b'\r') => Self::Start,
            _ => Self::Plain,
        }
    }
}

/// The cells of a line; `None` when a quote in it is not closed.
pub(super) fn cells(line: &[u8]) -> Option<Vec<Vec<u8>>> {
    let mut cells = Vec::new();
    let mut cell = Vec::new();
    let mut place = Place::Start;
    for byte in line.iter().copied() {
        let next = place.behind(byte);
        match (place, next) {
            (_, Place::Start) if byte == b',' => cells.push(std::mem::take(&mut cell)),
            // The quotes around a cell; the second of two in it is kept.
            (Place::Start, Place::Quoted) | (Place::Quoted, Place::Quote) => {}
            _ => cell.push(byte),
        }
        place = next;
    }
    cells.push(cell);
    (place != Place::Quoted).then_some(cells)
}
