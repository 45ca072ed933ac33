//! JSON: one object with the settings and an array of units, each with its tries and what they come
//! to. Tries go out as they end; the object is whole when the test has ended.

use std::io::{self, Write};
use std::time::Duration;

use humantime::format_duration;
use jiff::Timestamp;
use serde::Serialize;

use super::{LoopbackSink, Subject, status};
use crate::output::json::{Exact, line};
use crate::output::rfc3339;
use crate::readings::loopback::{AnswerTime, LineEcho, Noticed, Summary, Times, Try};

/// How the test was set.
#[derive(Debug, Clone)]
pub struct Settings {
    /// The port.
    pub port: String,
    /// Bits a second.
    pub baud: u32,
    /// `none`, `even` or `odd`.
    pub parity: String,
    /// One or two.
    pub stop_bits: u8,
    /// How long an answer may take to begin.
    pub timeout: Duration,
    /// Least time from one request to the next.
    pub interval: Duration,
    /// How many tries a unit gets; `None` until stopped.
    pub count: Option<u64>,
}

#[derive(Serialize)]
struct SettingsObject<'a> {
    port: &'a str,
    baud: u32,
    parity: &'a str,
    stop_bits: u8,
    timeout: String,
    interval: String,
    count: Option<u64>,
}

#[derive(Serialize)]
struct SubjectObject<'a> {
    meter: Option<&'a str>,
    unit_id: u8,
}

#[derive(Serialize)]
struct TryObject {
    time: String,
    #[serde(rename = "try")]
    number: u64,
    word: String,
    status: String,
    answer_ms: Option<Exact<AnswerTime>>,
}

#[derive(Serialize)]
struct SummaryObject {
    tries: u64,
    answered: u64,
    refused: u64,
    lost: u64,
    min_ms: Option<Exact<AnswerTime>>,
    median_ms: Option<Exact<AnswerTime>>,
    p95_ms: Option<Exact<AnswerTime>>,
    max_ms: Option<Exact<AnswerTime>>,
    jitter_ms: Option<Exact<AnswerTime>>,
    damaged_answers: u64,
    noise_bytes: u64,
    late_answers: u64,
    other_frames: u64,
    echo: Option<bool>,
    verdict: &'static str,
    words: String,
}

/// One object.
pub struct Json<W: Write> {
    out: W,
    settings: Settings,
    /// Whether there is a unit before.
    begun: bool,
    /// Whether there is a try before.
    tried: bool,
}

impl<W: Write> Json<W> {
    /// Writes to `out`.
    pub const fn new(out: W, settings: Settings) -> Self {
        Self {
            out,
            settings,
            begun: false,
            tried: false,
        }
    }

    fn put(&mut self, text: &str) -> io::Result<()> {
        self.out.write_all(text.as_bytes())?;
        self.out.flush()
    }

    /// An object up to its closing brace, with an array begun in it.
    fn opening(object: &impl Serialize, array: &str) -> io::Result<String> {
        let mut text = line(object)?;
        text.pop();
        Ok(format!("{text},\"{array}\":["))
    }

    /// What stands before the first unit.
    fn head(&self) -> io::Result<String> {
        let settings = &self.settings;
        let object = SettingsObject {
            port: &settings.port,
            baud: settings.baud,
            parity: &settings.parity,
            stop_bits: settings.stop_bits,
            timeout: format_duration(settings.timeout).to_string(),
            interval: format_duration(settings.interval).to_string(),
            count: settings.count,
        };
        Self::opening(&object, "units")
    }
}

impl<W: Write> LoopbackSink for Json<W> {
    fn begin(&mut self, subject: Subject<'_>, _time: Timestamp) -> io::Result<()> {
        let before = if self.begun {
            ",".to_owned()
        } else {
            self.head()?
        };
        (self.begun, self.tried) = (true, false);
        let object = SubjectObject {
            meter: Some(subject.meter).filter(|meter| !meter.is_empty()),
            unit_id: subject.unit.get(),
        };
        let opening = Self::opening(&object, "tries")?;
        self.put(&format!("{before}\n{opening}"))
    }

    fn attempt(&mut self, _subject: Subject<'_>, attempt: &Try) -> io::Result<()> {
        let before = if self.tried { "," } else { "" };
        self.tried = true;
        let object = line(&TryObject {
            time: rfc3339(attempt.time),
            number: attempt.number,
            word: format!("0x{:04X}", attempt.word),
            status: status(attempt),
            answer_ms: attempt.result.as_ref().ok().copied().map(Exact),
        })?;
        self.put(&format!("{before}\n{object}"))
    }

    fn end(&mut self, summary: &Summary) -> io::Result<()> {
        let object = line(&object(summary))?;
        self.put(&format!("\n],\"summary\":{object}}}"))
    }

    fn finish(&mut self) -> io::Result<()> {
        let before = if self.begun {
            String::new()
        } else {
            self.head()?
        };
        self.put(&format!("{before}\n]}}\n"))
    }
}

fn object(summary: &Summary) -> SummaryObject {
    let Noticed {
        noise,
        late,
        others,
    } = summary.noticed;
    let time =
        |of: fn(&Times) -> Option<AnswerTime>| summary.times.as_ref().and_then(of).map(Exact);
    SummaryObject {
        tries: summary.tries,
        answered: summary.answered,
        refused: summary.failed.refused,
        lost: summary.lost(),
        min_ms: time(|times| Some(times.min)),
        median_ms: time(|times| Some(times.median)),
        p95_ms: time(|times| Some(times.p95)),
        max_ms: time(|times| Some(times.max)),
        jitter_ms: time(|times| times.jitter),
        damaged_answers: summary.failed.damaged,
        noise_bytes: noise,
        late_answers: late,
        other_frames: others,
        echo: match summary.echo {
            LineEcho::Present => Some(true),
            LineEcho::Absent => Some(false),
            LineEcho::Unknown => None,
        },
        verdict: summary.verdict().word(),
        words: summary.to_string(),
    }
}
