//! No text stops the program: profiles, selectors and fault rules are read, or refused with a place.

use std::sync::LazyLock;

use meterpoll::profile::advice::advise;
use meterpoll::profile::load::load;
use meterpoll::profile::selector::{Numbering, Purpose, Reading, select};
use meterpoll::profile::{Profile, builtin};
use meterpoll::transport::FaultScript;

use super::cursor::Cursor;

const EM21: &str = include_str!("../../../src/profile/meters/em21.toml");

/// Reads the bytes as text, or as changes to a profile.
pub(crate) fn profile(data: &[u8]) {
    let mut cursor = Cursor::new(data);
    let is_change = cursor.chance();
    let text = if is_change {
        changed(&mut cursor)
    } else {
        String::from_utf8_lossy(&cursor.rest()).into_owned()
    };
    loads(&text);
    if !is_change {
        selects(&text);
        if let Ok(script) = FaultScript::from_text(&text) {
            let again = script.rules().iter().map(ToString::to_string);
            assert_eq!(FaultScript::parse(again).ok().as_ref(), Some(&script));
        }
    }
}

/// A small meter's file with some places overwritten.
fn changed(cursor: &mut Cursor) -> String {
    let mut text: Vec<char> = EM21.chars().collect();
    for _ in 0..=cursor.below(4) {
        let start = cursor.below(65_536) % text.len();
        let end = text.len().min(start + cursor.below(40));
        let length = cursor.below(20);
        let piece = cursor.take(length);
        text.splice(start..end, String::from_utf8_lossy(&piece).chars());
    }
    text.into_iter().collect()
}

fn loads(text: &str) {
    let lines = 1..=text.matches('\n').count() + 1;
    let loaded = load("m.toml", text);
    if let Err(error) = &loaded {
        assert!(lines.contains(&error.line), "{error}");
        assert!(!error.problem.to_string().is_empty());
    }
    let advised = advise("m.toml", text);
    assert_eq!(advised.is_ok(), loaded.is_ok());
    for advice in advised.map(|(_, advice)| advice).unwrap_or_default() {
        assert!(lines.contains(&advice.line));
    }
}

fn selects(text: &str) {
    static METER: LazyLock<Profile> =
        LazyLock::new(|| builtin::find("em21").expect("it is built in").profile());
    let words: Vec<String> = text.split_whitespace().map(str::to_owned).collect();
    for profile in [None, Some(&*METER)] {
        for numbering in [Numbering::Protocol, Numbering::Modicon] {
            for purpose in [Purpose::Read, Purpose::LookUp] {
                let reading = Reading {
                    numbering,
                    function: None,
                    profile,
                    purpose,
                };
                match select(&words, reading) {
                    Ok(points) => assert!(!points.is_empty()),
                    Err(error) => assert!(!error.to_string().is_empty()),
                }
            }
        }
    }
}
