//! `poll` and files that do not take its rows.

#![cfg(unix)]

mod support {
    pub(crate) mod folder;
    pub(crate) mod program;
    pub(crate) mod waiting;
}

use std::fs;
use std::io::{BufRead, BufReader, Lines, Write};
use std::process::{Child, ChildStderr, Stdio};

use rustix::fs::{OFlags, fcntl_getfl, fcntl_setfl};
use support::folder::Folder;
use support::program::{Program, kill, without_times};
use support::waiting::wait_until;

/// Two meters with a file each.
const SITE: &str = r#"
[defaults]
every = "100ms"

[[lines]]
name = "hall"
port = "sim:"

[[lines]]
name = "roof"
port = "sim:"

[[meters]]
name = "main"
line = "hall"
unit = 17
profile = "pqm"
points = ["ct_primary"]

[[meters]]
name = "other"
line = "roof"
unit = 17
profile = "pqm"
points = ["ct_primary"]

[[outputs]]
name = "log"
path = "{meter}.csv"
"#;

/// What a file holds that rows do not belong into.
const OTHER: &str = "a,b\n1,2\n";

/// A poll under way.
struct Poll {
    child: Child,
    told: Lines<BufReader<ChildStderr>>,
}

impl Poll {
    fn start(folder: &Folder, site: &str) -> Self {
        Self::run(folder, site, "poll -q --config site.toml")
    }

    fn run(folder: &Folder, site: &str, arguments: &str) -> Self {
        folder.write("site.toml", site);
        let mut command = Program::new(arguments).folder(folder.path()).command();
        let command = command.stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().unwrap();
        let told = BufReader::new(child.stderr.take().unwrap()).lines();
        Self { child, told }
    }

    /// The next line on stderr. On a machine that is busy slots may be missed, which is told too.
    fn next(&mut self) -> Option<String> {
        let told = self.told.by_ref().map(Result::unwrap);
        let mut told = told.filter(|line| !line.starts_with("warning: "));
        told.next().map(|line| without_times(&line))
    }

    /// Stops it; what it still says, and what it ends with.
    fn stop(mut self) -> (Vec<String>, Option<i32>) {
        kill(&self.child, "TERM");
        let told = std::iter::from_fn(|| self.next()).collect();
        (told, self.child.wait().unwrap().code())
    }
}

/// Puts something else in place of a file.
fn spoil(folder: &Folder, name: &str) {
    folder.write("spoilt", OTHER);
    fs::rename(folder.file("spoilt"), folder.file(name)).unwrap();
}

#[test]
fn at_the_end_the_rows_of_every_file_that_does_not_take_them_are_told() {
    let folder = Folder::new("poll_files_at_the_end");
    let mut poll = Poll::start(&folder, SITE);
    wait_until(|| folder.names() == ["main.csv", "other.csv", "site.toml"]);
    for name in ["main.csv", "other.csv"] {
        spoil(&folder, name);
    }
    for _ in 0..2 {
        let error = poll.next().unwrap();
        assert!(error.contains("it has other columns"), "{error}");
    }
    let (told, code) = poll.stop();
    assert_eq!(code, Some(7));
    for meter in ["main", "other"] {
        let error = format!("  because: {meter}.csv: it has other columns");
        let count = told.iter().filter(|line| line.starts_with(&error)).count();
        assert_eq!(count, 1, "{told:?}");
        let row = format!("not written: <time>,{meter},17,ok,600");
        assert!(told.contains(&row), "{told:?}");
        assert_eq!(folder.read(&format!("{meter}.csv")), OTHER);
    }
}

/// The site with the rows of one meter on stdout.
fn with_stdout() -> String {
    let site = SITE.replace("\"roof\"\nunit", "\"roof\"\noutput = \"print\"\nunit");
    let site = site.replace("\"hall\"\nunit", "\"hall\"\noutput = \"log\"\nunit");
    let site = site.replace("100ms", "50ms");
    site + "\n[[outputs]]\nname = \"print\"\n"
}

/// How many lines a file has.
fn lines(folder: &Folder, name: &str) -> usize {
    let text = fs::read_to_string(folder.file(name));
    text.unwrap_or_default().lines().count()
}

#[test]
fn where_stdout_is_closed_that_is_told_and_files_go_on() {
    let folder = Folder::new("poll_files_closed_pipe");
    let mut poll = Poll::start(&folder, &with_stdout());
    drop(poll.child.stdout.take());
    let told = poll.told.next().unwrap().unwrap();
    assert_eq!(told, "warning: stdout was closed: no more rows go there");
    let before = lines(&folder, "main.csv");
    wait_until(|| lines(&folder, "main.csv") > before + 3);
    assert_eq!(poll.stop(), (Vec::new(), Some(7)));
}

#[test]
fn a_reader_that_stands_still_holds_up_neither_the_files_nor_the_end() {
    let folder = Folder::new("poll_files_stalled_pipe");
    // A pipe that is full before the first row.
    let (reader, mut writer) = std::io::pipe().unwrap();
    let flags = fcntl_getfl(&writer).unwrap();
    fcntl_setfl(&writer, flags | OFlags::NONBLOCK).unwrap();
    while writer.write(&[b'x'; 4096]).is_ok() {}
    fcntl_setfl(&writer, flags).unwrap();
    folder.write("site.toml", with_stdout());
    let mut command = Program::new("poll -q --config site.toml")
        .folder(folder.path())
        .command();
    let mut child = command
        .stdout(writer)
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let told = BufReader::new(child.stderr.take().unwrap()).lines();
    wait_until(|| lines(&folder, "main.csv") > 5);
    kill(&child, "TERM");
    assert_eq!(child.wait().unwrap().code(), Some(7));
    let told = told.map(Result::unwrap);
    let told: Vec<String> = told.filter(|line| !line.starts_with("warning: ")).collect();
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(told[0].starts_with("error: stdout: nobody reads it; "));
    assert!(told[0].ends_with(" rows are lost"));
    drop(reader);
}

#[test]
fn files_that_follow_one_another_are_told_once_and_when_rows_are_written_again() {
    let folder = Folder::new("poll_files_by_time");
    let site = SITE.replace("{meter}.csv", "log/%H%M%S.csv");
    folder.write("log", "");
    fs::remove_file(folder.file("log")).unwrap();
    let mut poll = Poll::run(&folder, &site, "poll --config site.toml");
    wait_until(|| fs::read_dir(folder.file("log")).is_ok_and(|files| files.count() > 0));
    // No file of any second can be made.
    fs::rename(folder.file("log"), folder.file("before")).unwrap();
    folder.write("log", "");
    let error = poll.next().unwrap();
    assert!(error.starts_with("error: log/"), "{error}");
    std::thread::sleep(std::time::Duration::from_millis(2500));
    fs::remove_file(folder.file("log")).unwrap();
    wait_until(|| fs::read_dir(folder.file("log")).is_ok_and(|files| files.count() > 2));
    let (told, _) = poll.stop();
    assert!(
        !told.iter().any(|line| line.starts_with("error")),
        "{told:?}"
    );
    let again = told.iter().filter(|line| line.ends_with(": written again"));
    assert_eq!(again.count(), 1, "{told:?}");
}
