//! A port that is lost: what becomes of the request in hand, and how the next one gets the port
//! back.

#[path = "support/clock.rs"]
mod clock;
#[path = "support/script.rs"]
mod script;

use std::io;
use std::sync::Arc;
use std::time::Duration;

use meterpoll::client::{Client, Echo, Failure, Patience};
use meterpoll::codec::{Request, Response};
use meterpoll::transport::holder::Holders;
use meterpoll::transport::{Clock, Line, LineSettings, OpenError, Timing, TransportError};

use self::clock::FakeClock;
use self::script::{Bench, ScriptedLine, dripped, read, true_reply, true_response, unit};

/// The time-out in these tests.
const T: Duration = Duration::from_secs(1);

/// At 9600 8N1.
const SILENCE: Duration = Duration::from_nanos(3_645_833);
const REQUEST: Duration = Duration::from_nanos(8_333_333);

const fn ms(milliseconds: u64) -> Duration {
    Duration::from_millis(milliseconds)
}

fn patience(retries: u32) -> Patience {
    Patience {
        timeout: T,
        longest_answer: T,
        retries,
        ..Patience::default()
    }
}

impl Bench {
    fn ask(&mut self, request: &Request, retries: u32) -> Result<Response, Failure> {
        self.client.request(unit(17), request, patience(retries))
    }

    /// A meter that answers truly after 40 ms, a byte a millisecond.
    fn dripping() -> Self {
        let bench = Self::new();
        bench
            .line
            .meter(|frame| dripped(ms(40), &true_reply(frame), ms(1)));
        bench
    }

    /// Reads a register and must get its true value.
    #[track_caller]
    fn reads(&mut self, address: u16) {
        let response = self.ask(&read(address, 1), 2).expect("an answer");
        assert_eq!(response, true_response(unit(17), address, 1));
    }

    /// Reads a register and must lose the port.
    #[track_caller]
    fn loses(&mut self, address: u16) {
        match self.ask(&read(address, 1), 2) {
            Err(Failure::Port(TransportError::Lost { port, .. })) => assert_eq!(port, "scripted"),
            other => panic!("{other:?}"),
        }
    }

    /// Reads a register and must be told that the port did not come back.
    #[track_caller]
    fn misses(&mut self, retries: u32) -> (Duration, OpenError) {
        match self.ask(&read(9, 1), retries) {
            Err(failure) if !failure.is_port_away() => panic!("{failure}"),
            Err(Failure::Port(TransportError::NotBack { within, source, .. })) => (within, source),
            other => panic!("{other:?}"),
        }
    }
}

/// The addresses that were asked for, frame by frame.
fn asked(bench: &Bench) -> Vec<u8> {
    let sent = bench.line.sent();
    sent.iter().map(|sent| sent.frame[3]).collect()
}

#[test]
fn in_whatever_phase_the_port_is_lost_the_read_fails_at_once_and_is_not_replayed() {
    // Before anything, before the frame, while the meter thinks, in the middle of its answer.
    for (lost_at, frames) in [(ms(0), 0), (ms(3), 0), (ms(30), 1), (ms(55), 1)] {
        let mut bench = Bench::dripping();
        bench.line.hang_up(lost_at);
        bench.line.come_back(ms(0));
        bench.loses(1);
        assert_eq!(bench.now(), lost_at);
        assert_eq!(bench.frames(), frames);
        bench.reads(2);
        assert_eq!(bench.line.reopened(), [lost_at]);
        bench.reads(3);
        let lost = vec![1; frames];
        assert_eq!(asked(&bench), [&lost[..], &[2, 3]].concat());
    }
}

#[test]
fn a_port_that_is_lost_while_a_frame_is_sent_comes_back_for_the_next() {
    let mut bench = Bench::dripping();
    bench.reads(1);
    bench.line.hang_up_at_frame(2);
    bench.loses(2);
    assert_eq!(bench.frames(), 1);
    bench.line.come_back(bench.now());
    bench.reads(3);
    assert_eq!(asked(&bench), [1, 3]);
}

