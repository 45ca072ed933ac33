//! `-o FILE` in company: many runs at once, runs that are killed, disks that are full.

#![cfg(unix)]

mod support {
    pub(crate) mod folder;
    pub(crate) mod program;
}

use std::collections::BTreeSet;
use std::fs;
use std::process::{Command, Output, Stdio};
use std::time::Duration;

use support::folder::Folder;
use support::program::{Program, binary, without_times};

const POINTS: &str = "read-registers -p sim: -a 17 --meter pqm product_code ct_primary -q -o";
const HEADER: &str = "time,meter,unit_id,status,product_code,ct_primary\n";
const ROW: &str = "<time>,pqm,17,ok,65,600\n";

fn read(folder: &Folder, file: &str) -> Program {
    Program::new(POINTS).argument(file).folder(folder.path())
}

/// The rows below the one header, each of them whole, as a strict reader finds them.
#[track_caller]
fn times(text: &str) -> Vec<String> {
    let count = text.lines().count() - 1;
    assert_eq!(
        without_times(text),
        format!("{HEADER}{}", ROW.repeat(count))
    );
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let times = reader.records().map(|row| row.unwrap()[0].to_owned());
    times.collect()
}

#[test]
fn twelve_runs_at_once_write_twelve_whole_rows_and_one_header() {
    let folder = Folder::new("append-twelve");
    for round in 1..=4 {
        let file = "logs/rows.csv";
        let runs: Vec<_> = (0..12)
            .map(|_| {
                let mut command = read(&folder, file).command();
                command.stderr(Stdio::piped()).spawn().expect("it starts")
            })
            .collect();
        for run in runs {
            let output = run.wait_with_output().expect("it ends");
            let stderr = String::from_utf8_lossy(&output.stderr);
            assert_eq!((output.status.code(), &*stderr), (Some(0), ""));
        }
        assert_eq!(times(&folder.read(file)).len(), 12 * round);
    }
}

#[test]
fn runs_at_once_with_two_sets_of_columns_keep_to_two_files() {
    let folder = Folder::new("append-two-sets");
    let runs: Vec<_> = (0..12)
        .map(|number| {
            let point = ["product_code", "ct_primary"][number % 2];
            let mut command = Program::new("read-registers -p sim: -a 17 --meter pqm -o rows.csv")
                .arguments("--on-schema-change new-file")
                .argument(point)
                .folder(folder.path())
                .command();
            command.spawn().expect("it starts")
        })
        .collect();
    for mut run in runs {
        assert_eq!(run.wait().expect("it ends").code(), Some(0));
    }
    let found: BTreeSet<String> = ["rows.csv", "rows.2.csv"]
        .map(|name| without_times(&folder.read(name)))
        .into();
    let expected = [("product_code", 65), ("ct_primary", 600)].map(|(point, value)| {
        let rows = format!("<time>,pqm,17,ok,{value}\n").repeat(6);
        format!("time,meter,unit_id,status,{point}\n{rows}")
    });
    assert_eq!(found, BTreeSet::from(expected));
    assert_eq!(folder.names(), ["rows.2.csv", "rows.csv"]);
}

#[test]
fn runs_that_are_killed_at_any_moment_leave_whole_rows_or_a_tail_that_the_next_removes() {
    let folder = Folder::new("append-killed");
    let file = folder.file("rows.csv");
    let mut whole = 0;
    let mut chance = fastrand::Rng::with_seed(17);
    for round in 0..48 {
        let mut run = read(&folder, "rows.csv")
            .command()
            .spawn()
            .expect("it starts");
        std::thread::sleep(Duration::from_micros(chance.u64(0..30_000)));
        run.kill().expect("it is ours");
        run.wait().expect("it ends");
        let mut text = fs::read_to_string(&file).unwrap_or_default();
        // A kill hardly ever leaves half a line; a power cut does.
        if round % 4 == 3 && text.len() > HEADER.len() {
            let cut = chance.usize(1..20).min(text.len() - HEADER.len());
            text.truncate(text.len() - cut);
            fs::write(&file, &text).expect("the folder is writable");
            whole = whole.min(text.lines().count().saturating_sub(2));
        }
        if round % 2 == 1 {
            let is_torn = !text.is_empty() && !text.ends_with('\n');
            let output = read(&folder, "rows.csv").output();
            assert_eq!(output.status.code(), Some(0));
            assert_eq!(output.stderr.is_empty(), !is_torn);
            let rows = times(&folder.read("rows.csv")).len();
            assert!(rows > whole, "{rows} rows after {whole}");
            whole = rows;
        }
    }
}

/// Runs the program with a shell around it, which says `before`; the last argument is the file.
fn shell(folder: &Folder, before: &str, arguments: &str) -> Output {
    let script = format!("{before}; exec \"$0\" \"$@\"");
    let mut command = Command::new("sh");
    command.args(["-c", &script]).arg(binary());
    command.args(arguments.split(' ')).arg("rows.csv");
    command.current_dir(folder.path()).stdin(Stdio::null());
    command.output().expect("there is a shell")
}

