//! The catalogue of faults (`tests/catalogue.md`) once more: the real program on a real terminal.
//!
//! A value is never wrong, however busy the machine is; where the machine can turn an answer into a
//! time-out, the value may be missing. After each case the program is run again, with all the time
//! it may need and without a fault, and the value is there.

#![cfg(unix)]

mod support {
    pub(crate) mod clock;
    pub(crate) mod lying_pty;
    pub(crate) mod program;
    pub(crate) mod pty;
    pub(crate) mod script;
    pub(crate) mod truthful;
}

use std::thread;

use meterpoll::codec::rtu::encode_request;

use support::lying_pty::LyingMeter;
use support::program::Program;
use support::pty::PtyMeter;
use support::script::{read, true_reply, truth, unit};

/// What the program made of a line.
#[derive(Debug)]
struct Seen {
    code: Option<i32>,
    status: String,
    /// Whether each register has a value. It is the true one.
    is_there: Vec<bool>,
    requests: usize,
}

/// A line with its rules, the options that the program is run with, and what must have been seen.
struct Case {
    rules: &'static [&'static str],
    options: &'static str,
    check: fn(&Seen) -> bool,
}

const fn case(
    rules: &'static [&'static str],
    options: &'static str,
    check: fn(&Seen) -> bool,
) -> Case {
    Case {
        rules,
        options,
        check,
    }
}

/// Two registers far apart: two requests.
const REGISTERS: [u16; 2] = [0x0010, 0x0140];

/// So long that the machine cannot make an answer late.
const AMPLE: &str = "-t 10s";

/// Runs the program on a line: every value that is there is the true one.
fn run(path: &str, registers: &[u16], options: &str) -> Seen {
    let names: Vec<String> = registers
        .iter()
        .map(|name| format!("{name:#06X}"))
        .collect();
    let output = Program::new(&format!("read-registers -p {path} -a 17 -f csv -q"))
        .arguments(options)
        .arguments(&names.join(" "))
        .output();
    let stdout = String::from_utf8(output.stdout).expect("CSV is text");
    let row = stdout.lines().nth(1).unwrap_or_else(|| panic!("{stdout}"));
    let cells: Vec<&str> = row.split(',').collect();
    let values = &cells[4..];
    assert_eq!(values.len(), registers.len(), "{stdout}");
    let is_there = registers.iter().zip(values).map(|(address, value)| {
        assert!(
            value.is_empty() || *value == truth(17, *address).to_string(),
            "0x{address:04X} is not {value}"
        );
        !value.is_empty()
    });
    Seen {
        code: output.status.code(),
        status: cells[3].to_owned(),
        is_there: is_there.collect(),
        requests: 0,
    }
}

/// Runs all cases at once: they mostly wait.
fn check(cases: &[Case]) {
    thread::scope(|scope| {
        for case in cases {
            scope.spawn(|| {
                let meter = LyingMeter::new(case.rules);
                let mut seen = run(meter.path(), &REGISTERS, case.options);
                seen.requests = meter.requests().len();
                assert!((case.check)(&seen), "{:?}: {seen:?}", case.rules);
                let last = run(meter.path(), &[0x0280], AMPLE);
                assert_eq!(last.is_there, [true], "{:?}: {last:?}", case.rules);
            });
        }
    });
}

fn all_there(seen: &Seen) -> bool {
    seen.is_there == [true, true] && seen.code == Some(0) && seen.requests == 2
}

/// The first register has no value; the second may have met a time-out that the machine made.
fn first_missing(seen: &Seen) -> bool {
    !seen.is_there[0] && seen.status != "ok" && matches!(seen.code, Some(1 | 4))
}

