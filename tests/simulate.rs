//! `simulate` on ptys and serial ports, as other programs meet it.

#![cfg(unix)]

mod support {
    pub(crate) mod program;
    pub(crate) mod pty;
    pub(crate) mod simulation;
}

use std::fs;
use std::io::{Read, Write};
use std::os::unix::fs::symlink;
#[cfg(target_os = "linux")]
use std::os::unix::fs::{MetadataExt, PermissionsExt};
#[cfg(target_os = "linux")]
use std::os::unix::process::CommandExt;
use std::path::Path;
#[cfg(target_os = "linux")]
use std::process::{Command, Stdio};
use std::time::Duration;

use meterpoll::codec::rtu::check;
#[cfg(target_os = "linux")]
use meterpoll::transport::Outside;
use meterpoll::transport::pty::Pty;
#[cfg(target_os = "linux")]
use rustix::fs::{Mode, OFlags};
#[cfg(target_os = "linux")]
use rustix::termios::ioctl_tiocexcl;
use rustix::termios::{LocalModes, OptionalActions, tcgetattr, tcsetattr};
use serialport::{SerialPort, TTYPort};

use support::program::Program;
use support::pty::pair;
use support::simulation::{Ended, Simulation, free_path};

/// Function 08 to unit 17: the answer is the same.
fn loopback(unit: u8) -> Vec<u8> {
    let body = [unit, 8, 0, 0, 0, 0];
    [&body[..], &check(&body)].concat()
}

/// A client that holds the line as serial clients do.
fn open(path: &str) -> TTYPort {
    let port = serialport::new(path, 115_200).timeout(Duration::from_secs(10));
    port.open_native().expect("the port opens")
}

/// Sends a request and expects this answer.
#[track_caller]
fn ask(client: &mut (impl Read + Write), request: &[u8], answer: &[u8]) {
    client.write_all(request).unwrap();
    let mut heard = vec![0; answer.len()];
    client.read_exact(&mut heard).unwrap();
    assert_eq!(heard, answer);
}

/// The value cells of a read in CSV.
#[track_caller]
fn values(reading: &Program) -> Vec<String> {
    let output = reading.output();
    let stdout = String::from_utf8(output.stdout).unwrap();
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert_eq!((output.status.code(), stderr.as_str()), (Some(0), ""));
    let row = stdout.lines().nth(1).expect("a row");
    row.split(',').skip(4).map(str::to_owned).collect()
}

#[test]
fn a_new_pty_is_read_by_clients_that_come_and_go_until_a_signal_ends_it() {
    let simulation = Simulation::new("");
    assert!(Path::new(&simulation.path).starts_with("/dev"));
    let pqm = simulation.reading("-a 17 --meter pqm product_code serial_number -f csv");
    let same = values(&pqm);
    assert_eq!(same[0], "65");
    assert_eq!(values(&pqm), same);
    let em24 = simulation.reading("-a 1 --meter em24 identification_code -f csv");
    assert_eq!(values(&em24), ["EM24-DIN AV9"]);
    let em21 = simulation.reading("-a 3 --meter em21 identification_code -f csv");
    assert_eq!(values(&em21), ["EM21 AV5"]);
    let end = simulation.stop("TERM");
    assert_eq!(
        end,
        Ended::by(15, "6 requests (function 03: 6), 6 answers\n")
    );
}

#[test]
fn what_is_simulated_is_what_the_line_inside_the_program_shows() {
    let simulation = Simulation::new("");
    let what = "-a 17 --meter pqm serial_number current_a_max current_a_min_date -f csv";
    let inside = Program::new(&format!("read-registers -p sim: {what}"));
    assert_eq!(values(&simulation.reading(what)), values(&inside));
}

