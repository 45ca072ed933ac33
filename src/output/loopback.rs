//! Loop-back tests, try by try, and what they come to.
//!
//! Every format is a [`LoopbackSink`]. Each try goes out in one write as soon as it has ended.

pub mod csv;
pub mod json;
pub mod table;

use std::io;

use jiff::Timestamp;

use crate::codec::Unit;
use crate::readings::Fault;
use crate::readings::loopback::{LineEcho, Summary, Try};
use crate::words::counted;

/// The unit under test.
#[derive(Debug, Clone, Copy)]
pub struct Subject<'a> {
    /// The meter's name; empty for an unknown one.
    pub meter: &'a str,
    /// Its unit.
    pub unit: Unit,
}

/// Takes the tries of one unit after the other, and prints them.
pub trait LoopbackSink {
    /// The tries of this unit come next; `time` is now.
    ///
    /// # Errors
    /// What the destination says.
    fn begin(&mut self, subject: Subject<'_>, time: Timestamp) -> io::Result<()>;

    /// Prints a try.
    ///
    /// # Errors
    /// What the destination says.
    fn attempt(&mut self, subject: Subject<'_>, attempt: &Try) -> io::Result<()>;

    /// Prints what they come to.
    ///
    /// # Errors
    /// What the destination says.
    fn end(&mut self, summary: &Summary) -> io::Result<()>;

    /// Prints what comes after the last unit.
    ///
    /// # Errors
    /// What the destination says.
    fn finish(&mut self) -> io::Result<()>;
}

/// `ok`, or what is missing as in readings.
fn status(attempt: &Try) -> String {
    let fault = attempt.result.as_ref().err().map(Fault::from);
    super::status(fault)
}

/// A summary in lines: how many, how long, what else, and the verdict.
pub fn lines(summary: &Summary) -> Vec<String> {
    let Summary {
        tries,
        answered,
        failed,
        times,
        noticed,
        echo,
    } = summary;
    let mut counts = counted(*tries, "try", "tries");
    counts = format!("{counts}, {answered} answered");
    if failed.refused > 0 {
        counts = format!("{counts}, {} refused", failed.refused);
    }
    let lost = summary.lost();
    let mut lines = vec![format!(
        "{counts}, {lost} lost ({} %)",
        percent(lost, *tries)
    )];
    if let Some(times) = times {
        let jitter = times.jitter.map(|jitter| format!(", jitter {jitter}"));
        lines.push(format!(
            "answer times: min {}, median {}, p95 {}, max {}{} ms",
            times.min,
            times.median,
            times.p95,
            times.max,
            jitter.unwrap_or_default()
        ));
    }
    let echo = match echo {
        LineEcho::Present => "yes",
        LineEcho::Absent => "no",
        LineEcho::Unknown => "not known",
    };
    lines.push(format!(
        "damaged answers: {}, noise bytes: {}, late answers: {}, frames of others: {}, echo: {echo}",
        failed.damaged, noticed.noise, noticed.late, noticed.others
    ));
    lines.push(summary.to_string());
    lines
}

/// With one decimal; 0.0 is none, and 100.0 is all.
fn percent(part: u64, whole: u64) -> String {
    let (part, whole) = (u128::from(part), u128::from(whole.max(1)));
    let rounded = (part * 2000 + whole) / (whole * 2);
    let tenths = match part {
        0 => 0,
        _ if part == whole => 1000,
        _ => rounded.clamp(1, 999),
    };
    format!("{}.{}", tenths / 10, tenths % 10)
}
