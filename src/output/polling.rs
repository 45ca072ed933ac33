//! A poll for people: the live table while it goes on, and what it came to.

use std::time::Duration;

use jiff::{SignedDuration, Timestamp};

use super::columns::columns;
use super::{escape, status};
use crate::polling::{Counts, Cycle, Every, Site, Tally};
use crate::profile::Value;

/// What is shown of a poll while it goes on: a line a set of points.
#[derive(Debug)]
pub struct Board(Vec<Entry>);

/// One line of it.
#[derive(Debug)]
struct Entry {
    name: String,
    points: Vec<(String, String)>,
    every: Option<Every>,
    /// When values were last read, and which.
    last: Option<(Timestamp, Vec<Option<Value>>)>,
    status: String,
    answer_time: Option<Duration>,
    rows: u64,
    lacking: u64,
    missed: u64,
}

impl Board {
    /// Nothing of a site has been read yet.
    pub fn new(site: &Site) -> Self {
        let entries = site.jobs.iter().map(|job| Entry {
            name: escape(&job.subject.to_string()),
            points: job
                .points
                .iter()
                .map(|point| {
                    let unit = point.unit.as_deref().map(escape);
                    (escape(&point.name), unit.unwrap_or_default())
                })
                .collect(),
            every: job.every,
            last: None,
            status: "-".to_owned(),
            answer_time: None,
            rows: 0,
            lacking: 0,
            missed: 0,
        });
        Self(entries.collect())
    }

    /// One more row.
    pub fn heed(&mut self, cycle: &Cycle) {
        let Some(entry) = self.0.get_mut(cycle.job) else {
            return;
        };
        let worst = cycle.row.worst();
        entry.status = status(worst);
        entry.rows += 1;
        entry.lacking += u64::from(worst.is_some());
        entry.missed = entry.missed.saturating_add(cycle.slot.missed);
        entry.answer_time = cycle.answer_time.or(entry.answer_time);
        if cycle.row.readings.iter().any(Result::is_ok) {
            let values = cycle.row.readings.iter().cloned();
            entry.last = Some((cycle.row.time, values.map(Result::ok).collect()));
        }
    }

    /// The table as it is now, in lines of at most `width` characters, and at most so many of them:
    /// what does not fit is counted in the last.
    pub fn lines(&self, now: Timestamp, width: usize, most: usize) -> Vec<String> {
        let header = [
            "METER", "STATUS", "AGE", "ANSWER", "ROWS", "LACKING", "MISSED", "NEXT", "VALUES",
        ];
        let rows = self.0.iter().map(|entry| entry.cells(now));
        let text = columns(&header, &[2, 3, 4, 5, 6], rows);
        let mut lines: Vec<String> = text
            .lines()
            .map(|line| line.chars().take(width).collect())
            .collect();
        let over = lines.len().saturating_sub(most.max(2));
        if over > 0 {
            lines.truncate(lines.len() - over - 1);
            lines.push(format!("and {} more", over + 1));
        }
        lines
    }
}

impl Entry {
    fn cells(&self, now: Timestamp) -> Vec<String> {
        let none = || "-".to_owned();
        let age = self.last.as_ref().map(|(time, _)| age(now, *time));
        vec![
            self.name.clone(),
            self.status.clone(),
            age.unwrap_or_else(none),
            self.answer_time.map_or_else(none, milliseconds),
            self.rows.to_string(),
            self.lacking.to_string(),
            self.missed.to_string(),
            self.every.map_or_else(none, |every| next(now, every)),
            self.values(),
        ]
    }

    /// The last values, those that are there.
    fn values(&self) -> String {
        let Some((_, values)) = &self.last else {
            return String::new();
        };
        let shown = self.points.iter().zip(values);
        let shown = shown.filter_map(|((name, unit), value)| {
            let value = escape(&value.as_ref()?.to_string());
            let space = if unit.is_empty() { "" } else { " " };
            Some(format!("{name} {value}{space}{unit}"))
        });
        shown.collect::<Vec<_>>().join(", ")
    }
}

/// `0 s`, `90 s`, `3 h`; a clock that was set back makes nothing younger than now.
fn age(now: Timestamp, then: Timestamp) -> String {
    let age = now.duration_since(then).max(SignedDuration::ZERO);
    match age.as_secs() {
        seconds @ 0..600 => format!("{seconds} s"),
        seconds @ 600..36_000 => format!("{} min", seconds / 60),
        seconds => format!("{} h", seconds / 3600),
    }
}

/// The time of the next slot.
fn next(now: Timestamp, every: Every) -> String {
    let every = i128::try_from(every.get().as_nanos()).unwrap_or(i128::MAX);
    let next = now
        .as_nanosecond()
        .checked_div_euclid(every)
        .and_then(|slots| slots.checked_add(1)?.checked_mul(every));
    let next = next.and_then(|next| Timestamp::from_nanosecond(next).ok());
    next.map_or_else(
        || "-".to_owned(),
        |next| next.strftime("%H:%M:%S").to_string(),
    )
}

/// What a poll came to: a line a set of points.
pub fn summary(site: &Site, tally: &Tally) -> String {
    let rows = site.jobs.iter().enumerate().map(|(index, job)| {
        let Counts {
            rows,
            complete,
            lacking,
            missed,
            latest,
            took,
            answer_time,
            ..
        } = tally.of(index);
        let mean = tally.of(index).mean();
        let causes: Vec<String> = lacking
            .iter()
            .map(|(status, count)| format!("{status} {count}"))
            .collect();
        let ms = |time: Option<Duration>| time.map_or_else(|| "-".to_owned(), milliseconds);
        vec![
            escape(&job.subject.to_string()),
            rows.to_string(),
            complete.to_string(),
            missed.to_string(),
            milliseconds(latest),
            ms(answer_time),
            ms(mean),
            ms(mean.map(|_| took.1)),
            causes.join(", "),
        ]
    });
    let header = [
        "METER", "ROWS", "COMPLETE", "MISSED", "LATEST", "ANSWER", "MEAN", "LONGEST", "LACKING",
    ];
    let table = columns(&header, &[1, 2, 3, 4, 5, 6, 7], rows);
    format!("{table}\nmissed: slots; times in ms\n")
}

fn milliseconds(time: Duration) -> String {
    format!("{:.1}", time.as_secs_f64() * 1000.0)
}
