//! What the program does on a line that lies: functions that alternate, busy meters, gateways, and
//! what `-v` tells of it in the end.

#![cfg(unix)]

mod support {
    pub(crate) mod program;
    pub(crate) mod pty;
}

use std::sync::atomic::{AtomicUsize, Ordering};

use meterpoll::codec::rtu;
use support::program::{Program, without_times};
use support::pty::{PtyMeter, answer};

/// A meter with functions 03 and 04 in one.
const METER: &str = r#"
name = "both"
title = "Both"
manual = "none"

[limits]
functions = [3, 4]
interchangeable_reads = true
longest_answer = "150ms"

[[points]]
name = "first"
address = 0x0010
type = "u16"

[[points]]
name = "second"
address = 0x0200
type = "u16"
"#;

/// A folder of the test's own with the profile in it.
struct Folder(std::path::PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("meterpoll-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&path).expect("a folder");
        std::fs::write(path.join("both.toml"), METER).expect("a file");
        Self(path)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// A meter that meets its first requests with silence.
fn silent_at_first(requests: usize) -> PtyMeter {
    let seen = AtomicUsize::new(0);
    PtyMeter::new(Box::new(move |request| {
        let number = seen.fetch_add(1, Ordering::Relaxed);
        let is_answered = number >= requests;
        is_answered
            .then(|| answer(1, request))
            .flatten()
            .unwrap_or_default()
    }))
}

/// The functions of all requests.
fn functions(meter: &PtyMeter) -> Vec<u8> {
    meter.requests().iter().map(|request| request[1]).collect()
}

fn exception(request: &[u8], code: u8) -> Vec<u8> {
    let body = [request[0], request[1] | 0x80, code];
    [&body[..], &rtu::check(&body)].concat()
}

#[test]
fn what_one_unit_owes_does_not_change_the_function_for_another() {
    let folder = Folder::new("alternates");
    let meter = silent_at_first(3);
    let output = Program::new(&format!("read-registers -p {} -a 2,1", meter.path()))
        .arguments("--meter both.toml first -f csv -q --retries 2")
        .folder(&folder.0)
        .output();
    // Unit 2 is not there; the other one owes nothing, so it is asked as ever.
    let stdout = String::from_utf8(output.stdout).expect("CSV is text");
    let expected =
        "time,meter,unit_id,status,first\n<time>,both,2,timeout,\n<time>,both,1,ok,115\n";
    assert_eq!(without_times(&stdout), expected);
    assert_eq!(functions(&meter), [3, 3, 3, 3]);
}

#[test]
fn a_unit_that_has_missed_one_read_is_asked_for_the_next_with_the_other_function() {
    let folder = Folder::new("missed");
    let seen = AtomicUsize::new(0);
    let meter = PtyMeter::new(Box::new(move |request| {
        // The first read is answered, so the unit is alive; then there is silence for one attempt.
        match seen.fetch_add(1, Ordering::Relaxed) {
            1 => Vec::new(),
            _ => answer(1, request).unwrap_or_default(),
        }
    }));
    let run = |function: &str| {
        Program::new(&format!("read-registers -p {} -a 1", meter.path()))
            .arguments("--meter both.toml first 0x0100 second -f csv -q --retries 0")
            .arguments(function)
            .folder(&folder.0)
            .output()
    };
    let output = run("");
    let stdout = String::from_utf8(output.stdout).expect("CSV is text");
    let expected = "time,meter,unit_id,status,first,0x0100,second\n\
                    <time>,both,1,timeout,115,,3587\n";
    assert_eq!(without_times(&stdout), expected);
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(functions(&meter), [3, 3, 4]);
}

#[test]
fn a_function_that_was_typed_is_kept_after_a_fault() {
    let folder = Folder::new("typed");
    let seen = AtomicUsize::new(0);
    let meter = PtyMeter::new(Box::new(move |request| {
        match seen.fetch_add(1, Ordering::Relaxed) {
            1 => Vec::new(),
            _ => answer(1, request).unwrap_or_default(),
        }
    }));
    let output = Program::new(&format!("read-registers -p {} -a 1", meter.path()))
        .arguments("--meter both.toml first 0x0100 second -f csv -q --retries 0 --function 4")
        .folder(&folder.0)
        .output();
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(functions(&meter), [4, 4, 4]);
}

#[test]
fn a_busy_meter_is_waited_for_and_the_waiting_is_told() {
    let seen = AtomicUsize::new(0);
    let meter = PtyMeter::new(Box::new(move |request| {
        match seen.fetch_add(1, Ordering::Relaxed) {
            0 | 1 => exception(request, 6),
            _ => answer(1, request).unwrap_or_default(),
        }
    }));
    let output = Program::new(&format!(
        "read-registers -p {} -a 1 0x10 -f csv -v --retries 0",
        meter.path()
    ))
    .output();
    let stdout = String::from_utf8(output.stdout).expect("CSV is text");
    let expected = "time,meter,unit_id,status,0x0010\n<time>,,1,ok,115\n";
    assert_eq!(without_times(&stdout), expected);
    let stderr = String::from_utf8(output.stderr).expect("text");
    for line in [
        "unit 1: busy, asking again in 100 ms\n",
        "unit 1: busy, asking again in 200 ms\n",
        "unit 1: 3 requests, 3 answers, 2 times busy\n",
    ] {
        assert!(stderr.contains(line), "{stderr}");
    }
}

#[test]
fn a_meter_that_stays_busy_is_there_and_says_so() {
    let meter = PtyMeter::new(Box::new(|request| exception(request, 6)));
    Program::new(&format!(
        "read-registers -p {} -a 1 0x10 -f csv -t 50ms",
        meter.path()
    ))
    .stdout("time,meter,unit_id,status,0x0010\n<time>,,1,exception:6,\n")
    .stderr(format!(
        "error: unit 1 on {} at 9600 8N1, registers 0x0010+1: the meter refused: exception 06 \
         (SERVER DEVICE BUSY)\n\
         hint: the meter is there but busy, perhaps somebody is at its keys: ask again later\n",
        meter.path()
    ))
    .code(5)
    .run();
    assert_eq!(meter.requests().len(), 4);
}

#[test]
fn a_gateway_without_its_unit_is_asked_as_often_as_a_silent_unit() {
    let meter = PtyMeter::new(Box::new(|request| exception(request, 0x0B)));
    Program::new(&format!(
        "read-registers -p {} -a 1 0x10 -f csv -t 50ms",
        meter.path()
    ))
    .stdout("time,meter,unit_id,status,0x0010\n<time>,,1,exception:11,\n")
    .stderr(format!(
        "error: unit 1 on {} at 9600 8N1, registers 0x0010+1: the meter refused: exception 0B \
         (GATEWAY TARGET DEVICE FAILED TO RESPOND), 3 attempts\n\
         hint: a gateway on the way got no answer from the unit: check --unit, then power and \
         wiring behind the gateway\n",
        meter.path()
    ))
    .code(5)
    .run();
    assert_eq!(meter.requests().len(), 3);
}
