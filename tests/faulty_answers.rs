//! What faults make of the bytes of an answer, byte by byte.

#[path = "support/lying.rs"]
mod lying;

use self::lying::{Lying, READ, SILENT, TRUE, read, sealed, truth};
use meterpoll::codec::rtu::{self, Hex};

/// Checks what comes at once, by the rules with their seed 0.
#[track_caller]
fn check(rule: &str, expected: &str) {
    assert_eq!(Lying::new(&[rule]).at_once(&READ), expected, "{rule}");
}

/// The bytes that come at once for each of the first so many reads.
fn several(rule: &str, count: usize) -> Vec<Vec<u8>> {
    let mut lying = Lying::new(&[rule]);
    std::iter::repeat_with(|| lying.at_once(&READ))
        .take(count)
        .map(|hex| bytes(&hex))
        .collect()
}

fn bytes(hex: &str) -> Vec<u8> {
    let pairs = hex.split_whitespace();
    pairs
        .map(|pair| u8::from_str_radix(pair, 16).unwrap())
        .collect()
}

/// The same for a frame with a right CRC, from what is before that.
#[track_caller]
fn check_sealed(rule: &str, body: &str) {
    check(rule, &framed(body));
}

fn framed(body: &str) -> String {
    Hex(&sealed(&bytes(body))).to_string()
}

#[test]
fn without_a_rule_the_answer_is_true() {
    assert_eq!(Lying::new(&[]).at_once(&READ), TRUE);
    assert_eq!(bytes(TRUE), truth(&READ));
}

#[test]
fn a_cut_leaves_the_first_bytes_and_never_all() {
    check("cut=1", "11");
    check("cut=5", "11 03 06 11 6B");
    check("cut=10", "11 03 06 11 6B 11 6C 11 6D C2");
    check("cut=11", "11 03 06 11 6B 11 6C 11 6D C2");
    check("cut=256", "11 03 06 11 6B 11 6C 11 6D C2");
    let cuts = several("cut", 300);
    let truth = truth(&READ);
    assert!(cuts.iter().all(|cut| truth.starts_with(cut)));
    for length in 1..truth.len() {
        assert!(cuts.iter().any(|cut| cut.len() == length), "{length}");
    }
    assert!(cuts.iter().all(|cut| (1..truth.len()).contains(&cut.len())));
}

#[test]
fn noise_is_before_or_after_the_answer() {
    check("before=00FF", "00 FF 11 03 06 11 6B 11 6C 11 6D C2 A1");
    check("before=1 1 1 1", "11 11 11 03 06 11 6B 11 6C 11 6D C2 A1");
    check("after=0a", "11 03 06 11 6B 11 6C 11 6D C2 A1 0A");
    let truth = truth(&READ);
    for (before, after) in several("before", 200).iter().zip(several("after", 200)) {
        assert!(before.ends_with(&truth) && after.starts_with(&truth));
        assert!((1..=32).contains(&(before.len() - truth.len())));
        assert!((1..=32).contains(&(after.len() - truth.len())));
    }
}

#[test]
fn the_answer_comes_twice() {
    check("twice", &format!("{TRUE} {TRUE}"));
}

#[test]
fn the_crc_is_wrong() {
    check("crc", "11 03 06 11 6B 11 6C 11 6D 3D 5E");
    check("crc-swapped", "11 03 06 11 6B 11 6C 11 6D A1 C2");
    // The CRC of these registers has two equal bytes.
    let equal = (1..SILENT)
        .flat_map(|unit| (0..=255).map(move |address| read(unit, 3, address, 1)))
        .find(|request| matches!(truth(request)[..], [.., low, high] if low == high))
        .expect("there is one");
    let swapped = bytes(&Lying::new(&["crc-swapped"]).at_once(&equal));
    let wrong = bytes(&Lying::new(&["crc"]).at_once(&equal));
    assert_eq!(swapped, wrong);
    assert!(rtu::open(&wrong).is_err());
}

#[test]
fn one_bit_is_flipped_by_its_number_on_the_wire() {
    check("flip=0", "10 03 06 11 6B 11 6C 11 6D C2 A1");
    check("flip=7", "91 03 06 11 6B 11 6C 11 6D C2 A1");
    check("flip=87", "11 03 06 11 6B 11 6C 11 6D C2 21");
    // There are 88.
    check("flip=88", "10 03 06 11 6B 11 6C 11 6D C2 A1");
    for frame in several("flip", 200) {
        assert_eq!(turned(&frame).len(), 1);
    }
}

/// The bits that are not as they should be.
fn turned(frame: &[u8]) -> Vec<usize> {
    let truth = truth(&READ);
    assert_eq!(frame.len(), truth.len());
    (0..frame.len() * 8)
        .filter(|bit| (frame[bit / 8] ^ truth[bit / 8]) >> (bit % 8) & 1 == 1)
        .collect()
}