#[cfg(target_os = "linux")]
#[test]
fn a_file_at_its_limit_stays_as_it_is_and_the_rows_are_on_stderr() {
    let folder = Folder::new("append-limit");
    // A block of `ulimit` has 512 bytes.
    for (size, problem) in [
        (500, "only 12 of 42 bytes could be written"),
        (
            512,
            "the rows cannot be written\n  because: File too large (os error 27)",
        ),
    ] {
        let row = "1,2,3,4,5,6\n";
        let mut before = HEADER.to_owned();
        while before.len() + 2 * row.len() <= size {
            before.push_str(row);
        }
        let rest = size - before.len() - "1,2,3,4,5,\n".len();
        let last = "6".repeat(rest);
        let before = format!("{before}1,2,3,4,5,{last}\n");
        assert_eq!(before.len(), size);
        folder.write("rows.csv", &before);
        let output = shell(&folder, "ulimit -f 1", POINTS);
        let stderr = String::from_utf8(output.stderr).expect("text");
        assert_eq!(
            without_times(&stderr),
            format!(
                "error: the readings were taken, and cannot be written\n  \
                 because: rows.csv: {problem}\n\
                 not written: {ROW}"
            )
        );
        assert_eq!(output.status.code(), Some(7));
        assert_eq!(folder.read("rows.csv"), before);
    }
}

#[cfg(target_os = "linux")]
#[test]
fn rows_that_are_not_written_weigh_more_than_readings_that_are_missing() {
    let folder = Folder::new("append-both");
    let points = "read-registers -p sim: -a 17,18 0 -t 300ms --retries 0 -q -o";
    let output = shell(&folder, "ulimit -f 0", points);
    assert_eq!(output.status.code(), Some(7));
    let stderr = String::from_utf8(output.stderr).expect("text");
    assert_eq!(
        without_times(&stderr),
        "error: unit 18 on sim: at 9600 8N1, registers 0x0000+1: no answer within 300ms\n\
         error: the readings were taken, and cannot be written\n  \
         because: rows.csv: the rows cannot be written\n  \
         because: File too large (os error 27)\n\
         not written: <time>,,17,ok,65\n\
         not written: <time>,,18,timeout,\n"
    );
}

#[cfg(target_os = "linux")]
#[test]
fn a_new_file_for_which_there_is_no_room_is_not_left_behind() {
    let folder = Folder::new("append-no-room");
    let output = shell(&folder, "ulimit -f 0", POINTS);
    assert_eq!(output.status.code(), Some(7));
    assert!(folder.names().is_empty());
}

/// On a disk of 64 KiB, where this user may have one.
#[cfg(target_os = "linux")]
#[test]
fn rows_go_on_when_a_full_disk_has_room_again() {
    let folder = Folder::new("append-full");
    let script = "
        mount -t tmpfs -o size=64k none disk || exit 99
        \"$@\" || exit 1
        cp disk/rows.csv before.csv
        # A page has 4096 bytes; 100 of that of the file are left, and no other page.
        size=$(wc -c < disk/rows.csv)
        head -c $((4096 - size - 101)) /dev/zero | tr '\\0' 6 >> disk/rows.csv
        echo >> disk/rows.csv
        dd if=/dev/zero of=disk/filler bs=1k 2>/dev/null
        cp disk/rows.csv full.csv
        for run in 1 2 3; do \"$@\" 2>> stderr; [ $? = 7 ] || echo code >> wrong; done
        cmp disk/rows.csv full.csv || echo changed >> wrong
        rm disk/filler
        \"$@\" || echo again >> wrong
        cp disk/rows.csv after.csv
    ";
    fs::create_dir(folder.file("disk")).expect("the folder is writable");
    let mut command = Command::new("unshare");
    command.args(["--mount", "--map-root-user", "sh", "-c", script, "sh"]);
    command
        .arg(binary())
        .args(POINTS.split(' '))
        .arg("disk/rows.csv");
    command.args(["-f", "jsonl"]);
    command.current_dir(folder.path()).stdin(Stdio::null());
    let Ok(output) = command.output() else { return };
    if output.status.code() == Some(99) || !folder.file("before.csv").exists() {
        return;
    }
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(
        !folder.file("wrong").exists(),
        "{}{said}",
        folder.read("wrong")
    );
    let (full, after) = (folder.read("full.csv"), folder.read("after.csv"));
    let new = after.strip_prefix(&full).expect("what was there is there");
    assert_eq!(new.lines().count(), 2);
    let stderr = folder.read("stderr");
    assert_eq!(
        stderr.matches("not written: {\"time\"").count(),
        6,
        "{stderr}"
    );
}
