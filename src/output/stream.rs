//! Rows in lines to anything that takes bytes, one write a row.

use std::io::{self, Write};

use super::{LineFormat, Sink};
use crate::profile::Point;
use crate::readings::Row;

/// Prints rows in lines, with what comes before the first.
pub struct Stream<W: Write, F: LineFormat> {
    out: W,
    format: F,
    begun: bool,
}

impl<W: Write, F: LineFormat> Stream<W, F> {
    /// Writes to `out`.
    pub const fn new(out: W, format: F) -> Self {
        Self {
            out,
            format,
            begun: false,
        }
    }
}

impl<W: Write, F: LineFormat> Sink for Stream<W, F> {
    fn row(&mut self, points: &[Point], row: &Row) -> io::Result<()> {
        let mut bytes = Vec::new();
        if !self.begun {
            bytes = self.format.start(points)?.head();
            self.begun = true;
        }
        bytes.extend(self.format.lines(points, row)?);
        self.out.write_all(&bytes)?;
        self.out.flush()
    }

    fn finish(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}
