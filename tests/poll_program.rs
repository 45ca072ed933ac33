//! `poll` as it is run: from a terminal, from cron, with a site file.

mod support {
    pub(crate) mod folder;
    pub(crate) mod program;
    pub(crate) mod waiting;
}

use std::io::{BufRead, BufReader};
use std::process::Stdio;

use support::folder::Folder;
use support::program::{Program, kill, without_times};
use support::waiting::wait_until;

/// A meter of the simulated line with two points that do not move.
const POLL: &str = "poll -p sim: -a 17 --meter pqm ct_primary nominal_frequency";

/// Two lines with a meter each.
const SITE: &str = r#"
[defaults]
every = "1m"

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
points = ["ct_primary", "nominal_frequency"]

[[meters]]
name = "other"
line = "roof"
unit = 17
profile = "pqm"
points = ["ct_primary", "nominal_frequency"]

[[outputs]]
name = "log"
path = "log/{meter}.csv"
"#;

#[test]
fn a_single_run_prints_a_row_a_meter_and_ends_with_what_came_of_it() {
    Program::new(POLL)
        .arguments("--once")
        .stdout(
            "time,meter,unit_id,status,ct_primary,nominal_frequency\n\
             <time>,pqm,17,ok,600,60\n",
        )
        .run();
}

#[test]
fn a_meter_that_is_not_there_has_its_row_as_well() {
    Program::new("poll -p sim: -a 17,18 --meter pqm ct_primary")
        .arguments("--once --retries 0 --timeout 20ms -q")
        .stdout(
            "time,meter,unit_id,status,ct_primary\n\
             <time>,pqm,17,ok,600\n\
             <time>,pqm,18,timeout,\n",
        )
        .stderr(
            "error: pqm, unit 18 on sim: at 9600 8N1, ct_primary (registers 0x1050+1): \
             no answer within 20ms\n",
        )
        .code(1)
        .run();
}

#[test]
fn a_row_of_nothing_can_be_left_out() {
    Program::new("poll -p sim: -a 18 --meter pqm ct_primary --skip-failed")
        .arguments("--once --retries 0 --timeout 20ms -q")
        .stderr(
            "error: pqm, unit 18 on sim: at 9600 8N1, ct_primary (registers 0x1050+1): \
             no answer within 20ms\n",
        )
        .code(4)
        .run();
}

#[test]
fn a_port_that_is_not_there_ends_a_run_without_end_at_once_and_is_a_row_of_a_single_one() {
    let error = "error: port /dev/nonexistent is not there\n";
    let poll = "poll -p /dev/nonexistent -a 17 --meter pqm ct_primary -q";
    Program::new(poll)
        .arguments("--every 24h")
        .stderr(error)
        .code(3)
        .run();
    Program::new(poll)
        .arguments("--once")
        .stdout("time,meter,unit_id,status,ct_primary\n<time>,pqm,17,port,\n")
        .stderr(format!(
            "{error}error: the port is away: 1 row is of meters that were not asked\n"
        ))
        .code(3)
        .run();
}

#[test]
fn single_runs_append_to_a_file_with_one_header() {
    let folder = Folder::new("poll_single_runs_append");
    for _ in 0..3 {
        Program::new(POLL)
            .arguments("--once -o log/{meter}.csv")
            .folder(folder.path())
            .run();
    }
    assert_eq!(
        without_times(&folder.read("log/pqm.csv")),
        "time,meter,unit_id,status,ct_primary,nominal_frequency\n\
         <time>,pqm,17,ok,600,60\n\
         <time>,pqm,17,ok,600,60\n\
         <time>,pqm,17,ok,600,60\n"
    );
}

#[test]
fn a_site_file_is_read_once_into_the_files_that_it_names() {
    let folder = Folder::new("poll_site_once");
    folder.write("site.toml", SITE);
    Program::new("poll --once --config")
        .argument(folder.file("site.toml"))
        .run();
    for meter in ["main", "other"] {
        assert_eq!(
            without_times(&folder.read(&format!("log/{meter}.csv"))),
            format!(
                "time,meter,unit_id,status,ct_primary,nominal_frequency\n\
                 <time>,{meter},17,ok,600,60\n"
            )
        );
    }
}

#[test]
fn a_check_says_what_would_be_read_when_and_makes_no_file() {
    let folder = Folder::new("poll_check");
    folder.write("site.toml", SITE);
    Program::new("poll --check --config site.toml")
        .folder(folder.path())
        .stdout(
            "hall, sim: at 9600 8N1\n\
             METER          POINTS  REQUESTS    MS  EVERY  NEXT                     TO\n\
             main, unit 17       2         1  37.5  1m     <time>  log/main.csv\n\
             \n\
             1 row, 37.5 ms in all: it fits\n\
             \n\
             roof, sim: at 9600 8N1\n\
             METER           POINTS  REQUESTS    MS  EVERY  NEXT                     TO\n\
             other, unit 17       2         1  37.5  1m     <time>  log/other.csv\n\
             \n\
             1 row, 37.5 ms in all: it fits\n",
        )
        .run();
    assert_eq!(folder.names(), ["site.toml"]);
}

#[test]
fn a_check_of_what_the_line_cannot_hold_ends_with_1() {
    let output = Program::new("poll -p sim: -a 17 --meter pqm --every 100ms --check").output();
    assert_eq!(output.status.code(), Some(1));
    let stdout = String::from_utf8(output.stdout).unwrap();
    assert!(
        stdout.contains("the intervals ask for 187 % of the time there is, so slots are missed"),
        "{stdout}"
    );
    let output = Program::new("poll -p sim: -a 17 --meter pqm --once --deadline 100ms --check");
    let output = output.output();
    assert_eq!(output.status.code(), Some(1));
    let stdout = String::from_utf8(output.stdout).unwrap();
    assert!(
        stdout.ends_with("more than the deadline of 100ms\n"),
        "{stdout}"
    );
}

