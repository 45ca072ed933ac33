//! Runs `loopback` and compares all it does but the times.

#![allow(dead_code, reason = "each test file uses its share")]

use super::program::{Program, without_times};

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
pub(crate) fn run(arguments: &str) -> (Option<i32>, String, String) {
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
pub(crate) fn check(arguments: &str, code: i32, stdout: &str, stderr: &str) {
    let expected = (Some(code), stdout.to_owned(), stderr.to_owned());
    assert_eq!(run(arguments), expected, "{arguments}");
}