#[test]
fn a_pty_has_the_name_it_is_given_as_long_as_it_is_there() {
    let path = free_path("named-meter");
    let name = path.display().to_string();
    let simulation = Simulation::new(&format!("--port {name} --meter em24=9"));
    assert_eq!(simulation.path, name);
    assert!(fs::read_link(&path).unwrap().starts_with("/dev"));
    let reading = simulation.reading("-a 9 --meter em24 identification_code -f csv");
    assert_eq!(values(&reading), ["EM24-DIN AV9"]);
    let end = simulation.stop("INT");
    assert_eq!(end, Ended::by(2, "1 request (function 03: 1), 1 answer\n"));
    assert!(path.symlink_metadata().is_err());
}

#[test]
fn quiet_says_nothing_in_the_end() {
    assert_eq!(Simulation::new("-q").stop("INT"), Ended::by(2, ""));
}

#[test]
fn after_so_many_requests_it_ends_well_and_their_answers_are_read() {
    let path = free_path("counted-meter");
    let simulation = Simulation::new(&format!("--count 2 --port {}", path.display()));
    let reading = simulation.reading("-a 17 --meter pqm product_code ct_primary -f csv");
    assert_eq!(values(&reading), ["65", "600"]);
    let end = simulation.ended();
    assert_eq!(
        end,
        Ended::with(0, "2 requests (function 03: 2), 2 answers\n")
    );
    assert!(path.symlink_metadata().is_err());
}

#[test]
fn each_unit_has_a_load_of_its_own() {
    let simulation = Simulation::new("--meter pqm=17,18 --meter em24=1-3");
    let reading = "--meter pqm serial_number modbus_address -f csv";
    let [one, other] = [17, 18].map(|unit| {
        let reading = simulation.reading(&format!("-a {unit} {reading}"));
        values(&reading)
    });
    assert_ne!(one[0], other[0]);
    assert_eq!([&one[1], &other[1]], ["17", "18"]);
    let em24 = simulation.reading("-a 1-3 --meter em24 rs485_address -f csv");
    let stdout = String::from_utf8(em24.output().stdout).unwrap();
    let last: Vec<&str> = stdout
        .lines()
        .filter_map(|row| row.rsplit(',').next())
        .collect();
    assert_eq!(last, ["rs485_address", "1", "2", "3"]);
}

#[test]
fn a_client_that_holds_the_pty_keeps_others_out() {
    let simulation = Simulation::new("");
    let mut client = open(&simulation.path);
    ask(&mut client, &loopback(17), &loopback(17));
    let output = simulation.reading("-a 17 0 --wait 0s -q").output();
    assert_eq!(output.status.code(), Some(3));
    let stderr = String::from_utf8(output.stderr).unwrap();
    let expected = format!("error: port {} is in use by ", simulation.path);
    assert!(stderr.starts_with(&expected), "{stderr}");
    ask(&mut client, &loopback(17), &loopback(17));
    drop(client);
    assert_eq!(values(&simulation.reading("-a 17 0 -f csv")), ["65"]);
}

#[test]
fn a_request_in_pieces_is_answered_and_a_damaged_one_is_not() {
    let simulation = Simulation::new("");
    let mut client = open(&simulation.path);
    let request = loopback(2);
    let (first, rest) = request.split_at(3);
    client.write_all(first).unwrap();
    ask(&mut client, rest, &request);
    let mut damaged = loopback(2);
    damaged[4] ^= 1;
    client.write_all(&damaged).unwrap();
    client.set_timeout(Duration::from_millis(100)).unwrap();
    assert!(client.read(&mut [0]).is_err());
    client.set_timeout(Duration::from_secs(10)).unwrap();
    ask(&mut client, &request, &request);
    let end = simulation.stop("INT");
    let expected = "2 requests (function 08: 2), 2 answers, 1 not understood\n";
    assert_eq!(end, Ended::by(2, expected));
}

