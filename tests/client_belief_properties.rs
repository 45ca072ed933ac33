//! Whatever is on the line, however it arrives: what holds for every answer that is believed.

#[path = "support/question.rs"]
mod question;

use meterpoll::client::Echo;
use meterpoll::codec::{Reply, Request, Response};
use proptest::prelude::*;
use proptest::test_runner::{RngAlgorithm, TestRng, TestRunner};

use self::question::{Question, exception, read, registers, reply_frame};

/// Runs a property on the same cases every time.
fn check<S: Strategy>(
    cases: u32,
    strategy: &S,
    test: impl Fn(S::Value) -> Result<(), TestCaseError>,
) {
    let config = ProptestConfig {
        cases,
        failure_persistence: None,
        ..ProptestConfig::default()
    };
    let rng = TestRng::deterministic_rng(RngAlgorithm::ChaCha);
    TestRunner::new_with_rng(config, rng)
        .run(strategy, test)
        .unwrap_or_else(|error| panic!("{error}"));
}

fn any_question() -> impl Strategy<Value = Question> {
    let request = prop_oneof![
        Just(read(0x6B, 3)),
        // Requests that start like their answers.
        Just(read(0x0240, 1)),
        Just(read(0x02A0, 1)),
        Just(read(0x0655, 3)),
        Just(read(0xFA00, 125)),
        Just(Request::ReadExceptionStatus),
        Just(Request::ReturnQueryData(0x1108)),
    ];
    let echo = prop_oneof![Just(Echo::Auto), Just(Echo::On), Just(Echo::Off)];
    (request, echo, any::<Option<bool>>())
        .prop_map(|(request, echo, seen)| Question::new(request).with(echo, seen))
}

/// What is on the line, in pieces: numbers choose a piece, where to cut it, and its content.
type Piece = (u8, prop::sample::Index, Vec<u16>);

fn any_pieces() -> impl Strategy<Value = Vec<Piece>> {
    let content = prop::collection::vec(any::<u16>(), 125);
    prop::collection::vec((0..9_u8, any::<prop::sample::Index>(), content), 1..6)
}

fn bytes_of(question: &Question, (kind, cut, content): &Piece) -> Vec<u8> {
    let own = question.frame.as_bytes().to_vec();
    let refusal = exception(question.request.function(), 2);
    let response = match &question.request {
        Request::Read { range, .. } => {
            let mut values = content[..usize::from(range.count())].to_vec();
            // An exception to this function, in the middle of the values.
            if values.len() >= 3 && cut.index(2) == 0 {
                values[..3].copy_from_slice(&[0x1183, 0x02C1, 0x3400]);
            }
            registers(&values)
        }
        Request::ReturnQueryData(word) => Reply::Normal(Response::QueryData(*word)),
        _ => Reply::Normal(Response::ExceptionStatus(content[0].to_le_bytes()[0])),
    };
    let whole = reply_frame(0x11, &response);
    match kind {
        0 => whole,
        1 => whole[..cut.index(whole.len())].to_vec(),
        2 => whole[cut.index(whole.len())..].to_vec(),
        3 => own,
        4 => own[..cut.index(own.len())].to_vec(),
        5 => reply_frame(0x11, &refusal),
        6 => reply_frame(0x12, &registers(&content[..=cut.index(125)])),
        7 => {
            let mut damaged = whole;
            let at = cut.index(damaged.len());
            damaged[at] ^= 0x40;
            damaged
        }
        _ => {
            let noise: Vec<u8> = content.iter().flat_map(|word| word.to_be_bytes()).collect();
            noise[..=cut.index(32)].to_vec()
        }
    }
}

#[test]
fn what_a_beginning_is_taken_for_the_whole_is_taken_for_too() {
    check(
        1500,
        &(any_question(), any_pieces()),
        |(question, pieces)| {
            let line: Vec<u8> = pieces
                .iter()
                .flat_map(|piece| bytes_of(&question, piece))
                .collect();
            let whole = question.answer(&line);
            for cut in 0..line.len() {
                if let Some(early) = question.answer(&line[..cut]) {
                    prop_assert_eq!(Some(early), whole, "after {} of {:02X?}", cut, line);
                    break;
                }
            }
            Ok(())
        },
    );
}

#[test]
fn what_is_believed_holds_unit_function_byte_count_and_crc() {
    // Few values, so that frames come about by chance.
    let byte = prop_oneof![
        4 => prop::sample::select(&[0x11_u8, 0x03, 0x83, 0x02, 0x06, 0x00, 0xC1, 0x34][..]),
        1 => any::<u8>(),
    ];
    let noise = prop::collection::vec(byte, 0..40);
    let strategy = (any_question(), noise, any_pieces(), any::<bool>());
    check(1000, &strategy, |(question, noise, pieces, mixed)| {
        let mut line = noise;
        if mixed {
            line.extend(pieces.iter().flat_map(|piece| bytes_of(&question, piece)));
        }
        if let Some(reply) = question.answer(&line) {
            let frame = reply_frame(0x11, &reply);
            prop_assert!(line.windows(frame.len()).any(|window| window == frame));
            let function = question.request.function().get();
            prop_assert!(frame[1] == function || frame[1] == function | 0x80);
            if let (Request::Read { range, .. }, true) = (&question.request, frame[1] == function) {
                prop_assert_eq!(u16::from(frame[2]), 2 * range.count());
            }
        }
        Ok(())
    });
}
