//! What a fault script says, and what it may not say.

#[path = "support/lying.rs"]
mod lying;

use meterpoll::transport::faulty::{FaultKind, FaultScript, RuleProblem};

use self::lying::{Lying, READ, TRUE, read, truth};
use meterpoll::codec::rtu::Hex;

const DAMAGED: &str = "11 03 06 11 6B 11 6C 11 6D 3D 5E";

/// All of them, as the documentation has them.
const KINDS: [&str; 27] = [
    "late",
    "delay",
    "silence",
    "cut",
    "split",
    "drip",
    "endless",
    "before",
    "after",
    "echo",
    "echo-only",
    "twice",
    "crc",
    "crc-swapped",
    "flip",
    "burst",
    "wrong-unit",
    "stranger",
    "stranger-only",
    "wrong-function",
    "wrong-count",
    "oversize",
    "exception",
    "exception-for",
    "garbage",
    "hang-up",
    "any",
];

/// For which of the first twelve reads a rule damages the CRC.
fn damaged(rule: &str) -> Vec<usize> {
    let mut lying = Lying::new(&[rule]);
    (1..=12)
        .filter(|_| match lying.at_once(&READ).as_str() {
            DAMAGED => true,
            TRUE => false,
            other => panic!("{other}"),
        })
        .collect()
}

#[test]
fn every_kind_is_known_by_its_name_and_needs_no_value() {
    let names: Vec<_> = FaultKind::all().map(FaultKind::name).collect();
    assert_eq!(names, KINDS);
    let script = FaultScript::parse(KINDS).unwrap();
    for (rule, name) in script.rules().iter().zip(KINDS) {
        assert_eq!((rule.kind().name(), rule.text()), (name, name));
        assert_eq!(rule.kind().to_string(), rule.to_string());
        assert_eq!(FaultKind::named(name), Some(rule.kind()));
    }
}

#[test]
fn the_documentation_has_a_row_for_every_kind_with_its_keys() {
    let source = include_str!("../src/transport/faulty.rs");
    for kind in FaultKind::all() {
        let start = format!("//! | `{kind}` |");
        let row = source.lines().find(|line| line.starts_with(&start));
        let row = row.unwrap_or_else(|| panic!("no row for {kind}"));
        let keys = row.split('|').nth(3).unwrap();
        let common = ["rate", "on", "for", "function", "seed"];
        let own: Vec<_> = kind
            .keys()
            .filter(|key| !common.contains(key))
            .map(|key| format!("`{key}`"))
            .collect();
        assert_eq!(keys.trim(), own.join(" "), "{kind}");
    }
}

#[test]
fn the_numbers_of_requests_choose() {
    for (on, expected) in [
        ("3", &[3][..]),
        ("3-5", &[3, 4, 5]),
        ("10-", &[10, 11, 12]),
        ("1/4", &[1, 5, 9]),
        ("3/4", &[3, 7, 11]),
        ("11/1", &[11, 12]),
        ("0x0C", &[12]),
        ("13", &[]),
    ] {
        assert_eq!(damaged(&format!("crc,on={on}")), expected, "{on}");
    }
    assert_eq!(damaged("crc"), (1..=12).collect::<Vec<_>>());
}

#[test]
fn unit_and_function_choose() {
    let answers = |rule| {
        let mut lying = Lying::new(&[rule]);
        let requests = [(17, 3), (17, 4), (18, 3)];
        requests.map(|(unit, function)| {
            let request = read(unit, function, 0, 1);
            lying.at_once(&request) == Hex(&truth(&request)).to_string()
        })
    };
    assert_eq!(answers("crc,for=17"), [false, false, true]);
    assert_eq!(answers("crc,for=0x12"), [true, true, false]);
    assert_eq!(answers("crc,function=4"), [true, false, true]);
    assert_eq!(answers("crc,for=17,function=3"), [false, true, true]);
    assert_eq!(answers("crc,for=18,on=1"), [true, true, true]);
}

