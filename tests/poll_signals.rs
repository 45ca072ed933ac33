//! `poll` while signals come at any moment: rows stay whole, the exit code says which signal it was,
//! and after a SIGKILL the next run goes on with a file in order.
//!
//! `METERPOLL_ROUNDS` says how often what is left to chance is tried.

#![cfg(unix)]

mod support {
    pub(crate) mod counting;
    pub(crate) mod folder;
    pub(crate) mod program;
    pub(crate) mod pty;
    pub(crate) mod rounds;
    pub(crate) mod waiting;
}

use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::process::{Child, ExitStatus, Stdio};
use std::time::Duration;

use support::counting::{HEADER, are_without_gap, counting, counts, poll};
use support::folder::Folder;
use support::program::kill;
use support::pty::PtyMeter;
use support::rounds::rounds;
use support::waiting::wait_until;

/// Under way, and appending to `rows.csv`.
fn start(meter: &PtyMeter, folder: &Folder) -> Child {
    let run = poll(meter, "--every 20ms --wait 60s -q --no-sync -o rows.csv");
    let mut command = run.folder(folder.path()).command();
    command.stderr(Stdio::null()).spawn().unwrap()
}

/// The exit code as a shell shows it.
fn code(status: ExitStatus) -> Option<i32> {
    status.code().or(status.signal().map(|signal| 128 + signal))
}

/// What is in the file when it is there and nobody writes.
fn text(folder: &Folder) -> String {
    fs::read_to_string(folder.file("rows.csv")).unwrap_or_default()
}

#[test]
fn signals_at_any_moment_leave_whole_rows_and_are_told_by_the_exit_code() {
    let folder = Folder::new("poll_signals");
    let meter = counting();
    let mut chance = fastrand::Rng::with_seed(66);
    for _ in 0..rounds(24) {
        let mut run = start(&meter, &folder);
        std::thread::sleep(Duration::from_micros(chance.u64(0..60_000)));
        // A window that changes its size ends nothing.
        for _ in 0..chance.usize(0..3) {
            kill(&run, "WINCH");
        }
        let (signal, expected) = [("INT", 130), ("TERM", 143)][chance.usize(0..2)];
        kill(&run, signal);
        assert_eq!(code(run.wait().unwrap()), Some(expected));
        let text = text(&folder);
        if !text.is_empty() {
            // The row in hand was finished each time: all that was asked is there.
            let found = counts(&text);
            assert!(are_without_gap(&found), "{found:?}");
            assert_eq!(found.len(), meter.requests().len());
        }
    }
    assert!(text(&folder).starts_with(HEADER));
}

#[test]
fn neither_a_change_of_the_window_s_size_nor_a_hang_up_without_a_terminal_ends_a_poll() {
    let folder = Folder::new("poll_window");
    let meter = counting();
    let mut run = start(&meter, &folder);
    wait_until(|| text(&folder).lines().count() > 2);
    kill(&run, "WINCH");
    // As whoever has renamed the file sends it.
    kill(&run, "HUP");
    let before = text(&folder).lines().count();
    wait_until(|| text(&folder).lines().count() > before + 2);
    kill(&run, "TERM");
    assert_eq!(code(run.wait().unwrap()), Some(143));
    assert!(are_without_gap(&counts(&text(&folder))));
}

#[test]
fn a_poll_that_is_killed_at_any_moment_leaves_one_torn_line_at_the_most_which_the_next_repairs() {
    let folder = Folder::new("poll_killed");
    let meter = counting();
    let mut chance = fastrand::Rng::with_seed(67);
    let mut whole = Vec::new();
    for round in 0..rounds(24) {
        let mut run = start(&meter, &folder);
        std::thread::sleep(Duration::from_micros(chance.u64(0..60_000)));
        run.kill().unwrap();
        run.wait().unwrap();
        let mut text = text(&folder);
        // A kill hardly ever leaves half a line; a power cut does.
        if round % 4 == 3 && text.len() > HEADER.len() {
            let cut = chance.usize(1..20).min(text.len() - HEADER.len());
            text.truncate(text.len() - cut);
            folder.write("rows.csv", &text);
            // That may be a whole row.
            whole.pop();
        }
        let output = poll(&meter, "--once --wait 60s -o rows.csv")
            .folder(folder.path())
            .output();
        assert_eq!(output.status.code(), Some(0));
        let is_torn = !text.is_empty() && !text.ends_with('\n');
        let told = String::from_utf8(output.stderr).unwrap();
        assert_eq!(!told.is_empty(), is_torn, "{told}");
        // Each row is there once, in its order, and none that was there has gone.
        let found = counts(&folder.read("rows.csv"));
        assert!(found.is_sorted_by(|a, b| a < b), "{found:?}");
        assert!(found.starts_with(&whole), "{found:?} after {whole:?}");
        assert_eq!(
            found.last().copied().map(usize::from),
            Some(meter.requests().len())
        );
        whole = found;
    }
}
