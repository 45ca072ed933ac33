//! Two programs and one port: who comes second waits or is told who holds it, and never gets in
//! the way of the first.

#![cfg(target_os = "linux")]

mod support {
    pub(crate) mod program;
    pub(crate) mod pty;
    pub(crate) mod waiting;
}

use std::fs::{self, OpenOptions, Permissions};
use std::io::{BufRead, BufReader, Read};
use std::os::unix::fs::{MetadataExt, PermissionsExt};
use std::os::unix::process::CommandExt;
use std::process::{Child, Command, Output, Stdio};
use std::sync::mpsc::channel;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use meterpoll::transport::holder::{self, Holder, Holders};
use meterpoll::transport::serial::Serial;
use meterpoll::transport::{LineSettings, OpenError, Transport};
use rustix::termios::ioctl_tiocnxcl;

use support::program::Program;
use support::pty::{self, PtyMeter};
use support::waiting::wait_until;

/// A process that is being started has for a moment everything open that the test has, so one test
/// at a time looks for who has a port open.
fn alone() -> MutexGuard<'static, ()> {
    static ALONE: Mutex<()> = Mutex::new(());
    ALONE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A process as messages name it.
fn named(process: u32) -> String {
    let name = fs::read_to_string(format!("/proc/{process}/comm")).expect("it runs");
    format!("{} (process {process})", name.trim_end())
}

/// Several, by their numbers.
fn all_named<const N: usize>(mut processes: [u32; N]) -> String {
    processes.sort_unstable();
    processes.map(named).join(" and ")
}

fn read(port: &str, more: &str) -> Program {
    Program::new(&format!("read-registers -p {port} -a 1 5 -f csv {more}"))
}

fn in_use(port: &str, holders: &str) -> String {
    format!(
        "error: port {port} is in use by {holders}\nhint: --wait 30s waits longer for it to end\n"
    )
}

const ROW: &str = "time,meter,unit_id,status,0x0005\n<time>,,1,ok,38\n";

/// Whether a program that knows of no lock, and is not root's, can open the port.
fn is_open_to_others(meter: &PtyMeter) -> bool {
    fs::set_permissions(meter.path(), Permissions::from_mode(0o666)).expect("our own pty");
    let mut command = Command::new("sh");
    command.args(["-c", &format!("exec 3<>{}", meter.path())]);
    if fs::metadata("/proc/self").is_ok_and(|own| own.uid() == 0) {
        command.uid(65534).gid(65534).current_dir("/");
    }
    let output = command.output().expect("there is a shell");
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(
        output.status.success() || stderr.contains("busy"),
        "{stderr}"
    );
    output.status.success()
}

/// Starts the program on a port and waits until the meter there has been asked.
fn start(program: &Program, meter: &PtyMeter) -> Running {
    let asked = meter.requests().len();
    let child = program
        .command()
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let child = Running(Some(child));
    wait_until(|| meter.requests().len() > asked);
    child
}

/// A process that is killed when the test ends, however it ends: it has the meter's line open.
struct Running(Option<Child>);

impl Running {
    fn id(&self) -> u32 {
        self.0.as_ref().expect("it was not waited for").id()
    }

