//! However the bytes on a line are cut into pieces, the client makes the same of them.

use std::time::Duration;

use meterpoll::client::{Failure, Patience};
use meterpoll::codec::ExceptionCode;
use meterpoll::transport::LineSettings;

use super::cursor::Cursor;
use super::pieces::{Question, line};
use super::script::{Bench, Chunk};

/// The last piece is there before the time-out of a second.
const LAST: Duration = Duration::from_millis(900);

/// No two pieces are as far apart as the gap behind which a damaged answer is given up.
const LONGEST_GAP: usize = 99;

/// Asks two clients the same; one gets all bytes at once, one in pieces.
pub(crate) fn chunks(data: &[u8]) {
    let mut cursor = Cursor::new(data);
    let question = Question::new(&mut cursor);
    let mut cuts = cursor.clone();
    let bytes = line(&question, &mut cursor, 512);
    let mut pieces = Vec::new();
    let mut at = Duration::from_millis(10);
    let mut rest = bytes.as_slice();
    while !rest.is_empty() {
        let (piece, behind) = rest.split_at((1 + cuts.below(9)).min(rest.len()));
        pieces.push((at, piece.to_vec()));
        let gap = Duration::from_millis(cuts.below(LONGEST_GAP + 1) as u64);
        at = (at + gap).min(LAST);
        rest = behind;
    }
    let (whole, split) = (
        outcome(&question, vec![(Duration::from_millis(10), bytes)]),
        outcome(&question, pieces.clone()),
    );
    assert_eq!(whole, split, "{pieces:02X?}");
}

/// What the client makes of one attempt.
fn outcome(question: &Question, chunks: Vec<Chunk>) -> String {
    let mut bench = Bench::with(LineSettings::default(), question.echo);
    bench.line.answer(chunks);
    let patience = Patience {
        retries: 0,
        ..Patience::default()
    };
    let request = &question.request;
    let result = bench.client.try_request(question.unit, request, patience);
    match result {
        // A second attempt goes out where there is time left, and what comes of it depends on what
        // is still under way of the first.
        _ if bench.frames() > 1 => "asked again".to_owned(),
        Err(Failure::Exception(ExceptionCode::SERVER_DEVICE_BUSY)) => "asked again".to_owned(),
        Ok(response) => format!("{response:?}"),
        Err(failure) => failure.to_string(),
    }
}
