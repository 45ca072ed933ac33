//! A signal while something is being written: what was sent is told, and nothing is waited for that
//! need not be.

#![cfg(unix)]

mod support {
    pub(crate) mod program;
    pub(crate) mod pty;
    pub(crate) mod run;
    pub(crate) mod waiting;
    pub(crate) mod writable;
}

use std::time::{Duration, Instant};

use support::pty::PtyMeter;
use support::run::{End, Run};
use support::waiting::wait_until;
use support::writable::{meter, obey, writes};

/// The time-out of every run: nobody waits for it.
const TIMEOUT: Duration = Duration::from_secs(120);

/// Starts a command on a meter.
fn start(meter: &PtyMeter, command: &str) -> Run {
    let (name, arguments) = command.split_once(' ').expect("a command and arguments");
    let path = meter.path();
    Run::start(&format!(
        "{name} -p {path} -b 115200 --timeout 120s {arguments}"
    ))
}

/// Sends a signal once so many writes were heard, and waits for the end.
fn stopped(meter: &PtyMeter, run: Run, heard: usize, signal: &str) -> End {
    wait_until(|| writes(meter).len() == heard);
    let start = Instant::now();
    run.signal(signal);
    let end = run.end();
    assert!(start.elapsed() < TIMEOUT / 2, "{end:?}");
    End {
        stdout: end.stdout.replace(meter.path(), "PORT"),
        stderr: end.stderr.replace(meter.path(), "PORT"),
        ..end
    }
}

#[test]
fn a_write_that_is_not_answered_yet_ends_as_unknown() {
    for signal in ["INT", "TERM", "HUP"] {
        let meter = meter(&[(0x10, 1)], |_, _| Vec::new());
        let run = start(&meter, "write-setpoint -a 17 0x0010=500 0x0020=600");
        let end = stopped(&meter, run, 1, signal);
        assert_eq!((end.code, end.signal), (Some(6), None), "{end:?}");
        let lines: Vec<&str> = end.stderr.lines().collect();
        let begin = "error: unit 17 on PORT at 115200 8N1, 0x0010: outcome unknown, it may be \
                     written or not: no answer before the program was stopped";
        assert!(lines[0].starts_with(begin), "{end:?}");
        assert_eq!(
            lines[2],
            "error: unit 17 on PORT at 115200 8N1, 0x0020: not written: something before it was not"
        );
        assert_eq!(writes(&meter), ["11 06 00 10 01 F4"]);
    }
}

#[test]
fn a_second_signal_changes_nothing() {
    let meter = meter(&[(0x10, 1)], |_, _| Vec::new());
    let run = start(&meter, "write-setpoint -a 17 0x0010=500");
    wait_until(|| writes(&meter).len() == 1);
    run.signal("INT");
    let end = stopped(&meter, run, 1, "INT");
    assert_eq!((end.code, end.signal), (Some(6), None), "{end:?}");
}

#[test]
fn an_operation_that_is_not_answered_yet_ends_as_unknown() {
    let meter = meter(&[(0, 65)], |_, _| Vec::new());
    let run = start(
        &meter,
        "execute-operation -a 17,18 --meter pqm --yes clear_energy",
    );
    let end = stopped(&meter, run, 1, "INT");
    assert_eq!((end.code, end.signal), (Some(6), None), "{end:?}");
    assert!(
        end.stderr.ends_with("error: 1 more unit was not tried\n"),
        "{end:?}"
    );
    assert_eq!(writes(&meter), ["11 05 00 0E FF 00"]);
}

#[test]
fn what_is_answered_in_time_is_done_and_the_rest_is_not_sent() {
    // The answer waits for the signal, which is sent once the write was heard.
    let (asked, go) = std::sync::mpsc::channel::<()>();
    let meter = meter(&[(0x10, 1), (0x20, 2)], move |frame, registers| {
        let _ = go.recv();
        obey(frame, registers)
    });
    let run = start(&meter, "write-setpoint -a 17 0x0010=500 0x0020=600");
    wait_until(|| writes(&meter).len() == 1);
    run.signal("INT");
    asked.send(()).expect("the meter waits");
    let end = stopped(&meter, run, 1, "INT");
    // Half a second may be over on a machine that is held up.
    if end.code == Some(6) {
        return;
    }
    assert_eq!(end.signal, Some(2), "{end:?}");
    assert!(end.stdout.ends_with("0x0010: 500, written\n"), "{end:?}");
    assert_eq!(
        end.stderr,
        "error: unit 17 on PORT at 115200 8N1, 0x0020: not sent: the program was stopped\n"
    );
    assert_eq!(writes(&meter), ["11 06 00 10 01 F4"]);
}

#[test]
fn a_point_that_is_half_written_is_told_as_such() {
    let (asked, go) = std::sync::mpsc::channel::<()>();
    let held: Vec<(u16, u16)> = (0x1100..0x1140).map(|address| (address, 1)).collect();
    let meter = meter(&held, move |frame, registers| {
        let _ = go.recv();
        obey(frame, registers)
    });
    let run = start(
        &meter,
        "write-setpoint -a 17 --meter em24 --yes ct_ratio=40.0",
    );
    wait_until(|| writes(&meter).len() == 1);
    run.signal("INT");
    asked.send(()).expect("the meter waits");
    let end = stopped(&meter, run, 1, "INT");
    assert_eq!((end.code, end.signal), (Some(6), None), "{end:?}");
    assert_eq!(writes(&meter), ["11 06 11 2C 01 90"]);
    // Half a second may be over on a machine that is held up.
    if end.stderr.contains("outcome unknown") {
        return;
    }
    assert_eq!(
        end.stderr,
        "warning: ct_ratio goes in 2 requests, low word first, for function 6 writes one register at a \
         time: in between the meter holds half of it\n\
         error: unit 17 on PORT at 115200 8N1, ct_ratio: half of its registers are written, and \
         then:\n\
         error: unit 17 on PORT at 115200 8N1, ct_ratio: not sent: the program was stopped\n\
         hint: `meterpoll read-registers -p PORT -b 115200 -a 17 --meter em24 ct_ratio` shows what \
         the meter holds now\n"
    );
}

#[test]
fn a_signal_before_anything_is_written_ends_the_program_as_ever() {
    for (signal, number) in [("INT", 2), ("TERM", 15)] {
        let meter = PtyMeter::new(Box::new(|_| Vec::new()));
        let run = start(&meter, "write-setpoint -a 17 0x0010=500");
        wait_until(|| meter.requests().len() == 1);
        run.signal(signal);
        let end = run.end();
        assert_eq!((end.code, end.signal), (None, Some(number)), "{end:?}");
        assert_eq!((end.stdout.as_str(), end.stderr.as_str()), ("", ""));
        assert_eq!(writes(&meter), [""; 0]);
    }
}

#[test]
fn a_broadcast_that_is_stopped_keeps_its_turnaround_and_sends_no_more() {
    let meter = PtyMeter::new(Box::new(|_| Vec::new()));
    let run = start(
        &meter,
        "broadcast --turnaround 400ms --meter pqm --one-by-one clock=1997-10-29T13:27:10.015",
    );
    let end = stopped(&meter, run, 1, "INT");
    assert_eq!((end.code, end.signal), (None, Some(2)), "{end:?}");
    assert_eq!(
        end.stdout,
        "# all meters on PORT at 115200 8N1\nclock: 1997-10-29 13:27:10.015\n"
    );
    assert_eq!(
        end.stderr,
        "error: all meters on PORT at 115200 8N1: request 2 of 2 not sent, those before it were: the program was stopped\n"
    );
    assert_eq!(writes(&meter).len(), 1);
}
