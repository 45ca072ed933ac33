//! `poll` while others are at its file, and while the disk is full, at a meter that counts what it is
//! asked.

#![cfg(unix)]

mod support {
    pub(crate) mod counting;
    pub(crate) mod folder;
    pub(crate) mod program;
    pub(crate) mod pty;
    pub(crate) mod waiting;
}

use std::fs;
use std::io::Read;
use std::process::{Child, Command, Stdio};

use support::counting::{HEADER, are_without_gap, counting, counts, poll};
use support::folder::Folder;
use support::program::{binary, kill};
use support::pty::PtyMeter;
use support::waiting::wait_until;

/// A poll under way that appends to `rows.csv`.
struct Poll<'a> {
    child: Child,
    folder: &'a Folder,
}

impl<'a> Poll<'a> {
    fn start(meter: &PtyMeter, folder: &'a Folder, more: &str) -> Self {
        let run = poll(meter, "--every 20ms -o rows.csv").arguments(more);
        let mut command = run.folder(folder.path()).command();
        let child = command.stderr(Stdio::piped()).spawn().unwrap();
        Self { child, folder }
    }

    /// Waits until there are so many rows in the file below a header.
    fn wait_for_rows(&self, rows: usize) {
        wait_until(|| {
            let text = fs::read_to_string(self.folder.file("rows.csv")).unwrap_or_default();
            text.lines().count() > rows && text.ends_with('\n')
        });
    }

    /// Stops it; what it has said, but for slots that were missed on a busy machine.
    fn stop(&mut self) -> Vec<String> {
        kill(&self.child, "TERM");
        let mut told = String::new();
        let stderr = self.child.stderr.as_mut().unwrap();
        stderr.read_to_string(&mut told).unwrap();
        self.child.wait().unwrap();
        let lines = told.lines().filter(|line| !line.contains("not begun"));
        lines.map(str::to_owned).collect()
    }
}

#[test]
fn a_file_that_is_renamed_while_polling_goes_on_is_followed_by_a_new_one_and_no_row_is_lost() {
    let folder = Folder::new("poll_renamed");
    let meter = counting();
    let mut poll = Poll::start(&meter, &folder, "");
    let mut all = Vec::new();
    for name in ["1.csv", "2.csv", "3.csv"] {
        poll.wait_for_rows(3);
        fs::rename(folder.file("rows.csv"), folder.file(name)).unwrap();
    }
    poll.wait_for_rows(3);
    assert_eq!(poll.stop(), [""; 0]);
    for name in ["1.csv", "2.csv", "3.csv", "rows.csv"] {
        all.extend(counts(&folder.read(name)));
    }
    assert!(are_without_gap(&all), "{all:?}");
    assert_eq!(all.len(), meter.requests().len());
    assert_eq!(folder.names(), ["1.csv", "2.csv", "3.csv", "rows.csv"]);
}

#[test]
fn a_file_that_is_deleted_or_emptied_while_polling_goes_on_begins_again_with_its_header() {
    let folder = Folder::new("poll_deleted");
    let meter = counting();
    let mut poll = Poll::start(&meter, &folder, "");
    poll.wait_for_rows(3);
    let before = meter.requests().len();
    fs::remove_file(folder.file("rows.csv")).unwrap();
    poll.wait_for_rows(3);
    // None of those that went with the file come again.
    let first = usize::from(counts(&folder.read("rows.csv"))[0]);
    assert!(first >= before, "{first} after {before}");
    let file = folder.file("rows.csv");
    let file = fs::OpenOptions::new().write(true).open(file).unwrap();
    file.set_len(0).unwrap();
    poll.wait_for_rows(3);
    assert_eq!(poll.stop(), [""; 0]);
    let left = counts(&folder.read("rows.csv"));
    assert!(are_without_gap(&left), "{left:?}");
    assert_eq!(
        left.last().copied().map(usize::from),
        Some(meter.requests().len())
    );
}

#[test]
fn a_poll_says_nothing_but_with_v_what_all_came_to() {
    let folder = Folder::new("poll_summary");
    let meter = counting();
    let mut poll = Poll::start(&meter, &folder, "-v");
    poll.wait_for_rows(3);
    let told = poll.stop();
    let head = told.iter().position(|line| line.starts_with("METER"));
    let row = &told[head.expect("a summary") + 1];
    let cells: Vec<&str> = row.split_whitespace().collect();
    let rows = counts(&folder.read("rows.csv")).len().to_string();
    assert_eq!(cells[..4], ["unit", "1", &rows, &rows], "{row}");
}

/// On a disk of 64 KiB, where this user may have one.
#[cfg(target_os = "linux")]
#[test]
fn rows_that_come_while_the_disk_is_full_are_kept_and_written_when_there_is_room() {
    let folder = Folder::new("poll_full");
    let meter = counting();
    // The file keeps what is left of its page, which the rows of 20 ms would take long to fill.
    let script = "
        mount -t tmpfs -o size=64k none disk || exit 99
        \"$@\" 2> stderr &
        poll=$!
        wait_for() {
            left=3000
            until eval \"$1\"; do
                left=$((left - 1))
                [ $left -gt 0 ] || { echo \"not: $1\" >> wrong; kill $poll; exit 1; }
                sleep 0.02
            done
        }
        rows() { cat disk/rows.csv 2>/dev/null | wc -l; }
        wait_for '[ $(rows) -gt 3 ]'
        dd if=/dev/zero of=disk/filler bs=1k 2>/dev/null
        wait_for 'grep -q ^error: stderr'
        cp disk/rows.csv full.csv
        sleep 0.2
        cmp disk/rows.csv full.csv >> wrong || echo changed >> wrong
        rm disk/filler
        before=$(rows)
        wait_for '[ $(rows) -gt $((before + 5)) ]'
        kill -TERM $poll
        wait $poll
        [ $? = 143 ] || echo code >> wrong
        cp disk/rows.csv after.csv
        [ -s wrong ] || rm wrong
    ";
    fs::create_dir(folder.file("disk")).unwrap();
    let run = poll(&meter, "--every 10ms -o disk/rows.csv").command();
    let mut command = Command::new("unshare");
    command.args(["--mount", "--map-root-user", "sh", "-c", script, "sh"]);
    command.arg(binary()).args(run.get_args());
    command.current_dir(folder.path()).stdin(Stdio::null());
    let Ok(output) = command.output() else { return };
    if output.status.code() == Some(99) || !folder.file("stderr").exists() {
        return;
    }
    let told = folder.read("stderr");
    assert!(
        !folder.file("wrong").exists(),
        "{}{told}",
        folder.read("wrong")
    );
    // Whole rows when it was full, and afterwards all of those that came meanwhile as well.
    let full = folder.read("full.csv");
    assert!(full.starts_with(HEADER));
    counts(&full);
    let found = counts(&folder.read("after.csv"));
    assert!(are_without_gap(&found), "{found:?}");
    assert_eq!(found.len(), meter.requests().len());
    // Once, and not for each row; how much of the page was left is left to chance.
    assert_eq!(told.matches("error: ").count(), 1, "{told}");
    assert!(told.contains("error: disk/rows.csv: "), "{told}");
    assert_eq!(
        told.matches("disk/rows.csv: written again\n").count(),
        1,
        "{told}"
    );
}
