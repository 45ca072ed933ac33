//! How the program behaves in company: with a full disk behind stderr, with meters that stop
//! answering, with a port that goes away, with whoever opens the port next.

#![cfg(unix)]

mod support {
    pub(crate) mod program;
    pub(crate) mod pty;
    pub(crate) mod run;
    pub(crate) mod waiting;
}

use std::fs::{self, OpenOptions};
use std::path::PathBuf;
use std::process::Command;
use std::time::Duration;

use support::program::{Program, without_times};
use support::pty::{self, PtyMeter};
use support::run::Run;
use support::waiting::wait_until;

const HEADER: &str = "time,meter,unit_id,status,0x0005\n";

#[test]
fn a_late_answer_is_not_left_to_the_next_run() {
    // Every answer comes after the time-out of the first run, and within what is waited for.
    let meter = PtyMeter::new(Box::new(|request| {
        std::thread::sleep(Duration::from_millis(700));
        pty::answer(1, request).unwrap_or_default()
    }));
    let read = |address: u16, timeout: &str| {
        let port = meter.path();
        let arguments = format!("read-registers -p {port} -a 1 {address} -t {timeout} -f csv -q");
        Program::new(&format!("{arguments} --retries 0")).output()
    };
    assert_eq!(read(0x10, "200ms").status.code(), Some(4));
    let next = read(0x20, "10s");
    assert_eq!(
        without_times(&String::from_utf8(next.stdout).expect("CSV is text")),
        format!(
            "time,meter,unit_id,status,0x0020\n<time>,,1,ok,{}\n",
            pty::register(0x20)
        )
    );
}

#[cfg(target_os = "linux")]
#[test]
fn readings_go_out_even_when_stderr_is_full() {
    let meter = PtyMeter::healthy(2);
    let arguments = format!(
        "read-registers -p {} -a 1,2 5 -f csv -t 300ms",
        meter.path()
    );
    let program = Program::new(&format!("{arguments} --retries 0"));
    let full = OpenOptions::new()
        .write(true)
        .open("/dev/full")
        .expect("Linux has it");
    let output = program
        .command()
        .stderr(full)
        .output()
        .expect("the program starts");
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(
        without_times(&String::from_utf8(output.stdout).expect("CSV is text")),
        format!("{HEADER}<time>,,1,timeout,\n<time>,,2,ok,38\n")
    );
}

#[test]
fn a_unit_that_stops_answering_is_given_up_after_three_reads() {
    let mut answers = 0;
    let meter = PtyMeter::new(Box::new(move |request| {
        answers += 1;
        pty::answer(1, request)
            .filter(|_| answers == 1)
            .unwrap_or_default()
    }));
    Program::new(&format!(
        "read-registers -p {} -a 1 0x10 0x20 0x30 0x40 0x50 -t 300ms --retries 0 -f csv -q",
        meter.path()
    ))
    .code(1)
    .stdout(
        "time,meter,unit_id,status,0x0010,0x0020,0x0030,0x0040,0x0050\n\
         <time>,,1,timeout,115,,,,\n",
    )
    .stderr(format!(
        "error: unit 1 on {0} at 9600 8N1, registers 0x0020+1: no answer within 300ms\n\
         error: unit 1 on {0} at 9600 8N1, registers 0x0030+1: no answer within 300ms\n\
         error: unit 1 on {0} at 9600 8N1, registers 0x0040+1: no answer within 300ms; 1 more \
         read of this unit was not tried\n",
        meter.path()
    ))
    .run();
    assert_eq!(meter.requests().len(), 4);
}

#[test]
fn a_quiet_table_of_several_units_says_which_is_which() {
    let meter = PtyMeter::new(Box::new(|request| {
        pty::answer(u16::from(request[0]), request).unwrap_or_default()
    }));
    Program::new(&format!(
        "read-registers -p {} -a 1,2 5 -q -t 10s",
        meter.path()
    ))
    .stdout(
        "unit 1\nPOINT   VALUE  UNIT\n0x0005     38\n\n\
             unit 2\nPOINT   VALUE  UNIT\n0x0005     38\n",
    )
    .run();
}

