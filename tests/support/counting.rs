//! A meter that counts what it is asked, and rows in which that can be seen: one that is lost,
//! doubled or made up shows in the numbers.

#![allow(dead_code, reason = "each test file uses its share")]

use std::thread;
use std::time::Duration;

use super::program::{Program, without_times};
use super::pty::{PtyMeter, answer_with};

/// What a file of such rows begins with.
pub(crate) const HEADER: &str = "time,meter,unit_id,status,0x0000\n";

/// Unit 1; its register 0 holds how many requests came, this one included.
pub(crate) fn counting() -> PtyMeter {
    counting_within(Duration::ZERO)
}

/// The same for a meter that takes so long before it answers.
pub(crate) fn counting_within(takes: Duration) -> PtyMeter {
    let mut count = 0;
    PtyMeter::new(Box::new(move |request| {
        count += 1;
        thread::sleep(takes);
        answer_with(1, request, |address| (address == 0).then_some(count)).unwrap_or_default()
    }))
}

/// A poll of it. Nothing is asked for twice: no machine is that slow.
pub(crate) fn poll(meter: &PtyMeter, more: &str) -> Program {
    let path = meter.path();
    Program::new(&format!(
        "poll -p {path} -b 115200 -a 1 0x0000 -t 30s {more}"
    ))
}

/// What the meter had counted in each row, of which each is whole, under one header.
#[track_caller]
pub(crate) fn counts(text: &str) -> Vec<u16> {
    let plain = without_times(text);
    let rows = plain.strip_prefix(HEADER).expect("the header");
    assert!(text.ends_with('\n'), "{text}");
    let counts = rows.lines().map(|row| {
        let count = row.strip_prefix("<time>,,1,ok,");
        let count = count.unwrap_or_else(|| panic!("{row}"));
        count.parse().unwrap_or_else(|_| panic!("{row}"))
    });
    counts.collect()
}

/// Whether each is the one before and one more.
pub(crate) fn are_without_gap(counts: &[u16]) -> bool {
    counts.windows(2).all(|pair| pair[1] == pair[0] + 1)
}
