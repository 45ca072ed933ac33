//! What `simulate --help` says of faults, against the rules that are read.

mod support {
    pub(crate) mod program;
}

use std::collections::BTreeSet;

use meterpoll::transport::faulty::{FaultKind, FaultRule, FaultScript};
use support::program::Program;

/// Of rows of tables.
const MARGIN: &str = "            ";

#[test]
fn the_help_shows_every_fault_and_every_key_with_a_value_that_it_takes() {
    let output = Program::new("simulate --help").output();
    let help = String::from_utf8(output.stdout).unwrap();
    let (_, help) = help.split_once("--fault <RULE>").unwrap();
    let (help, _) = help.split_once("--fault-script").unwrap();
    // The margin of a man page is 14.
    let rows = help.lines().filter_map(|line| line.strip_prefix(MARGIN));
    let widest = rows.map(|row| 2 + row.chars().count()).max();
    assert!(widest <= Some(80 - 14), "{widest:?}");
    let (kinds, keys) = help.split_once("KEY is").unwrap();
    let shown = |table: &str| -> Vec<String> {
        let rows = table.lines().filter_map(|line| {
            let row = line.strip_prefix(MARGIN)?;
            row.split(' ').next().filter(|rule| !rule.is_empty())
        });
        rows.map(str::to_owned).collect()
    };
    let rules = shown(kinds);
    let script = FaultScript::parse(&rules).unwrap();
    let shown_kinds: Vec<FaultKind> = script.rules().iter().map(FaultRule::kind).collect();
    assert_eq!(shown_kinds, FaultKind::all().collect::<Vec<_>>());
    let all: BTreeSet<&str> = FaultKind::all().flat_map(FaultKind::keys).collect();
    let keys = shown(keys);
    let names = keys.iter().filter_map(|key| key.split('=').next());
    assert_eq!(names.collect::<BTreeSet<_>>(), all);
    for key in &keys {
        let name = key.split('=').next().unwrap();
        let mut kinds = FaultKind::all().filter(|kind| kind.keys().any(|known| known == name));
        let kind = kinds.next().unwrap();
        assert!(
            FaultScript::parse([format!("{kind},{key}")]).is_ok(),
            "{key}"
        );
    }
    let short = Program::new("simulate -h").output();
    assert!(
        !String::from_utf8(short.stdout)
            .unwrap()
            .contains("exception-for")
    );
}
