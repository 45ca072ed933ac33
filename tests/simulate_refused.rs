//! What `simulate` refuses: one clear error, its exit code, and nothing left behind.

#![cfg(unix)]

mod support {
    pub(crate) mod program;
    pub(crate) mod pty;
    pub(crate) mod simulation;
}

use std::fs;
use std::net::TcpListener;

use support::program::Program;
use support::pty::pair;
use support::simulation::free_path;

#[track_caller]
fn refused(arguments: &str, code: i32, stderr: &str) {
    Program::new(&format!("simulate {arguments}"))
        .code(code)
        .stderr(stderr)
        .run();
}

/// An error of the command line, as it begins.
#[track_caller]
fn not_taken(arguments: &str, begins: &str) {
    let output = Program::new(&format!("simulate {arguments}")).output();
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert!(stderr.starts_with(begins), "{stderr}");
    assert_eq!(
        (output.status.code(), &output.stdout[..]),
        (Some(2), &[][..])
    );
}

#[test]
fn meters_that_are_not_there() {
    refused(
        "--meter em99",
        2,
        "error: there is no meter 'em99'; known are em21, em24, pm290, pqm\n\
         hint: `meterpoll meters list` shows them; a profile file is named by its path\n",
    );
    refused(
        "--meter ./nowhere.toml=1",
        2,
        "error: profile ./nowhere.toml cannot be read\n  \
           because: No such file or directory (os error 2)\n",
    );
}

#[test]
fn units_that_a_meter_cannot_have() {
    refused(
        "--meter em24=250",
        2,
        "error: unit 250 is above 247, the highest this meter can have\n\
         hint: units go to 247; to 255 only for meters whose profile says so, such as --meter \
         pqm\n",
    );
    let begin = "error: invalid value";
    not_taken(
        "--meter pqm=0",
        &format!("{begin} 'pqm=0' for '--meter <METER[=UNITS]>': unit 0 is the broadcast address"),
    );
    not_taken(
        "--meter pqm=300",
        &format!("{begin} 'pqm=300' for '--meter <METER[=UNITS]>': '300' is no unit"),
    );
    not_taken("--meter pqm=", &format!("{begin} 'pqm=' for"));
    not_taken("--meter pqm=9-2", &format!("{begin} 'pqm=9-2' for"));
}

#[test]
fn a_unit_simulated_twice() {
    let hint = "hint: each unit is one meter: --meter pqm=17,18 --meter em24=1\n";
    let error = "error: unit 1 is to be both pqm and em24\n";
    refused("--meter pqm=1 --meter em24=1", 2, &format!("{error}{hint}"));
    for (meters, twice) in [
        ("--meter em21 --meter em21=2-4", "3 is to be em21"),
        ("--meter pqm=1,1", "1 is to be pqm"),
        ("--meter em24=7 --meter pqm=1-5,9,4", "4 is to be pqm"),
    ] {
        let error = format!("error: unit {twice} twice\n");
        refused(meters, 2, &format!("{error}{hint}"));
    }
}

#[test]
fn places_where_no_meter_can_be() {
    for place in ["sim:", "sim", "udp://127.0.0.1:1", "sim:2"] {
        refused(
            &format!("--port {place}"),
            2,
            &format!(
                "error: port {place} is no place for a simulated meter\n\
                 hint: a name for a pty, a serial port, rtu+tcp://host:port or tcp://host:port\n"
            ),
        );
    }
    refused(
        "--port /dev/ttyNOWHERE",
        3,
        "error: port /dev/ttyNOWHERE is not there\n\
         hint: `meterpoll ports` lists the ports; plugging an adapter in shows a new one (a \
         program such as brltty can take it away again)\n",
    );
    refused(
        "--port /tmp",
        3,
        "error: /tmp exists already, as a directory\n\
         hint: a pty needs a name that is free\n",
    );
    refused(
        "--port /nonexistent/meter",
        3,
        "error: the pty cannot be named /nonexistent/meter\n  \
           because: No such file or directory (os error 2)\n",
    );
}

#[test]
fn addresses_that_are_none() {
    for address in ["127.0.0.1:70000", "127.0.0.1:x", ""] {
        refused(
            &format!("--port tcp://{address}"),
            2,
            &format!(
                "error: '{address}' is no address to listen on\n\
                 hint: an address is host:port, such as 127.0.0.1:5020; port 0 is any that is \
                 free\n"
            ),
        );
    }
    refused(
        "--port rtu+tcp://127.0.0.1 -q",
        2,
        "error: '127.0.0.1' is no address to listen on\n",
    );
}

#[test]
fn an_address_that_another_program_has() {
    let other = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = other.local_addr().unwrap();
    refused(
        &format!("--port tcp://{address}"),
        3,
        &format!(
            "error: {address} is in use by another program\n\
             hint: take another port; port 0 is any that is free\n"
        ),
    );
}

#[test]
fn a_serial_port_that_another_program_has() {
    let (_ours, _theirs, path) = pair().unwrap();
    let mut other = serialport::new(&path, 9600).open_native().unwrap();
    serialport::TTYPort::set_exclusive(&mut other, true).unwrap();
    let output = Program::new(&format!("simulate --port {path} --wait 0s -q")).output();
    let stderr = String::from_utf8(output.stderr).unwrap();
    let expected = format!("error: port {path} is in use by ");
    assert!(stderr.starts_with(&expected), "{stderr}");
    assert_eq!(
        (output.status.code(), &output.stdout[..]),
        (Some(3), &[][..])
    );
}