#[test]
fn requests_and_answers_are_told_in_words_and_in_hex() {
    let simulation = Simulation::new("-v --count 2");
    let mut client = open(&simulation.path);
    ask(&mut client, &loopback(17), &loopback(17));
    let refused = [0x11, 0x83, 2];
    let refused = [&refused[..], &check(&refused)].concat();
    let body = [0x11, 3, 0xFF, 0xF0, 0, 1];
    ask(&mut client, &[&body[..], &check(&body)].concat(), &refused);
    let expected = "\
asked: unit 17, function 08 (Diagnostics) 0000
answered: unit 17, function 08 (Diagnostics) done
asked: unit 17, function 03 (Read Holding Registers) 0xFFF0+1
answered: unit 17, exception 02 (ILLEGAL DATA ADDRESS) to function 03 (Read Holding Registers)
2 requests (function 03: 1, 08: 1), 1 answer, 1 exception (02: 1)
";
    assert_eq!(simulation.ended(), Ended::with(0, expected));

    let simulation = Simulation::new("-vv --count 1");
    let mut client = open(&simulation.path);
    ask(&mut client, &loopback(17), &loopback(17));
    let end = simulation.ended();
    let lines: Vec<&str> = end
        .stderr
        .lines()
        .filter(|line| line.contains(" ms "))
        .collect();
    let hex = "11 08 00 00 00 00 E2 9B";
    assert_eq!(lines.len(), 2);
    assert!(
        lines[0].starts_with("< ") && lines[0].ends_with(hex),
        "{lines:?}"
    );
    assert!(
        lines[1].starts_with("> ") && lines[1].ends_with(hex),
        "{lines:?}"
    );
}

#[test]
fn faults_spoil_answers_and_are_counted() {
    let rules = free_path("faults-script.txt");
    fs::write(&rules, "# the second one\n\nexception=6,on=2\n").unwrap();
    let script = rules.display();
    let simulation = Simulation::new(&format!("--fault crc,on=1 --fault-script {script}"));
    let mut client = open(&simulation.path);
    let mut spoiled = loopback(17);
    spoiled[6] ^= 0xFF;
    spoiled[7] ^= 0xFF;
    ask(&mut client, &loopback(17), &spoiled);
    let busy = [17, 0x88, 6];
    ask(
        &mut client,
        &loopback(17),
        &[&busy[..], &check(&busy)].concat(),
    );
    ask(&mut client, &loopback(17), &loopback(17));
    let expected = "3 requests (function 08: 3), 1 answer, 1 exception (06: 1), 1 spoiled\n\
                    faults: crc 1, exception 1\n";
    assert_eq!(simulation.stop("INT"), Ended::by(2, expected));
    fs::remove_file(rules).unwrap();
}

#[test]
fn a_pty_that_has_hung_up_is_there_again_under_its_name() {
    let path = free_path("hanging-meter");
    let name = path.display();
    let simulation = Simulation::new(&format!("--port {name} --fault hang-up=before,on=1"));
    let output = simulation
        .reading("-a 17 0 -f csv --retries 0 -t 100ms")
        .output();
    assert_eq!(output.status.code(), Some(3));
    assert_eq!(values(&simulation.reading("-a 17 0 -f csv")), ["65"]);
    let expected = "2 requests (function 03: 2), 1 answer\nfaults: hang-up 1\n";
    assert_eq!(simulation.stop("INT"), Ended::by(2, expected));
    assert!(path.symlink_metadata().is_err());
}

#[test]
fn a_serial_port_is_served_until_it_is_lost() {
    let (mut client, other, path) = pair().unwrap();
    let simulation = Simulation::new(&format!("--port {path} -b 19200 -P even"));
    assert_eq!(simulation.path, path);
    for unit in [1, 2, 3, 17] {
        ask(&mut client, &loopback(unit), &loopback(unit));
    }
    drop((client, other));
    let end = simulation.ended();
    assert_eq!(end.code, Some(3));
    let expected = format!("4 requests (function 08: 4), 4 answers\nerror: port {path} was lost\n");
    assert!(end.stderr.starts_with(&expected), "{}", end.stderr);
}

