//! Site files: what is polled, checked before anything is.

use std::path::{Path, PathBuf};
use std::time::Duration;

use meterpoll::client::Echo;
use meterpoll::polling::site::load::{file, load};
use meterpoll::polling::site::{
    ColumnUnits, FailedRows, OnSchemaChange, PathError, PathTemplate, RowForm, RowSync,
};
use meterpoll::polling::{Every, Site};

/// A whole one.
const SITE: &str = r#"
[defaults]
every = "15m"
retries = 1
output = "log"

[[lines]]
name = "hall"
port = "/dev/ttyUSB0"
parity = "even"
echo = "on"
settle = "1s"
wait = "20s"

[[lines]]
name = "roof"
port = "/dev/ttyUSB1"

[[meters]]
name = "main"
line = "hall"
unit = 17
profile = "pqm"
timeout = "300ms"
pause = "10ms"

[[meters]]
name = "press"
line = "roof"
unit = 3
profile = "em24"
retries = 0

[[meters.groups]]
points = ["@power"]
every = "10s"
output = "fast"

[[meters.groups]]
points = ["energy_active_import_l1", "0x0000"]

[[meters]]
name = "unknown"
line = "roof"
unit = 4
points = ["0x0010+2"]

[[outputs]]
name = "log"
path = "log/{meter}-%Y-%m-%d.csv"
units = true
no_sync = true

[[outputs]]
name = "fast"
format = "csv"
layout = "long"
on_schema_change = "new-file"
skip_failed = true
"#;

fn site(text: &str) -> Site {
    load("site.toml", text, "etc").unwrap()
}

fn every(text: &str) -> Every {
    Every::new(text.parse::<humantime::Duration>().unwrap().into()).unwrap()
}

#[test]
fn a_site_file_says_what_is_read_where_and_how_often() {
    let site = site(SITE);
    let names: Vec<&str> = site.lines.iter().map(|line| &*line.name).collect();
    assert_eq!(names, ["hall", "roof"]);
    let hall = &site.lines[0];
    assert_eq!(hall.port, "/dev/ttyUSB0");
    assert_eq!(hall.settings.to_string(), "9600 8E1");
    assert_eq!(hall.echo, Echo::On);
    assert_eq!(hall.settle, Duration::from_secs(1));
    assert_eq!(hall.wait, Duration::from_secs(20));
    assert_eq!(site.lines[1].wait, Duration::from_secs(5));

    let jobs: Vec<_> = site
        .jobs
        .iter()
        .map(|job| (job.subject.to_string(), job.subject.line, job.meter))
        .collect();
    assert_eq!(
        jobs,
        [
            ("main, unit 17".to_owned(), 0, 0),
            ("press, unit 3".to_owned(), 1, 1),
            ("press, unit 3".to_owned(), 1, 1),
            ("unknown, unit 4".to_owned(), 1, 2),
        ]
    );
    let intervals: Vec<_> = site.jobs.iter().filter_map(|job| job.every).collect();
    assert_eq!(
        intervals,
        [every("15m"), every("10s"), every("15m"), every("15m")]
    );
    let outputs: Vec<_> = site.jobs.iter().map(|job| job.output).collect();
    assert_eq!(outputs, [0, 1, 0, 0]);
    let main = &site.jobs[0];
    assert_eq!(main.patience.timeout, Duration::from_millis(300));
    assert_eq!(main.patience.retries, 1);
    assert_eq!(main.patience.pause, Duration::from_millis(10));
    assert_eq!(site.jobs[1].patience.retries, 0);
    let names: Vec<&str> = site.jobs[2].points.iter().map(|p| &*p.name).collect();
    assert_eq!(names, ["energy_active_import_l1", "0x0000"]);
    assert_eq!(site.jobs[3].points.len(), 2);
    assert_eq!(
        site.jobs_on(1).map(|(index, _)| index).collect::<Vec<_>>(),
        [1, 2, 3]
    );
}