#[test]
fn a_frame_that_was_under_way_as_the_port_was_lost_has_left_before_the_next_one_goes_out() {
    let mut bench = Bench::dripping();
    bench.line.hang_up(ms(4));
    bench.line.come_back(ms(0));
    bench.loses(1);
    assert_eq!(bench.now(), ms(4));
    bench.reads(1);
    assert_eq!(bench.sent_at(), [SILENCE, SILENCE + REQUEST + SILENCE]);
}

#[test]
fn a_port_that_is_lost_between_two_requests_costs_the_second_one() {
    let mut bench = Bench::dripping();
    bench.reads(1);
    let lost_at = bench.now() + ms(500);
    bench.line.hang_up(lost_at);
    bench.clock.advance(ms(800));
    bench.loses(2);
    bench.line.come_back(lost_at + ms(100));
    bench.reads(3);
    assert_eq!(asked(&bench), [1, 3]);
}

#[test]
fn a_port_that_comes_back_in_time_is_used_as_soon_as_that_is_seen() {
    let mut bench = Bench::dripping();
    bench.line.hang_up(ms(0));
    bench.loses(1);
    bench.line.come_back(ms(300));
    bench.reads(2);
    assert_eq!(bench.line.reopened(), [0, 50, 150, 350].map(ms));
    // Nobody knows what was on the line while it was closed, so silence is seen first.
    assert_eq!(bench.sent_at(), [ms(350) + SILENCE]);
    assert_eq!(asked(&bench), [2]);
}

#[test]
fn a_port_that_does_not_come_back_is_looked_for_as_long_as_the_attempts_would_take() {
    let mut bench = Bench::dripping();
    bench.line.hang_up(ms(0));
    bench.loses(1);
    let (within, source) = bench.misses(0);
    assert_eq!(within, T);
    assert_eq!(source.to_string(), "port scripted is not there");
    assert_eq!(bench.now(), T);
    assert_eq!(
        bench.line.reopened(),
        [0, 50, 150, 350, 550, 750, 950, 1000].map(ms)
    );
    let (within, _) = bench.misses(2);
    assert_eq!(within, T * 3);
    assert_eq!(bench.now(), T * 4);
    assert_eq!(bench.frames(), 0);
    // Who asks later looks for it anew.
    bench.line.come_back(ms(0));
    bench.reads(2);
}

#[test]
fn a_loss_says_which_port_and_how_long_it_was_looked_for() {
    let mut bench = Bench::dripping();
    bench.line.hang_up(ms(0));
    bench.loses(1);
    match bench.ask(&read(9, 1), 0) {
        Err(failure) => assert_eq!(
            failure.to_string(),
            "port scripted did not come back within 1s"
        ),
        other => panic!("{other:?}"),
    }
}

#[test]
fn whatever_is_in_the_way_of_a_port_is_waited_for() {
    let reasons: [fn() -> OpenError; 4] = [
        || OpenError::NotThere {
            port: "scripted".to_owned(),
        },
        || OpenError::Busy {
            port: "scripted".to_owned(),
            holders: Holders::Unknown,
        },
        || OpenError::NotPermitted {
            port: "scripted".to_owned(),
            who: "it belongs to group dialout, and user me is in no group".to_owned(),
            group: None,
        },
        || OpenError::Other {
            port: "scripted".to_owned(),
            source: io::Error::other("no such device"),
        },
    ];
    for reason in reasons {
        let mut bench = Bench::dripping();
        bench.line.until_then(reason);
        bench.line.hang_up(ms(0));
        bench.loses(1);
        let (_, source) = bench.misses(0);
        let told = |error: OpenError| error.with_holders().to_string();
        assert_eq!(source.to_string(), told(reason()));
        bench.line.come_back(T + ms(300));
        bench.reads(2);
        assert_eq!(asked(&bench), [2]);
    }
}

#[test]
fn a_port_that_is_lost_again_is_looked_for_again() {
    let mut bench = Bench::dripping();
    bench.line.come_back(ms(0));
    for address in 1..=5 {
        bench.line.hang_up(bench.now() + ms(20));
        bench.loses(address);
        bench.reads(address + 10);
    }
    assert_eq!(bench.line.reopened().len(), 5);
    assert_eq!(asked(&bench), [1, 11, 2, 12, 3, 13, 4, 14, 5, 15]);
}