#[test]
fn registers_that_cannot_be_what_they_are_read_as_are_told() {
    let meter = PtyMeter::healthy(1);
    Program::new(&format!(
        "read-registers -p {} -a 1 0x3FE:mod10000 -f csv -t 10s",
        meter.path()
    ))
    .code(0)
    .stdout("time,meter,unit_id,status,0x03FE\n<time>,,1,ok,71577164\n")
    .run();
    Program::new(&format!(
        "read-registers -p {} -a 1 0x10:date -f csv -t 10s",
        meter.path()
    ))
    .code(4)
    .stdout("time,meter,unit_id,status,0x0010\n<time>,,1,mismatch,\n")
    .stderr(format!(
        "error: unit 1 on {} at 9600 8N1, 0x0010: registers 0073 007A hold no date\n\
             hint: the type, byte order or scale is not this register's, or the meter's value is \
             broken\n",
        meter.path()
    ))
    .run();
}

#[test]
fn meters_lists_what_can_be_named_and_ends_with_2_when_one_does_not_load() {
    let home = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("listed");
    let folder = home.join("meterpoll/meters");
    fs::create_dir_all(&folder).expect("the folder for tests is writable");
    let profile = |name: &str| {
        format!(
            "name = \"{name}\"\ntitle = \"Title\"\nmanual = \"none\"\n\n[[points]]\nname = \"b\"\n\
             address = 0x10\ntype = \"u16\"\n"
        )
    };
    fs::write(folder.join("pqm.toml"), profile("pqm")).expect("writable");
    fs::write(folder.join("other.toml"), profile("another")).expect("writable");
    let folder = folder.display();
    Program::new("meters list")
        .variable("XDG_CONFIG_HOME", &home)
        .code(2)
        .stdout(format!(
            "NAME   METER                                POINTS  VERIFIED  LINE       FROM\n\
             em21   Carlo Gavazzi EM21 energy meter          42        42  19200 8N1  built in\n\
             em24   Carlo Gavazzi EM24-DIN energy meter      96        70  9600 8N1   built in\n\
             pm290  Satec PM290 powermeter                   66        37  9600 8N1   built in\n\
             pqm    Title                                     1         1  9600 8N1   {folder}/pqm.toml\n"
        ))
        .stderr(format!(
            "error: profile {folder}/other.toml has name = \"another\", and its file says otherwise\n\
             hint: give both the same name\n"
        ))
        .run();
}

#[test]
fn options_that_would_do_nothing_or_too_much_are_refused() {
    for (arguments, error) in [
        ("--layout long", "error: --layout is for --format csv\n"),
        ("--units -f json", "error: --units is for --format csv\n"),
        (
            "--units -f csv --layout long",
            "error: --units is for wide CSV\n",
        ),
        (
            "--retries 101",
            "error: invalid value '101' for '--retries <COUNT>': 101 is not in 0..=100\n\n\
             For more information, try '--help'.\n",
        ),
        (
            "--timeout 0s",
            "error: invalid value '0s' for '--timeout <TIME>': no meter answers in no time\n\n\
             For more information, try '--help'.\n",
        ),
        (
            "--wait 2days",
            "error: invalid value '2days' for '--wait <TIME>': the longest time is 24h\n\n\
             For more information, try '--help'.\n",
        ),
        (
            "--baud 1",
            "error: invalid value '1' for '--baud <BAUD>': a speed is a whole number of bits a \
             second from 50, such as 9600\n\n\
             For more information, try '--help'.\n",
        ),
    ] {
        Program::new(&format!("read-registers -p sim: -a 17 0 {arguments}"))
            .code(2)
            .stderr(error)
            .run();
    }
}

#[test]
fn a_port_that_looks_like_the_simulated_line_is_told_its_name() {
    Program::new("read-registers -p sim -a 17 0")
        .code(2)
        .stderr("error: there is no simulated line 'sim'\nhint: the simulated line is named sim:\n")
        .run();
    Program::new("read-registers -a 17 0 -p")
        .argument("")
        .code(2)
        .stderr(
            "error: no port is named\n\
             hint: give a serial port with --port, or sim: for the simulated line\n",
        )
        .run();
}