#[test]
fn settings_of_a_line_that_has_none() {
    for (arguments, option) in [
        ("-b 9600", "--baud"),
        ("--port tcp://127.0.0.1:0 -P even", "--parity"),
        ("--port /tmp/none -s 2", "--stop-bits"),
    ] {
        refused(
            arguments,
            2,
            &format!("error: {option} is for a serial port\n"),
        );
    }
}

#[test]
fn fault_rules_that_are_none() {
    refused(
        "--fault cutt=3",
        2,
        "error: fault rule 'cutt=3': there is no fault 'cutt'; did you mean 'cut'?\n",
    );
    let file = free_path("refused-script.txt");
    let name = file.display();
    let cannot = format!("error: the fault rules in {name} cannot be read\n");
    let because = "  because: No such file or directory (os error 2)\n";
    refused(
        &format!("--fault-script {name}"),
        2,
        &format!("{cannot}{because}"),
    );
    fs::write(&file, "# all well\nsilence\ncrc=1\n").unwrap();
    refused(
        &format!("--fault crc --fault-script {name}"),
        2,
        &format!(
            "error: {name}: fault rule 'crc=1' in line 3: crc takes no value, and '1' was found\n"
        ),
    );
    fs::remove_file(file).unwrap();
}

#[test]
fn faults_that_modbus_tcp_cannot_carry() {
    for rule in ["cut=3", "crc,rate=0.1", "garbage", "echo"] {
        refused(
            &format!("--port tcp://127.0.0.1:0 --fault silence --fault {rule}"),
            2,
            &format!(
                "error: fault rule '{rule}' leaves no whole frame, and Modbus TCP carries no \
                 other\nhint: rtu+tcp:// and ptys show all faults\n"
            ),
        );
    }
}

#[test]
fn faults_of_which_modbus_tcp_can_carry_some() {
    for rule in ["any", "any,without=cut,rate=0.1"] {
        refused(
            &format!("--port tcp://127.0.0.1:0 --fault {rule}"),
            2,
            &format!(
                "error: some kinds that fault rule '{rule}' picks from leave no whole frame, and \
                 Modbus TCP carries no other\nhint: rtu+tcp:// and ptys show all faults\n"
            ),
        );
    }
}

#[test]
fn a_hang_up_that_would_be_the_end() {
    let file = free_path("refused-hang-up.txt");
    fs::write(&file, "crc\nhang-up,on=3\n").unwrap();
    let script = format!("--fault-script {}", file.display());
    for (arguments, rule) in [
        ("--fault hang-up", "hang-up"),
        (
            "--fault crc --fault hang-up=after,on=9",
            "hang-up=after,on=9",
        ),
        ("--fault any,with=hang-up", "any,with=hang-up"),
        (&script, "hang-up,on=3"),
    ] {
        refused(
            arguments,
            2,
            &format!(
                "error: fault rule '{rule}' can end the line for good: a pty without a name is not \
                 found again\nhint: --port /tmp/meter gives the pty a name\n"
            ),
        );
    }
    fs::remove_file(file).unwrap();
}

#[test]
fn words_that_are_no_paths() {
    for word in ["COM3", "ttyUSB0", "meter", "Cargo.toml"] {
        refused(
            &format!("--port {word}"),
            2,
            &format!(
                "error: a port is a path, and '{word}' has no / in it\n\
                 hint: a serial port is named like /dev/ttyUSB0; ./{word} makes a pty of that name \
                 in this folder\n"
            ),
        );
    }
    refused(
        "--port ./Cargo.toml",
        3,
        "error: ./Cargo.toml exists already, as a file\n\
         hint: a pty needs a name that is free\n",
    );
}

#[test]
fn values_in_an_empty_file() {
    let file = free_path("refused-empty.csv");
    let name = file.display();
    for text in ["", "\n\n", "\u{FEFF}"] {
        fs::write(&file, text).unwrap();
        refused(
            &format!("--values {name}"),
            2,
            &format!("error: {name} is empty: its first line names the columns, point,value\n"),
        );
    }
    fs::remove_file(file).unwrap();
}

#[test]
fn values_that_cannot_be_held_leave_no_pty_behind() {
    let (file, path) = (free_path("refused-values.csv"), free_path("refused-meter"));
    let (name, port) = (file.display(), path.display());
    let arguments = format!("--port {port} --meter pqm --values {name}");
    let cannot = format!("error: the values in {name} cannot be read\n");
    let because = "  because: No such file or directory (os error 2)\n";
    refused(&arguments, 2, &format!("{cannot}{because}"));
    for (text, problem) in [
        (
            "point,value\ncurrent_a,1.5\n",
            "2: current_a: 1.5 is between two steps: the nearest are 1 and 2",
        ),
        (
            "point,value\ncurrent_x,1\n",
            "2: current_x: pqm has no such point; did you mean current_a, current_b, current_c?",
        ),
        (
            "name,value\n",
            "1: there is no column 'point' in the header, which has name, value",
        ),
    ] {
        fs::write(&file, text).unwrap();
        refused(&arguments, 2, &format!("error: {name}:{problem}\n"));
        assert!(path.symlink_metadata().is_err());
    }
    fs::remove_file(file).unwrap();
}