#[test]
fn outputs_have_a_file_a_form_and_a_way_with_trouble() {
    let site = site(SITE);
    let [log, fast] = &site.outputs[..] else {
        panic!("{:?}", site.outputs);
    };
    assert_eq!(log.form, RowForm::WideCsv(ColumnUnits::Shown));
    assert_eq!(log.syncing, RowSync::Never);
    assert_eq!(log.on_schema_change, OnSchemaChange::Refuse);
    assert_eq!(log.failed, FailedRows::Written);
    let path = log.path.as_ref().unwrap();
    let time = "2026-01-31T23:59:59.999Z".parse().unwrap();
    assert_eq!(
        path.at("main", time),
        Path::new("etc/log/main-2026-01-31.csv")
    );
    assert!(path.names_the_meter());
    assert_eq!(fast.path, None);
    assert_eq!(fast.form, RowForm::LongCsv);
    assert_eq!(fast.on_schema_change, OnSchemaChange::NewFile);
    assert_eq!(fast.failed, FailedRows::Skipped);
}

#[test]
fn the_shortest_site_prints_wide_csv_and_sets_its_line_as_the_meter_leaves_the_factory() {
    let site = site(
        "[[lines]]\nname = \"l\"\nport = \"sim:\"\n[[meters]]\nname = \"m\"\nunit = 17\nprofile = \"pqm\"\n",
    );
    assert_eq!(site.outputs.len(), 1);
    assert_eq!(site.outputs[0].path, None);
    assert_eq!(site.jobs[0].every, None);
    assert_eq!(site.jobs[0].patience.retries, 2);
    assert_eq!(site.lines[0].settings.to_string(), "9600 8N1");
}

#[test]
fn two_meters_of_one_unit_on_one_line_can_have_different_names() {
    let text = SITE.replace("unit = 4", "unit = 3");
    assert_eq!(site(&text).jobs.len(), 4);
}

/// What is said of the site when this stands in place of that.
#[track_caller]
fn wrong(that: &str, this: &str, expected: &str) {
    assert!(SITE.contains(that), "{that}");
    let text = SITE.replacen(that, this, 1);
    let error = load("site.toml", &text, "").unwrap_err();
    assert_eq!(error.to_string(), expected, "{this}");
}

#[test]
fn what_is_wrong_is_told_with_file_line_and_key() {
    wrong(
        "retries = 1",
        "retry = 1",
        "site.toml:4: defaults.retry: unknown key, expected every, timeout, retries, pause, output",
    );
    wrong(
        "retries = 1",
        "retries = 101",
        "site.toml:4: defaults.retries: 101 is not 0 to 100",
    );
    wrong(
        "retries = 1",
        "retries = \"1\"",
        "site.toml:4: defaults.retries: \"1\" is not a whole number from 0 to 4294967295",
    );
    wrong(
        "\"15m\"",
        "\"15\"",
        "site.toml:3: defaults.every: \"15\" is not a duration with its unit, such as \"500ms\", at most 24h",
    );
    wrong(
        "\"10s\"",
        "\"1ms\"",
        "site.toml:36: meters.press.every: \"1ms\" is not an interval, from 10ms to 24h",
    );
    wrong(
        "\"300ms\"",
        "\"0s\"",
        "site.toml:24: meters.main.timeout: \"0s\" is not above 0: no meter answers in no time",
    );
    wrong(
        "parity = \"even\"",
        "parity = \"mark\"",
        "site.toml:10: lines.hall.parity: \"mark\" is not \"none\", \"even\" or \"odd\"",
    );
    wrong(
        "parity = \"even\"",
        "stop_bits = 3",
        "site.toml:10: lines.hall.stop_bits: 3 is not 1 or 2",
    );
    wrong(
        "parity = \"even\"",
        "baud = 0",
        "site.toml:10: lines.hall.baud: 0 is not a speed from 50 bits a second",
    );
    wrong(
        "line = \"hall\"",
        "line = \"hell\"",
        "site.toml:21: meters.main.line: there is no line 'hell'; there are hall, roof",
    );
    wrong(
        "line = \"hall\"\n",
        "",
        "site.toml:20: meters.main.line: this key is missing: there are several lines",
    );
    wrong(
        "unit = 17",
        "unit = 0",
        "site.toml:22: meters.main.unit: unit 0 is the broadcast address, which no meter answers",
    );
    wrong(
        "profile = \"pqm\"",
        "profile = \"pqn\"",
        "site.toml:23: meters.main.profile: there is no meter 'pqn'; known are em21, em24, pm290, pqm",
    );
    wrong(
        "\"@power\"",
        "\"@powers\"",
        "site.toml:35: meters.press.points: em24 has no group '@powers'; its groups are @all, @counter, @current, @default, @demand, @energy, @frequency, @identity, @minmax, @power, @resets, @setpoints, @status, @voltage",
    );
    wrong(
        "output = \"fast\"",
        "output = \"slow\"",
        "site.toml:37: meters.press.output: there is no output 'slow'; there are log, fast",
    );
    wrong(
        "retries = 0\n",
        "points = [\"@power\"]\n",
        "site.toml:32: meters.press.points: a meter has points or groups, not both",
    );
    wrong(
        "layout = \"long\"",
        "units = false\nlayout = \"long\"",
        "site.toml:57: outputs.fast.units: only wide CSV has units in its header",
    );
    wrong(
        "format = \"csv\"",
        "format = \"jsonl\"",
        "site.toml:57: outputs.fast.layout: only CSV has a layout",
    );
    wrong(
        "{meter}",
        "{metre}",
        "site.toml:50: outputs.log.path: only {meter} can stand in braces",
    );
    wrong(
        "[[outputs]]",
        "[[outputs]",
        "site.toml:48: not TOML: unclosed array table, expected `]`",
    );
}

