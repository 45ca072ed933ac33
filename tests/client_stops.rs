//! A client that is to stop: what was not sent yet is not sent, and nothing is waited for that need
//! not be.

mod support {
    pub(crate) mod clock;
    pub(crate) mod script;
    pub(crate) mod written;
}

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use meterpoll::client::{Patience, Unwritten, Ways};
use meterpoll::transport::{Clock, OpenError};

use support::script::{Bench, Chunk, read, true_reply, unit};
use support::written::{answer, ms, outcome, refusal, set};

const PATIENT: Patience = Patience {
    timeout: Duration::from_secs(30),
    longest_answer: Duration::from_secs(30),
    retries: 2,
    pause: Duration::ZERO,
    ways: Ways {
        interchangeable_reads: false,
        loopback: None,
    },
};

/// A bench whose line is known not to echo, and the flag that stops the client.
fn bench() -> (Bench, Arc<AtomicBool>) {
    let mut bench = Bench::new();
    bench.line.meter(|frame| vec![(ms(10), true_reply(frame))]);
    let clean = bench.client.request(unit(17), &read(1, 1), PATIENT);
    assert!(clean.is_ok());
    let stop = Arc::default();
    bench.client.stop_when(Arc::clone(&stop));
    (bench, stop)
}

/// The flag goes up with the first request, which is answered like this.
fn stopped_at_once(bench: &Bench, stop: &Arc<AtomicBool>, answered: Vec<Chunk>) {
    let stop = Arc::clone(stop);
    bench.line.meter(move |_| {
        stop.store(true, Ordering::SeqCst);
        answered.clone()
    });
}

#[test]
fn a_write_that_is_to_be_sent_is_not() {
    let (mut bench, stop) = bench();
    stop.store(true, Ordering::SeqCst);
    let result = bench.client.write(unit(17), &set(1, 2), PATIENT);
    assert!(matches!(result, Err(Unwritten::Stopped)), "{result:?}");
    let result = bench.client.broadcast(&|_| set(1, 2), ms(200), PATIENT);
    assert!(matches!(result, Err(Unwritten::Stopped)), "{result:?}");
    assert_eq!(bench.frames(), 1);
}

#[test]
fn a_write_that_was_sent_gets_half_a_second() {
    let (mut bench, stop) = bench();
    stopped_at_once(&bench, &stop, Vec::new());
    let start = bench.now();
    let result = bench.client.write(unit(17), &set(1, 2), PATIENT);
    let found = outcome(&result);
    assert!(
        found == "outcome unknown: no answer before the program was stopped",
        "{found}"
    );
    assert_eq!(bench.frames(), 2);
    assert!(
        bench.now().saturating_sub(start) < ms(600),
        "{:?}",
        bench.now().saturating_sub(start)
    );
}

#[test]
fn an_answer_within_that_half_second_confirms() {
    let (mut bench, stop) = bench();
    stopped_at_once(&bench, &stop, vec![(ms(400), answer(&set(1, 2)))]);
    let result = bench.client.write(unit(17), &set(1, 2), PATIENT);
    assert_eq!(outcome(&result), "done");
}

#[test]
fn a_busy_unit_is_not_written_to_again() {
    let (mut bench, stop) = bench();
    stopped_at_once(&bench, &stop, vec![(ms(10), refusal(&set(1, 2), 6))]);
    let result = bench.client.write(unit(17), &set(1, 2), PATIENT);
    let found = "the meter refused: exception 06 (SERVER DEVICE BUSY)";
    assert_eq!(outcome(&result), found);
    assert_eq!(bench.frames(), 2);
}

#[test]
fn the_turnaround_of_a_broadcast_is_kept_all_the_same() {
    let (mut bench, stop) = bench();
    stopped_at_once(&bench, &stop, Vec::new());
    let start = bench.now();
    let result = bench.client.broadcast(&|_| set(1, 2), ms(200), PATIENT);
    assert!(result.is_ok(), "{result:?}");
    assert!(bench.now().saturating_sub(start) >= ms(200));
}

#[test]
fn a_line_that_is_never_silent_is_not_waited_for() {
    let (mut bench, stop) = bench();
    let line = bench.line.clone();
    let mut bytes = 0;
    line.inject_endlessly(bench.now(), ms(2), move || {
        bytes += 1;
        if bytes == 100 {
            stop.store(true, Ordering::SeqCst);
        }
        vec![0x55]
    });
    let start = bench.now();
    let result = bench.client.write(unit(17), &set(1, 2), PATIENT);
    assert!(matches!(result, Err(Unwritten::NotSent(_))), "{result:?}");
    assert_eq!(bench.frames(), 1);
    assert!(
        bench.now().saturating_sub(start) < ms(400),
        "{:?}",
        bench.now().saturating_sub(start)
    );
}

#[test]
fn a_line_that_is_silent_again_within_the_time_out_is_written_to() {
    // The wait is cut into pieces, which add up.
    let (mut bench, _stop) = bench();
    let start = bench.now();
    for index in 0..1000 {
        bench.line.inject(start + ms(2 * index), &[0x55]);
    }
    bench.line.meter(|_| vec![(ms(10), answer(&set(1, 2)))]);
    let result = bench.client.write(unit(17), &set(1, 2), PATIENT);
    assert_eq!(outcome(&result), "done");
    assert_eq!(bench.client.counters(unit(17)).stray, 1000);
}

#[test]
fn a_read_that_fails_is_not_repeated() {
    let (mut bench, stop) = bench();
    stopped_at_once(&bench, &stop, Vec::new());
    let start = bench.now();
    let result = bench.client.request(unit(17), &read(2, 1), PATIENT);
    assert!(result.is_err());
    assert_eq!(bench.frames(), 2);
    assert!(
        bench.now().saturating_sub(start) < ms(600),
        "{:?}",
        bench.now().saturating_sub(start)
    );
}

#[test]
fn a_port_that_is_lost_is_not_waited_for() {
    let (mut bench, stop) = bench();
    bench.line.hang_up(bench.now());
    bench.line.until_then(|| OpenError::NotThere {
        port: "scripted".to_owned(),
    });
    assert!(
        bench
            .client
            .request(unit(17), &read(2, 1), PATIENT)
            .is_err()
    );
    stop.store(true, Ordering::SeqCst);
    let start = bench.now();
    let result = bench.client.write(unit(17), &set(1, 2), PATIENT);
    assert!(matches!(result, Err(Unwritten::NotSent(_))), "{result:?}");
    assert!(
        bench.now().saturating_sub(start) < ms(100),
        "{:?}",
        bench.now().saturating_sub(start)
    );
}

#[test]
fn whoever_leaves_the_line_waits_for_no_late_answer() {
    let (mut bench, stop) = bench();
    stopped_at_once(&bench, &stop, Vec::new());
    let result = bench.client.write(unit(17), &set(1, 2), PATIENT);
    assert!(result.is_err());
    let start = bench.now();
    assert!(bench.client.finish().is_ok());
    assert!(bench.clock.now().saturating_sub(start) < ms(100));
}
