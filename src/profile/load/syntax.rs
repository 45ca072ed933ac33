//! What the TOML parser and serde complain about, told to the person who wrote the file: which key,
//! what stands there, what could stand there.

use std::ops::Range;

use toml::de::{DeTable, DeValue};

use super::Source;
use crate::profile::error::{Problem, ProfileError};

/// The error of a file that is not TOML or does not have the shape of a profile.
pub(super) fn explain(source: &Source<'_>, error: &toml::de::Error) -> ProfileError {
    let at = error.span().unwrap_or_default();
    let message = error.message();
    let Ok(root) = DeTable::parse(source.text) else {
        return not_toml(source, at, message);
    };
    let key = in_table(root.get_ref(), &at, "").unwrap_or_default();
    if let Some(field) = quoted(message, "missing field `") {
        let problem = Problem::Syntax("this key is missing".to_owned());
        return source.error(at, joined(&key, field), problem);
    }
    let expected = message.split_once(", expected ").map(|(_, after)| after);
    let problem = match expected {
        Some(known) if message.starts_with("unknown field `") => {
            let known = known.trim_start_matches("one of ").replace('`', "");
            Problem::Syntax(format!("unknown key, expected {known}"))
        }
        Some(expected) if message.starts_with("invalid ") => Problem::Value {
            found: found(source, &at, message),
            expected: in_words(expected).to_owned(),
        },
        _ => Problem::Syntax(message.replace('\n', ", ")),
    };
    source.error(at, key, problem)
}

fn not_toml(source: &Source<'_>, at: Range<usize>, message: &str) -> ProfileError {
    if message == "duplicate key" {
        let key = source.text.get(at.clone()).unwrap_or_default();
        let problem = Problem::Syntax("this key stands here twice".to_owned());
        return source.error(at, key, problem);
    }
    let problem = Problem::Syntax(format!("not TOML: {}", message.replace('\n', ", ")));
    source.error(at, "", problem)
}

/// The text between this opening and the next backtick.
fn quoted<'a>(message: &'a str, opening: &str) -> Option<&'a str> {
    message.strip_prefix(opening)?.split('`').next()
}

/// What stands there: as it is written, or what kind of value it is where that is long.
fn found(source: &Source<'_>, at: &Range<usize>, message: &str) -> String {
    const LONGEST: usize = 40;
    let written = source.text.get(at.clone()).unwrap_or_default();
    if !written.is_empty() && written.len() <= LONGEST && !written.contains('\n') {
        return written.to_owned();
    }
    // "invalid type: sequence, expected a boolean"
    let kind = message.split_once(": ").map_or(message, |(_, kind)| kind);
    let kind = match kind.split([' ', ',']).next() {
        Some("string") => "this text",
        Some("sequence") => "this list",
        Some("map") => "this table",
        _ => "this",
    };
    kind.to_owned()
}

/// What serde expects, without the names of Rust's types.
fn in_words(expected: &str) -> &str {
    match expected {
        "u8" => "a whole number from 0 to 255",
        "u16" => "a whole number from 0 to 65535",
        "u32" => "a whole number from 0 to 4294967295",
        "i64" => "a whole number",
        "a string" => "text in quotes",
        "a boolean" => "true or false",
        "a sequence" => "a list in [ ]",
        "a map" => "a table",
        _ if expected.starts_with("struct ") => "a table",
        other => other,
    }
}

/// The key at this place, as `limits.pause` or, for a point, `current_a.address`.
fn in_table(table: &DeTable<'_>, at: &Range<usize>, path: &str) -> Option<String> {
    table.iter().find_map(|(key, value)| {
        let path = joined(path, key.get_ref());
        if key.span() == *at || value.span() == *at {
            return Some(path);
        }
        in_value(value.get_ref(), at, &path)
    })
}

fn in_value(value: &DeValue<'_>, at: &Range<usize>, path: &str) -> Option<String> {
    match value {
        DeValue::Table(table) => in_table(table, at, path),
        DeValue::Array(items) => items.iter().find_map(|item| {
            let name = || match item.get_ref() {
                DeValue::Table(row) => row.get("name")?.get_ref().as_str(),
                _ => None,
            };
            let path = match (path, name()) {
                ("points", Some(name)) => name.to_owned(),
                ("operations", Some(name)) => joined(path, name),
                _ => path.to_owned(),
            };
            if item.span() == *at {
                return Some(path);
            }
            in_value(item.get_ref(), at, &path)
        }),
        _ => None,
    }
}

fn joined(path: &str, key: &str) -> String {
    if path.is_empty() {
        return key.to_owned();
    }
    format!("{path}.{key}")
}
