//! The catalogue of faults (`tests/catalogue.md`): writes and broadcasts.

mod support {
    pub(crate) mod catalogue;
    pub(crate) mod clock;
    pub(crate) mod script;
    pub(crate) mod written;
}

use std::sync::{Arc, Mutex};
use std::time::Duration;

use meterpoll::client::{Confirmation, Failure, Patience, Unwritten, Ways};
use meterpoll::codec::{AddressError, ExceptionCode, RegisterBlock, Write};

use support::catalogue::{Case, SILENCE, T, THINKS, UNIT, answer, ms};
use support::clock::FakeClock;
use support::script::unit;
use support::written::{block, coil, confirmed, outcome, set};

/// 8 bytes at 9600 8N1.
const WRITE: Duration = Duration::from_nanos(8_333_333);

/// A case on a meter that does what it is told, and the writes that came to it.
fn case<'a>(rules: impl IntoIterator<Item = &'a str>) -> (Case, Arc<Mutex<Vec<Vec<u8>>>>) {
    let clock = Arc::new(FakeClock::new());
    let heard: Arc<Mutex<Vec<Vec<u8>>>> = Arc::default();
    let seen = Arc::clone(&heard);
    let case = Case::on(&clock, [rules], move |frame| {
        if !matches!(frame[1], 5 | 6 | 16) {
            return vec![(THINKS, answer(frame))];
        }
        seen.lock()
            .expect("no test thread panicked")
            .push(frame.to_vec());
        if frame[0] == 0 {
            return Vec::new();
        }
        vec![(THINKS, confirmed(frame))]
    });
    (case, heard)
}

const fn patience() -> Patience {
    Patience {
        timeout: T,
        longest_answer: T,
        retries: 2,
        pause: Duration::ZERO,
        ways: Ways {
            interchangeable_reads: false,
            loopback: None,
        },
    }
}

/// What comes of a write behind a read without a fault.
fn written(case: &mut Case, write: &Write) -> Result<Confirmation, Unwritten> {
    case.reads(1);
    case.client.write(unit(UNIT), write, patience())
}

#[track_caller]
fn heard_once(heard: &Mutex<Vec<Vec<u8>>>) {
    let heard = heard.lock().expect("no test thread panicked");
    assert_eq!(heard.len(), 1, "{heard:02X?}");
}

/// Row 28: the line is known to echo by the read before it.
#[test]
fn the_echo_of_a_write_is_no_success() {
    for write in [set(0x1028, 500), coil(14), block(0x1028, &[1, 2])] {
        let (mut case, _) = case(["echo,on=1", "echo-only,on=2"]);
        let result = written(&mut case, &write);
        let found = "outcome unknown: nothing but the echo of the own request came back";
        assert_eq!(outcome(&result), found);
        assert_eq!(case.attempts(), 2);
    }
}

/// Row 28: and where nothing is known of the line.
#[test]
fn one_copy_of_a_write_is_no_success_on_a_line_that_may_echo() {
    for write in [set(0x1028, 500), coil(14)] {
        let (mut case, _) = case(["echo-only,on=1"]);
        let result = case.client.write(unit(UNIT), &write, patience());
        let found = "outcome unknown: nothing but the echo of the own request came back";
        assert_eq!(outcome(&result), found);
        assert_eq!(case.attempts(), 1);
    }
}

/// Row 41.
#[test]
fn a_write_that_is_acknowledged_is_not_sent_again_and_not_done_yet() {
    for write in [set(0x1028, 500), coil(14), block(0x1028, &[1, 2])] {
        let (mut case, heard) = case(["exception=5,on=2"]);
        let result = written(&mut case, &write);
        assert!(matches!(result, Ok(Confirmation::Accepted)), "{result:?}");
        assert_eq!(case.attempts(), 2);
        drop(case);
        heard_once(&heard);
    }
}

/// Row 40, of writes.
#[test]
fn a_refused_write_is_told_with_its_code_and_not_sent_again() {
    for code in [1, 2, 3, 4] {
        let rule = format!("exception={code},on=2");
        let (mut case, heard) = case([rule.as_str()]);
        let result = written(&mut case, &set(0x1028, 500));
        assert!(
            matches!(result, Err(Unwritten::Refused(ExceptionCode(found))) if found == code),
            "{result:?}"
        );
        heard_once(&heard);
    }
}

/// Row 51.
#[test]
fn another_value_in_the_answer_is_reported_as_what_is_stored() {
    let clock = Arc::new(FakeClock::new());
    let mut case = Case::on(&clock, [[]; 0] as [[&str; 0]; 0], |frame| {
        let chunk = match frame[1] {
            6 => confirmed(&[&frame[..4], &[0x01, 0x90]].concat()),
            _ => answer(frame),
        };
        vec![(THINKS, chunk)]
    });
    let result = written(&mut case, &set(0x1028, 500));
    assert!(
        matches!(result, Ok(Confirmation::Stored(400))),
        "{result:?}"
    );
    assert_eq!(case.attempts(), 2);
}

/// Row 51.
#[test]
fn another_address_in_the_answer_is_no_answer() {
    let clock = Arc::new(FakeClock::new());
    let mut case = Case::on(&clock, [[]; 0] as [[&str; 0]; 0], |frame| {
        let chunk = match frame[1] {
            6 => confirmed(&[&frame[..3], &[frame[3] + 1], &frame[4..]].concat()),
            _ => answer(frame),
        };
        vec![(THINKS, chunk)]
    });
    let result = written(&mut case, &set(0x1028, 500));
    assert!(
        matches!(result, Err(Unwritten::Unknown(Failure::Mismatch { .. }))),
        "{result:?}"
    );
    assert_eq!(case.attempts(), 2);
}

/// Row 52.
#[test]
fn of_a_write_whose_answer_is_lost_nothing_is_known_and_it_was_sent_once() {
    for rule in ["silence,on=2", "late=1.5,on=2", "crc,on=2", "cut=4,on=2"] {
        for write in [set(0x1028, 500), coil(14), block(0x1028, &[1, 2])] {
            let (mut case, heard) = case([rule]);
            let result = written(&mut case, &write);
            assert!(
                matches!(result, Err(Unwritten::Unknown(_))),
                "{rule}: {result:?}"
            );
            assert_eq!(case.attempts(), 2);
            drop(case);
            heard_once(&heard);
        }
    }
}

/// Row 53.
#[test]
fn a_write_of_123_registers_is_done_and_of_124_is_none() {
    let (mut case, heard) = case([]);
    let result = written(&mut case, &block(0x1000, &[7; 123]));
    assert!(matches!(result, Ok(Confirmation::Done)), "{result:?}");
    heard_once(&heard);
    let refused = RegisterBlock::new(0x1000, vec![7; 124]);
    assert!(
        matches!(refused, Err(AddressError::Count { .. })),
        "{refused:?}"
    );
}

/// Row 54.
#[test]
fn a_broadcast_waits_for_the_turnaround_and_for_no_answer_and_is_sent_once() {
    let (mut case, heard) = case([]);
    case.reads(1);
    let start = case.now();
    let result = case
        .client
        .broadcast(&|_| set(0x1028, 500), ms(200), patience());
    assert!(result.is_ok(), "{result:?}");
    let took = case.now().saturating_sub(start);
    let least = SILENCE + WRITE + ms(200);
    assert!(took >= least && took <= least + ms(1), "{took:?}");
    case.reads(2);
    assert!(case.sent()[2].silence >= ms(200));
    drop(case);
    heard_once(&heard);
}