#[test]
fn the_first_rule_that_applies_decides() {
    let mut lying = Lying::new(&["cut=1,on=2", "cut=2,on=1-2", "crc,on=4-"]);
    let answers = [(); 4].map(|()| lying.at_once(&READ));
    assert_eq!(answers, ["11 03", "11", TRUE, DAMAGED]);
    let counts = lying.line.counts();
    assert_eq!((counts.requests, counts.answers), (4, 4));
    assert_eq!(counts.all_faults(), 3);
    assert_eq!(
        counts.faults().collect::<Vec<_>>(),
        [(FaultKind::Cut, 2), (FaultKind::Crc, 1)]
    );
    assert_eq!(counts.of(FaultKind::Silence), 0);
    assert_eq!(lying.line.tally().counts(), counts);
}

#[test]
fn a_file_has_a_rule_a_line() {
    let text = "# broken\n\n  cut=1 , on = 2 \r\n\t# crc\ncrc,on=3\n";
    let script = FaultScript::from_text(text).unwrap();
    let rules: Vec<_> = script.rules().iter().map(ToString::to_string).collect();
    assert_eq!(rules, ["cut=1 , on = 2", "crc,on=3"]);
    assert_eq!(FaultScript::from_text("").unwrap(), FaultScript::default());
    assert!(FaultScript::default().rules().is_empty());
    let error = FaultScript::from_text("crc\n\ncrc,rate=2").unwrap_err();
    assert_eq!(
        error.to_string(),
        "fault rule 'crc,rate=2' in line 3: rate is '2'; allowed is a probability from 0 to 1, \
         such as 0.3"
    );
    assert_eq!(error.place.line, Some(3));
}

/// Checks what is said of a rule that is none.
#[track_caller]
fn refused(rule: &str, expected: &str) {
    let error = FaultScript::parse(["silence", rule]).unwrap_err();
    let shown = rule.escape_debug();
    assert_eq!(
        error.to_string(),
        format!("fault rule '{shown}': {expected}")
    );
    assert_eq!(error.place.line, None);
}

/// Checks that none of these is taken, and what is said to be allowed.
#[track_caller]
fn allowed(rules: &[&str], expected: &str) {
    for rule in rules {
        let (_, last) = rule.rsplit_once(',').unwrap_or(("", rule));
        let (key, found) = last.split_once('=').unwrap_or((last, ""));
        refused(rule, &format!("{key} is '{found}'; allowed is {expected}"));
    }
}

#[test]
fn a_kind_that_there_is_not_is_refused_with_those_there_are() {
    let all = KINDS.join(", ");
    for (rule, shown) in [
        ("", ""),
        ("=5", ""),
        ("xyzzy", "xyzzy"),
        ("\u{7}=1", "\\u{7}"),
    ] {
        refused(
            rule,
            &format!("there is no fault '{shown}'; allowed are {all}"),
        );
    }
    for (rule, shown, near) in [
        ("lat=1.1", "lat", "late"),
        ("hangup", "hangup", "hang-up"),
        ("LATE", "LATE", "late"),
        ("wrong-cuont=0,on=1", "wrong-cuont", "wrong-count"),
    ] {
        refused(
            rule,
            &format!("there is no fault '{shown}'; did you mean '{near}'?"),
        );
    }
}

#[test]
fn a_key_or_value_that_the_kind_has_no_use_for_is_refused() {
    let useless = |rule, kind, key, own| {
        let allowed = format!("{own}rate, on, for, function, seed");
        refused(
            rule,
            &format!("{kind} has no use for '{key}'; allowed are {allowed}"),
        );
    };
    useless("crc,gap=1s", "crc", "gap", "");
    useless("crc,", "crc", "", "");
    useless("split,every=1s", "split", "every", "gap, ");
    useless("drip,rest=1", "drip", "rest", "");
    refused(
        "split,gaps=1s",
        "split has no use for 'gaps'; did you mean 'gap'?",
    );
    refused("crc,on=1,on=2", "'on' is there more than once");
    for (rule, kind, found) in [
        ("silence=3", "silence", "3"),
        ("silence=", "silence", ""),
        ("any=crc", "any", "crc"),
    ] {
        refused(
            rule,
            &format!("{kind} takes no value, and '{found}' was found"),
        );
    }
}

