//! `loopback` over a terminal and on the simulated line, to the letter.

#![cfg(unix)]

mod support {
    pub(crate) mod program;
    pub(crate) mod pty;
}

use std::io::{BufRead, BufReader, Read};
use std::os::unix::process::ExitStatusExt;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use support::program::{Program, without_times};
use support::pty::{self, PtyMeter};

/// What is said where answers get through beside noise.
const WIRING: &str = "hint: answers get through, so the setting is right: check the cable, its \
                      termination at both ends, bias resistors and shield\n";

/// What is said where only our echo comes back.
const ONLY_ECHO: &str = "hint: the adapter hears itself but no meter: check --unit, --baud and \
                         --parity, then the wiring behind the adapter\n";

/// Every number with one decimal is a time that was measured, unless it is a percentage.
fn without_answer_times(text: &str) -> String {
    let mut result = String::new();
    let mut rest = text;
    while let Some(at) = rest.find(|c: char| c.is_ascii_digit()) {
        let (before, number) = rest.split_at(at);
        let end = number.find(|c: char| !c.is_ascii_digit() && c != '.');
        let (number, after) = number.split_at(end.unwrap_or(number.len()));
        let decimal = number
            .split_once('.')
            .map(|(_, decimal)| decimal.as_bytes());
        let is_time = matches!(decimal, Some([b'0'..=b'9'])) && !after.starts_with(" %");
        result.push_str(before);
        result.push_str(if is_time { "<ms>" } else { number });
        rest = after;
    }
    result + rest
}

/// What the program did: exit code, stdout, stderr, without times.
fn run(arguments: &str) -> (Option<i32>, String, String) {
    let output = Program::new(&format!("loopback {arguments}")).output();
    let text = |bytes: Vec<u8>| {
        let text = String::from_utf8(bytes).expect("UTF-8");
        without_answer_times(&without_times(&text))
    };
    (
        output.status.code(),
        text(output.stdout),
        text(output.stderr),
    )
}

#[track_caller]
fn check(arguments: &str, code: i32, stdout: &str, stderr: &str) {
    let expected = (Some(code), stdout.to_owned(), stderr.to_owned());
    assert_eq!(run(arguments), expected, "{arguments}");
}

/// A healthy meter at `unit`: it sends back any word, and has registers.
fn healthy(unit: u16, request: &[u8]) -> Vec<u8> {
    match request {
        [first, 0x08, ..] if u16::from(*first) == unit => request.to_vec(),
        _ => pty::answer(unit, request).unwrap_or_default(),
    }
}

fn meter(behaviour: impl FnMut(&[u8]) -> Vec<u8> + Send + 'static) -> PtyMeter {
    PtyMeter::new(Box::new(behaviour))
}

/// A profile of a meter that is given up soon.
fn quick(file: &str) -> String {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(file);
    let profile = "name = \"quick\"\ntitle = \"Quick\"\nmanual = \"none\"\n\
                   limits = { functions = [3, 8], longest_answer = \"100ms\" }\n\
                   [[points]]\nname = \"a\"\naddress = 0\ntype = \"u16\"\n";
    std::fs::write(&path, profile).expect("the folder for tests is writable");
    path.to_str().expect("text").to_owned()
}

#[test]
fn a_good_line_is_called_good() {
    let meter = meter(|request| healthy(17, request));
    let port = meter.path();
    check(
        &format!("-p {port} -a 17 --count 3 -t 10s"),
        0,
        &format!(
            "unit 17 on {port} at 9600 8N1, <time>\n\
             1: 0x0000 back after <ms> ms\n\
             2: 0xFFFF back after <ms> ms\n\
             3: 0x5555 back after <ms> ms\n\
             \n\
             3 tries, 3 answered, 0 lost (0.0 %)\n\
             answer times: min <ms>, median <ms>, p95 <ms>, max <ms>, jitter <ms> ms\n\
             damaged answers: 0, noise bytes: 0, late answers: 0, frames of others: 0, echo: no\n\
             the line is good: 3 of 3 answered, no damage, no noise\n"
        ),
        "",
    );
    let frames: Vec<Vec<u8>> = meter.requests();
    assert_eq!(frames.len(), 4);
    assert_eq!(frames[0][..6], [0x11, 0x03, 0, 0, 0, 1]);
    assert_eq!(frames[3][..6], [0x11, 0x08, 0, 0, 0x55, 0x55]);
}

