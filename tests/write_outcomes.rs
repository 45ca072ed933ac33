//! What `write-setpoint` makes of what comes of a write: the exit code, what it says, and how often
//! the meter has seen the request.

#![cfg(unix)]

mod support {
    pub(crate) mod program;
    pub(crate) mod pty;
    pub(crate) mod writable;
}

use std::path::PathBuf;
use std::sync::LazyLock;
use std::thread;

use support::pty::PtyMeter;
use support::writable;
use support::writable::{Registers, Told, behaviour, came_to, meter, obey, refuse, sealed, writes};

/// A meter that answers soon or never, so that nobody waits long for what may still come.
const QUICK: &str = r#"
name = "quick"
title = "Quick"
manual = "none"

[limits]
functions = [3, 6, 16]
longest_answer = "200ms"

[[points]]
name = "elsewhere"
address = 0x0300
type = "u16"
"#;

static PROFILE: LazyLock<PathBuf> = LazyLock::new(|| {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("quick.toml");
    std::fs::write(&path, QUICK).expect("the folder for tests is writable");
    path
});

/// Runs a command on that meter, of which nothing else is known: its name and file are left out of
/// what is said.
fn run(path: &str, command: &str) -> Told {
    let profile = format!(" --meter {}", PROFILE.display());
    let told = writable::run(path, &format!("{command}{profile}"));
    Told {
        stdout: told.stdout.replace("# quick unit", "# unit"),
        stderr: told.stderr.replace(&profile, ""),
        ..told
    }
}

/// Two registers are written with one request each, and read back.
const COMMAND: &str = "write-setpoint -a 17 0x0010=500 0x0020=600";

const HELD: [(u16, u16); 2] = [(0x10, 1), (0x20, 2)];

const FIRST: &str = "11 06 00 10 01 F4";
const SECOND: &str = "11 06 00 20 02 58";

const SHOWN: &str = "\
# unit 17 on PORT at 115200 8N1
POINT   NOW  NEW  UNIT
0x0010    1  500
0x0020    2  600
";

const HINT: &str = "hint: `meterpoll read-registers -p PORT -b 115200 -a 17 0x0010 0x0020` shows what \
                    the meter holds now\n";

const NOT_SECOND: &str = "error: unit 17 on PORT at 115200 8N1, 0x0020: not written: something before \
                          it was not\n";

type Treat = Box<dyn FnMut(&[u8], &mut Registers) -> Vec<u8> + Send>;

/// A run on a meter that treats writes like this, and the writes that it has seen.
fn outcome(treat: Treat) -> (Told, Vec<String>) {
    let meter = meter(&HELD, treat);
    let told = run(meter.path(), COMMAND);
    (told, writes(&meter))
}

/// What is obeyed, and answered with something made of the right answer.
fn obeyed(mut spoilt: impl FnMut(Vec<u8>) -> Vec<u8> + Send + 'static) -> Treat {
    Box::new(move |frame, registers| spoilt(obey(frame, registers)))
}

#[test]
fn what_is_confirmed_is_read_back() {
    let (told, writes) = outcome(obeyed(|answer| answer));
    let done = "0x0010: 500, written and read back\n0x0020: 600, written and read back\n";
    came_to(&told, 0, &format!("{SHOWN}{done}"), "");
    assert_eq!(writes, [FIRST, SECOND]);
}

#[test]
fn an_answer_that_is_lost_or_spoilt_leaves_the_outcome_unknown_and_ends_it() {
    let cases: Vec<(Treat, &str)> = vec![
        (obeyed(|_| Vec::new()), "no answer within 200ms"),
        (
            obeyed(|mut answer| {
                answer[4] ^= 1;
                answer
            }),
            "the answer was damaged: 8 bytes without a valid CRC",
        ),
        (
            obeyed(|answer| answer[..5].to_vec()),
            "the answer broke off after 5 of 8 bytes",
        ),
        (
            obeyed(|answer| sealed(&[17, 6, 0, 0x11, answer[4], answer[5]])),
            "the unit answered something else: 0x0011 written, and 0x0010 was sent",
        ),
        (
            obeyed(|answer| sealed(&[18, 6, 0, 0x10, answer[4], answer[5]])),
            "no answer within 200ms, only 1 frame of other units",
        ),
        // The gateway does not know either.
        (
            Box::new(|frame, registers| {
                obey(frame, registers);
                refuse(frame, 0x0B)
            }),
            "the meter refused: exception 0B (GATEWAY TARGET DEVICE FAILED TO RESPOND)",
        ),
    ];
    thread::scope(|scope| {
        for (treat, found) in cases {
            scope.spawn(move || {
                let (told, writes) = outcome(treat);
                let text = format!(
                    "error: unit 17 on PORT at 115200 8N1, 0x0010: outcome unknown, it may be \
                     written or not: {found}\n{HINT}{NOT_SECOND}"
                );
                came_to(&told, 6, SHOWN, &text);
                assert_eq!(writes, [FIRST]);
            });
        }
    });
}

