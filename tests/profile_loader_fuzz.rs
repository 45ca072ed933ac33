//! No text makes the loader panic: it loads, or it says in which line it does not. Advice is about
//! what loads, and of its lines.

use meterpoll::profile::advice::advise;
use meterpoll::profile::load::load;
use proptest::prelude::*;

const PQM: &str = include_str!("../src/profile/meters/pqm.toml");

/// Pieces that a slip of the pen or of an editor leaves in a file.
const PIECES: &[&str] = &[
    "",
    "\n",
    "\"",
    "'",
    "'''",
    "=",
    "{",
    "}",
    "[",
    "]",
    "[[",
    ",",
    "#",
    "\0",
    "\r\n",
    "é",
    "-",
    "0x",
    "1e999",
    "99999999999999999999",
    "name = ",
    "points",
    "0xFFFF",
    "\"u64\"",
    "\\u0000",
    "\u{feff}",
];

/// A part of the PQM's file, with some places overwritten.
fn mutated() -> impl Strategy<Value = String> {
    let change = (
        any::<prop::sample::Index>(),
        0..12_usize,
        prop::sample::select(PIECES),
    );
    let changes = prop::collection::vec(change, 1..4);
    (changes, 0..80_usize).prop_map(|(changes, rows)| {
        // The head with the limits and groups, and some of the points.
        let head = PQM.lines().take_while(|line| !line.starts_with("points"));
        let points = PQM.lines().skip_while(|line| !line.starts_with("points"));
        let lines: Vec<&str> = head.chain(points.take(rows)).chain(["]"]).collect();
        let mut text: Vec<char> = lines.join("\n").chars().collect();
        for (at, length, piece) in changes {
            let start = at.index(text.len());
            let end = text.len().min(start + length);
            text.splice(start..end, piece.chars());
        }
        text.into_iter().collect()
    })
}

fn check(text: &str) -> Result<(), TestCaseError> {
    let lines = 1..=text.matches('\n').count() + 1;
    let loaded = load("m.toml", text);
    if let Err(error) = &loaded {
        prop_assert!(lines.contains(&error.line), "{error}");
        prop_assert!(!error.problem.to_string().is_empty());
    }
    let advised = advise("m.toml", text).map(|(profile, advice)| {
        let are_there = advice.iter().all(|advice| lines.contains(&advice.line));
        (profile, are_there)
    });
    prop_assert_eq!(advised, loaded.map(|profile| (profile, true)));
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(100) })]

    #[test]
    fn arbitrary_text_never_panics(text in "\\PC{0,200}") {
        check(&text)?;
    }

    #[test]
    fn lines_that_look_like_toml_never_panic(
        text in "(name|title|points|limits|labels|groups)( = |\\.)[a-z0-9\"\\[\\]{}=, .x\n-]{0,60}",
    ) {
        check(&text)?;
    }

    #[test]
    fn a_damaged_profile_never_panics(text in mutated()) {
        check(&text)?;
    }
}
