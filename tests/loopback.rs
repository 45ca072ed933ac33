//! `loopback` over a terminal, to the letter.

#![cfg(unix)]

mod support {
    pub(crate) mod program;
    pub(crate) mod pty;
    pub(crate) mod run;
    pub(crate) mod tried;
}

use std::path::PathBuf;
use std::time::Duration;

use support::pty::{self, PtyMeter};
use support::run::Run;
use support::tried::{check, run};

/// What is said where answers get through beside noise.
const WIRING: &str = "hint: answers get through, so the setting is right: check the cable, its \
                      termination at both ends, bias resistors and shield\n";

/// What is said where only our echo comes back.
const ONLY_ECHO: &str = "hint: the adapter hears itself but no meter: check --unit, --baud and \
                         --parity, then the wiring behind the adapter\n";

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
fn a_signal_ends_it_with_the_summary() {
    for (format, signal, number) in [("table", "INT", 2), ("json", "TERM", 15)] {
        let meter = meter(|request| healthy(17, request));
        let arguments = format!("loopback -p {} -a 17 --forever -t 20s", meter.path());
        let mut run = Run::start(&format!("{arguments} --interval 1ms -f {format}"));
        run.wait_for_lines(5);
        run.signal(signal);
        let end = run.end();
        assert_eq!(end.signal, Some(number));
        let text = end.stdout;
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
fn a_signal_ends_an_interval() {
    let arguments = "loopback -p sim: -a 17 --forever --interval 20h --meter pqm -f csv";
    let mut run = Run::start(arguments);
    // The header and a row.
    run.wait_for_lines(2);
    run.signal("INT");
    let end = run.end();
    assert_eq!(end.signal, Some(2));
    let verdict = "the line is good: 1 of 1 answered, no damage, no noise\n";
    assert!(end.stderr.ends_with(verdict), "{}", end.stderr);
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