#[test]
fn named_points_are_read_as_the_meter_wants_whatever_function_is_typed() {
    // The PQM takes 03 and 04 for one, so there the function typed is used.
    Program::new("read-registers -a 17 --meter pqm product_code 0x10 --function 4 --dry-run")
        .stdout("11 04 00 00 00 01 33 5A\n11 04 00 10 00 01 32 9F\n")
        .run();
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("two_tables.toml");
    let text = "name = \"two\"\ntitle = \"Two\"\nmanual = \"none\"\n\n[[points]]\nname = \"status\"\n\
                address = 0x0\ntype = \"u16\"\n";
    fs::write(&path, text).expect("the folder for tests is writable");
    Program::new("read-registers -a 17 status 0x10 --function 4 --dry-run --meter")
        .argument(&path)
        .stdout("11 03 00 00 00 01 86 9A\n11 04 00 10 00 01 32 9F\n")
        .run();
    // Where it would do nothing at all, it is refused.
    Program::new("read-registers -a 17 status --function 4 --dry-run --meter")
        .argument(&path)
        .code(2)
        .stderr(
            "error: --function is for registers by address, or a meter whose functions 03 and 04 \
             are one\n",
        )
        .run();
    // Nor is a point named like a fixed column put into wide CSV.
    Program::new("read-registers -a 17 status -f csv --dry-run --meter")
        .argument(&path)
        .code(2)
        .stderr(
            "error: 'status' would be two columns of one name in wide CSV\n\
             hint: ask for it once, or use --layout long or another --format\n",
        )
        .run();
}

#[test]
fn a_signal_lets_the_row_in_hand_be_finished_and_a_second_one_does_not() {
    /// Longer than any test machine takes to start the program and to deliver a signal.
    const ANSWER: Duration = Duration::from_millis(1500);

    for (signal, number) in [("INT", 2), ("TERM", 15)] {
        for is_second in [false, true] {
            let meter = PtyMeter::new(Box::new(|request| {
                std::thread::sleep(ANSWER);
                pty::answer(u16::from(request[0]), request).unwrap_or_default()
            }));
            let arguments = format!("read-registers -p {} -a 1-9 5 -f csv -t 20s", meter.path());
            let mut run = Run::start(&arguments);
            wait_until(|| !meter.requests().is_empty());
            run.signal(signal);
            // Two that come at once are one to the system.
            while is_second && run.child.try_wait().expect("a child").is_none() {
                run.signal(signal);
            }
            let end = run.end();
            assert_eq!((end.signal, end.stderr.as_str()), (Some(number), ""));
            let stdout = without_times(&end.stdout);
            let row = format!("{HEADER}<time>,,1,ok,38\n");
            assert_eq!(stdout, if is_second { String::new() } else { row });
        }
    }
}

/// Whether whoever runs the tests wants what it starts to outlive a closed window.
fn hang_ups_are_ignored_here() -> bool {
    let mut shell = Command::new("/bin/sh");
    let status = shell.args(["-c", "kill -s HUP $$"]).status();
    status.expect("a shell").success()
}

#[test]
fn a_closed_window_lets_the_row_in_hand_be_finished_however_often_it_is_told() {
    if hang_ups_are_ignored_here() {
        return;
    }
    let meter = PtyMeter::new(Box::new(|request| {
        std::thread::sleep(Duration::from_millis(1500));
        pty::answer(u16::from(request[0]), request).unwrap_or_default()
    }));
    let arguments = format!("read-registers -p {} -a 1-9 5 -f csv -t 20s", meter.path());
    let mut run = Run::start(&arguments);
    wait_until(|| !meter.requests().is_empty());
    while run.child.try_wait().expect("a child").is_none() {
        run.signal("HUP");
    }
    let end = run.end();
    assert_eq!((end.signal, end.stderr.as_str()), (Some(1), ""));
    let row = format!("{HEADER}<time>,,1,ok,38\n");
    assert_eq!(without_times(&end.stdout), row);
}

#[test]
fn a_signal_while_a_late_answer_is_waited_for_is_told_in_the_end() {
    let meter = PtyMeter::new(Box::new(|_| Vec::new()));
    let arguments = format!("read-registers -p {} -a 1 5 -f csv -q", meter.path());
    let mut run = Run::start(&format!("{arguments} -t 200ms --retries 0"));
    // The header and the row.
    run.wait_for_lines(2);
    run.signal("INT");
    assert_eq!(run.end().signal, Some(2));
}

#[test]
fn an_own_profile_that_cannot_be_read_is_not_replaced_by_a_built_in_one() {
    let home = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("dangling");
    let folder = home.join("meterpoll/meters");
    fs::create_dir_all(&folder).expect("the folder for tests is writable");
    let link = folder.join("pqm.toml");
    let _ = fs::remove_file(&link);
    std::os::unix::fs::symlink("/nonexistent/pqm.toml", &link).expect("a link can be made");
    Program::new("read-registers -p sim: -a 17 --meter pqm current_a")
        .variable("XDG_CONFIG_HOME", &home)
        .code(2)
        .stderr(format!(
            "error: profile {} cannot be read\n  because: No such file or directory (os error 2)\n",
            link.display()
        ))
        .run();
}
