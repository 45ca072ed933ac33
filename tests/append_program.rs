//! `-o FILE`: what a run adds to a file, to the letter, and what it leaves alone.

#![cfg(unix)]

mod support {
    pub(crate) mod folder;
    pub(crate) mod program;
}

use std::fs;
use std::os::unix::fs::PermissionsExt;

use support::folder::Folder;
use support::program::{Program, without_times};

const HEADER: &str = "time,meter,unit_id,status,product_code,ct_primary\n";
const ROW: &str = "<time>,pqm,17,ok,65,600\n";
const NEW_FILE_HINT: &str =
    "hint: the file is as it was; --on-schema-change new-file goes on in another, name.2.csv\n";

/// Two points that do not change, with these words besides.
fn read(folder: &Folder, more: &str) -> Program {
    let points = "read-registers -p sim: -a 17 --meter pqm product_code ct_primary";
    Program::new(&format!("{points} {more}")).folder(folder.path())
}

#[track_caller]
fn holds(folder: &Folder, name: &str, expected: &str) {
    assert_eq!(without_times(&folder.read(name)), expected);
}

#[test]
fn a_second_run_appends_and_the_header_is_there_once() {
    let folder = Folder::new("append-twice");
    for rows in 1..=3 {
        read(&folder, "-o logs/rows.csv").run();
        let expected = format!("{HEADER}{}", ROW.repeat(rows));
        holds(&folder, "logs/rows.csv", &expected);
    }
    // What is there may be empty as well.
    folder.write("empty.csv", "");
    read(&folder, "-o empty.csv").run();
    holds(&folder, "empty.csv", &format!("{HEADER}{ROW}"));
}

#[test]
fn every_format_of_lines_goes_into_a_file_as_it_goes_to_stdout() {
    let folder = Folder::new("append-formats");
    for format in ["csv", "csv --layout long", "csv --units", "jsonl", "influx"] {
        let name = format.replace(' ', "");
        read(&folder, &format!("-f {format} -o {name}")).run();
        let output = read(&folder, &format!("-f {format}")).output();
        let stdout = String::from_utf8(output.stdout).expect("text");
        // The last of influx is the time.
        let timeless = |text: &str| match text.rsplit_once(' ') {
            Some((rest, _)) if format == "influx" => rest.to_owned(),
            _ => without_times(text),
        };
        assert_eq!(timeless(&folder.read(&name)), timeless(&stdout), "{format}");
    }
}

#[test]
fn a_run_of_several_units_is_rows_in_their_order_and_missing_ones_are_rows_too() {
    let folder = Folder::new("append-units");
    Program::new("read-registers -p sim: -a 17,18 0 -o rows.csv -t 300ms --retries 0 -q")
        .folder(folder.path())
        .code(1)
        .stderr("error: unit 18 on sim: at 9600 8N1, registers 0x0000+1: no answer within 300ms\n")
        .run();
    let expected = "time,meter,unit_id,status,0x0000\n<time>,,17,ok,65\n<time>,,18,timeout,\n";
    holds(&folder, "rows.csv", expected);
}

#[test]
fn other_columns_are_refused_before_anything_is_sent_and_nothing_is_touched() {
    let folder = Folder::new("append-refused");
    let cases = [
        (
            "time,meter,unit_id,status,ct_primary\n1,2,3,4,5\n",
            "it has other columns: column 5 is 'ct_primary', not 'product_code'",
        ),
        (
            "time,meter,unit_id,status,product_code\n1,2,3,4,5\n",
            "it has fewer columns: there is no column 6, 'ct_primary'",
        ),
        (
            "time,meter,unit_id,status,product_code,ct_primary,frequency\ntorn",
            "it has more columns: column 7, 'frequency', is not among those to be written",
        ),
        (
            "\u{feff}time,meter,unit_id,status,product_code,ct_primary\n",
            "it begins with a byte order mark, as from a spreadsheet",
        ),
        (
            "time,meter,unit_id,status,product_code,ct_primary\r\n",
            "its lines end in CR LF, as from a spreadsheet, and not in LF",
        ),
        (
            "time;meter;unit_id;status;product_code;ct_primary\n",
            "it has other columns: column 1 is 'time;meter;unit_id;status;product_code;c...', not \
             'time'",
        ),
        (
            "a note without a line end",
            "it has other columns: column 1 is 'a note without a line end', not 'time'",
        ),
        ("\n", "it has other columns: column 1 is '', not 'time'"),
    ];
    for (text, problem) in cases {
        folder.write("rows.csv", text);
        // The port is not even looked for.
        Program::new("read-registers -p /nonexistent -a 17 --meter pqm product_code ct_primary")
            .arguments("-o rows.csv")
            .folder(folder.path())
            .code(7)
            .stderr(format!("error: rows.csv: {problem}\n{NEW_FILE_HINT}"))
            .run();
        assert_eq!(folder.read("rows.csv"), text);
    }
    assert_eq!(folder.names(), ["rows.csv"]);
}