#[test]
fn there_are_twenty_tries_unless_told_otherwise() {
    let meter = meter(|request| healthy(17, request));
    let (code, _, _) = run(&format!("-p {} -a 17 -t 10s -q", meter.path()));
    assert_eq!(code, Some(0));
    assert_eq!(meter.requests().len(), 21);
}

#[test]
fn a_silent_line_is_bad_and_ends_with_4() {
    let meter = meter(|_| Vec::new());
    let profile = quick("loopback-silent.toml");
    let port = meter.path();
    check(
        &format!("-p {port} -a 17 --meter {profile} --count 2"),
        4,
        &format!(
            "quick, unit 17 on {port} at 9600 8N1, <time>\n\
             1: no answer within 100ms\n\
             2: no answer within 100ms\n\
             \n\
             2 tries, 0 answered, 2 lost (100.0 %)\n\
             damaged answers: 0, noise bytes: 0, late answers: 0, frames of others: 0, echo: no\n\
             the line is bad: none of 2 answered\n"
        ),
        "hint: check --unit, --baud, --parity and --stop-bits against the meter, then power and \
         wiring (A and B swapped?); a slow meter needs a longer --timeout\n",
    );
}

#[test]
fn a_damaged_answer_is_told_and_some_answers_end_with_1() {
    let mut words = 0;
    let meter = meter(move |request| {
        let mut answer = healthy(17, request);
        words += u32::from(request[1] == 0x08);
        if words == 2 {
            answer[4] ^= 0x01;
        }
        answer
    });
    check(
        &format!("-p {} -a 17 --count 3 -t 1s -q", meter.path()),
        1,
        "1: 0x0000 back after <ms> ms\n\
         2: the answer was damaged: 8 bytes without a valid CRC\n\
         3: 0x5555 back after <ms> ms\n\
         \n\
         3 tries, 2 answered, 1 lost (33.3 %)\n\
         answer times: min <ms>, median <ms>, p95 <ms>, max <ms>, jitter <ms> ms\n\
         damaged answers: 1, noise bytes: 0, late answers: 0, frames of others: 0, echo: no\n\
         the line is bad: 2 of 3 answered, 1 damaged answer\n",
        "",
    );
}

#[test]
fn noise_makes_a_line_doubtful_though_every_word_came_back() {
    let meter = meter(|request| {
        let mut answer = healthy(17, request);
        if request[1] == 0x08 {
            answer.splice(..0, [0x00, 0xFF]);
        }
        answer
    });
    let port = meter.path();
    check(
        &format!("-p {port} -a 17 --count 2 -t 10s"),
        0,
        &format!(
            "unit 17 on {port} at 9600 8N1, <time>\n\
             1: 0x0000 back after <ms> ms\n\
             2: 0xFFFF back after <ms> ms\n\
             \n\
             2 tries, 2 answered, 0 lost (0.0 %)\n\
             answer times: min <ms>, median <ms>, p95 <ms>, max <ms>, jitter <ms> ms\n\
             damaged answers: 0, noise bytes: 4, late answers: 0, frames of others: 0, echo: no\n\
             the line is doubtful: 2 of 2 answered, 4 noise bytes\n"
        ),
        WIRING,
    );
}

