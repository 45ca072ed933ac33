//! `poll` on a port that is lost and comes back, and beside a meter that is off for a while.

#![cfg(unix)]

mod support {
    pub(crate) mod folder;
    pub(crate) mod program;
    pub(crate) mod pty;
    pub(crate) mod waiting;
}

use std::fs;
use std::io::Read;
use std::process::{Child, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use support::folder::Folder;
use support::program::{Program, kill, without_times};
use support::pty::{PtyMeter, answer};
use support::waiting::wait_until;

/// Two lines, of which one has a name that stays.
const SITE: &str = r#"
[defaults]
every = "50ms"
timeout = "500ms"
retries = 0

[[lines]]
name = "first"
port = "PORT"

[[lines]]
name = "second"
port = "OTHER"

[[meters]]
name = "main"
line = "first"
unit = 17
points = ["0x0005"]

[[meters]]
name = "other"
line = "second"
unit = 18
points = ["0x0005"]

[[outputs]]
name = "log"
path = "{meter}.csv"
"#;

/// A poll of that site, under way.
struct Poll {
    child: Child,
    folder: Folder,
}

impl Poll {
    fn start(name: &str, first: &PtyMeter, second: &PtyMeter) -> Self {
        let folder = Folder::new(name);
        let poll = |folder: &Folder| folder.file("port").display().to_string();
        let site = SITE.replace("PORT", &poll(&folder));
        folder.write("site.toml", site.replace("OTHER", second.path()));
        connect(&folder, first);
        let mut command = Program::new("poll --config site.toml -q")
            .folder(folder.path())
            .command();
        let child = command.stderr(Stdio::piped()).spawn().unwrap();
        Self { child, folder }
    }

    /// The statuses of a meter's rows so far.
    fn statuses(&self, meter: &str) -> Vec<String> {
        let text = fs::read_to_string(self.folder.file(&format!("{meter}.csv")));
        let text = text.unwrap_or_default();
        let rows = text.lines().skip(1);
        let status = rows.filter_map(|row| row.split(',').nth(3));
        status.map(str::to_owned).collect()
    }

    fn wait_for(&self, meter: &str, statuses: &[&str]) {
        wait_until(|| {
            let mut found = self.statuses(meter);
            found.dedup();
            found == statuses
        });
    }

    /// Stops it; what it has said.
    fn stop(&mut self) -> String {
        kill(&self.child, "TERM");
        let mut told = String::new();
        let stderr = self.child.stderr.as_mut().unwrap();
        stderr.read_to_string(&mut told).unwrap();
        self.child.wait().unwrap();
        without_times(&told)
    }
}

/// Puts a meter behind the name.
fn connect(folder: &Folder, meter: &PtyMeter) {
    let new = folder.file("new");
    std::os::unix::fs::symlink(meter.path(), &new).unwrap();
    fs::rename(&new, folder.file("port")).unwrap();
}

#[test]
fn a_lost_port_costs_its_own_rows_and_is_read_again_when_it_is_back() {
    let mut first = PtyMeter::healthy(17);
    let second = PtyMeter::healthy(18);
    let mut poll = Poll::start("poll_lost_port", &first, &second);
    poll.wait_for("main", &["ok"]);
    first.hang_up();
    poll.wait_for("main", &["ok", "port"]);
    let third = PtyMeter::healthy(17);
    connect(&poll.folder, &third);
    poll.wait_for("main", &["ok", "port", "ok"]);
    let port = poll.folder.file("port").display().to_string();
    let told = poll.stop();
    let error = format!(
        "error: main, unit 17 on {port} at 9600 8N1, registers 0x0005+1: port {port} was lost"
    );
    assert!(told.starts_with(&error), "{told}");
    assert_eq!(told.matches("error: ").count(), 1, "{told}");
    let mut others = poll.statuses("other");
    others.dedup();
    assert_eq!(others, ["ok"]);
}

#[test]
fn a_meter_that_is_off_for_a_while_is_told_once_and_read_again() {
    let is_off = Arc::new(AtomicBool::new(false));
    let switch = Arc::clone(&is_off);
    let first = PtyMeter::new(Box::new(move |request| {
        if switch.load(Ordering::SeqCst) {
            return Vec::new();
        }
        answer(17, request).unwrap_or_default()
    }));
    let second = PtyMeter::healthy(18);
    let mut poll = Poll::start("poll_dead_meter", &first, &second);
    poll.wait_for("main", &["ok"]);
    is_off.store(true, Ordering::SeqCst);
    wait_until(|| {
        poll.statuses("main")
            .iter()
            .filter(|s| *s == "timeout")
            .count()
            > 1
    });
    is_off.store(false, Ordering::SeqCst);
    poll.wait_for("main", &["ok", "timeout", "ok"]);
    let port = poll.folder.file("port").display().to_string();
    let told: Vec<String> = poll.stop().lines().map(str::to_owned).collect();
    let error = format!(
        "error: main, unit 17 on {port} at 9600 8N1, registers 0x0005+1: no answer within 500ms"
    );
    // Slots were missed as well: a time-out is longer than the interval.
    let errors: Vec<&String> = told
        .iter()
        .filter(|line| line.starts_with("error"))
        .collect();
    assert_eq!(errors, [&error]);
    let mut others = poll.statuses("other");
    others.dedup();
    assert_eq!(others, ["ok"]);
}
