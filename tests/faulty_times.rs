//! When faults let bytes arrive, to the microsecond of the test's clock.

#[path = "support/lying.rs"]
mod lying;

use std::time::Duration;

use meterpoll::transport::faulty::FaultScript;
use meterpoll::transport::{Clock, LineSettings, Timing, Transport};

use self::lying::{Lying, READ, SILENT, TRUE, TWICE, read, sealed, truth};
use meterpoll::codec::rtu::Hex;

const ECHO: &str = "11 03 00 6B 00 03 76 87";

const fn ms(milliseconds: u64) -> Duration {
    Duration::from_millis(milliseconds)
}

/// Checks what is heard in so many milliseconds after the request.
#[track_caller]
fn check(rule: &str, milliseconds: u64, expected: &[&str]) {
    let heard = Lying::new(&[rule]).ask(&READ, milliseconds);
    assert_eq!(heard, expected, "{rule}");
}

fn at(milliseconds: u64, bytes: &str) -> String {
    format!("{milliseconds}: {bytes}")
}

#[test]
fn a_late_answer_begins_so_many_time_outs_after_the_request() {
    check("late=1.1", 5000, &[&at(1100, TRUE)]);
    check("late=1.1,timeout=300ms", 5000, &[&at(330, TRUE)]);
    check("late=0", 5000, &[&at(0, TRUE)]);
    check("late=3,timeout=1s", 2999, &[]);
}

#[test]
fn a_late_answer_without_a_number_comes_in_the_second_time_out() {
    let mut lying = Lying::new(&["late"]);
    for _ in 0..200 {
        let heard = lying.ask(&READ, 2000);
        let (time, bytes) = heard[0].split_once(": ").unwrap();
        let time: f64 = time.parse().unwrap();
        assert!((1100.0..=1900.0).contains(&time), "{time}");
        assert_eq!((heard.len(), bytes), (1, TRUE));
    }
}

#[test]
fn a_delay_is_a_time() {
    check("delay", 5000, &[&at(40, TRUE)]);
    check("delay=900ms", 5000, &[&at(900, TRUE)]);
}

#[test]
fn times_count_from_the_end_of_the_request_on_the_wire() {
    let heard = |rule| {
        let timing = Timing::Paced(LineSettings::default());
        let script = FaultScript::parse([rule]).unwrap();
        Lying::with(script, timing).ask(&READ, 2000)
    };
    // Eight characters of 10 bits at 9600.
    assert_eq!(heard("delay=40ms"), [format!("48.333: {TRUE}")]);
    assert_eq!(heard("late=1"), [format!("1008.333: {TRUE}")]);
    assert_eq!(heard("echo-only"), [format!("8.333: {ECHO}")]);
    let echo = [format!("8.333: {ECHO}"), format!("13.333: {TRUE}")];
    assert_eq!(heard("echo,gap=5ms"), echo);
}

#[test]
fn the_pieces_of_an_answer_are_as_far_apart_as_the_rule_says() {
    let (first, second) = ("11 03 06 11", "6B 11 6C 11 6D C2 A1");
    check("split=4", 5000, &[&at(0, first), &at(16, second)]);
    check("split=4,gap=60ms", 5000, &[&at(0, first), &at(60, second)]);
    check("cut=4", 5000, &[&at(0, first)]);
    check("cut=4,rest=1.1", 5000, &[&at(0, first), &at(1100, second)]);
    check(
        "cut=4,rest=1.1,timeout=100ms",
        5000,
        &[&at(0, first), &at(110, second)],
    );
    check("twice,gap=5ms", 5000, &[&at(0, TRUE), &at(5, TRUE)]);
    check("before=00,gap=5ms", 5000, &[&at(0, "00"), &at(5, TRUE)]);
    check("after=00,gap=5ms", 5000, &[&at(0, TRUE), &at(5, "00")]);
}

#[test]
fn a_dripping_answer_comes_byte_by_byte() {
    let expected: Vec<String> = (0..)
        .zip(TRUE.split(' '))
        .map(|(place, byte)| at(place * 20, byte))
        .collect();
    assert_eq!(Lying::new(&["drip"]).ask(&READ, 5000), expected);
    let slow = Lying::new(&["drip=1s"]).ask(&READ, 60_000);
    assert_eq!(slow.last().unwrap(), "10000: A1");
}

#[test]
fn bytes_that_were_not_taken_in_time_are_there_all_the_same() {
    let mut lying = Lying::new(&["drip"]);
    lying.line.send(&READ).unwrap();
    assert_eq!(lying.listen(0), ["0: 11"]);
    lying.clock.advance(ms(100));
    assert_eq!(lying.listen(0), ["0: 03 06 11 6B 11"]);
}

#[test]
fn a_small_buffer_gets_the_bytes_one_after_the_other() {
    let mut lying = Lying::new(&["twice"]);
    lying.line.send(&READ).unwrap();
    let mut heard = Vec::new();
    for _ in 0..22 {
        let mut one = [0];
        assert_eq!(lying.line.receive(&mut one, ms(10)).unwrap(), 1);
        heard.extend(one);
    }
    assert_eq!(heard, truth(&READ).repeat(2));
    assert_eq!(lying.line.receive(&mut [0], ms(10)).unwrap(), 0);
    assert_eq!(lying.clock.now(), ms(10));
}

#[test]
fn an_echo_is_before_the_answer_or_in_its_place() {
    check("echo", 5000, &[&at(0, ECHO), &at(0, TRUE)]);
    check("echo=3", 5000, &[&at(0, "11 03 00"), &at(0, TRUE)]);
    check("echo=9", 5000, &[&at(0, ECHO), &at(0, TRUE)]);
    check("echo-only", 5000, &[&at(0, ECHO)]);
}

