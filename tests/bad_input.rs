//! What goes wrong before anything is sent: one clear message, the right exit code, nothing on
//! stdout.

mod support {
    pub(crate) mod program;
}

use std::fs;
use std::path::PathBuf;

use support::program::Program;

/// A file of its own in the folder cargo gives tests.
fn file(name: &str, text: &str) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    fs::write(&path, text).expect("the folder for tests is writable");
    path
}

#[test]
fn unit_0_cannot_be_read() {
    // The port is not even looked for.
    Program::new("read-registers -p /nonexistent -a 0 0x0000")
        .code(2)
        .stderr(
            "error: unit 0 is the broadcast address, which no meter answers\n\
             hint: meters are 1 to 247; `meterpoll broadcast` writes to all of them at once\n",
        )
        .run();
}

#[test]
fn unit_248_needs_a_meter_that_allows_it() {
    Program::new("read-registers -p sim: -a 248 0x0000")
        .code(2)
        .stderr(
            "error: unit 248 is above 247, the highest this meter can have\n\
             hint: units go to 247; to 255 only for meters whose profile says so, such as --meter \
             pqm\n",
        )
        .run();
    Program::new("read-registers -p sim: -a 248 --meter pqm product_code --dry-run")
        .stdout("F8 03 00 00 00 01 90 63\n")
        .run();
}

#[test]
fn a_unit_that_is_no_number_is_refused() {
    Program::new("read-registers -p sim: -a one 0x0000")
        .code(2)
        .stderr(
            "error: invalid value 'one' for '--unit <UNITS>': 'one' is no unit: a number from 1 \
             to 255, or a list such as 1,2,5-9\n\n\
             For more information, try '--help'.\n",
        )
        .run();
}

#[test]
fn no_registers_are_nothing_to_read() {
    Program::new("read-registers -p sim: -a 1 0x0000+0")
        .code(2)
        .stderr(
            "error: '0x0000+0': 0 registers are nothing to read\n\
             hint: registers are written 0x006B, 107, 0x6B+3 or 0x11F:u32/CDAB*0.1=kWh\n",
        )
        .run();
}

#[test]
fn an_address_past_65535_is_refused() {
    Program::new("read-registers -p sim: -a 1 65536")
        .code(2)
        .stderr(
            "error: '65536' is no number from 0 to 65535, or 0x0 to 0xFFFF\n\
             hint: registers are written 0x006B, 107, 0x6B+3 or 0x11F:u32/CDAB*0.1=kWh\n",
        )
        .run();
    Program::new("read-registers -p sim: -a 1 0xFFFF+2")
        .code(2)
        .stderr("error: '0xFFFF+2': 2 registers from 0xFFFF run past 0xFFFF, the last address\n")
        .run();
}

#[test]
fn an_unknown_point_is_answered_with_the_nearest_names() {
    Program::new("read-registers -p sim: -a 17 --meter pqm curent_a")
        .code(2)
        .stderr(
            "error: pqm has no point 'curent_a'; did you mean current_a, current_avg, \
             current_b?\n",
        )
        .run();
}

#[test]
fn an_unknown_meter_is_answered_with_the_list() {
    Program::new("read-registers -p sim: -a 17 --meter pmq")
        .code(2)
        .stderr(
            "error: there is no meter 'pmq'; known are em21, em24, pm290, pqm\n\
             hint: `meterpoll meters list` shows them; a profile file is named by its path\n",
        )
        .run();
}

#[test]
fn a_profile_that_does_not_parse_is_named_with_line_and_key() {
    let path = file(
        "wrong.toml",
        "name = \"mine\"\ntitle = \"Mine\"\nmanual = \"none\"\n\n[[points]]\nname = \"a\"\n\
         adress = 0\ntype = \"u16\"\n",
    );
    let path = path.to_str().expect("a path of text");
    Program::new("read-registers -p sim: -a 1 --meter")
        .argument(path)
        .code(2)
        .stderr(format!(
            "error: {path}:7: a.adress: unknown key, expected \
             name, address, repeat, type, order, scale, span, unit, about, access, range, labels, \
             no_value, only_with, alone, function, hazard, momentary, moves, step, allowed, also, \
             write_function, broadcast, writable_with, shown_by, verified, page\n"
        ))
        .run();
}

#[cfg(unix)]
#[test]
fn a_profile_that_is_not_there_is_named() {
    Program::new("read-registers -p sim: -a 1 --meter ./nowhere.toml")
        .code(2)
        .stderr(
            "error: profile ./nowhere.toml cannot be read\n  \
             because: No such file or directory (os error 2)\n",
        )
        .run();
}

#[test]
fn a_time_without_unit_is_refused() {
    Program::new("read-registers -p sim: -a 1 0 --timeout 5")
        .code(2)
        .stderr(
            "error: invalid value '5' for '--timeout <TIME>': a time needs its unit, such as 5s \
             or 5ms\n\n\
             For more information, try '--help'.\n",
        )
        .run();
}

#[test]
fn without_a_port_the_option_is_named() {
    Program::new("read-registers -a 1 0")
        .code(2)
        .stderr(
            "error: no port is named\n\
             hint: give a serial port with --port, or sim: for the simulated line\n",
        )
        .run();
}

#[test]
fn one_column_cannot_hold_two_readings() {
    Program::new("read-registers -p /nowhere -a 1 0x10:u16 0x10:i16 -f csv")
        .code(2)
        .stderr(
            "error: '0x0010' would be two columns of one name in wide CSV\n\
             hint: ask for it once, or use --layout long or another --format\n",
        )
        .run();
}

#[test]
fn a_name_without_a_meter_is_refused() {
    Program::new("read-registers -p sim: -a 1 current_a")
        .code(2)
        .stderr(
            "error: 'current_a' is no register, and without a meter there are no points\n\
             hint: name the meter with --meter, or registers as 0x0000+10\n",
        )
        .run();
}

#[test]
fn a_line_over_tcp_is_refused_in_so_many_words() {
    Program::new("read-registers -p tcp://192.0.2.1 -a 1 0")
        .code(2)
        .stderr(
            "error: port tcp://192.0.2.1: lines over TCP are not in this version\n\
             hint: give a serial port, or sim: for the simulated line\n",
        )
        .run();
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_exit_7_and_a_closed_pipe_is_quiet() {
    use std::process::Stdio;

    let program = Program::new("read-registers -p sim: -a 17 0 -f csv");
    let full = fs::OpenOptions::new()
        .write(true)
        .open("/dev/full")
        .expect("Linux has it");
    let output = program
        .command()
        .stdout(full)
        .output()
        .expect("the program starts");
    assert_eq!(output.status.code(), Some(7));
    assert_eq!(
        String::from_utf8(output.stderr).expect("text"),
        "error: the output cannot be written\n  \
         because: No space left on device (os error 28)\n"
    );

    let mut child = program
        .command()
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    // Nobody will read: the same as `| head -0`.
    drop(child.stdout.take());
    let output = child.wait_with_output().expect("the program ends");
    assert_eq!(output.status.code(), Some(7));
    assert_eq!(String::from_utf8(output.stderr).expect("text"), "");
}