/// Rows 2 to 6, 9 and 10.
#[test]
fn silence_and_lateness_make_no_wrong_value() {
    check(&[
        case(&["silence,on=1-2"], "-t 60ms --retries 1", |seen| {
            first_missing(seen) && seen.requests >= 2
        }),
        case(&["silence,on=1"], "-t 500ms --retries 9", |seen| {
            seen.is_there == [true, true]
        }),
        case(&["late=0.9,timeout=300ms,on=1"], "-t 300ms", |_| true),
        case(
            &["late=1.1,timeout=80ms,on=1"],
            "-t 80ms --retries 0",
            |_| true,
        ),
        case(
            &["late=1.9,timeout=80ms,on=1"],
            "-t 80ms --retries 0",
            |_| true,
        ),
        case(
            &["late=1.1,timeout=80ms,on=1-2"],
            "-t 80ms --retries 1",
            |_| true,
        ),
        case(
            &["late=1.1,timeout=80ms,on=1-4"],
            "-t 80ms --retries 0",
            |_| true,
        ),
        case(
            &["late=5,timeout=80ms,on=1-4"],
            "-t 80ms --retries 1",
            |_| true,
        ),
    ]);
}

/// Row 10: many reads, each answered late.
#[test]
fn of_many_reads_that_are_all_answered_late_no_value_is_wrong() {
    thread::scope(|scope| {
        for rule in ["late=1.5,timeout=60ms", "late,timeout=60ms"] {
            scope.spawn(move || {
                let meter = LyingMeter::new(&[rule]);
                for registers in [[0x10, 0x140], [0x11, 0x141], [0x12, 0x142]] {
                    for retries in [0, 2] {
                        let options = format!("-t 60ms --retries {retries}");
                        run(meter.path(), &registers, &options);
                    }
                }
            });
        }
    });
}

/// Rows 12, 15, 17 to 20, 22 to 25, 27, 29 and 35.
#[test]
fn what_is_around_the_answer_or_between_its_bytes_does_no_harm() {
    check(&[
        case(&["drip=20ms,on=1"], AMPLE, all_there),
        case(&["split=4,gap=60ms,on=1"], AMPLE, all_there),
        case(&["before=00,on=1"], AMPLE, all_there),
        case(&["before=000000,on=1"], AMPLE, all_there),
        case(&["before=FF,on=1"], AMPLE, all_there),
        case(&["before,on=1"], AMPLE, all_there),
        case(&["before=11,on=1"], AMPLE, all_there),
        case(&["after=00,on=1"], AMPLE, all_there),
        case(&["after=A75C3E,gap=3ms,on=1"], AMPLE, all_there),
        case(&["echo,gap=5ms,on=1-2"], AMPLE, all_there),
        case(&["echo=4,on=1-2"], AMPLE, all_there),
        case(&["twice,on=1"], "-t 500ms --retries 9", |seen| {
            seen.is_there == [true, true]
        }),
        case(&["twice,gap=2ms,on=1"], "-t 500ms --retries 9", |seen| {
            seen.is_there == [true, true]
        }),
        case(&["stranger,gap=5ms,on=1"], AMPLE, all_there),
        case(&["cut=5,on=1"], "-t 80ms --retries 0", first_missing),
        case(&["echo-only,on=1-2"], "-t 60ms --retries 1", first_missing),
    ]);
}

/// Rows 30, 37, 38 and 45.
#[test]
fn damaged_and_foreign_answers_are_missing_or_asked_for_again() {
    check(&[
        case(&["crc,on=1"], "-t 500ms --retries 9", |seen| {
            seen.is_there == [true, true] && seen.requests >= 3
        }),
        case(
            &["wrong-function,on=1"],
            "-t 80ms --retries 0",
            first_missing,
        ),
        case(
            &["wrong-count=+1,on=1"],
            "-t 80ms --retries 0",
            first_missing,
        ),
        case(
            &["wrong-count=-1,on=1"],
            "-t 80ms --retries 0",
            first_missing,
        ),
        case(
            &["wrong-count=odd,on=1"],
            "-t 80ms --retries 0",
            first_missing,
        ),
        case(
            &["wrong-count=0,on=1"],
            "-t 80ms --retries 0",
            first_missing,
        ),
        case(
            &["wrong-count=255,on=1"],
            "-t 80ms --retries 0",
            first_missing,
        ),
        case(
            &["exception-for=4,on=1"],
            "-t 80ms --retries 0",
            first_missing,
        ),
        case(&["wrong-count=+1,on=1"], "-t 500ms --retries 9", |seen| {
            seen.is_there == [true, true]
        }),
    ]);
}

