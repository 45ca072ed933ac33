//! What is believed holds a frame with the unit, function, byte count and CRC that the request
//! implies, and is believed as soon as it is there.

use meterpoll::client::belief::{Expectation, Verdict};
use meterpoll::codec::rtu::{Hex, encode_reply};
use meterpoll::codec::{Reply, Request, Response};

use super::cursor::Cursor;
use super::pieces::{Question, line};

/// Judges what the bytes make of a line.
pub(crate) fn reply(data: &[u8]) {
    let mut cursor = Cursor::new(data);
    let question = Question::new(&mut cursor);
    let cut = cursor.word();
    let bytes = if cursor.chance() {
        cursor.rest()
    } else {
        line(&question, &mut cursor, 600)
    };
    let Question {
        unit,
        request,
        frame,
        echo,
        echoes,
    } = &question;
    let expectation = Expectation::new(*unit, request, frame, *echo, *echoes);
    let verdict = expectation.judge(&bytes);
    let cut = usize::from(cut) % (bytes.len() + 1);
    if let Verdict::Answer(early, _) = expectation.judge(&bytes[..cut]) {
        match &verdict {
            Verdict::Answer(whole, _) => assert_eq!(&early, whole),
            Verdict::Waiting(_) => panic!("believed after {cut} bytes of {}", Hex(&bytes)),
        }
    }
    let Verdict::Answer(reply, before) = verdict else {
        return;
    };
    let encoded = encode_reply(*unit, &reply);
    let believed = encoded.as_bytes();
    let at = bytes
        .windows(believed.len())
        .position(|window| window == believed);
    let at = at.unwrap_or_else(|| panic!("{} is not in {}", Hex(believed), Hex(&bytes)));
    assert!(before.stray <= bytes.len() && at <= bytes.len());
    let function = request.function();
    match &reply {
        Reply::Exception {
            function: refused, ..
        } => assert_eq!(*refused, function),
        Reply::Normal(response) => {
            assert_eq!(response.function(), function);
            if let (Request::Read { range, .. }, Response::Registers { values, .. }) =
                (request, response)
            {
                assert_eq!(values.count(), range.count());
                assert_eq!(u16::from(believed[2]), 2 * range.count());
            }
        }
    }
}