#[test]
fn a_name_is_there_once_and_makes_a_name_of_a_file() {
    wrong(
        "name = \"press\"",
        "name = \"main\"",
        "site.toml:28: meters.main.name: there is a meter of this name in line 20 already",
    );
    wrong(
        "name = \"roof\"",
        "name = \"hall\"",
        "site.toml:16: lines.hall.name: there is a line of this name in line 8 already",
    );
    wrong(
        "name = \"main\"",
        "name = \"../main\"",
        "site.toml:20: meters.name: '../main' is no name: letters, digits, '_', '-' and '.', a letter or digit first",
    );
}

#[test]
fn what_must_be_there_is_asked_for() {
    let error = load("a.toml", "", "").unwrap_err();
    assert_eq!(error.to_string(), "a.toml:1: lines: this key is missing");
    let error = load("a.toml", "lines = []\nmeters = []", "").unwrap_err();
    assert_eq!(
        error.to_string(),
        "a.toml:1: lines: this key is missing: a site has one at least"
    );
}

#[test]
fn a_file_that_cannot_be_read_is_named() {
    let error = file(Path::new("/nonexistent/site.toml")).unwrap_err();
    assert_eq!(
        error.to_string(),
        "site /nonexistent/site.toml cannot be read"
    );
}

#[test]
fn a_path_has_the_meter_and_the_time_in_utc_in_it() {
    let time = "2026-03-01T00:30:00+02:00".parse().unwrap();
    let at = |text: &str| PathTemplate::new("", text).unwrap().at("a%b", time);
    assert_eq!(at("log.csv"), PathBuf::from("log.csv"));
    assert_eq!(at("/var/{meter}.csv"), PathBuf::from("/var/a%b.csv"));
    assert_eq!(at("%Y/%j-%H-{meter}"), PathBuf::from("2026/059-22-a%b"));
    assert_eq!(at("100%%.csv"), PathBuf::from("100%.csv"));
    assert_eq!(PathTemplate::new("", ""), Err(PathError::Empty));
    assert_eq!(PathTemplate::new("", "{x}"), Err(PathError::Braces));
    for wrong in ["%", "a%!b", "%Y-%"] {
        let error = PathTemplate::new("", wrong).unwrap_err();
        assert!(matches!(error, PathError::Field(_)), "{wrong}");
    }
}
