//! A port that is lost by a fault: once, and then it works again.

#[path = "support/lying.rs"]
mod lying;

use std::error::Error;
use std::time::Duration;

use meterpoll::transport::faulty::FaultKind;
use meterpoll::transport::{Transport, TransportError};

use self::lying::{Lying, READ, TRUE, truth};

const LOST: &str = "port (faulty) was lost";

#[test]
fn the_port_is_lost_before_the_request_reaches_the_meter() {
    let mut lying = Lying::new(&["hang-up=before,on=1"]);
    let error = lying.line.send(&READ).unwrap_err();
    assert_eq!(error.to_string(), LOST);
    assert_eq!(error.source().unwrap().to_string(), "a fault rule hangs up");
    assert!(lying.listen(1000).is_empty());
    assert_eq!(lying.ask(&READ, 1000), [format!("0: {TRUE}")]);
    let counts = lying.line.counts();
    assert_eq!((counts.requests, counts.answers), (2, 1));
    assert_eq!(counts.of(FaultKind::HangUp), 1);
}

#[test]
fn the_port_is_lost_after_part_of_the_answer() {
    let mut lying = Lying::new(&["hang-up,on=1-100"]);
    for _ in 0..100 {
        let heard = lying.ask(&READ, 1000);
        assert_eq!((heard.len(), heard[1].as_str()), (2, LOST));
        let (_, part) = heard[0].split_once(": ").unwrap();
        assert!(TRUE.starts_with(part) && part.len() < TRUE.len());
        assert!(lying.listen(1000).is_empty());
    }
    assert_eq!(lying.ask(&READ, 1000), [format!("0: {TRUE}")]);
}

#[test]
fn the_port_is_lost_after_the_answer_at_whatever_is_done_next() {
    let heard = |next: fn(&mut Lying) -> Result<(), TransportError>| {
        let mut lying = Lying::new(&["hang-up=after,on=1"]);
        lying.line.send(&READ).unwrap();
        let mut into = [0; 64];
        let count = lying.line.receive(&mut into, Duration::ZERO);
        assert_eq!(into[..count.unwrap()], truth(&READ));
        let error = next(&mut lying).unwrap_err();
        assert_eq!(lying.ask(&READ, 1000), [format!("0: {TRUE}")]);
        error.to_string()
    };
    assert_eq!(heard(|lying| lying.line.send(&READ)), LOST);
    assert_eq!(heard(|lying| lying.line.discard_input()), LOST);
    assert_eq!(
        heard(|lying| {
            let wait = Duration::from_secs(1);
            lying.line.receive(&mut [0; 9], wait).map(drop)
        }),
        LOST
    );
}

#[test]
fn what_was_on_its_way_is_lost_with_the_port() {
    let mut lying = Lying::new(&["late=2,on=1", "hang-up=before,on=2"]);
    assert!(lying.ask(&READ, 1000).is_empty());
    assert!(lying.line.send(&READ).is_err());
    assert!(lying.listen(5000).is_empty());
    assert_eq!(lying.line.kept_bytes(), 0);
}

#[test]
fn the_error_names_the_port_it_is_given() {
    let mut lying = Lying::new(&["hang-up=before"]);
    lying.line = lying.line.with_name("sim:");
    let error = lying.line.send(&READ).unwrap_err();
    assert_eq!(error.to_string(), "port sim: was lost");
}