/// Polls until so many rows were printed, sends a signal, and returns all that was printed and the
/// exit code.
fn stopped_after(rows: usize, signal: &str, arguments: &str) -> (Vec<String>, Option<i32>) {
    let mut command = Program::new(POLL).arguments(arguments).command();
    let mut child = command.stdout(Stdio::piped()).spawn().unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
    let mut found = Vec::new();
    while found.len() <= rows {
        found.push(lines.next().unwrap().unwrap());
    }
    kill(&child, signal);
    found.extend(lines.map(Result::unwrap));
    let status = child.wait().unwrap();
    #[cfg(unix)]
    let code = status
        .code()
        .or(std::os::unix::process::ExitStatusExt::signal(&status).map(|signal| 128 + signal));
    #[cfg(not(unix))]
    let code = status.code();
    (found, code)
}

#[test]
fn a_poll_goes_on_until_a_signal_comes_and_rows_are_whole() {
    for (signal, code) in [("INT", 130), ("TERM", 143)] {
        let (lines, found) = stopped_after(3, signal, "--every 50ms");
        assert_eq!(found, Some(code));
        for line in &lines[1..] {
            assert_eq!(without_times(line), "<time>,pqm,17,ok,600,60");
        }
    }
}

#[test]
fn rows_are_json_lines_or_influx_when_asked_for() {
    let (lines, _) = stopped_after(1, "TERM", "--every 50ms -f jsonl");
    assert_eq!(
        without_times(&lines[0]),
        "{\"time\":\"<time>\",\"meter\":\"pqm\",\"unit_id\":17,\"point\":\"ct_primary\",\
         \"value\":600,\"unit\":\"A\",\"status\":\"ok\"}"
    );
    let (lines, _) = stopped_after(1, "TERM", "--every 50ms -f influx");
    assert!(
        lines[0].starts_with("meter,meter=pqm,unit_id=17 "),
        "{}",
        lines[0]
    );
}

#[test]
fn a_file_that_does_not_take_rows_is_told_once_and_gets_them_later() {
    let folder = Folder::new("poll_file_comes_back");
    let mut command = Program::new(POLL)
        .arguments("--every 100ms -q -o log.csv")
        .folder(folder.path())
        .command();
    let mut child = command.stderr(Stdio::piped()).spawn().unwrap();
    // On a machine that is busy slots may be missed, which is told as well.
    let told = BufReader::new(child.stderr.take().unwrap()).lines();
    let mut told = told
        .map(Result::unwrap)
        .filter(|line| !line.starts_with("warning"));
    wait_until(|| folder.names() == ["log.csv"]);
    // Others put something else there at once.
    folder.write("other", "a,b\n1,2\n");
    std::fs::rename(folder.file("other"), folder.file("log.csv")).unwrap();
    let error = told.next().unwrap();
    assert!(error.starts_with("error: log.csv: "), "{error}");
    // And away again.
    std::fs::remove_file(folder.file("log.csv")).unwrap();
    wait_until(|| folder.names() == ["log.csv"] && folder.read("log.csv").lines().count() > 3);
    kill(&child, "TERM");
    child.wait().unwrap();
    assert_eq!(told.next(), None);
    let text = without_times(&folder.read("log.csv"));
    let mut lines = text.lines();
    assert_eq!(
        lines.next(),
        Some("time,meter,unit_id,status,ct_primary,nominal_frequency")
    );
    assert!(lines.all(|line| line == "<time>,pqm,17,ok,600,60"));
}

#[test]
fn what_cannot_be_polled_is_refused_before_anything_is_sent() {
    let cases = [
        (
            POLL.to_owned(),
            2,
            "error: nothing says how often pqm, unit 17 is read\n",
        ),
        (
            format!("{POLL} --every 1m -f jsonl --layout long"),
            2,
            "error: --layout is for --format csv\n",
        ),
        (
            format!("{POLL} --every 1m -f influx --units"),
            2,
            "error: --units is for --format csv\n",
        ),
        (
            format!("{POLL} --every 1m -o {{x}}.csv"),
            2,
            "error: --output {x}.csv: only {meter} can stand in braces\n",
        ),
        (
            "poll -a 17 --meter pqm --every 1m".to_owned(),
            2,
            "error: no port is named\n",
        ),
        (
            "poll -p sim:x -a 17 --meter pqm --every 1m".to_owned(),
            2,
            "error: there is no simulated line 'sim:x'\n",
        ),
    ];
    for (arguments, code, stderr) in cases {
        Program::new(&arguments)
            .arguments("-q")
            .stderr(stderr)
            .code(code)
            .run();
    }
}

#[test]
fn rows_with_different_columns_do_not_go_into_one_file_of_wide_csv() {
    let folder = Folder::new("poll_columns");
    let site = SITE
        .replace("{meter}", "all")
        .replacen("\"nominal_frequency\"", "\"frequency\"", 1);
    folder.write("site.toml", site);
    Program::new("poll --config site.toml -q")
        .folder(folder.path())
        .stderr(
            "error: main, unit 17 and other, unit 17 have different columns, and both would go to \
             log/all.csv\n",
        )
        .code(2)
        .run();
    assert_eq!(folder.names(), ["site.toml"]);
}