#[test]
fn a_refusal_ends_it_and_nothing_is_sent_again() {
    for (code, name, hint) in [
        (
            1,
            "01 (ILLEGAL FUNCTION)",
            "the meter may take the other function, --function 6 or 16",
        ),
        (
            2,
            "02 (ILLEGAL DATA ADDRESS)",
            "the meter has no such registers, or none that can be written",
        ),
        (
            3,
            "03 (ILLEGAL DATA VALUE)",
            "the meter does not take this value, or not now",
        ),
        (
            4,
            "04 (SERVER DEVICE FAILURE)",
            "the meter itself failed: its display or its manual may say why",
        ),
        (
            0x0A,
            "0A (GATEWAY PATH UNAVAILABLE)",
            "a gateway on the way has no path to this unit: check its setup, and --unit",
        ),
    ] {
        let (told, writes) = outcome(Box::new(move |frame, _| refuse(frame, code)));
        let text = format!(
            "error: unit 17 on PORT at 115200 8N1, 0x0010: the meter refused: exception {name}\n\
             hint: {hint}\n{NOT_SECOND}"
        );
        came_to(&told, 5, SHOWN, &text);
        assert_eq!(writes, [FIRST]);
    }
}

#[test]
fn what_was_done_before_a_refusal_is_told_too() {
    let (told, writes) = outcome(Box::new(|frame, registers| match frame[3] {
        0x20 => refuse(frame, 3),
        _ => obey(frame, registers),
    }));
    came_to(
        &told,
        5,
        &format!("{SHOWN}0x0010: 500, written and read back\n"),
        "error: unit 17 on PORT at 115200 8N1, 0x0020: the meter refused: exception 03 (ILLEGAL DATA \
         VALUE)\nhint: the meter does not take this value, or not now\n",
    );
    assert_eq!(writes, [FIRST, SECOND]);
}

#[test]
fn a_busy_meter_is_written_to_again() {
    let mut busy = 2;
    let (told, writes) = outcome(Box::new(move |frame, registers| {
        if busy > 0 {
            busy -= 1;
            return refuse(frame, 6);
        }
        obey(frame, registers)
    }));
    let done = "0x0010: 500, written and read back\n0x0020: 600, written and read back\n";
    came_to(&told, 0, &format!("{SHOWN}{done}"), "");
    assert_eq!(writes, [FIRST, FIRST, FIRST, SECOND]);
}

#[test]
fn a_meter_that_stays_busy_has_done_nothing() {
    let (told, writes) = outcome(Box::new(|frame, _| refuse(frame, 6)));
    let text = format!(
        "error: unit 17 on PORT at 115200 8N1, 0x0010: the meter refused: exception 06 (SERVER DEVICE \
         BUSY)\nhint: the meter is there but busy, perhaps somebody is at its keys: ask again later\n\
         {NOT_SECOND}"
    );
    came_to(&told, 5, SHOWN, &text);
    assert_eq!(writes, [FIRST, FIRST, FIRST, FIRST]);
}

#[test]
fn a_meter_that_is_still_at_work_has_confirmed_nothing() {
    let command = "write-setpoint -a 17 --no-verify 0x0010=500";
    let meter = meter(&HELD, |frame, _| refuse(frame, 5));
    let told = run(meter.path(), command);
    came_to(
        &told,
        6,
        "# unit 17 on PORT at 115200 8N1\nPOINT   NOW  NEW  UNIT\n0x0010    1  500\n",
        "error: unit 17 on PORT at 115200 8N1, 0x0010: not confirmed: the meter has taken it and is \
         still at work (05 ACKNOWLEDGE); it was not sent again\n\
         hint: `meterpoll read-registers -p PORT -b 115200 -a 17 0x0010` shows what the meter holds \
         now\n",
    );
    assert_eq!(writes(&meter), [FIRST]);
}

#[test]
fn a_meter_that_keeps_another_value_is_told_with_both() {
    // It says so in its answer, or says nothing and holds another one.
    for is_told in [true, false] {
        let (told, writes) = outcome(Box::new(move |frame, registers| {
            if frame[3] == 0x20 {
                return obey(frame, registers);
            }
            registers.insert(0x10, 400);
            if is_told {
                sealed(&[17, 6, 0, 0x10, 0x01, 0x90])
            } else {
                sealed(&frame[..6])
            }
        }));
        came_to(
            &told,
            6,
            &format!("{SHOWN}0x0020: 600, written and read back\n"),
            "error: unit 17 on PORT at 115200 8N1, 0x0010: 500 was written, and the meter holds 400\n\
             hint: the meter keeps it within its own limits, or something else sets it\n",
        );
        assert_eq!(writes, [FIRST, SECOND]);
    }
}

