//! How `simulate` begins and ends: what it says to a terminal, and what a closed window leaves.

#![cfg(unix)]

mod support {
    pub(crate) mod program;
    pub(crate) mod pty;
    pub(crate) mod simulation;
}

use std::fs::{self, File};
use std::io::{BufRead, BufReader};
#[cfg(target_os = "linux")]
use std::os::unix::process::ExitStatusExt;
use std::process::{Command, Stdio};

use support::program::Program;
#[cfg(target_os = "linux")]
use support::program::binary;
use support::pty::pair;
use support::simulation::{Ended, Simulation, free_path};

#[test]
fn a_terminal_is_told_in_three_lines() {
    let (ours, theirs, _path) = pair().unwrap();
    let path = free_path("told-meter");
    let name = path.display();
    let arguments = format!("simulate --port {name} --meter em24=3 --meter pqm=17,18");
    let mut child = Program::new(&arguments)
        .command()
        .stdout(Stdio::null())
        .stderr(File::from(theirs.try_clone().unwrap()))
        .spawn()
        .unwrap();
    let lines = BufReader::new(ours).lines().take(3);
    let lines: Vec<String> = lines.map(Result::unwrap).collect();
    child.kill().unwrap();
    child.wait().unwrap();
    assert_eq!(
        lines,
        [
            "em24 at unit 3; pqm at units 17, 18".to_owned(),
            format!("read it: meterpoll read-registers -p {name} -a 18 --meter pqm"),
            "end it: Ctrl-C".to_owned(),
        ]
    );
    fs::remove_file(path).unwrap();
}

#[cfg(target_os = "linux")]
#[test]
fn an_error_at_the_start_is_followed_by_no_counts() {
    let path = free_path("full-meter");
    let full = File::options().write(true).open("/dev/full").unwrap();
    let arguments = format!("simulate --port {}", path.display());
    let output = Program::new(&arguments).command().stdout(full).output();
    let output = output.unwrap();
    assert_eq!(
        String::from_utf8(output.stderr).unwrap(),
        "error: the output cannot be written\n  \
           because: No space left on device (os error 28)\n"
    );
    assert_eq!(output.status.code(), Some(7));
    assert!(path.symlink_metadata().is_err());
}

#[test]
fn a_port_that_is_lost_before_anything_was_asked_is_followed_by_no_counts() {
    let (client, other, path) = pair().unwrap();
    let simulation = Simulation::new(&format!("--port {path}"));
    drop((client, other));
    let end = simulation.ended();
    assert_eq!(end.code, Some(3));
    let expected = format!("error: port {path} was lost\n");
    assert!(end.stderr.starts_with(&expected), "{}", end.stderr);
    assert!(!end.stderr.contains("0 requests"), "{}", end.stderr);
}

/// Whether whoever runs the tests wants what it starts to outlive a closed window.
fn hang_ups_are_ignored_here() -> bool {
    let mut shell = Command::new("/bin/sh");
    let status = shell.args(["-c", "kill -s HUP $$"]).status();
    status.expect("a shell").success()
}

#[test]
fn a_closed_window_ends_it_as_a_key_does() {
    if hang_ups_are_ignored_here() {
        return;
    }
    let path = free_path("closed-meter");
    let arguments = format!("--port {}", path.display());
    for _ in 0..2 {
        let simulation = Simulation::new(&arguments);
        assert_eq!(
            simulation.stop("HUP"),
            Ended::by(1, "0 requests, 0 answers\n")
        );
        assert!(path.symlink_metadata().is_err());
    }
}

#[cfg(target_os = "linux")]
#[test]
fn what_is_to_outlive_its_window_does() {
    let mut child = Command::new("/bin/sh")
        .args(["-c", "trap '' HUP; exec \"$0\" simulate --meter pqm"])
        .arg(binary())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut first = String::new();
    let mut stdout = BufReader::new(child.stdout.take().unwrap());
    stdout.read_line(&mut first).unwrap();
    let send = |signal: &str| {
        let pid = child.id().to_string();
        let status = Command::new("kill").args(["-s", signal, &pid]).status();
        assert!(status.unwrap().success());
    };
    send("HUP");
    let reading = format!("read-registers -p {} -a 17 --meter pqm", first.trim_end());
    let reading = Program::new(&format!("{reading} product_code -b 115200 -q"));
    assert_eq!(reading.output().status.code(), Some(0));
    send("TERM");
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.signal(), Some(15));
    assert_eq!(
        String::from_utf8(output.stderr).unwrap(),
        "1 request (function 03: 1), 1 answer\n"
    );
}