#[test]
fn a_meter_that_refuses_every_word_ends_with_5() {
    // A meter of these tests knows reads alone, and calls anything else an illegal address.
    let meter = PtyMeter::healthy(17);
    let port = meter.path();
    check(
        &format!("-p {port} -a 17 --count 2 -t 10s"),
        5,
        &format!(
            "unit 17 on {port} at 9600 8N1, <time>\n\
             1: the meter refused: exception 02 (ILLEGAL DATA ADDRESS)\n\
             2: the meter refused: exception 02 (ILLEGAL DATA ADDRESS)\n\
             \n\
             2 tries, 0 answered, 2 refused, 0 lost (0.0 %)\n\
             damaged answers: 0, noise bytes: 0, late answers: 0, frames of others: 0, echo: no\n\
             the line carries every frame, but the meter refused 2 of 2\n"
        ),
        "hint: name the meter with --meter: a profile knows what its meter sends back, and \
         whether it has function 08 at all\n",
    );
}

#[test]
fn an_echo_is_never_taken_for_a_meter() {
    let profile = quick("loopback-echo.toml");
    for option in ["", "--echo on", "--echo off"] {
        let meter = meter(<[u8]>::to_vec);
        let port = meter.path();
        check(
            &format!("-p {port} -a 17 --meter {profile} --count 2 {option}"),
            4,
            &format!(
                "quick, unit 17 on {port} at 9600 8N1, <time>\n\
                 1: nothing but the echo of the own request came back\n\
                 2: nothing but the echo of the own request came back\n\
                 \n\
                 2 tries, 0 answered, 2 lost (100.0 %)\n\
                 damaged answers: 0, noise bytes: 0, late answers: 0, frames of others: 0, \
                 echo: yes\n\
                 the line is bad: only our own echo comes back, no meter answers\n"
            ),
            ONLY_ECHO,
        );
    }
}

#[test]
fn a_meter_behind_an_echo_is_heard() {
    for option in ["", "--echo on", "--echo off"] {
        let meter = meter(|request| [request.to_vec(), healthy(17, request)].concat());
        check(
            &format!("-p {} -a 17 --count 2 -t 10s -q {option}", meter.path()),
            0,
            "1: 0x0000 back after <ms> ms\n\
             2: 0xFFFF back after <ms> ms\n\
             \n\
             2 tries, 2 answered, 0 lost (0.0 %)\n\
             answer times: min <ms>, median <ms>, p95 <ms>, max <ms>, jitter <ms> ms\n\
             damaged answers: 0, noise bytes: 0, late answers: 0, frames of others: 0, echo: yes\n\
             the line is good: 2 of 2 answered, no damage, no noise\n",
            "",
        );
    }
}

#[test]
fn an_echo_that_is_said_to_be_there_and_is_not_is_told() {
    let meter = meter(|request| healthy(17, request));
    let port = meter.path();
    let arguments = format!("-p {port} -a 17 --count 1 -t 1s --echo on");
    check(
        &arguments,
        4,
        &format!(
            "unit 17 on {port} at 9600 8N1, <time>\n\
             1: nothing but the echo of the own request came back\n\
             \n\
             1 try, 0 answered, 1 lost (100.0 %)\n\
             damaged answers: 0, noise bytes: 0, late answers: 0, frames of others: 0, echo: no\n\
             the line is bad: none of 1 answered\n"
        ),
        "hint: the line does not echo: leave --echo on out\n",
    );
}

#[test]
fn late_answers_are_thrown_away_and_told() {
    // The read at the beginning is answered late as well.
    let meter = meter(|request| {
        std::thread::sleep(Duration::from_millis(300));
        healthy(17, request)
    });
    let port = meter.path();
    let (code, stdout, _) = run(&format!("-p {port} -a 17 --count 2 -t 100ms -q"));
    assert_eq!(code, Some(4));
    assert_eq!(
        stdout,
        "1: no answer within 100ms\n\
         2: no answer within 100ms\n\
         \n\
         2 tries, 0 answered, 2 lost (100.0 %)\n\
         damaged answers: 0, noise bytes: 0, late answers: 2, frames of others: 0, echo: no\n\
         the line is bad: none of 2 answered, 2 late answers\n"
    );
}

