//! CSV: a row a try. What they come to is for people, and goes elsewhere.

use std::io::{self, Write};

use jiff::Timestamp;

use super::{LoopbackSink, Subject, status};
use crate::output::csv::records;
use crate::output::rfc3339;
use crate::readings::loopback::{Summary, Try};

const HEADER: [&str; 7] = [
    "time",
    "meter",
    "unit_id",
    "try",
    "word",
    "status",
    "answer_ms",
];

/// `time,meter,unit_id,try,word,status,answer_ms`.
pub struct Csv<W: Write> {
    out: W,
    headed: bool,
}

impl<W: Write> Csv<W> {
    /// Writes to `out`.
    pub const fn new(out: W) -> Self {
        Self { out, headed: false }
    }

    fn put(&mut self, cells: &[&str]) -> io::Result<()> {
        self.out.write_all(&records(cells, [])?)?;
        self.out.flush()
    }
}

impl<W: Write> LoopbackSink for Csv<W> {
    fn begin(&mut self, _subject: Subject<'_>, _time: Timestamp) -> io::Result<()> {
        if self.headed {
            return Ok(());
        }
        self.headed = true;
        self.put(&HEADER)
    }

    fn attempt(&mut self, subject: Subject<'_>, attempt: &Try) -> io::Result<()> {
        let answer = attempt.result.as_ref().map(ToString::to_string);
        self.put(&[
            &rfc3339(attempt.time),
            subject.meter,
            &subject.unit.to_string(),
            &attempt.number.to_string(),
            &format!("0x{:04X}", attempt.word),
            &status(attempt),
            &answer.unwrap_or_default(),
        ])
    }

    fn end(&mut self, _summary: &Summary) -> io::Result<()> {
        Ok(())
    }

    fn finish(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}
