//! What is hazardous asks whoever sits at the terminal, and nothing is sent without a yes.

#![cfg(unix)]

mod support {
    pub(crate) mod program;
    pub(crate) mod pty;
    pub(crate) mod terminal;
    pub(crate) mod waiting;
    pub(crate) mod writable;
}

use support::pty::PtyMeter;
use support::terminal::{End, Terminal};
use support::writable::{behaviour, meter, obey, on, run, sealed, writes};

/// One write, which is hazardous, behind a read that tells whether the line echoes.
const COMMAND: &str = "execute-operation -a 17 --meter em21 reset_all_meters";

const WRITE: &str = "11 06 30 00 00 01";

const HAZARD: &str = "reset_all_meters sets all energy counters to zero\n\
                      Do this to unit 17 on PORT at 115200 8N1? Type yes: ";

const SHOWN: &str = "# em21 unit 17 on PORT at 115200 8N1\n\
                     reset_all_meters: sets all meters to zero\n";

/// A meter whose every register holds a number.
fn any_meter() -> PtyMeter {
    meter(&held(), obey)
}

fn held() -> Vec<(u16, u16)> {
    (0..0x60).map(|address| (address, 1)).collect()
}

/// The same meter at every unit.
fn two_units() -> PtyMeter {
    let mut seventeen = behaviour(&held(), obey);
    PtyMeter::new(Box::new(move |frame| {
        let mut asked = frame.to_vec();
        asked[0] = 17;
        let body = asked.len() - 2;
        let mut answer = seventeen(&sealed(&asked[..body]));
        answer[0] = frame[0];
        let body = answer.len() - 2;
        sealed(&answer[..body])
    }))
}

/// The run of a command on a meter, when somebody types this; the port is `PORT`.
fn answered(meter: &PtyMeter, command: &str, typed: &str) -> End {
    let mut terminal = Terminal::start(&on(meter.path(), command));
    terminal.is_asked(1);
    assert_eq!(writes(meter), [""; 0]);
    terminal.types(typed);
    told(meter, terminal)
}

fn told(meter: &PtyMeter, terminal: Terminal) -> End {
    let end = terminal.end();
    End {
        stdout: end.stdout.replace(meter.path(), "PORT"),
        terminal: end.terminal.replace(meter.path(), "PORT"),
        ..end
    }
}

#[test]
fn yes_does_it() {
    for typed in ["yes\n", "y\n", "YES\n", " yes \n"] {
        let meter = any_meter();
        let end = answered(&meter, COMMAND, typed);
        assert_eq!(end.terminal, HAZARD);
        assert_eq!(end.code, Some(0));
        assert_eq!(end.stdout, format!("{SHOWN}reset_all_meters: done\n"));
        assert_eq!(writes(&meter), [WRITE]);
    }
}

#[test]
fn anything_else_does_nothing() {
    for typed in ["no\n", "\n", "yess\n", "n\n", "yes please\n"] {
        let meter = any_meter();
        let end = answered(&meter, COMMAND, typed);
        let text = format!(
            "{HAZARD}error: unit 17 on PORT at 115200 8N1: not confirmed, so nothing was sent there\n"
        );
        assert_eq!(end.terminal, text);
        assert_eq!(end.code, Some(2));
        assert_eq!(end.stdout, SHOWN);
        assert_eq!(writes(&meter), [""; 0]);
    }
}

#[test]
fn yes_beforehand_asks_nothing() {
    let meter = any_meter();
    let terminal = Terminal::start(&on(meter.path(), &format!("{COMMAND} --yes")));
    let end = told(&meter, terminal);
    assert_eq!((end.code, end.terminal.as_str()), (Some(0), ""));
    assert_eq!(writes(&meter), [WRITE]);
}

#[test]
fn every_unit_is_asked_about() {
    let meter = two_units();
    let command = COMMAND.replace("-a 17", "-a 17,18");
    let mut terminal = Terminal::start(&on(meter.path(), &command));
    terminal.is_asked(1);
    terminal.types("yes\n");
    terminal.is_asked(2);
    assert_eq!(writes(&meter), [WRITE]);
    terminal.types("no\n");
    let end = told(&meter, terminal);
    assert!(
        end.terminal.ends_with(
            "error: unit 18 on PORT at 115200 8N1: not confirmed, so nothing was sent there\n"
        ),
        "{end:?}"
    );
    assert!(end.stdout.contains("reset_all_meters: done\n"), "{end:?}");
    assert_eq!(end.code, Some(2));
    assert_eq!(writes(&meter), [WRITE]);
}

#[test]
fn a_terminal_that_goes_away_is_no_yes() {
    // Whatever was typed before, as long as it is no whole line.
    for typed in ["", "y", "yes"] {
        let meter = any_meter();
        let mut terminal = Terminal::start(&on(meter.path(), COMMAND));
        terminal.is_asked(1);
        terminal.types(typed);
        terminal.hangs_up();
        let end = told(&meter, terminal);
        assert_eq!((end.code, end.signal), (Some(2), None));
        assert_eq!(end.stdout, SHOWN);
        assert_eq!(writes(&meter), [""; 0]);
    }
}

#[test]
fn without_a_terminal_nobody_is_asked() {
    let meter = any_meter();
    let told = run(meter.path(), COMMAND);
    assert_eq!((told.code, told.stdout.as_str()), (Some(2), ""));
    assert_eq!(
        told.stderr,
        "error: reset_all_meters sets all energy counters to zero, and there is no terminal to ask at; \
         nothing was sent\nhint: --yes says that it is meant\n"
    );
    assert_eq!(meter.requests(), [[0; 0]; 0]);
}

#[test]
fn a_signal_while_somebody_is_asked_ends_it_and_nothing_is_sent() {
    for (signal, number) in [("INT", 2), ("TERM", 15)] {
        let meter = any_meter();
        let terminal = Terminal::start(&on(meter.path(), COMMAND));
        terminal.is_asked(1);
        terminal.signal(signal);
        let end = told(&meter, terminal);
        assert_eq!((end.code, end.signal), (None, Some(number)));
        assert_eq!(writes(&meter), [""; 0]);
    }
}

#[test]
fn a_signal_ends_the_question_about_the_second_unit_too() {
    let meter = two_units();
    let command = COMMAND.replace("-a 17", "-a 17,18");
    let mut terminal = Terminal::start(&on(meter.path(), &command));
    terminal.is_asked(1);
    terminal.types("yes\n");
    terminal.is_asked(2);
    terminal.signal("INT");
    let end = told(&meter, terminal);
    assert_eq!((end.code, end.signal), (None, Some(2)));
    assert!(end.stdout.contains("reset_all_meters: done\n"), "{end:?}");
    assert_eq!(writes(&meter), [WRITE]);
}
