//! Files that are renamed, deleted, emptied or locked between rows, and what an appender makes of it.

#![cfg(unix)]

mod support {
    pub(crate) mod clock;
    pub(crate) mod folder;
}

use std::fs::{self, OpenOptions};
use std::io::Write;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use meterpoll::append::{AppendOptions, Appender, OnMisfit, Problem, Removed, Start, Syncing};
use meterpoll::transport::{Clock, SystemClock};
use support::clock::FakeClock;
use support::folder::Folder;

const OPTIONS: AppendOptions = AppendOptions {
    on_misfit: OnMisfit::Refuse,
    syncing: Syncing::Each,
    wait: Duration::from_secs(10),
};

fn start() -> Start {
    Start::Header(b"a,b".to_vec())
}

fn appender(path: impl Into<PathBuf>) -> Appender {
    Appender::new(path, start(), OPTIONS, Arc::new(SystemClock::new()))
}

/// Appends, where nothing is to be removed.
#[track_caller]
fn append(appender: &Appender, rows: &str) -> PathBuf {
    let mut tell = |file: &Path, removed: &Removed| panic!("{}: {removed}", file.display());
    let result = appender.append(rows.as_bytes(), &mut tell);
    result.unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn a_file_that_is_renamed_deleted_replaced_or_emptied_begins_anew() {
    let folder = Folder::new("append-rotated");
    let file = folder.file("rows.csv");
    let appender = appender(&file);
    append(&appender, "1,2\n");

    fs::rename(&file, folder.file("old.csv")).unwrap();
    append(&appender, "3,4\n");
    assert_eq!(folder.read("rows.csv"), "a,b\n3,4\n");

    fs::remove_file(&file).unwrap();
    append(&appender, "5,6\n");
    assert_eq!(folder.read("rows.csv"), "a,b\n5,6\n");

    folder.write("new.csv", "");
    fs::rename(folder.file("new.csv"), &file).unwrap();
    append(&appender, "7,8\n");
    assert_eq!(folder.read("rows.csv"), "a,b\n7,8\n");

    let emptied = OpenOptions::new().write(true).open(&file).unwrap();
    emptied.set_len(0).unwrap();
    append(&appender, "9,0\n");
    assert_eq!(folder.read("rows.csv"), "a,b\n9,0\n");

    assert_eq!(folder.read("old.csv"), "a,b\n1,2\n");
}

#[test]
fn a_folder_that_is_taken_away_is_made_again() {
    let folder = Folder::new("append-folders");
    let appender = appender(folder.file("one/two/rows.csv"));
    append(&appender, "1,2\n");
    fs::remove_dir_all(folder.file("one")).unwrap();
    append(&appender, "3,4\n");
    assert_eq!(folder.read("one/two/rows.csv"), "a,b\n3,4\n");
}

#[test]
fn rows_go_through_a_link_even_where_its_file_is_not_there_yet() {
    let folder = Folder::new("append-link");
    symlink("target.csv", folder.file("rows.csv")).unwrap();
    let appender = appender(folder.file("rows.csv"));
    appender.check().unwrap();
    append(&appender, "1,2\n");
    append(&appender, "3,4\n");
    assert_eq!(folder.read("target.csv"), "a,b\n1,2\n3,4\n");
}

#[test]
fn what_others_append_in_between_stays_and_a_tail_of_theirs_is_repaired() {
    let folder = Folder::new("append-others");
    let file = folder.file("rows.csv");
    let appender = appender(&file);
    append(&appender, "1,2\n");
    let mut other = OpenOptions::new().append(true).open(&file).unwrap();
    other.write_all(b"3,4\n5,").unwrap();
    let mut told = Vec::new();
    let mut tell = |file: &Path, removed: &Removed| told.push((file.to_owned(), removed.clone()));
    appender.append(b"7,8\n", &mut tell).unwrap();
    assert_eq!(folder.read("rows.csv"), "a,b\n1,2\n3,4\n7,8\n");
    let removed = Removed {
        bytes: 2,
        beginning: b"5,".to_vec(),
    };
    assert_eq!(told, [(file, removed)]);
}

#[test]
fn columns_that_change_while_it_runs_are_refused_or_left_to_a_new_file() {
    let folder = Folder::new("append-changed");
    let file = folder.file("rows.csv");
    let clock: Arc<dyn Clock> = Arc::new(SystemClock::new());
    let refusing = appender(&file);
    let numbering = Appender::new(
        &file,
        start(),
        AppendOptions {
            on_misfit: OnMisfit::NewFile,
            ..OPTIONS
        },
        clock,
    );
    assert_eq!(append(&numbering, "1,2\n"), file);
    folder.write("rows.csv", "a,c\n");
    let error = refusing.append(b"3,4\n", &mut |_, _| {}).unwrap_err();
    assert!(matches!(error.problem, Problem::Misfit(_)), "{error}");
    assert!(matches!(
        refusing.check().unwrap_err().problem,
        Problem::Misfit(_)
    ));
    assert_eq!(append(&numbering, "5,6\n"), folder.file("rows.2.csv"));
    assert_eq!(folder.read("rows.csv"), "a,c\n");
    assert_eq!(folder.read("rows.2.csv"), "a,b\n5,6\n");
}

#[test]
fn a_lock_that_others_hold_is_waited_for_and_then_told() {
    let folder = Folder::new("append-locked");
    folder.write("rows.csv", "a,b\n");
    let file = folder.file("rows.csv");
    let held = OpenOptions::new().append(true).open(&file).unwrap();
    held.lock().unwrap();
    let clock = Arc::new(FakeClock::new());
    let appender = Appender::new(&file, start(), OPTIONS, Arc::clone(&clock) as _);
    let error = appender.append(b"1,2\n", &mut |_, _| {}).unwrap_err();
    assert!(
        matches!(error.problem, Problem::Locked { waited } if waited == OPTIONS.wait),
        "{error}"
    );
    assert_eq!(
        error.to_string(),
        format!(
            "{}: another program has had it locked for 10 s",
            file.display()
        )
    );
    assert!((10_000..10_010).contains(&clock.now().as_millis()));
    assert!(matches!(
        appender.check().unwrap_err().problem,
        Problem::Locked { .. }
    ));
    assert_eq!(folder.read("rows.csv"), "a,b\n");
    held.unlock().unwrap();
    append(&appender, "1,2\n");
    assert_eq!(folder.read("rows.csv"), "a,b\n1,2\n");
}

/// Does something the first time that somebody waits.
struct Meanwhile<F: Fn() + Send + Sync>(FakeClock, F);

impl<F: Fn() + Send + Sync> Clock for Meanwhile<F> {
    fn now(&self) -> Duration {
        self.0.now()
    }

    fn sleep(&self, time: Duration) {
        if self.0.now().is_zero() {
            (self.1)();
        }
        self.0.sleep(time);
    }

    fn utc_now(&self) -> jiff::Timestamp {
        self.0.utc_now()
    }
}

#[test]
fn a_file_that_is_rotated_while_its_lock_is_waited_for_is_left_alone() {
    let folder = Folder::new("append-rotated-meanwhile");
    folder.write("rows.csv", "a,b\n");
    let file = folder.file("rows.csv");
    let held = OpenOptions::new().append(true).open(&file).unwrap();
    held.lock().unwrap();
    let rotate = {
        let (file, old) = (file.clone(), folder.file("old.csv"));
        move || {
            fs::rename(&file, &old).unwrap();
            held.unlock().unwrap();
        }
    };
    let clock = Arc::new(Meanwhile(FakeClock::new(), rotate));
    let appender = Appender::new(&file, start(), OPTIONS, clock);
    append(&appender, "1,2\n");
    assert_eq!(folder.read("old.csv"), "a,b\n");
    assert_eq!(folder.read("rows.csv"), "a,b\n1,2\n");
}

#[test]
fn a_check_changes_nothing_and_no_rows_are_no_work() {
    let folder = Folder::new("append-check");
    let torn = "a,b\n1,2\n3,";
    folder.write("rows.csv", torn);
    let there = appender(folder.file("rows.csv"));
    there.check().unwrap();
    append(&there, "");
    assert_eq!(folder.read("rows.csv"), torn);
    let not_there = appender(folder.file("one/two/rows.csv"));
    not_there.check().unwrap();
    append(&not_there, "");
    assert_eq!(folder.names(), ["rows.csv"]);
}

#[test]
fn a_new_file_has_the_rights_that_the_umask_leaves() {
    let folder = Folder::new("append-rights");
    folder.write("like", "");
    append(&appender(folder.file("rows.csv")), "1,2\n");
    let mode = |name: &str| {
        fs::metadata(folder.file(name))
            .unwrap()
            .permissions()
            .mode()
    };
    assert_eq!(mode("rows.csv"), mode("like"));
}
