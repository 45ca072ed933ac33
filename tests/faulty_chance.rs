//! Chance in faults: seeded, and each rule's own.

#[path = "support/lying.rs"]
mod lying;

use std::collections::BTreeMap;

use meterpoll::transport::faulty::{FaultKind, FaultScript};
use meterpoll::transport::{Timing, Transport};

use self::lying::{Lying, READ, TRUE};

/// How often each kind was chosen in so many requests.
fn chosen(script: FaultScript, requests: u32) -> BTreeMap<&'static str, u64> {
    let mut lying = Lying::with(script, Timing::Unpaced);
    for _ in 0..requests {
        // A hang-up counts like any other.
        lying.line.send(&READ).ok();
        lying.line.discard_input().ok();
    }
    let counts = lying.line.counts();
    counts
        .faults()
        .map(|(kind, count)| (kind.name(), count))
        .collect()
}

fn script(rules: &[&str]) -> FaultScript {
    FaultScript::parse(rules).unwrap()
}

/// Everything heard of so many reads.
fn heard(script: FaultScript, requests: u32) -> Vec<Vec<String>> {
    let mut lying = Lying::with(script, Timing::Unpaced);
    (0..requests).map(|_| lying.ask(&READ, 50)).collect()
}

#[test]
fn the_same_seed_gives_the_same_faults_byte_for_byte() {
    let rules = ["any,rate=0.5", "before,rate=0.5", "flip,rate=0.5"];
    let with = |seed| heard(script(&rules).with_seed(seed), 300);
    assert_eq!(with(7), with(7));
    assert_ne!(with(7), with(8));
    let own = |seed| heard(script(&["flip,seed=5"]).with_seed(seed), 20);
    assert_eq!(own(7), own(8));
    assert_ne!(own(7), heard(script(&["flip,seed=6"]), 20));
}

#[test]
fn a_rule_applies_as_often_as_its_rate_says() {
    for (rate, expected) in [
        ("0", 0),
        ("0.001", 11),
        ("0.3", 3010),
        ("0.5", 4973),
        ("1", 10_000),
    ] {
        let counts = chosen(script(&[&format!("crc,rate={rate}")]), 10_000);
        assert_eq!(counts.get("crc").copied().unwrap_or_default(), expected);
    }
}

#[test]
fn a_rule_added_before_changes_only_what_it_decides() {
    let rules = ["flip,rate=0.5", "cut,rate=0.5"];
    let before = heard(script(&rules), 200);
    let after = heard(script(&["crc,on=1/7", rules[0], rules[1]]), 200);
    for (number, (before, after)) in (1..).zip(before.iter().zip(&after)) {
        if number % 7 == 1 {
            assert_eq!(after, &["0: 11 03 06 11 6B 11 6C 11 6D 3D 5E"]);
        } else {
            assert_eq!(before, after);
        }
    }
}

#[test]
fn two_rules_of_the_same_text_are_two_chances() {
    let once = chosen(script(&["crc,rate=0.5"]), 10_000)["crc"];
    let twice = chosen(script(&["crc,rate=0.5", "crc,rate=0.5"]), 10_000)["crc"];
    assert_eq!((once, twice), (4973, 7492));
}

#[test]
fn one_in_ten_of_any_is_late_and_every_kind_but_a_hang_up_comes() {
    let counts = chosen(script(&["any"]), 10_000);
    assert_eq!(counts["late"], 970);
    let kinds = FaultKind::all().map(FaultKind::name);
    let usual: Vec<_> = kinds
        .filter(|name| !["any", "hang-up"].contains(name))
        .collect();
    for kind in usual {
        assert!(counts.get(kind).is_some_and(|count| *count > 50), "{kind}");
    }
    assert_eq!(counts.get("hang-up"), None);
}

#[test]
fn any_picks_what_it_is_told_to() {
    let without = chosen(script(&["any,without=late+garbage"]), 2000);
    assert_eq!((without.get("late"), without.get("garbage")), (None, None));
    let with = chosen(script(&["any,with=hang-up"]), 2000);
    assert!(with["hang-up"] > 10);
    let others: Vec<_> = FaultKind::all()
        .filter(|kind| !["any", "late"].contains(&kind.name()))
        .map(FaultKind::name)
        .collect();
    let rule = format!("any,without={}", others.join("+"));
    assert_eq!(chosen(script(&[&rule]), 100)["late"], 100);
}

#[test]
fn what_any_picks_ends_two_time_outs_later() {
    let all = FaultKind::all().map(FaultKind::name);
    let others: Vec<_> = all
        .filter(|name| !["any", "garbage"].contains(name))
        .collect();
    let rule = format!("any,timeout=100ms,without={}", others.join("+"));
    let mut lying = Lying::new(&[&rule]);
    let heard = lying.ask(&READ, 1000);
    assert_eq!(heard.len(), 200);
    assert!(heard[199].starts_with("199: "));
}

#[test]
fn a_late_answer_of_any_is_late_by_the_time_out_given() {
    let all = FaultKind::all().map(FaultKind::name);
    let others: Vec<_> = all.filter(|name| !["any", "late"].contains(name)).collect();
    let rule = format!("any,timeout=100ms,without={}", others.join("+"));
    let heard = Lying::new(&[&rule]).ask(&READ, 1000);
    let (time, bytes) = heard[0].split_once(": ").unwrap();
    assert_eq!(bytes, TRUE);
    assert!((110.0..=190.0).contains(&time.parse::<f64>().unwrap()));
}