#[test]
fn a_pqm_is_sent_zeros_alone() {
    let meter = meter(|request| healthy(17, request));
    let port = meter.path();
    let (code, stdout, _) = run(&format!("-p {port} -a 17 --meter pqm --count 3 -t 10s -q"));
    assert_eq!(code, Some(0));
    assert!(stdout.starts_with("1: 0x0000 back after <ms> ms\n2: 0x0000 back after"));
    for frame in &meter.requests()[1..] {
        assert_eq!(frame[..6], [0x11, 0x08, 0, 0, 0, 0]);
    }
}

#[test]
fn every_simulated_meter_sends_back_what_its_profile_says() {
    for (unit, meter) in [(1, "em24"), (2, "pm290"), (3, "em21"), (17, "pqm")] {
        let (code, stdout, stderr) = run(&format!(
            "-p sim: -a {unit} --meter {meter} --count 36 -b 115200 -f csv"
        ));
        assert_eq!((code, stdout.lines().count()), (Some(0), 37), "{meter}");
        assert!(
            stderr.ends_with("the line is good: 36 of 36 answered, no damage, no noise\n"),
            "{meter}: {stderr}"
        );
    }
}

#[test]
fn csv_has_a_row_a_try_and_the_summary_on_stderr() {
    check(
        "-p sim: -a 17,3 --count 2 -f csv",
        1,
        "time,meter,unit_id,try,word,status,answer_ms\n\
         <time>,,17,1,0x0000,ok,<ms>\n\
         <time>,,17,2,0xFFFF,exception:3,\n\
         <time>,,3,1,0x0000,ok,<ms>\n\
         <time>,,3,2,0xFFFF,ok,<ms>\n",
        "2 tries, 1 answered, 1 refused, 0 lost (0.0 %)\n\
         answer times: min <ms>, median <ms>, p95 <ms>, max <ms> ms\n\
         damaged answers: 0, noise bytes: 0, late answers: 0, frames of others: 0, echo: no\n\
         the line carries every frame, but the meter refused 1 of 2\n\
         hint: name the meter with --meter: a profile knows what its meter sends back, and \
         whether it has function 08 at all\n\
         2 tries, 2 answered, 0 lost (0.0 %)\n\
         answer times: min <ms>, median <ms>, p95 <ms>, max <ms>, jitter <ms> ms\n\
         damaged answers: 0, noise bytes: 0, late answers: 0, frames of others: 0, echo: no\n\
         the line is good: 2 of 2 answered, no damage, no noise\n",
    );
    check(
        "-p sim: -a 17 --meter pqm --count 1 -f csv -q",
        0,
        "time,meter,unit_id,try,word,status,answer_ms\n<time>,pqm,17,1,0x0000,ok,<ms>\n",
        "",
    );
}