#[test]
fn silence_is_silence() {
    check("silence", 60_000, &[]);
}

#[test]
fn a_late_answer_comes_across_the_next_request() {
    let mut lying = Lying::new(&["late=1.5,on=1"]);
    assert!(lying.ask(&READ, 1000).is_empty());
    let next = read(17, 3, 0x80, 1);
    let truth = Hex(&truth(&next)).to_string();
    assert_eq!(lying.ask(&next, 1000), [at(0, &truth), at(500, TRUE)]);
}

#[test]
fn several_late_answers_come_in_the_order_of_their_times() {
    let mut lying = Lying::new(&["late=3,on=1", "late=1,on=2", "late=1,on=3"]);
    let requests = [1, 2, 3].map(|address| read(17, 3, address, 1));
    let [first, second, third] = requests.map(|request| {
        assert!(lying.ask(&request, 100).is_empty());
        Hex(&truth(&request)).to_string()
    });
    assert_eq!(
        lying.listen(5000),
        [at(800, &second), at(900, &third), at(2700, &first)]
    );
}

#[test]
fn discarding_takes_what_has_arrived_and_leaves_what_is_on_its_way() {
    let mut lying = Lying::new(&["late=1,on=1", "drip,on=2"]);
    lying.line.send(&READ).unwrap();
    // The meter has answered, the line has not brought it yet.
    lying.line.discard_input().unwrap();
    assert_eq!(lying.listen(2000), [at(1000, TRUE)]);
    lying.line.send(&READ).unwrap();
    assert_eq!(lying.listen(50), ["0: 11", "20: 03", "40: 06"]);
    lying.clock.advance(ms(110));
    lying.line.discard_input().unwrap();
    assert_eq!(lying.listen(1000), ["20: C2", "40: A1"]);
    lying.line.send(&READ).unwrap();
    lying.line.discard_input().unwrap();
    assert!(lying.listen(1000).is_empty());
}

#[test]
fn an_answer_nobody_took_is_not_taken_for_the_next_one() {
    let mut lying = Lying::new(&["crc,on=2"]);
    lying.line.send(&read(17, 3, 1, 1)).unwrap();
    let first = Hex(&truth(&read(17, 3, 1, 1))).to_string();
    assert_eq!(
        lying.ask(&READ, 1000),
        [at(0, &first), at(0, "11 03 06 11 6B 11 6C 11 6D 3D 5E")]
    );
}

#[test]
fn what_is_due_next_is_known() {
    let mut lying = Lying::new(&["late=1,on=1", "garbage,every=5ms,on=2"]);
    assert_eq!(lying.line.next_due(), None);
    lying.line.send(&READ).unwrap();
    assert_eq!(lying.line.receive(&mut [0; 9], ms(0)).unwrap(), 0);
    assert_eq!(lying.line.next_due(), Some(ms(1000)));
    lying.clock.advance(ms(700));
    lying.line.send(&READ).unwrap();
    assert_eq!(lying.line.next_due(), Some(ms(700)));
    assert_eq!(lying.line.receive(&mut [0; 9], ms(0)).unwrap(), 1);
    assert_eq!(lying.line.next_due(), Some(ms(705)));
    lying.line.send(&read(SILENT, 3, 0, 1)).unwrap();
    assert_eq!(lying.line.next_due(), Some(ms(1000)));
}

#[test]
fn no_wait_is_longer_than_asked() {
    let mut lying = Lying::new(&["late=1"]);
    lying.line.send(&READ).unwrap();
    let mut into = [0; 64];
    assert_eq!(lying.line.receive(&mut into, ms(300)).unwrap(), 0);
    assert_eq!(lying.clock.now(), ms(300));
    assert_eq!(lying.line.receive(&mut into, ms(5000)).unwrap(), 11);
    assert_eq!(lying.clock.now(), ms(1000));
}

#[test]
fn an_answer_whose_length_is_unknown_is_whole_when_nothing_more_comes() {
    let request = sealed(&[17, 0x2B, 1, 2, 3, 4]);
    let whole = at(100, "11 2B 01 02 03 04");
    let [low, high] = [request[6], request[7]].map(|byte| !byte);
    let heard = Lying::new(&["crc"]).ask(&request, 1000);
    assert_eq!(heard, [format!("{whole} {low:02X} {high:02X}")]);
}

#[test]
fn what_comes_behind_an_answer_passes() {
    let request = read(TWICE, 3, 1, 1);
    let truth = truth(&request);
    let once = Hex(&truth).to_string();
    let twice = at(0, &format!("{once} {once}"));
    assert_eq!(Lying::new(&[]).ask(&request, 1000), [twice]);
    let heard = Lying::new(&["cut=2"]).ask(&request, 1000);
    assert_eq!(heard, [at(0, &format!("62 03 {once}"))]);
    let heard = Lying::new(&["late=0.5"]).ask(&request, 1000);
    assert_eq!(heard, [at(0, &once), at(500, &once)]);
    assert!(Lying::new(&["silence"]).ask(&request, 1000).is_empty());
}

#[test]
fn what_arrives_while_it_is_discarded_is_discarded() {
    for rules in [&[][..], &["crc"]] {
        let mut lying = Lying::slow(rules);
        lying.line.send(&READ).unwrap();
        lying.line.discard_input().unwrap();
        assert!(lying.listen(1000).is_empty(), "{rules:?}");
    }
}
