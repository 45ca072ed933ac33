//! The table of `tests/catalogue.md`: each row names its tests, and they are there.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

const TABLE: &str = include_str!("catalogue.md");

fn tests_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests")
}

/// File and name.
type Test = (String, String);

/// The numbers of each row, and its tests.
fn rows() -> Vec<(Vec<u32>, Vec<Test>)> {
    let rows = TABLE.lines().filter(|line| {
        let cell = line.strip_prefix("| ");
        cell.is_some_and(|cell| cell.starts_with(|first: char| first.is_ascii_digit()))
    });
    rows.map(|row| {
        let cells: Vec<&str> = row.trim_matches('|').split('|').map(str::trim).collect();
        let [numbers, _, _, tests] = cells[..] else {
            panic!("{row}");
        };
        let numbers = numbers.split(", ").map(|number| number.parse().unwrap());
        let tests = tests.split("; ").map(|test| {
            let (file, name) = test.split_once(' ').unwrap_or_else(|| panic!("{row}"));
            (file.trim_matches('`').to_owned(), name.to_owned())
        });
        (numbers.collect(), tests.collect())
    })
    .collect()
}

/// The names of the tests in a file.
fn tests_in(file: &str) -> BTreeSet<String> {
    let path = tests_folder().join(file).with_extension("rs");
    let text = fs::read_to_string(&path).unwrap_or_else(|error| panic!("{file}: {error}"));
    let lines: Vec<&str> = text.lines().collect();
    let pairs = lines.windows(2).filter(|pair| pair[0] == "#[test]");
    let names = pairs.filter_map(|pair| pair[1].strip_prefix("fn ")?.split_once('('));
    names.map(|(name, _)| name.to_owned()).collect()
}

#[test]
fn every_test_that_a_row_names_is_there() {
    for (numbers, tests) in rows() {
        assert!(!tests.is_empty(), "{numbers:?}");
        for (file, name) in tests {
            assert!(
                tests_in(&file).contains(&name),
                "{numbers:?}: {file} {name}"
            );
        }
    }
}

#[test]
fn every_test_of_the_catalogue_is_in_a_row() {
    let named: BTreeSet<Test> = rows().into_iter().flat_map(|(_, tests)| tests).collect();
    for entry in fs::read_dir(tests_folder()).expect("a readable folder") {
        let path = entry.expect("an entry").path();
        let file = path.file_stem().and_then(|stem| stem.to_str()).unwrap();
        if !file.starts_with("catalogue_") || file == "catalogue_table" {
            continue;
        }
        for name in tests_in(file) {
            let test = (file.to_owned(), name);
            assert!(named.contains(&test), "{test:?}");
        }
    }
}

#[test]
fn each_row_is_there_once_in_its_order() {
    let firsts: Vec<u32> = rows().iter().map(|(numbers, _)| numbers[0]).collect();
    assert!(firsts.is_sorted(), "{firsts:?}");
    let all: Vec<u32> = rows()
        .into_iter()
        .flat_map(|(numbers, _)| numbers)
        .collect();
    let unlike: BTreeSet<u32> = all.iter().copied().collect();
    assert_eq!(all.len(), unlike.len());
    assert!(all.len() >= 60, "{} rows", all.len());
}