#[test]
fn a_time_that_is_none_is_refused() {
    allowed(
        &[
            "late=x",
            "late=",
            "late=-1",
            "late=101",
            "late=inf",
            "late=NaN",
            "cut,rest=x",
        ],
        "a number of time-outs from 0 to 100, such as 1.1",
    );
    allowed(
        &["delay=40", "delay=25h", "split,gap", "garbage,lasts=x"],
        "a time with its unit to 24h, such as 40ms",
    );
    allowed(
        &["late,timeout=0s", "any,timeout=25h"],
        "a time with its unit above 0 and to 24h, such as 20ms",
    );
    allowed(
        &[
            "drip=0ms",
            "garbage,every=0s",
            "endless,every=99us",
            "stranger-only,every=25h",
        ],
        "a time with its unit from 100us to 24h, such as 20ms",
    );
}

#[test]
fn a_script_that_follows_another_is_tried_after_it() {
    let first = FaultScript::parse(["crc,on=1"]).unwrap().with_seed(7);
    let other = FaultScript::from_text("# more\nsilence\nany").unwrap();
    let both = FaultScript::parse(["crc,on=1", "silence", "any"]).unwrap();
    assert_eq!(first.followed_by(other.with_seed(8)), both.with_seed(7));
}

#[test]
fn a_number_out_of_its_range_is_refused() {
    allowed(
        &["cut=0", "echo=257", "split=+4", "cut=0x"],
        "a number of bytes from 1 to 256",
    );
    allowed(
        &["before=0", "after=", "after=0g", "after=zz"],
        "1 to 256 bytes in hex, such as 00FF",
    );
    allowed(
        &["flip=2048", "flip=-1"],
        "the number of a bit from 0 to 2047",
    );
    allowed(
        &["burst=0", "burst=2049"],
        "a number of bits from 1 to 2048",
    );
    allowed(
        &[
            "wrong-unit=256",
            "stranger=x",
            "stranger-only=-1",
            "crc,for=300",
        ],
        "a unit from 0 to 255",
    );
    allowed(
        &["wrong-function=0", "exception-for=128", "crc,function=x"],
        "a function from 1 to 127",
    );
    allowed(&["wrong-count=2", "wrong-count=1"], "+1, -1, odd, 0 or 255");
    allowed(&["exception=256"], "an exception code from 0 to 255");
    allowed(&["hang-up=now"], "before, during or after");
}

#[test]
fn a_condition_that_is_none_is_refused() {
    allowed(
        &["crc,rate=1.1", "crc,rate=-0.1", "crc,rate=NaN", "crc,rate"],
        "a probability from 0 to 1, such as 0.3",
    );
    allowed(
        &[
            "crc,on=0",
            "crc,on=5-3",
            "crc,on=1/0",
            "crc,on=-",
            "crc,on=1-2-3",
        ],
        "numbers of requests from 1: 3, 3-5, 3- or 1/4 (one in 4, from the 1st)",
    );
    allowed(
        &["crc,seed=-1", "crc,seed=18446744073709551616"],
        "a whole number from 0 to 18446744073709551615",
    );
    allowed(
        &["any,without=cut+x", "any,with=any", "any,with="],
        "names of faults with + between them, such as hang-up+garbage",
    );
}

#[test]
fn any_needs_something_to_pick_from() {
    let all = KINDS[..26].join("+");
    let error = FaultScript::parse([format!("any,without={all}")]).unwrap_err();
    assert_eq!(error.problem, RuleProblem::NothingLeft);
    assert_eq!(
        error.problem.to_string(),
        "'any' has no fault left to pick from; allowed is to leave out some, not all"
    );
}
