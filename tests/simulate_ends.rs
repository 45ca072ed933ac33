//! How `simulate` begins and ends: what it says to a terminal, and what a closed window leaves.

#![cfg(unix)]

mod support {
    pub(crate) mod program;
    pub(crate) mod pty;
    pub(crate) mod simulation;
}

use std::fs::{self, File};
use std::io::{BufRead, BufReader};
use std::process::Stdio;

use support::program::Program;
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