#[test]
fn json_is_one_object_with_settings_tries_and_summary() {
    check(
        "-p sim: -a 3,9 --count 1 -b 19200 -P even -t 50ms -f json -q",
        1,
        "{\"port\":\"sim:\",\"baud\":19200,\"parity\":\"even\",\"stop_bits\":1,\"timeout\":\"50ms\",\
         \"interval\":\"0s\",\"count\":1,\"units\":[\n\
         {\"meter\":null,\"unit_id\":3,\"tries\":[\n\
         {\"time\":\"<time>\",\"try\":1,\"word\":\"0x0000\",\"status\":\"ok\",\"answer_ms\":<ms>}\n\
         ],\"summary\":{\"tries\":1,\"answered\":1,\"refused\":0,\"lost\":0,\"min_ms\":<ms>,\
         \"median_ms\":<ms>,\"p95_ms\":<ms>,\"max_ms\":<ms>,\"jitter_ms\":null,\
         \"damaged_answers\":0,\"noise_bytes\":0,\"late_answers\":0,\"other_frames\":0,\
         \"echo\":false,\"verdict\":\"good\",\
         \"words\":\"the line is good: 1 of 1 answered, no damage, no noise\"}},\n\
         {\"meter\":null,\"unit_id\":9,\"tries\":[\n\
         {\"time\":\"<time>\",\"try\":1,\"word\":\"0x0000\",\"status\":\"timeout\",\"answer_ms\":null}\n\
         ],\"summary\":{\"tries\":1,\"answered\":0,\"refused\":0,\"lost\":1,\"min_ms\":null,\
         \"median_ms\":null,\"p95_ms\":null,\"max_ms\":null,\"jitter_ms\":null,\
         \"damaged_answers\":0,\"noise_bytes\":0,\"late_answers\":0,\"other_frames\":0,\
         \"echo\":false,\"verdict\":\"bad\",\"words\":\"the line is bad: none of 1 answered\"}}\n\
         ]}\n",
        "",
    );
}

#[test]
fn several_units_get_a_block_each() {
    let (code, stdout, stderr) = run("-p sim: -a 1,3 --count 1 -q");
    assert_eq!((code, stderr.as_str()), (Some(0), ""));
    assert!(
        stdout.starts_with("unit 1\n1: 0x0000 back after <ms> ms\n"),
        "{stdout}"
    );
    assert!(
        stdout.contains("no noise\n\nunit 3\n1: 0x0000 back after <ms> ms\n"),
        "{stdout}"
    );
}

#[test]
fn a_signal_ends_it_with_the_summary() {
    for (format, signal, number) in [("table", "INT", 2), ("json", "TERM", 15)] {
        let meter = meter(|request| healthy(17, request));
        let arguments = format!("loopback -p {} -a 17 --forever -t 20s", meter.path());
        let mut child = Program::new(&format!("{arguments} --interval 1ms -f {format}"))
            .command()
            .stdout(Stdio::piped())
            .spawn()
            .expect("the program starts");
        let mut out = BufReader::new(child.stdout.take().expect("it is piped"));
        let mut text = String::new();
        for _ in 0..5 {
            out.read_line(&mut text).expect("a line");
        }
        let pid = child.id().to_string();
        let kill = Command::new("kill").args(["-s", signal, &pid]).status();
        assert!(kill.expect("kill is there").success());
        out.read_to_string(&mut text).expect("the rest");
        assert_eq!(child.wait().expect("it ends").signal(), Some(number));
        if format == "json" {
            let object: serde_json::Value = serde_json::from_str(&text).expect("JSON");
            assert_eq!(object["count"], serde_json::Value::Null);
            let unit = &object["units"][0];
            let tries = unit["tries"].as_array().expect("an array").len();
            assert!(tries >= 3, "{text}");
            assert_eq!(unit["summary"]["answered"], tries);
        } else {
            assert!(text.ends_with("answered, no damage, no noise\n"), "{text}");
        }
    }
}

#[test]
fn an_interval_is_kept_from_start_to_start() {
    let start = Instant::now();
    let (code, _, _) = run("-p sim: -a 17 --meter pqm --count 4 --interval 80ms -q");
    assert_eq!(code, Some(0));
    // Nothing is waited for behind the last.
    assert!(start.elapsed() >= Duration::from_millis(240));
}

#[test]
fn a_signal_ends_an_interval() {
    let arguments = "loopback -p sim: -a 17 --forever --interval 20h --meter pqm -f csv";
    let mut child = Program::new(arguments)
        .command()
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let mut lines = BufReader::new(child.stdout.take().expect("it is piped")).lines();
    assert!(lines.nth(1).is_some(), "header and row are out");
    let pid = child.id().to_string();
    let kill = Command::new("kill").args(["-s", "INT", &pid]).status();
    assert!(kill.expect("kill is there").success());
    let output = child.wait_with_output().expect("it ends");
    assert_eq!(output.status.signal(), Some(2));
    let stderr = String::from_utf8(output.stderr).expect("text");
    assert!(stderr.ends_with("the line is good: 1 of 1 answered, no damage, no noise\n"));
}

