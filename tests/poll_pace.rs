//! `poll` keeps its pace with a slow meter, and lets one that is off cost the others little.

#![cfg(unix)]

mod support {
    pub(crate) mod counting;
    pub(crate) mod folder;
    pub(crate) mod program;
    pub(crate) mod pty;
    pub(crate) mod waiting;
}

use std::io::Read;
use std::process::Stdio;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use jiff::Timestamp;

use support::counting::{counting_within, poll};
use support::folder::Folder;
use support::program::{Program, kill, without_times};
use support::pty::{PtyMeter, answer};
use support::waiting::wait_until;

#[test]
fn the_time_that_a_meter_takes_does_not_add_up() {
    const INTERVAL: i64 = 400;
    let folder = Folder::new("poll_pace");
    let meter = counting_within(Duration::from_millis(50));
    let mut command = poll(&meter, "--every 400ms -q -o rows.csv")
        .folder(folder.path())
        .command();
    let mut child = command.stderr(Stdio::null()).spawn().unwrap();
    wait_until(|| folder.names() == ["rows.csv"] && folder.read("rows.csv").lines().count() > 6);
    kill(&child, "TERM");
    child.wait().unwrap();
    let text = folder.read("rows.csv");
    // How far behind its slot each row is. On a machine that is busy some are late by more; of
    // three, the middle one tells.
    let behind = text.lines().skip(1).map(|row| {
        let time: Timestamp = row.split(',').next().unwrap().parse().unwrap();
        time.as_millisecond().rem_euclid(INTERVAL)
    });
    let behind: Vec<i64> = behind.collect();
    let middle = |rows: &[i64]| {
        let mut rows = rows.to_vec();
        rows.sort_unstable();
        rows[1]
    };
    // A pause of one interval after each answer adds 50 ms three times.
    let drift = middle(&behind[3..6]) - middle(&behind[..3]);
    assert!(drift < 100, "{behind:?}");
}

#[test]
fn one_of_five_that_is_off_has_its_rows_and_so_have_the_others() {
    let folder = Folder::new("poll_one_of_five");
    let is_off = Arc::new(AtomicBool::new(true));
    let switch = Arc::clone(&is_off);
    let meter = PtyMeter::new(Box::new(move |request| {
        let first = if switch.load(Ordering::SeqCst) { 2 } else { 1 };
        let answer = (first..=5).find_map(|unit| answer(unit, request));
        answer.unwrap_or_default()
    }));
    let port = meter.path();
    let mut command = Program::new("poll -a 1-5 0x0005 --every 200ms -t 500ms --retries 0")
        .arguments(&format!("-b 115200 -p {port} -o rows.csv"))
        .folder(folder.path())
        .command();
    let mut child = command.stderr(Stdio::piped()).spawn().unwrap();
    let rows_of = |unit: &str| -> Vec<String> {
        let text = std::fs::read_to_string(folder.file("rows.csv")).unwrap_or_default();
        let rows = without_times(&text);
        let rows = rows
            .lines()
            .filter(|row| row.split(',').nth(2) == Some(unit));
        rows.map(str::to_owned).collect()
    };
    wait_until(|| rows_of("1").len() > 1);
    is_off.store(false, Ordering::SeqCst);
    wait_until(|| rows_of("1").contains(&"<time>,,1,ok,38".to_owned()));
    kill(&child, "TERM");
    let mut told = String::new();
    child
        .stderr
        .take()
        .unwrap()
        .read_to_string(&mut told)
        .unwrap();
    child.wait().unwrap();

    let mut first = rows_of("1");
    let missing = first
        .iter()
        .filter(|row| *row == "<time>,,1,timeout,")
        .count();
    first.dedup();
    assert_eq!(first, ["<time>,,1,timeout,", "<time>,,1,ok,38"]);
    for unit in ["2", "3", "4", "5"] {
        let rows = rows_of(unit);
        // Whoever is stopped in the middle of a slot has asked some of them.
        assert!(rows.len() >= missing, "{rows:?} beside {missing}");
        let expected = format!("<time>,,{unit},ok,38");
        assert!(rows.iter().all(|row| *row == expected), "{rows:?}");
    }
    // Once when it begins, and once when it is over; slots are missed as well.
    let told = without_times(&told);
    let told = told.lines().filter(|line| !line.contains("not begun"));
    let told: Vec<&str> = told.filter(|line| !line.starts_with("hint: ")).collect();
    let place = format!("unit 1 on {port} at 115200 8N1");
    assert_eq!(
        told,
        [
            format!("error: {place}, registers 0x0005+1: no answer within 500ms"),
            format!("{place}: all is there again; {missing} rows lacked some since <time>"),
        ]
    );
}