#[test]
fn a_burst_is_as_long_as_it_says_and_starts_and_ends_with_a_wrong_bit() {
    for length in [1, 2, 16, 17, 88] {
        for frame in several(&format!("burst={length}"), 50) {
            let turned = turned(&frame);
            let span = turned.last().unwrap() - turned[0] + 1;
            assert_eq!(span, length);
        }
    }
    // No longer than the answer.
    let turned = turned(&several("burst=2048", 1)[0]);
    assert_eq!((turned[0], *turned.last().unwrap()), (0, 87));
}

#[test]
fn no_flip_or_burst_without_values_gets_past_the_crc() {
    for frame in [several("flip", 2000), several("burst", 2000)].concat() {
        assert!(rtu::open(&frame).is_err(), "{}", Hex(&frame));
    }
}

#[test]
fn another_unit_or_function_comes_with_a_right_crc() {
    check_sealed("wrong-unit=18", "12 03 06 11 6B 11 6C 11 6D");
    check_sealed("wrong-unit=0", "00 03 06 11 6B 11 6C 11 6D");
    check_sealed("wrong-function=16", "11 10 06 11 6B 11 6C 11 6D");
    check_sealed("wrong-function", "11 04 06 11 6B 11 6C 11 6D");
    // Where the meter has it itself, the one after it.
    check_sealed("wrong-unit=17", "12 03 06 11 6B 11 6C 11 6D");
    check_sealed("wrong-function=3", "11 04 06 11 6B 11 6C 11 6D");
    for frame in several("wrong-unit", 300) {
        let (unit, rest) = rtu::open(&frame).unwrap();
        assert!((1..=247).contains(&unit) && unit != 17, "{unit}");
        assert_eq!(rest, &truth(&READ)[1..9]);
    }
}

#[test]
fn the_count_is_wrong_and_fits_the_data() {
    check_sealed("wrong-count=+1", "11 03 08 11 6B 11 6C 11 6D 11 6B");
    check_sealed("wrong-count=-1", "11 03 04 11 6B 11 6C");
    check_sealed("wrong-count=odd", "11 03 07 11 6B 11 6C 11 6D 11");
    check_sealed("wrong-count=0", "11 03 00");
    let most = &several("wrong-count=255", 1)[0];
    assert_eq!((most[2], most.len()), (255, 260));
    assert_eq!(*most, sealed(&most[..258]));
    let lengths: Vec<_> = several("wrong-count", 100).iter().map(Vec::len).collect();
    for length in [5, 9, 12, 13, 260] {
        assert!(lengths.contains(&length), "{length}");
    }
}

#[test]
fn an_answer_that_counts_nothing_gets_a_byte_more_or_less() {
    let write = sealed(&[17, 6, 0, 1, 0, 9]);
    let spoiled = |rule| Lying::new(&[rule]).at_once(&write);
    assert_eq!(spoiled("wrong-count=+1"), framed("11 06 00 01 00 09 00"));
    assert_eq!(spoiled("wrong-count=255"), framed("11 06 00 01 00 09 00"));
    assert_eq!(spoiled("wrong-count=-1"), framed("11 06 00 01 00"));
    assert_eq!(spoiled("wrong-count=0"), framed("11 06 00 01 00"));
}

#[test]
fn an_oversize_answer_is_a_byte_longer_than_a_frame_can_be() {
    let frame = &several("oversize", 1)[0];
    assert_eq!((frame[2], frame.len()), (252, 257));
    assert_eq!(*frame, sealed(&frame[..255]));
}

#[test]
fn an_exception_takes_the_place_of_the_answer() {
    check_sealed("exception=6", "11 83 06");
    check_sealed("exception=0x63", "11 83 63");
    check_sealed("exception-for=16", "11 90 02");
    check_sealed("exception-for=3", "11 84 02");
    for frame in several("exception", 100) {
        let (_, rest) = rtu::open(&frame).unwrap();
        assert!([1, 2, 3, 4, 5, 6, 8, 10, 11].contains(&rest[1]));
    }
    for frame in several("exception-for", 300) {
        let (_, rest) = rtu::open(&frame).unwrap();
        assert!(rest[0] > 0x80 && rest[0] != 0x83, "{}", Hex(&frame));
    }
}

#[test]
fn a_meter_that_does_not_answer_is_not_made_to() {
    let request = read(SILENT, 3, 0, 1);
    for rule in [
        "late",
        "delay",
        "silence",
        "cut",
        "split",
        "drip",
        "endless",
        "before",
        "after",
        "twice",
        "crc",
        "flip",
        "burst",
        "wrong-unit",
        "wrong-count",
        "oversize",
        "exception",
        "hang-up",
        "hang-up=after",
    ] {
        let heard = Lying::new(&[rule]).ask(&request, 3000);
        assert!(heard.is_empty(), "{rule}: {heard:?}");
    }
}