/// Rows 40 and 42.
#[test]
fn a_refusal_is_told_with_its_code_and_a_busy_meter_is_asked_again() {
    check(&[
        case(&["exception=1,on=1"], AMPLE, |seen| {
            seen.is_there == [false, true] && seen.status == "exception:1" && seen.requests == 2
        }),
        // What comes a second time is asked for once more.
        case(&["exception=4,on=1-3"], AMPLE, |seen| {
            seen.is_there == [false, false] && seen.code == Some(5) && seen.requests == 3
        }),
        // What a busy unit may answer all the same is waited for, where nothing tells it.
        case(&["exception=6,on=1-2"], "-t 2s", |seen| {
            seen.is_there == [true, true] && seen.requests == 4
        }),
    ]);
}

/// Row 59: the answer to something else is there before the program comes.
#[test]
fn what_was_there_before_the_port_was_opened_is_ignored() {
    let other = encode_request(unit(17), &read(0x0300, 1));
    let stale = true_reply(other.as_bytes());
    for bytes in [&stale[..], &stale[..4], &[0x00; 300]] {
        let meter = LyingMeter::with(&[], bytes);
        let seen = run(meter.path(), &REGISTERS, AMPLE);
        assert_eq!(seen.is_there, [true, true]);
        assert_eq!(meter.requests().len(), 2);
    }
}

/// Row 73.
#[test]
fn what_is_no_number_is_an_empty_cell() {
    let meter = PtyMeter::holding(
        &[17],
        &[
            (0x10, 0x7FC0),
            (0x11, 0x0000),
            (0x20, 0x7F80),
            (0x21, 0x0000),
            (0x30, 0x47F1),
            (0x31, 0x2000),
        ],
    );
    Program::new(&format!(
        "read-registers -p {} -a 17 -f csv -q",
        meter.path()
    ))
    .arguments("0x10:f32 0x20:f32 0x30:f32")
    .arguments(AMPLE)
    .code(1)
    .stdout(
        "time,meter,unit_id,status,0x0010,0x0020,0x0030\n\
             <time>,,17,overflow,,,123456\n",
    )
    .run();
}

/// Row 74.
#[test]
fn every_order_of_bytes_gives_the_same_number() {
    // 123456.0 in the order of the selector; see `a_single_float_is_the_same_number_...` for why.
    let meter = PtyMeter::holding(
        &[17],
        &[
            (0x10, 0x47F1),
            (0x11, 0x2000),
            (0x20, 0x2000),
            (0x21, 0x47F1),
            (0x30, 0xF147),
            (0x31, 0x0020),
            (0x40, 0x0020),
            (0x41, 0xF147),
        ],
    );
    let selectors = |kind: &str| {
        [
            (0x10, "ABCD"),
            (0x20, "CDAB"),
            (0x30, "BADC"),
            (0x40, "DCBA"),
        ]
        .map(|(address, order)| format!("{address}:{kind}/{order}"))
        .join(" ")
    };
    for (kind, value) in [
        ("f32", "123456"),
        ("u32", "1206984704"),
        ("i32", "1206984704"),
    ] {
        Program::new(&format!(
            "read-registers -p {} -a 17 -f csv -q",
            meter.path()
        ))
        .arguments(&selectors(kind))
        .arguments(AMPLE)
        .stdout(format!(
            "time,meter,unit_id,status,0x0010,0x0020,0x0030,0x0040\n\
                 <time>,,17,ok,{value},{value},{value},{value}\n"
        ))
        .run();
    }
}