#[test]
fn what_ends_within_quotes_is_refused_and_the_line_is_named() {
    let folder = Folder::new("append-quotes");
    let text = format!("{HEADER}1,2,3,4,5,6\n1,2,3,4,\"of two\nlines\",6\n1,2,3,4,\"open\nstill\n");
    folder.write("rows.csv", &text);
    read(&folder, "-o rows.csv")
        .code(7)
        .stderr(
            "error: rows.csv: a quote that is opened in line 5 is never closed\n\
             hint: close the quote, or go on in another file: --on-schema-change new-file\n",
        )
        .run();
    assert_eq!(folder.read("rows.csv"), text);
    // One that is closed is none of our business, even in lines that are no rows.
    let text = format!("{HEADER}1,2,3,4,\"of two\nlines\",6\n\n");
    folder.write("rows.csv", &text);
    read(&folder, "-o rows.csv").run();
    holds(&folder, "rows.csv", &format!("{text}{ROW}"));
}

#[test]
fn lines_of_another_kind_are_refused_by_formats_without_a_header() {
    let folder = Folder::new("append-kinds");
    read(&folder, "-o rows.csv").run();
    let before = folder.read("rows.csv");
    for (format, begin) in [("jsonl", "{\"time\":\""), ("influx", "meter,")] {
        read(&folder, &format!("-o rows.csv -f {format}"))
            .code(7)
            .stderr(format!(
                "error: rows.csv: it holds something else: its first line begins with \
                 'time,meter,unit_id,status,product_code,c...', not with '{begin}'\n\
                 {NEW_FILE_HINT}"
            ))
            .run();
    }
    assert_eq!(folder.read("rows.csv"), before);
}

#[test]
fn with_new_file_rows_go_to_the_first_numbered_file_that_fits() {
    let folder = Folder::new("append-numbered");
    let other = "time,meter,unit_id,status,frequency\n";
    folder.write("rows.csv", other);
    folder.write("rows.2.csv", other);
    for rows in 1..=2 {
        read(&folder, "-o rows.csv --on-schema-change new-file").run();
        holds(
            &folder,
            "rows.3.csv",
            &format!("{HEADER}{}", ROW.repeat(rows)),
        );
    }
    // An empty one fits.
    folder.write("rows.2.csv", "");
    read(&folder, "-o rows.csv --on-schema-change new-file").run();
    holds(&folder, "rows.2.csv", &format!("{HEADER}{ROW}"));
    assert_eq!(folder.read("rows.csv"), other);
    assert_eq!(folder.names(), ["rows.2.csv", "rows.3.csv", "rows.csv"]);
    folder.write("plain", other);
    read(&folder, "-o plain --on-schema-change new-file").run();
    holds(&folder, "plain.2", &format!("{HEADER}{ROW}"));
}

#[test]
fn a_tail_that_is_not_whole_is_removed_and_told_even_with_q() {
    let folder = Folder::new("append-torn");
    let zeros = "\0".repeat(5000);
    let whole = "1,2,3,4,5,6\n";
    let long = "9".repeat(100);
    let cases = [
        (
            format!("{HEADER}{whole}2026-11-22T04:16"),
            format!("{HEADER}{whole}"),
            "removed 16 bytes of a last line that was not whole: '2026-11-22T04:16'".to_owned(),
        ),
        (
            format!("{HEADER}{whole}{zeros}"),
            format!("{HEADER}{whole}"),
            "removed 5000 bytes at its end that were zero".to_owned(),
        ),
        (
            format!("{HEADER}{whole}1,2{zeros}"),
            format!("{HEADER}{whole}"),
            "removed 5003 bytes of a last line that was not whole: '1,2...'".to_owned(),
        ),
        // Behind zeros somebody has gone on.
        (
            format!("{HEADER}{whole}1,2\0\0{whole}"),
            format!("{HEADER}{whole}"),
            "removed 17 bytes of a last line that was not whole: \
             '1,2\\x00\\x001,2,3,4,5,6\\n'"
                .to_owned(),
        ),
        (
            format!("{HEADER}{whole}{long}"),
            format!("{HEADER}{whole}"),
            format!(
                "removed 100 bytes of a last line that was not whole: '{}...'",
                &long[..80]
            ),
        ),
        (
            zeros.clone(),
            HEADER.to_owned(),
            "removed 5000 bytes at its end that were zero".to_owned(),
        ),
        (
            "time,met".to_owned(),
            HEADER.to_owned(),
            "removed 8 bytes of a last line that was not whole: 'time,met'".to_owned(),
        ),
        (
            "time,met\0\0".to_owned(),
            HEADER.to_owned(),
            "removed 10 bytes of a last line that was not whole: 'time,met...'".to_owned(),
        ),
        // Half of a text in quotes.
        (
            format!("{HEADER}1,2,3,4,\"say"),
            HEADER.to_owned(),
            "removed 12 bytes of a last line that was not whole: '1,2,3,4,\\\"say'".to_owned(),
        ),
    ];
    for (before, kept, told) in cases {
        folder.write("rows.csv", before);
        read(&folder, "-o rows.csv -q")
            .stderr(format!("rows.csv: {told}\n"))
            .run();
        holds(&folder, "rows.csv", &format!("{kept}{ROW}"));
    }
}