#[test]
fn another_value_in_the_answer_counts_where_nothing_is_read_back() {
    let command = "write-setpoint -a 17 --no-verify 0x0010=500";
    let meter = meter(&HELD, |_, _| sealed(&[17, 6, 0, 0x10, 0x01, 0x90]));
    let told = run(meter.path(), command);
    came_to(
        &told,
        6,
        "# unit 17 on PORT at 115200 8N1\nPOINT   NOW  NEW  UNIT\n0x0010    1  500\n",
        "error: unit 17 on PORT at 115200 8N1, 0x0010: 500 was written, and the meter holds 400\n\
         hint: the meter keeps it within its own limits, or something else sets it\n",
    );
    assert_eq!(writes(&meter), [FIRST]);
}

#[test]
fn on_a_line_that_echoes_the_echo_is_no_answer() {
    for is_answered in [true, false] {
        let mut behaviour = behaviour(&HELD, move |frame, registers| {
            let answer = obey(frame, registers);
            if is_answered { answer } else { Vec::new() }
        });
        let meter = PtyMeter::new(Box::new(move |frame| {
            [frame.to_vec(), behaviour(frame)].concat()
        }));
        let told = run(meter.path(), COMMAND);
        if is_answered {
            let done = "0x0010: 500, written and read back\n0x0020: 600, written and read back\n";
            came_to(&told, 0, &format!("{SHOWN}{done}"), "");
            assert_eq!(writes(&meter), [FIRST, SECOND]);
        } else {
            let text = format!(
                "error: unit 17 on PORT at 115200 8N1, 0x0010: outcome unknown, it may be written or \
                 not: nothing but the echo of the own request came back\n{HINT}{NOT_SECOND}"
            );
            came_to(&told, 6, SHOWN, &text);
            assert_eq!(writes(&meter), [FIRST]);
        }
    }
}

#[test]
fn a_port_that_is_lost_during_the_write_leaves_the_outcome_unknown() {
    // The two points are read first.
    let behaviour = behaviour(&HELD, obey);
    let meter = PtyMeter::hanging_up(behaviour, 3);
    let told = run(meter.path(), COMMAND);
    assert_eq!(told.code, Some(6), "{told:?}");
    assert_eq!(told.stdout, SHOWN);
    let begin = "error: unit 17 on PORT at 115200 8N1, 0x0010: outcome unknown, it may be written or \
                 not: ";
    assert!(told.stderr.starts_with(begin), "{}", told.stderr);
    let end = format!("{HINT}{NOT_SECOND}");
    assert!(told.stderr.ends_with(&end), "{}", told.stderr);
    assert_eq!(writes(&meter), [FIRST]);
}

#[test]
fn a_port_that_is_lost_before_the_write_has_carried_nothing() {
    let behaviour = behaviour(&HELD, obey);
    let meter = PtyMeter::hanging_up(behaviour, 1);
    let told = run(meter.path(), COMMAND);
    assert_eq!((told.code, told.stdout.as_str()), (Some(3), ""), "{told:?}");
    let begin = "error: unit 17 on PORT at 115200 8N1: nothing was written: ";
    assert!(told.stderr.starts_with(begin), "{}", told.stderr);
    assert_eq!(writes(&meter), [""; 0]);
}

#[test]
fn a_read_back_that_fails_is_no_confirmation() {
    let mut behaviour = behaviour(&HELD, obey);
    let mut is_written = false;
    let meter = PtyMeter::new(Box::new(move |frame| {
        is_written |= frame[1] == 6;
        if is_written && frame[1] == 3 {
            return refuse(frame, 4);
        }
        behaviour(frame)
    }));
    let told = run(meter.path(), "write-setpoint -a 17 0x0010=500");
    came_to(
        &told,
        6,
        "# unit 17 on PORT at 115200 8N1\nPOINT   NOW  NEW  UNIT\n0x0010    1  500\n",
        "error: unit 17 on PORT at 115200 8N1, 0x0010: confirmed by the meter, but reading it back \
         failed (exception:4)\n\
         hint: `meterpoll read-registers -p PORT -b 115200 -a 17 0x0010` shows what the meter holds \
         now\n",
    );
    assert_eq!(writes(&meter), [FIRST]);
}

#[test]
fn what_is_unknown_of_one_unit_counts_more_than_what_is_known_of_another() {
    let mut seventeen = behaviour(&HELD, |_, _| Vec::new());
    let meter = PtyMeter::new(Box::new(move |frame| match frame[0] {
        17 => seventeen(frame),
        18 if frame[1] == 6 => refuse(frame, 2),
        _ => sealed(&[18, 3, 2, 0, 7]),
    }));
    let command = "write-setpoint -a 17,18 0x0010=500";
    let told = run(meter.path(), command);
    assert_eq!(told.code, Some(6), "{told:?}");
    let lines: Vec<&str> = told.stderr.lines().collect();
    assert!(
        lines[0].starts_with("error: unit 17 on PORT at 115200 8N1, 0x0010: outcome unknown"),
        "{lines:?}"
    );
    assert_eq!(
        lines[2],
        "error: unit 18 on PORT at 115200 8N1, 0x0010: the meter refused: exception 02 (ILLEGAL DATA \
         ADDRESS)"
    );
    assert_eq!(writes(&meter), [FIRST, "12 06 00 10 01 F4"]);
}
