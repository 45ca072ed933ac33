//! `poll --once` as cron runs it, at a meter that counts what it is asked.
//!
//! `METERPOLL_ROUNDS` says how often what is left to chance is tried.

#![cfg(unix)]

mod support {
    pub(crate) mod counting;
    pub(crate) mod folder;
    pub(crate) mod program;
    pub(crate) mod pty;
    pub(crate) mod rounds;
}

use std::process::Stdio;

use meterpoll::transport::LineSettings;
use meterpoll::transport::serial::Serial;

use support::counting::{HEADER, counting, counts, poll};
use support::folder::Folder;
use support::program::{Program, without_times};
use support::pty::{PtyMeter, answer_with};
use support::rounds::rounds;

#[test]
fn twelve_runs_at_once_wait_for_the_port_and_leave_twelve_whole_rows_under_one_header() {
    let folder = Folder::new("poll_twelve");
    let meter = counting();
    for round in 1..=rounds(2) {
        let runs: Vec<_> = (0..12)
            .map(|_| {
                let run = poll(&meter, "--once --wait 60s -o log/rows.csv");
                let mut command = run.folder(folder.path()).command();
                command.stderr(Stdio::piped()).spawn().unwrap()
            })
            .collect();
        for run in runs {
            let output = run.wait_with_output().unwrap();
            let stderr = String::from_utf8_lossy(&output.stderr);
            assert_eq!((output.status.code(), &*stderr), (Some(0), ""));
        }
        let mut counts = counts(&folder.read("log/rows.csv"));
        counts.sort_unstable();
        let all: Vec<u16> = (1..).take(12 * round).collect();
        assert_eq!(counts, all);
    }
}

#[test]
fn a_port_that_another_program_holds_is_a_row_without_values_and_exit_code_3() {
    let folder = Folder::new("poll_held_port");
    let meter = counting();
    let held = Serial::open(meter.path(), LineSettings::default()).unwrap();
    let run = |wait| {
        let run = poll(&meter, "--once -q -o rows.csv --wait").arguments(wait);
        run.folder(folder.path())
    };
    let output = run("20ms").output();
    assert_eq!(output.status.code(), Some(3));
    let stderr = String::from_utf8(output.stderr).unwrap();
    let error = format!("error: port {} is in use by ", meter.path());
    assert!(stderr.starts_with(&error), "{stderr}");
    let missing = format!("{HEADER}<time>,,1,port,\n");
    assert_eq!(without_times(&folder.read("rows.csv")), missing);
    assert_eq!(meter.requests(), [[0; 0]; 0]);
    drop(held);
    run("60s").run();
    let both = format!("{missing}<time>,,1,ok,1\n");
    assert_eq!(without_times(&folder.read("rows.csv")), both);
}

#[test]
fn rows_of_two_meters_go_to_a_file_a_meter_and_day_and_hold_what_these_held_then() {
    let folder = Folder::new("poll_meter_and_day");
    let mut count = 0;
    let meter = PtyMeter::new(Box::new(move |request| {
        count += 1;
        let held = |address| (address == 5).then_some(count);
        let answer = |unit| answer_with(unit, request, held);
        answer(1).or_else(|| answer(2)).unwrap_or_default()
    }));
    let site = r#"
        [[lines]]
        name = "hall"
        port = "PORT"

        [[meters]]
        name = "press"
        unit = 1
        points = ["0x0005"]

        [[meters]]
        name = "saw"
        unit = 2
        points = ["0x0005"]

        [[outputs]]
        name = "log"
        path = "log/%Y/{meter}-%Y-%m-%d.csv"
    "#;
    folder.write("site.toml", site.replace("PORT", meter.path()));
    for _ in 0..3 {
        Program::new("poll --once --config site.toml")
            .folder(folder.path())
            .run();
    }
    for (meter, unit, expected) in [("press", 1, [1, 3, 5]), ("saw", 2, [2, 4, 6])] {
        // Midnight may have come in between.
        let mut rows = Vec::new();
        for year in folder.names_in("log") {
            for name in folder.names_in(&format!("log/{year}")) {
                if !name.starts_with(meter) {
                    continue;
                }
                let text = folder.read(&format!("log/{year}/{name}"));
                let (header, found) = text.split_once('\n').unwrap();
                assert_eq!(header, "time,meter,unit_id,status,0x0005");
                for row in found.lines() {
                    let day = row.get(..10).unwrap();
                    assert_eq!(name, format!("{meter}-{day}.csv"));
                    assert!(day.starts_with(&year), "{year}: {day}");
                }
                rows.extend(without_times(found).lines().map(str::to_owned));
            }
        }
        let expected = expected.map(|count| format!("<time>,{meter},{unit},ok,{count}"));
        assert_eq!(rows, expected);
    }
}

