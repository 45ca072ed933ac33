//! Whatever the script: no rule text stops the program, and what no rule is for passes unchanged.

#[path = "support/cases.rs"]
mod cases;
#[path = "support/lying.rs"]
mod lying;

use meterpoll::codec::rtu::Hex;
use meterpoll::transport::faulty::{FaultKind, FaultScript};
use meterpoll::transport::{Timing, Transport};
use proptest::prelude::*;

use self::cases::hold;
use self::lying::{Lying, read, truth};

/// Values that some kind or key takes.
const VALUES: [&str; 24] = [
    "", "0", "1", "5", "16", "255", "256", "2047", "0.3", "1.1", "100", "1ms", "20ms", "24h", "+1",
    "-1", "odd", "00FF", "before", "during", "after", "3-5", "1/4", "crc+flip",
];

const KEYS: [&str; 14] = [
    "rate", "on", "for", "function", "seed", "timeout", "rest", "gap", "every", "lasts", "with",
    "without", "x", "",
];

/// Rules that are one, and many that are nearly one.
fn any_rule() -> impl Strategy<Value = String> {
    let kinds: Vec<_> = FaultKind::all().map(FaultKind::name).collect();
    let value = || prop::sample::select(VALUES.to_vec());
    let head = (prop::sample::select(kinds), prop::option::of(value()));
    let keys = prop::collection::vec((prop::sample::select(KEYS.to_vec()), value()), 0..3);
    (head, keys).prop_map(|((kind, own), keys)| {
        let own = own.map(|own| format!("={own}")).unwrap_or_default();
        let keys = keys.iter().map(|(key, value)| format!(",{key}={value}"));
        format!("{kind}{own}{}", keys.collect::<String>())
    })
}

/// The rules among these that are one.
fn valid(rules: &[String]) -> Vec<&str> {
    let is_one = |rule: &&str| FaultScript::parse([rule]).is_ok();
    rules.iter().map(String::as_str).filter(is_one).collect()
}

#[test]
fn no_text_stops_the_program() {
    hold(2000, &any::<String>(), |text| {
        let _ = FaultScript::from_text(&text);
        Ok(())
    });
    hold(2000, &any_rule(), |rule| {
        if let Ok(script) = FaultScript::parse([&rule]) {
            prop_assert_eq!(script.rules()[0].text(), rule.trim());
        }
        Ok(())
    });
}

#[test]
fn what_no_rule_is_for_passes_unchanged() {
    // Rules for the odd requests; late bytes of theirs are done with before the even ones.
    let rules = prop::collection::vec(any_rule(), 0..4);
    hold(300, &(rules, any::<u64>()), |(rules, seed)| {
        let odd: Vec<_> = valid(&rules)
            .into_iter()
            .filter(|rule| !rule.contains(",on="))
            .map(|rule| format!("{rule},on=1/2"))
            .collect();
        let script = FaultScript::parse(&odd).unwrap().with_seed(seed);
        let mut lying = Lying::with(script, Timing::Unpaced);
        for address in 1..=10 {
            let request = read(17, 3, address, address);
            if address % 2 == 1 {
                lying.line.send(&request).ok();
                lying.listen_to_nothing(10_000);
            } else {
                let truth = format!("0: {}", Hex(&truth(&request)));
                let heard = lying.ask(&request, 0);
                prop_assert_eq!(heard, [truth]);
            }
        }
        Ok(())
    });
}

#[test]
fn however_it_is_listened_to_the_bytes_are_the_same() {
    let strategy = (any_rule(), any::<u64>(), 1..40_usize);
    hold(300, &strategy, |(rule, seed, room)| {
        let Ok(script) = FaultScript::parse([&rule]) else {
            return Ok(());
        };
        let script = script.with_seed(seed);
        let bytes = |room: usize| {
            let mut lying = Lying::with(script.clone(), Timing::Unpaced);
            let mut heard = Vec::new();
            for address in 1..=3 {
                if lying.line.send(&read(17, 3, address, 2)).is_err() {
                    continue;
                }
                heard.extend(lying.bytes(500, room));
            }
            heard
        };
        prop_assert_eq!(bytes(512), bytes(room), "{}", rule);
        Ok(())
    });
}
