//! A question, and bytes on the line that are made of what may be there: answers, echoes, frames of
//! others, parts of them, and anything else.

use meterpoll::client::Echo;
use meterpoll::codec::rtu::{check, encode_reply, encode_request};
use meterpoll::codec::{
    ExceptionCode, Frame, ReadFunction, ReadValues, RegisterRange, Reply, Request, Response, Unit,
};

use super::cursor::Cursor;
use super::script::unit;

/// A request, and what is known of echoes when it goes out.
pub(crate) struct Question {
    pub(crate) unit: Unit,
    pub(crate) request: Request,
    pub(crate) frame: Frame,
    pub(crate) echo: Echo,
    pub(crate) echoes: Option<bool>,
}

impl Question {
    pub(crate) fn new(cursor: &mut Cursor) -> Self {
        let unit = unit(cursor.pick(&[17, 1, 3, 4, 131, 255]));
        let request = match cursor.below(8) {
            0 => Request::ReadExceptionStatus,
            1 => Request::ReturnQueryData(cursor.word()),
            kind => {
                let count = 1 + u16::from(cursor.byte()) % 125;
                let start = cursor.word().min(u16::MAX - count);
                let function = if kind < 5 {
                    ReadFunction::HoldingRegisters
                } else {
                    ReadFunction::InputRegisters
                };
                let range = RegisterRange::new(start, count).expect("a range");
                Request::Read { function, range }
            }
        };
        Self {
            unit,
            frame: encode_request(unit, &request),
            request,
            echo: cursor.pick(&[Echo::Auto, Echo::On, Echo::Off]),
            echoes: cursor.pick(&[None, Some(true), Some(false)]),
        }
    }
}

/// At most so many bytes that may be on the line behind a question.
pub(crate) fn line(question: &Question, cursor: &mut Cursor, most: usize) -> Vec<u8> {
    let mut line = Vec::new();
    while !cursor.is_over() && line.len() < most {
        let mut piece = match cursor.below(6) {
            0 => answer(question, cursor),
            1 => question.frame.as_bytes().to_vec(),
            2 => refusal(question, cursor),
            3 => {
                let count = cursor.below(16);
                let body = [&[question.unit.get()][..], &cursor.take(count)].concat();
                [&body[..], &check(&body)].concat()
            }
            _ => {
                let count = 1 + cursor.below(32);
                cursor.take(count)
            }
        };
        match cursor.below(8) {
            0 => piece.truncate(cursor.below(256)),
            1 => piece = piece.split_off(cursor.below(256).min(piece.len())),
            2 if !piece.is_empty() => {
                let bit = cursor.below(piece.len() * 8);
                piece[bit / 8] ^= 1 << (bit % 8);
            }
            _ => {}
        }
        line.extend(piece);
    }
    line.truncate(most);
    line
}

fn answer(question: &Question, cursor: &mut Cursor) -> Vec<u8> {
    let response = match &question.request {
        Request::Read { function, range } => {
            let more = cursor.pick(&[0, 0, 0, 1, 2]);
            let count = (range.count() + more).min(125);
            let values = (0..count).map(|_| cursor.word()).collect();
            Response::Registers {
                function: *function,
                values: ReadValues::new(values).expect("1 to 125 values"),
            }
        }
        Request::ReturnQueryData(word) => Response::QueryData(*word),
        _ => Response::ExceptionStatus(cursor.byte()),
    };
    let reply = encode_reply(question.unit, &Reply::Normal(response));
    reply.as_bytes().to_vec()
}

fn refusal(question: &Question, cursor: &mut Cursor) -> Vec<u8> {
    let reply = Reply::Exception {
        function: question.request.function(),
        code: ExceptionCode(cursor.byte()),
    };
    encode_reply(question.unit, &reply).as_bytes().to_vec()
}