#[test]
fn a_line_that_was_cut_anywhere_is_removed_by_the_next_run_and_told() {
    let folder = Folder::new("poll_torn");
    let meter = counting();
    let whole = format!("{HEADER}2026-11-22T12:00:00.000Z,,1,ok,7\n");
    let row = "2026-11-22T12:00:01.000Z,,1,ok,8";
    for cut in [1, 20, row.len()] {
        let torn = row.get(..cut).unwrap();
        let removed = if cut == 1 {
            "1 byte".to_owned()
        } else {
            format!("{cut} bytes")
        };
        folder.write("rows.csv", format!("{whole}{torn}"));
        let before = meter.requests().len();
        poll(&meter, "--once -o rows.csv")
            .folder(folder.path())
            .stderr(without_times(&format!(
                "rows.csv: removed {removed} of a last line that was not whole: '{torn}'\n"
            )))
            .run();
        let text = folder.read("rows.csv");
        let added = text.strip_prefix(&whole).unwrap();
        assert_eq!(
            without_times(added),
            format!("<time>,,1,ok,{}\n", before + 1)
        );
    }
}

#[test]
fn a_file_with_other_columns_is_refused_and_not_touched_and_nothing_is_sent() {
    let folder = Folder::new("poll_other_columns");
    let meter = counting();
    let other = "time,meter,unit_id,status,0x0001\n2026-11-22T12:00:00.000Z,,1,ok,7\n";
    folder.write("rows.csv", other);
    for way in ["--once", "--every 1s"] {
        let run = poll(&meter, "-q -o rows.csv").arguments(way);
        let output = run.folder(folder.path()).output();
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(7), "{stderr}");
        assert!(stderr.starts_with("error: rows.csv: "), "{stderr}");
        assert_eq!(folder.read("rows.csv"), other);
    }
    assert_eq!(meter.requests(), [[0; 0]; 0]);
}

#[test]
fn a_site_file_that_does_not_parse_is_named_with_line_and_key_and_nothing_is_sent() {
    let folder = Folder::new("poll_bad_site");
    let meter = counting();
    let site = format!(
        "[[lines]]\nname = \"hall\"\nport = \"{}\"\nspeed = 9600\n",
        meter.path()
    );
    folder.write("site.toml", site);
    for way in ["--once", "--check", ""] {
        let output = Program::new("poll -q --config site.toml")
            .arguments(way)
            .folder(folder.path())
            .output();
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{stderr}");
        assert!(stderr.contains("site.toml:4"), "{stderr}");
        assert!(stderr.contains("speed"), "{stderr}");
    }
    assert_eq!(meter.requests(), [[0; 0]; 0]);
    assert_eq!(folder.names(), ["site.toml"]);
}

#[test]
fn a_check_opens_neither_port_nor_file() {
    let folder = Folder::new("poll_check_opens_nothing");
    let port = folder.file("port").display().to_string();
    let output = Program::new("poll -a 1 0x0000 --every 1m --check -o log/rows.csv")
        .arguments("-p")
        .argument(&port)
        .folder(folder.path())
        .output();
    let stdout = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(0), "{stdout}");
    assert!(stdout.ends_with("it fits\n"), "{stdout}");
    assert!(folder.names().is_empty());
}
