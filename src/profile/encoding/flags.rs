//! Labels and names of bits, back into the register they stand for.

use crate::profile::point::{Labels, Names};

/// Of a long list of names so many are told.
const NAMED: usize = 8;

/// The code that has this name.
pub(super) fn code(labels: &Labels, name: &str) -> Option<u16> {
    match labels {
        Labels::Codes(names) => of_name(names, name),
        Labels::None | Labels::Bits(_) => None,
    }
}

/// The register of hex or bits that shows as this, or is this number.
pub(super) fn word(labels: &Labels, shown: &str) -> Option<u16> {
    match labels {
        Labels::Codes(names) => of_name(names, shown).or_else(|| number(shown)),
        Labels::Bits(names) => {
            let whole = of_name(names, shown).or_else(|| number(shown));
            whole.or_else(|| bits(names, shown))
        }
        Labels::None => number(shown),
    }
}

/// `input 1|relay 2|0x0040`, and `none` for no bit at all.
fn bits(names: &Names, shown: &str) -> Option<u16> {
    if shown == "none" {
        return Some(0);
    }
    shown.split('|').try_fold(0, |word, part| {
        let part = part.trim();
        let mask = of_name(names, part).or_else(|| number(part))?;
        Some(word | mask)
    })
}

fn of_name(names: &Names, wanted: &str) -> Option<u16> {
    let mut pairs = names.iter();
    let pair = pairs.find(|(_, name)| *name == wanted);
    pair.map(|(code, _)| *code)
}

/// `0x00FF`, `0b101`, `255`.
fn number(text: &str) -> Option<u16> {
    let prefixed = |prefix: &str, radix| Some((text.strip_prefix(prefix)?, radix));
    let (digits, radix) = prefixed("0x", 16)
        .or_else(|| prefixed("0X", 16))
        .or_else(|| prefixed("0b", 2))
        .unwrap_or((text, 10));
    // The conversion would take a sign.
    let digits = Some(digits).filter(|digits| !digits.starts_with('+'));
    u16::from_str_radix(digits?, radix).ok()
}

/// `one of a, b and 3 more`.
pub(super) fn one_of(names: &Names) -> String {
    format!("or one of {}", listed(names))
}

/// The names, not all of them where there are many.
pub(super) fn listed(names: &Names) -> String {
    let shown: Vec<String> = names.values().take(NAMED).cloned().collect();
    let shown = shown.join(", ");
    match names.len().saturating_sub(NAMED) {
        0 => shown,
        more => format!("{shown} and {more} more"),
    }
}
