//! For people: a line a try, and lines for what they come to.

use std::io::{self, Write};

use jiff::Timestamp;

use super::{LoopbackSink, Subject, lines};
use crate::output::escape;
use crate::output::table::{Heading, title};
use crate::readings::loopback::{Summary, Try};

/// Lines for people, a block a unit.
pub struct Table<W: Write> {
    out: W,
    heading: Heading,
    begun: bool,
}

impl<W: Write> Table<W> {
    /// Writes to `out`.
    pub const fn new(out: W, heading: Heading) -> Self {
        Self {
            out,
            heading,
            begun: false,
        }
    }

    fn put(&mut self, text: &str) -> io::Result<()> {
        self.out.write_all(text.as_bytes())?;
        self.out.flush()
    }
}

impl<W: Write> LoopbackSink for Table<W> {
    fn begin(&mut self, subject: Subject<'_>, time: Timestamp) -> io::Result<()> {
        let between = if self.begun { "\n" } else { "" };
        self.begun = true;
        let heading = match &self.heading {
            Heading::Full { line } => title(subject.meter, subject.unit, line, time),
            Heading::Unit => format!("unit {}\n", subject.unit),
            Heading::None => String::new(),
        };
        self.put(&format!("{between}{heading}"))
    }

    fn attempt(&mut self, _subject: Subject<'_>, attempt: &Try) -> io::Result<()> {
        let Try { number, word, .. } = attempt;
        let outcome = match &attempt.result {
            Ok(time) => format!("0x{word:04X} back after {time} ms"),
            Err(failure) => escape(&failure.to_string()),
        };
        self.put(&format!("{number}: {outcome}\n"))
    }

    fn end(&mut self, summary: &Summary) -> io::Result<()> {
        self.put(&format!("\n{}\n", lines(summary).join("\n")))
    }

    fn finish(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}
