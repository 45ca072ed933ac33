//! What the TOML parser and serde complain about, told with the key it is about.

use std::ops::Range;

use toml::de::{DeTable, DeValue};

use super::error::{SiteError, SiteProblem};
use super::source::Source;

/// The error of a file that is not TOML or does not have the shape of a site.
pub(super) fn explain(source: &Source<'_>, error: &toml::de::Error) -> SiteError {
    let at = error.span().unwrap_or_default();
    let message = error.message().replace('\n', ", ");
    let Ok(root) = DeTable::parse(source.text) else {
        let problem = SiteProblem::Syntax(format!("not TOML: {message}"));
        return source.error(at, "", problem);
    };
    let key = in_table(root.get_ref(), &at, "").unwrap_or_default();
    if let Some(field) = message.strip_prefix("missing field `") {
        let field = field.trim_end_matches('`');
        let problem = SiteProblem::Syntax("this key is missing".to_owned());
        return source.error(at, joined(&key, field), problem);
    }
    let expected = message.split_once(", expected ").map(|(_, after)| after);
    let problem = match expected {
        Some(known) if message.starts_with("unknown field `") => {
            let known = known.trim_start_matches("one of ").replace('`', "");
            SiteProblem::Syntax(format!("unknown key, expected {known}"))
        }
        Some(expected) if message.starts_with("invalid ") => SiteProblem::Value {
            found: found(source, &at),
            expected: in_words(expected).to_owned(),
        },
        _ => SiteProblem::Syntax(message),
    };
    source.error(at, key, problem)
}

/// What stands there, where that is short.
fn found(source: &Source<'_>, at: &Range<usize>) -> String {
    const LONGEST: usize = 40;
    let written = source.text.get(at.clone()).unwrap_or_default();
    let is_short = !written.is_empty() && written.len() <= LONGEST && !written.contains('\n');
    if is_short { written } else { "this" }.to_owned()
}

/// What serde expects, without the names of Rust's types.
fn in_words(expected: &str) -> &str {
    match expected {
        "u8" => "a whole number from 0 to 255",
        "u16" => "a whole number from 0 to 65535",
        "u32" => "a whole number from 0 to 4294967295",
        "a string" => "text in quotes",
        "a boolean" => "true or false",
        "a sequence" => "a list",
        _ if expected.starts_with("struct ") => "a table",
        other => other,
    }
}

/// The key at this place, `meters.main.every`.
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
            let name = match item.get_ref() {
                DeValue::Table(row) => row.get("name").and_then(|name| name.get_ref().as_str()),
                _ => None,
            };
            let path = name.map_or_else(|| path.to_owned(), |name| joined(path, name));
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