#[test]
fn a_port_that_is_lost_ends_it_with_3_whatever_came_before() {
    for (requests, tried) in [
        (1, ""),
        (2, "<time>,,17,1,0x0000,port,\n"),
        (
            3,
            "<time>,,17,1,0x0000,ok,<ms>\n<time>,,17,2,0xFFFF,port,\n",
        ),
    ] {
        let behaviour = Box::new(|request: &[u8]| healthy(17, request));
        let line = PtyMeter::hanging_up(behaviour, requests);
        let port = line.path();
        let (code, stdout, stderr) = run(&format!("-p {port} -a 17,18 -f csv -q -t 10s"));
        assert_eq!(code, Some(3));
        assert_eq!(
            stdout,
            format!("time,meter,unit_id,try,word,status,answer_ms\n{tried}")
        );
        let error = format!("error: unit 17 on {port} at 9600 8N1: port {port} was lost\n");
        assert!(stderr.starts_with(&error), "{stderr}");
        assert!(
            stderr.ends_with("error: 1 more unit was not tried\n"),
            "{stderr}"
        );
    }
}

#[test]
fn a_port_that_is_not_there_ends_it_with_3() {
    let (code, stdout, stderr) = run("-p /dev/ttyNone -a 17");
    assert_eq!((code, stdout.as_str()), (Some(3), ""));
    assert!(stderr.starts_with("error: "), "{stderr}");
}

#[test]
fn what_cannot_be_tested_is_refused_before_sending() {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("loopback-none.toml");
    let profile = "name = \"none\"\ntitle = \"None\"\nmanual = \"none\"\n\
                   [[points]]\nname = \"a\"\naddress = 0\ntype = \"u16\"\n";
    std::fs::write(&path, profile).expect("the folder for tests is writable");
    for (arguments, stderr) in [
        (
            format!("-a 17 --meter {}", path.display()),
            "error: none does not answer function 08\n\
             hint: without --meter it is sent all the same, and the meter may refuse it\n",
        ),
        (
            "-a 1,2 --forever".to_owned(),
            "error: --forever is for one unit\n",
        ),
        (
            "-a 0".to_owned(),
            "error: unit 0 is the broadcast address, which no meter answers\n\
             hint: a read needs one meter: --unit 1 to 247\n",
        ),
        (
            "-a 17 --retries 1".to_owned(),
            "error: invalid value '1' for '--retries <COUNT>': each try is made once; --count \
             says how many there are\n\n\
             For more information, try '--help'.\n",
        ),
        (
            "-a 17 --count 0".to_owned(),
            "error: invalid value '0' for '--count <COUNT>': 0 is not in 1..=1000000\n\n\
             For more information, try '--help'.\n",
        ),
    ] {
        check(&format!("-p sim: {arguments}"), 2, "", stderr);
    }
}

#[test]
fn a_dry_run_prints_what_would_be_sent() {
    check(
        "-a 17,18 --count 2 --dry-run",
        0,
        "11 03 00 00 00 01 86 9A\n\
         11 08 00 00 00 00 E2 9B\n\
         11 08 00 00 FF FF E3 2B\n\
         12 08 00 00 00 00 E2 A8\n\
         12 08 00 00 FF FF E3 18\n",
        "",
    );
    check(
        "-a 17 --meter pqm --count 2 --dry-run",
        0,
        "11 03 00 00 00 01 86 9A\n11 08 00 00 00 00 E2 9B\n11 08 00 00 00 00 E2 9B\n",
        "",
    );
}
