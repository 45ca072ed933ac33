//! A meter and its line as the client is promised to get on with them: what comes back begins less
//! than twice the time-out after its request, a second copy comes soon after an answer that was in
//! time, and everything else may be wrong with it.

use std::collections::BTreeMap;
use std::time::Duration;

use meterpoll::codec::rtu::{Destination, check, decode_request, encode_reply};
use meterpoll::codec::{ExceptionCode, Reply, Request, Response};

use super::cursor::Cursor;
use super::script::{Chunk, dripped, reply, true_reply, unit};

/// What a session's line does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Manner {
    /// Answers may be late, missing, cut, damaged, or something else.
    Late,
    /// Answers are in time and may come twice; nothing is asked twice.
    Copies,
    /// Nothing is wrong.
    Good,
}

/// The meter and its line, and what they have put on the wire as a whole.
pub(crate) struct Model {
    pub(crate) cursor: Cursor,
    pub(crate) manner: Manner,
    pub(crate) echo: bool,
    pub(crate) frames: Vec<Vec<u8>>,
    /// When the last answer of each unit comes: a meter answers in the order it was asked.
    last: BTreeMap<u8, Duration>,
}

impl Model {
    pub(crate) fn new(cursor: Cursor, manner: Manner, echo: bool) -> Self {
        Self {
            cursor,
            manner,
            echo,
            frames: Vec::new(),
            last: BTreeMap::new(),
        }
    }

    /// Whether answers may come twice.
    pub(crate) fn makes_copies(&self) -> bool {
        self.manner == Manner::Copies
    }

    /// What comes back to a request whose last byte has left the wire at `end`.
    pub(crate) fn answer(&mut self, frame: &[u8], end: Duration) -> Vec<Chunk> {
        let mut chunks = Vec::new();
        if self.echo {
            chunks.push((Duration::ZERO, frame.to_vec()));
        }
        let limit = match self.manner {
            Manner::Late => 1940,
            Manner::Copies => 500,
            Manner::Good => 40,
        };
        let drawn = Duration::from_millis(self.cursor.below(limit) as u64);
        let last = self.last.entry(frame[0]).or_default();
        let at = (end + drawn).max(*last + Duration::from_millis(1));
        *last = at;
        let delay = at.saturating_sub(end);
        let whole = truth(frame);
        let kind = match self.manner {
            Manner::Late => self.cursor.below(16),
            Manner::Copies => 14 + self.cursor.below(4),
            Manner::Good => 14,
        };
        chunks.extend(self.spoil(frame, whole, delay, kind));
        // Nothing is no sign of life on the wire.
        chunks.retain(|(_, bytes)| !bytes.is_empty());
        chunks
    }

    fn spoil(
        &mut self,
        frame: &[u8],
        mut whole: Vec<u8>,
        delay: Duration,
        kind: usize,
    ) -> Vec<Chunk> {
        let ms = Duration::from_millis;
        let place = self.cursor.below(whole.len());
        match kind {
            0 => return Vec::new(),
            1 => return vec![(delay, whole[..place].to_vec())],
            2 => whole[place] ^= 1 << self.cursor.below(8),
            3 => whole = self.refusal(frame),
            4 => {
                let count = self.cursor.below(32);
                let noise = self.cursor.take(count);
                self.frames.push(whole.clone());
                return vec![(ms(1), noise), (delay, whole)];
            }
            5 => whole = other(frame, |frame| frame[0] = 99),
            6 => whole = other(frame, |frame| frame[1] ^= 7),
            7 if frame[1] < 5 => {
                // Registers more or fewer than were asked for.
                let count = 1 + self.cursor.byte() % 4;
                whole = other(frame, |frame| frame[5] = count);
            }
            8 => {
                self.frames.push(whole.clone());
                let (first, second) = whole.split_at(place);
                return vec![(delay, first.to_vec()), (delay + ms(40), second.to_vec())];
            }
            9 => {
                self.frames.push(whole.clone());
                return dripped(delay, &whole, ms(1));
            }
            16.. => {
                self.frames.push(whole.clone());
                let copy = delay + ms(self.cursor.below(400) as u64);
                return vec![(delay, whole.clone()), (copy, whole)];
            }
            _ => {}
        }
        self.frames.push(whole.clone());
        vec![(delay, whole)]
    }

    fn refusal(&mut self, frame: &[u8]) -> Vec<u8> {
        let code = ExceptionCode(self.cursor.pick(&[1, 2, 3, 4, 5, 6, 6, 8, 10]));
        let (_, request) = decode_request(frame).expect("a request");
        let function = request.function();
        let reply = Reply::Exception { function, code };
        encode_reply(unit(frame[0].into()), &reply)
            .as_bytes()
            .to_vec()
    }
}

/// The true answer to another request than this.
fn other(frame: &[u8], change: impl FnOnce(&mut [u8])) -> Vec<u8> {
    let mut body = frame[..frame.len() - 2].to_vec();
    change(&mut body);
    truth(&[&body[..], &check(&body)].concat())
}

/// The true answer.
fn truth(frame: &[u8]) -> Vec<u8> {
    match decode_request(frame) {
        Ok((Destination::Unit(unit), Request::ReturnQueryData(word))) => {
            reply(unit, Response::QueryData(word))
        }
        Ok((_, Request::Read { .. })) => true_reply(frame),
        // Some other function: what it has to say is none of a read's business.
        _ => [&[frame[0], 0x84, 2][..], &check(&[frame[0], 0x84, 2])].concat(),
    }
}