#[test]
fn the_variable_that_names_a_port_has_no_say() {
    let program = Program::new("simulate").variable("METERPOLL_PORT", "/nonexistent/port");
    let simulation = Simulation::start(&program);
    assert!(simulation.path.starts_with("/dev"));
}

#[test]
fn a_name_that_leads_elsewhere_by_now_is_left_alone() {
    let path = free_path("taken-meter");
    let pty = Pty::named(&path).unwrap();
    fs::remove_file(&path).unwrap();
    symlink("/dev/null", &path).unwrap();
    drop(pty);
    assert_eq!(fs::read_link(&path).unwrap(), Path::new("/dev/null"));
    fs::remove_file(path).unwrap();
}

const HINT: &str = "hint: a pty needs a name that is free; a simulation that was killed leaves its \
                    own behind: remove it when none runs there any more\n";

#[test]
fn a_link_that_was_left_does_not_make_somebodys_terminal_a_line() {
    let path = free_path("stale-meter");
    let (_ours, theirs, terminal) = pair().unwrap();
    symlink(&terminal, &path).unwrap();
    let mut settings = tcgetattr(&theirs).unwrap();
    settings.local_modes |= LocalModes::ECHO | LocalModes::ICANON;
    tcsetattr(&theirs, OptionalActions::Now, &settings).unwrap();
    let name = path.display();
    Program::new(&format!("simulate --port {name}"))
        .code(3)
        .stderr(format!(
            "error: {name} exists already, as a link to a pty\n{HINT}"
        ))
        .run();
    let modes = tcgetattr(&theirs).unwrap().local_modes;
    assert_eq!(modes, settings.local_modes);
    assert!(serialport::new(&terminal, 9600).open_native().is_ok());
    assert_eq!(fs::read_link(&path).unwrap(), Path::new(&terminal));
    fs::remove_file(path).unwrap();
}

#[test]
fn what_others_left_is_never_written_over() {
    let path = free_path("left-meter");
    symlink("/nonexistent", &path).unwrap();
    let name = path.display();
    Program::new(&format!("simulate --port {name}"))
        .code(3)
        .stderr(format!(
            "error: {name} exists already, as a link that leads nowhere\n\
             {HINT}"
        ))
        .run();
    fs::remove_file(&path).unwrap();
    fs::write(&path, "precious").unwrap();
    Program::new(&format!("simulate --port {name} -q"))
        .code(3)
        .stderr(format!("error: {name} exists already, as a file\n"))
        .run();
    assert_eq!(fs::read_to_string(&path).unwrap(), "precious");
    fs::remove_file(path).unwrap();
}

/// Whether an ordinary user can open a port; root can open what is locked as well.
#[cfg(target_os = "linux")]
fn opens_for_anybody(path: &str) -> bool {
    let mut shell = Command::new("/bin/sh");
    shell
        .args(["-c", "exec 3<>\"$0\"", path])
        .stderr(Stdio::null());
    if fs::metadata("/proc/self").is_ok_and(|own| own.uid() == 0) {
        shell.uid(65534).gid(65534);
    }
    shell.current_dir("/").status().expect("a shell").success()
}

#[cfg(target_os = "linux")]
#[test]
fn a_lock_that_a_client_leaves_behind_goes_when_it_has_gone() {
    let mut pty = Pty::new().unwrap();
    let path = pty.path();
    fs::set_permissions(&path, fs::Permissions::from_mode(0o666)).unwrap();
    assert!(opens_for_anybody(&path));
    let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC;
    let client = rustix::fs::open(&path, flags, Mode::empty()).unwrap();
    ioctl_tiocexcl(&client).unwrap();
    let hear = |pty: &mut Pty| drop(pty.hear(Duration::from_millis(50)));
    hear(&mut pty);
    assert!(!opens_for_anybody(&path));
    drop(client);
    // Another test that forks just now holds the client's end open for a moment.
    let goes = (0..200).any(|_| {
        hear(&mut pty);
        opens_for_anybody(&path)
    });
    assert!(goes);
}
