//! Faults without end: they go on until the next request, and cost no memory.

#[path = "support/lying.rs"]
mod lying;

use std::time::Duration;

use meterpoll::codec::rtu;
use meterpoll::transport::{Clock, Transport};

use self::lying::{Lying, READ, SILENT, TRUE, read};

/// The unit that three registers are said to be of.
fn unit_of(heard: &str) -> u8 {
    let (_, hex) = heard.split_once(": ").unwrap();
    let frame: Vec<u8> = hex
        .split(' ')
        .map(|pair| u8::from_str_radix(pair, 16).unwrap())
        .collect();
    let (unit, rest) = rtu::open(&frame).unwrap();
    assert_eq!((rest[0], rest[1], rest.len()), (3, 6, 8));
    unit
}

fn times(heard: &[String]) -> Vec<u64> {
    heard
        .iter()
        .map(|heard| heard.split_once(": ").unwrap().0.parse().unwrap())
        .collect()
}

#[test]
fn garbage_is_a_byte_each_millisecond_in_place_of_the_answer() {
    let heard = Lying::new(&["garbage"]).ask(&READ, 1000);
    assert_eq!(times(&heard), (0..=1000).collect::<Vec<_>>());
    let slow = Lying::new(&["garbage,every=100ms,lasts=350ms"]).ask(&READ, 1000);
    assert_eq!(times(&slow), [0, 100, 200, 300]);
    // Any byte at all.
    let heard = Lying::new(&["garbage"]).ask(&READ, 5000);
    for byte in 0..=255 {
        let end = format!(": {byte:02X}");
        assert!(heard.iter().any(|heard| heard.ends_with(&end)), "{end}");
    }
}

#[test]
fn another_unit_answers_again_and_again() {
    let heard = Lying::new(&["stranger-only=3"]).ask(&READ, 1000);
    assert_eq!(times(&heard), [200, 400, 600, 800, 1000]);
    assert!(heard.iter().all(|heard| unit_of(heard) == 3));
    assert_ne!(heard[0].split_once(": "), heard[1].split_once(": "));
    let heard = Lying::new(&["stranger-only,every=5ms,lasts=12ms"]).ask(&READ, 1000);
    assert_eq!(times(&heard), [5, 10, 15]);
    // One unit, whichever.
    let unit = unit_of(&heard[0]);
    assert!(unit != 17 && heard.iter().all(|heard| unit_of(heard) == unit));
}

#[test]
fn another_unit_answers_before_the_right_one() {
    let heard = Lying::new(&["stranger=9,gap=20ms"]).ask(&READ, 1000);
    assert_eq!(times(&heard), [0, 20]);
    assert_eq!(unit_of(&heard[0]), 9);
    assert_eq!(heard[1], format!("20: {TRUE}"));
    let heard = Lying::new(&["stranger=17"]).ask(&READ, 1000);
    assert_eq!(unit_of(&heard[0]), 18);
}

#[test]
fn an_endless_answer_has_no_crc_and_starts_again() {
    let heard = Lying::new(&["endless"]).ask(&READ, 400);
    let expected: Vec<String> = (0..=20)
        .zip(
            ["11", "03", "06", "11", "6B", "11", "6C", "11", "6D"]
                .iter()
                .cycle(),
        )
        .map(|(place, byte)| format!("{}: {byte}", place * 20))
        .collect();
    assert_eq!(heard, expected);
    let short = Lying::new(&["endless,every=5ms,lasts=8ms"]).ask(&READ, 400);
    assert_eq!(short, ["0: 11", "5: 03"]);
}

#[test]
fn what_needs_no_answer_comes_without_a_meter() {
    let request = read(SILENT, 3, 0, 3);
    for (rule, count) in [
        ("echo", 1),
        ("echo-only", 1),
        ("stranger", 1),
        ("stranger-only", 5),
        ("garbage,every=100ms", 11),
    ] {
        let heard = Lying::new(&[rule]).ask(&request, 1000);
        assert_eq!(heard.len(), count, "{rule}: {heard:?}");
    }
}

#[test]
fn the_next_request_ends_it() {
    for rule in ["garbage,on=1", "stranger-only,on=1", "endless,on=1"] {
        let mut lying = Lying::new(&[rule]);
        assert!(lying.ask(&READ, 1000).len() >= 5, "{rule}");
        assert_eq!(lying.ask(&READ, 1000), [format!("0: {TRUE}")], "{rule}");
    }
}

#[test]
fn nothing_is_made_before_it_is_taken() {
    for rule in ["garbage", "stranger-only,every=1ms", "endless,every=1ms"] {
        let mut lying = Lying::new(&[rule]);
        lying.line.send(&READ).unwrap();
        let mut into = [0; 64];
        for _ in 0..1000 {
            assert!(lying.line.receive(&mut into, Duration::ZERO).unwrap() <= 64);
            assert!(lying.line.kept_bytes() <= 16, "{rule}");
            // Ten minutes of it each time.
            lying.clock.advance(Duration::from_secs(600));
        }
        lying.line.discard_input().unwrap();
        let next = lying.line.next_due().unwrap();
        assert!(next > lying.clock.now(), "{rule}");
    }
}

#[test]
fn answers_that_are_later_than_anybody_waits_do_not_pile_up() {
    let mut lying = Lying::new(&["late=100,timeout=24h"]);
    for _ in 0..2000 {
        assert!(lying.ask(&READ, 0).is_empty());
    }
    assert_eq!(lying.line.kept_bytes(), 1024 * 11);
}
