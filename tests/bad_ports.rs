//! Ports that cannot be opened: which of the many reasons it is, what to do about it, and exit
//! code 3.

#![cfg(unix)]

mod support {
    pub(crate) mod program;
    pub(crate) mod pty;
}

use std::fs;
use std::io::ErrorKind;
use std::os::unix::fs::{MetadataExt, PermissionsExt};
use std::os::unix::process::CommandExt;
use std::path::PathBuf;
use std::process::{Command, Output};
use std::time::{Duration, Instant};

use support::program::Program;
use support::pty::PtyMeter;

#[test]
fn a_directory_or_a_file_is_no_port() {
    Program::new("read-registers -p /tmp -a 1 0")
        .code(3)
        .stderr(
            "error: port /tmp is a directory, not a serial port\n\
             hint: `meterpoll ports` lists the ports\n",
        )
        .run();
    Program::new("read-registers -p /etc/passwd -a 1 0")
        .code(3)
        .stderr(
            "error: port /etc/passwd is a file, not a serial port\n\
             hint: `meterpoll ports` lists the ports\n",
        )
        .run();
    Program::new("read-registers -p /dev/null -a 1 0")
        .code(3)
        .stderr(
            "error: port /dev/null is a device without line settings, not a serial port\n\
             hint: `meterpoll ports` lists the ports\n",
        )
        .run();
}

#[test]
fn a_port_that_is_not_there_says_so() {
    Program::new("read-registers -p /dev/ttyNOWHERE -a 1 0")
        .code(3)
        .stderr(
            "error: port /dev/ttyNOWHERE is not there\n\
             hint: `meterpoll ports` lists the ports; plugging an adapter in shows a new one (a \
             program such as brltty can take it away again)\n",
        )
        .run();
}

#[test]
fn a_port_that_is_not_permitted_names_its_group_and_the_user() {
    let meter = PtyMeter::healthy(1);
    fs::set_permissions(meter.path(), fs::Permissions::from_mode(0o000)).expect("our own pty");
    let program = Program::new(&format!("read-registers -p {} -a 1 0", meter.path()));
    // Root may open anything, so as root the program runs as nobody.
    let is_root = fs::metadata("/proc/self").is_ok_and(|own| own.uid() == 0);
    let output = if is_root {
        output_as_nobody(&program.command())
    } else {
        program.output()
    };
    let stderr = String::from_utf8(output.stderr).expect("text");
    assert_eq!(output.status.code(), Some(3), "{stderr}");
    assert!(output.stdout.is_empty());
    let owner = stderr
        .strip_prefix(&format!(
            "error: port {} is not permitted: it belongs to ",
            meter.path()
        ))
        .expect(&stderr);
    assert!(stderr.contains(", and user "), "{stderr}");
    // The group of a pty need not have a name.
    assert!(
        owner.starts_with("group ") || owner.starts_with("an unknown group, "),
        "{stderr}"
    );
    // Its mode lets no group in, so there is none to join.
    assert!(
        stderr.ends_with("\nhint: an administrator or a udev rule must let you use it\n"),
        "{stderr}"
    );
}

/// A file that is removed when the test ends, however it ends.
struct Temporary(PathBuf);

impl Drop for Temporary {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.0);
    }
}

/// Runs a copy of the program as nobody, from a folder that nobody reaches.
fn output_as_nobody(command: &Command) -> Output {
    let name = format!("meterpoll-nobody-{}", std::process::id());
    let copy = Temporary(std::env::temp_dir().join(name));
    fs::copy(command.get_program(), &copy.0).expect("a copy for nobody");
    let mut as_nobody = Command::new(&copy.0);
    as_nobody
        .args(command.get_args())
        .uid(65534)
        .gid(65534)
        .current_dir("/");
    let start = Instant::now();
    loop {
        match as_nobody.output() {
            // Another test that forks just now holds the copy open for a moment.
            Err(error)
                if error.kind() == ErrorKind::ExecutableFileBusy
                    && start.elapsed() < Duration::from_secs(30) =>
            {
                std::thread::sleep(Duration::from_millis(5));
            }
            result => return result.expect("the program starts"),
        }
    }
}