#[test]
fn what_can_hold_no_rows_is_refused_before_anything_is_sent() {
    let folder = Folder::new("append-no-file");
    let refused = |output: &str, stderr: &str| {
        Program::new("read-registers -p /nonexistent -a 1 0 -o")
            .argument(output)
            .folder(folder.path())
            .code(7)
            .stderr(stderr)
            .run();
    };
    folder.write("file", "");
    refused(".", "error: .: it is a folder, not a file\n");
    refused(
        "file/rows.csv",
        "error: file/rows.csv: it cannot be opened for appending\n  \
         because: Not a directory (os error 20)\n",
    );
    let hint = "hint: without --output rows go to stdout, from where a shell leads them anywhere\n";
    let device = "it is no file that rows can be appended to, but a pipe or a device";
    refused("/dev/null", &format!("error: /dev/null: {device}\n{hint}"));
    let status = std::process::Command::new("mkfifo")
        .arg(folder.file("pipe"))
        .status();
    assert!(status.expect("mkfifo is there").success());
    refused("pipe", &format!("error: pipe: {device}\n{hint}"));
    assert_eq!(folder.names(), ["file", "pipe"]);
}

#[test]
fn a_folder_that_is_not_writable_is_told_before_anything_is_sent() {
    let folder = Folder::new("append-not-permitted");
    let closed = folder.file("closed");
    fs::create_dir(&closed).expect("the folder is writable");
    fs::set_permissions(&closed, fs::Permissions::from_mode(0o555)).expect("it is ours");
    // Nothing stops root.
    let is_root = fs::write(closed.join("probe"), "").is_ok();
    if !is_root {
        Program::new("read-registers -p /nonexistent -a 1 0 -o closed/logs/rows.csv")
            .folder(folder.path())
            .code(7)
            .stderr(
                "error: closed/logs/rows.csv: the folder closed cannot have it\n  \
                 because: Permission denied (os error 13)\n",
            )
            .run();
    }
    fs::set_permissions(&closed, fs::Permissions::from_mode(0o755)).expect("it is ours");
}

#[test]
fn nothing_is_made_where_the_port_cannot_be_opened_or_nothing_is_sent() {
    let folder = Folder::new("append-nothing-made");
    let output = Program::new("read-registers -p /nonexistent -a 1 0 -o logs/rows.csv")
        .folder(folder.path())
        .output();
    assert_eq!(output.status.code(), Some(3));
    read(&folder, "-o logs/rows.csv --dry-run")
        .stdout("11 03 00 00 00 01 86 9A\n11 03 10 50 00 01 82 4B\n")
        .run();
    assert!(folder.names().is_empty());
}

#[test]
fn formats_and_options_that_are_not_for_files_are_refused() {
    let folder = Folder::new("append-usage");
    for format in ["table", "json"] {
        read(&folder, &format!("-o rows.csv -f {format}"))
            .code(2)
            .stderr("error: --output is for --format csv, jsonl or influx\n")
            .run();
    }
    read(&folder, "-o rows.csv --plan")
        .code(2)
        .stderr("error: --output is for readings\n")
        .run();
    read(&folder, "-o -")
        .code(2)
        .stderr(
            "error: invalid value '-' for '--output <FILE>': rows go to stdout without it; a file \
             of that name is ./-\n\nFor more information, try '--help'.\n",
        )
        .run();
    for alone in ["--no-sync", "--on-schema-change new-file"] {
        let output = read(&folder, alone).output();
        assert_eq!(output.status.code(), Some(2), "{alone}");
    }
    assert!(folder.names().is_empty());
}