#[test]
fn the_answer_to_a_request_during_which_the_port_was_lost_is_no_answer_to_the_next() {
    // The meter answers while the port is away, as it comes back, and after that.
    for late in [100, 299, 300, 340, 360, 800, 1500].map(ms) {
        let mut bench = Bench::new();
        let mut first = true;
        bench.line.meter(move |frame| {
            let delay = if std::mem::take(&mut first) {
                late
            } else {
                ms(40)
            };
            vec![(delay, true_reply(frame))]
        });
        bench.line.hang_up(ms(50));
        bench.loses(1);
        bench.line.come_back(ms(350));
        bench.reads(2);
        bench.reads(3);
        assert_eq!(asked(&bench), [1, 2, 3]);
        // It was waited for as ever: as long again as it had to begin.
        let waited = bench.sent_at()[1];
        assert!(waited >= REQUEST + late.min(T * 2), "{waited:?}");
    }
}

#[test]
fn the_same_request_goes_out_as_soon_as_the_port_is_back() {
    let mut bench = Bench::dripping();
    bench.line.hang_up(ms(30));
    bench.loses(1);
    bench.line.come_back(ms(0));
    bench.reads(1);
    assert_eq!(bench.sent_at(), [SILENCE, ms(30) + SILENCE]);
}

#[test]
fn a_line_whose_port_is_lost_is_left_at_once() {
    let mut bench = Bench::dripping();
    bench.line.hang_up(ms(30));
    bench.loses(1);
    let (clock, line) = (Arc::clone(&bench.clock), bench.line.clone());
    assert!(bench.client.finish().is_ok());
    assert_eq!(clock.now(), ms(30));
    assert_eq!(line.reopened(), []);
}

#[test]
fn an_adapter_that_needs_time_after_opening_gets_it_after_reopening_too() {
    let clock = Arc::new(FakeClock::new());
    let settings = LineSettings::default();
    let scripted = ScriptedLine::new(Arc::clone(&clock), settings);
    scripted.meter(|frame| vec![(ms(40), true_reply(frame))]);
    let shared = Arc::clone(&clock) as Arc<dyn Clock>;
    let line = Line::new(Box::new(scripted.clone()), shared, Timing::Paced(settings));
    let line = line.expect("the line is open").settling(ms(700));
    let mut client = Client::new(line, Echo::Auto);
    scripted.hang_up(ms(0));
    assert!(client.request(unit(17), &read(1, 1), patience(2)).is_err());
    scripted.come_back(ms(50));
    // What arrives until then is thrown away.
    scripted.inject(ms(400), &[0x11, 0x03, 0x02]);
    let response = client.request(unit(17), &read(2, 1), patience(2));
    assert_eq!(response.expect("an answer"), true_response(unit(17), 2, 1));
    assert_eq!(scripted.sent()[0].at, ms(750) + SILENCE);
}

#[test]
fn a_port_that_is_gone_again_before_it_has_settled_is_not_back() {
    let clock = Arc::new(FakeClock::new());
    let settings = LineSettings::default();
    let scripted = ScriptedLine::new(Arc::clone(&clock), settings);
    let shared = Arc::clone(&clock) as Arc<dyn Clock>;
    let line = Line::new(Box::new(scripted.clone()), shared, Timing::Paced(settings));
    let mut line = line.expect("the line is open").settling(ms(100));
    scripted.hang_up(ms(0));
    scripted.come_back(ms(0));
    assert!(line.send(&[0]).is_err());
    assert_eq!(line.loss().map(|loss| loss.at), Some(ms(0)));
    scripted.hang_up_again(ms(50));
    let error = line.reopen().expect_err("it is gone again");
    assert_eq!(error.to_string(), "port scripted cannot be opened");
    assert!(line.loss().is_some());
    assert!(line.reopen().is_ok());
    assert_eq!(line.loss(), None);
}