    /// Waits for its end.
    fn ended(mut self) -> Output {
        let child = self.0.take().expect("it was not waited for");
        child.wait_with_output().expect("it ends")
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        if let Some(child) = &mut self.0 {
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

#[test]
fn who_holds_a_port_is_named() {
    let _alone = alone();
    let meter = PtyMeter::healthy(1);
    let port = meter.path();
    let held = Serial::open(port, LineSettings::default()).expect("nobody else has it");
    let own = std::process::id();
    read(port, "--wait 0s")
        .code(3)
        .stderr(in_use(port, &named(own)))
        .run();
    // By whatever name the port goes.
    let link = format!("{}/port", env!("CARGO_TARGET_TMPDIR"));
    let _ = fs::remove_file(&link);
    std::os::unix::fs::symlink(port, &link).expect("a link can be made");
    read(&link, "--wait 0s -q")
        .code(3)
        .stderr(format!("error: port {link} is in use by {}\n", named(own)))
        .run();
    assert_eq!(meter.requests().len(), 0);
    drop(held);
    read(&link, "-t 60s").stdout(ROW).run();
}

#[test]
fn several_programs_that_have_a_port_open_are_all_named() {
    let _alone = alone();
    let meter = PtyMeter::healthy(1);
    let port = meter.path();
    let file = OpenOptions::new().read(true).open(port).expect("our pty");
    file.try_lock().expect("nobody else has it");
    let beside = file.try_clone().expect("a file can be cloned");
    let sleeping = Command::new("sleep").arg("600").stdin(beside).spawn();
    let sleeping = Running(Some(sleeping.expect("sleep is there")));
    wait_until(|| named(sleeping.id()).starts_with("sleep "));
    let holders = all_named([std::process::id(), sleeping.id()]);
    read(port, "--wait 0s")
        .code(3)
        .stderr(in_use(port, &holders))
        .run();
    drop(sleeping);
}

#[test]
fn a_holder_that_cannot_be_seen_is_said_to_be_perhaps_another_users() {
    let error = OpenError::Busy {
        port: "/dev/null/nothing".to_owned(),
        holders: Holders::Unseen,
    };
    assert_eq!(
        error.to_string(),
        "port /dev/null/nothing is in use by another program (of another user, perhaps)"
    );
    // Nothing is said of a port that cannot be followed to its device.
    assert_eq!(
        error.with_holders().to_string(),
        "port /dev/null/nothing is in use by another program"
    );
    // Something that nobody has open.
    let unused = concat!(env!("CARGO_TARGET_TMPDIR"), "/unused");
    fs::write(unused, "").expect("the folder for tests is writable");
    assert_eq!(holder::of(unused), Holders::Unseen);
}

#[test]
fn of_many_holders_three_are_named() {
    let holders = |count: u32| {
        let holders = (1..=count).map(|process| Holder {
            name: "a".to_owned(),
            process,
        });
        Holders::Seen(holders.collect()).to_string()
    };
    assert_eq!(holders(1), "a (process 1)");
    assert_eq!(holders(2), "a (process 1) and a (process 2)");
    assert_eq!(holders(3), "a (process 1), a (process 2) and a (process 3)");
    assert_eq!(
        holders(5),
        "a (process 1), a (process 2), a (process 3) and 2 more"
    );
}

#[test]
fn the_second_of_two_runs_waits_for_the_first() {
    let _alone = alone();
    let (go, wait) = channel::<()>();
    // It answers once it is told to, and from then on at once.
    let meter = PtyMeter::new(Box::new(move |request| {
        let _ = wait.recv();
        pty::answer(1, request).unwrap_or_default()
    }));
    let port = meter.path();
    let first = start(&read(port, "-t 60s"), &meter);
    let second = read(port, "-t 60s --wait 60s -v").command();
    let mut second = { second }
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let mut said = BufReader::new(second.stderr.take().expect("it is piped"));
    let mut line = String::new();
    said.read_line(&mut line).expect("text");
    assert_eq!(line, format!("port {port} is in use, waiting for it\n"));
    assert_eq!(second.try_wait().expect("our own child"), None);
    assert_eq!(meter.requests().len(), 1);
    drop(go);
    for run in [first, Running(Some(second))] {
        let output = run.ended();
        let stdout = String::from_utf8(output.stdout).expect("CSV is text");
        assert_eq!(support::program::without_times(&stdout), ROW);
        assert_eq!(output.status.code(), Some(0));
    }
    let mut rest = String::new();
    said.read_to_string(&mut rest).expect("text");
    assert!(rest.starts_with(&format!("opened {port} at")), "{rest}");
}

#[test]
fn the_second_of_two_runs_ends_with_3_when_the_first_goes_on() {
    let _alone = alone();
    let meter = PtyMeter::new(Box::new(|_| Vec::new()));
    let port = meter.path();
    let first = start(&read(port, "-t 1h"), &meter);
    // The test has the other end of the pair, and this one beside the client.
    let holders = all_named([std::process::id(), first.id()]);
    assert!(holders.contains("meterpoll (process "), "{holders}");
    let start = Instant::now();
    read(port, "--wait 300ms")
        .code(3)
        .stderr(in_use(port, &holders))
        .run();
    assert!(start.elapsed() >= Duration::from_millis(300));
    assert_eq!(meter.requests().len(), 1);
    drop(first);
}

#[test]
fn many_runs_at_once_all_get_their_turn() {
    let _alone = alone();
    let meter = PtyMeter::healthy(1);
    let runs: Vec<Child> = (0..12)
        .map(|_| {
            read(meter.path(), "-t 60s --wait 60s")
                .command()
                .stdout(Stdio::piped())
                .stderr(Stdio::piped())
                .spawn()
                .expect("the program starts")
        })
        .collect();
    for run in runs {
        let output = run.wait_with_output().expect("it ends");
        let stdout = String::from_utf8(output.stdout).expect("CSV is text");
        assert_eq!(String::from_utf8_lossy(&output.stderr), "");
        assert_eq!(support::program::without_times(&stdout), ROW);
        assert_eq!(output.status.code(), Some(0));
    }
    assert_eq!(meter.requests().len(), 12);
}

#[test]
fn a_holder_that_is_killed_leaves_no_lock() {
    let _alone = alone();
    // Silent to the first run, which is killed over it.
    let mut asked = 0;
    let meter = PtyMeter::new(Box::new(move |request| {
        asked += 1;
        pty::answer(1, request)
            .filter(|_| asked > 1)
            .unwrap_or_default()
    }));
    let first = start(&read(meter.path(), "-t 1h"), &meter);
    drop(first);
    // The system takes the exclusive mode back when the last one closes a port; here the test has
    // it open still.
    ioctl_tiocnxcl(meter.client_end()).expect("our own pty");
    read(meter.path(), "-t 60s --wait 0s").stdout(ROW).run();
}

#[test]
fn who_comes_second_does_not_open_the_port_to_others() {
    let _alone = alone();
    let meter = PtyMeter::healthy(1);
    let held = Serial::open(meter.path(), LineSettings::default()).expect("nobody else has it");
    assert!(!is_open_to_others(&meter));
    let second = Serial::open(meter.path(), LineSettings::default());
    assert!(matches!(second, Err(OpenError::Busy { .. })));
    assert_eq!(
        read(meter.path(), "--wait 200ms").output().status.code(),
        Some(3)
    );
    assert!(!is_open_to_others(&meter));
    drop(held);
    assert!(is_open_to_others(&meter));
}

#[test]
fn a_port_that_was_opened_to_others_is_held_again_from_the_next_request() {
    let _alone = alone();
    let meter = PtyMeter::healthy(1);
    let mut held = Serial::open(meter.path(), LineSettings::default()).expect("nobody else has it");
    // As other programs on the same library do it to one another when root runs them.
    ioctl_tiocnxcl(meter.client_end()).expect("our own pty");
    assert!(is_open_to_others(&meter));
    held.send(&[0]).expect("the line is open");
    assert!(!is_open_to_others(&meter));
}

#[test]
fn a_port_that_is_closed_after_a_failed_open_stays_usable() {
    let _alone = alone();
    let meter = PtyMeter::healthy(1);
    let port = meter.path();
    let mut first = Serial::open(port, LineSettings::default()).expect("nobody else has it");
    for _ in 0..3 {
        assert!(Serial::open(port, LineSettings::default()).is_err());
        first.reopen().expect("nobody else has it");
    }
    drop(first);
    read(port, "-t 60s --wait 0s").stdout(ROW).run();
}
