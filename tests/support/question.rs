//! A question to unit 17, and the frames that may come back.

#![allow(dead_code, reason = "each test file uses its share")]

use meterpoll::client::Echo;
use meterpoll::client::belief::{Evidence, Expectation, Verdict};
use meterpoll::codec::rtu::{self, Frame};
use meterpoll::codec::{
    ExceptionCode, FunctionCode, ReadFunction, ReadValues, RegisterRange, Reply, Request, Response,
    Unit, UnitRange,
};

fn unit(number: u16) -> Unit {
    Unit::new(number, UnitRange::Standard).expect("a unit")
}

pub(crate) fn read(start: u16, count: u16) -> Request {
    Request::Read {
        function: ReadFunction::HoldingRegisters,
        range: RegisterRange::new(start, count).expect("a range"),
    }
}

pub(crate) fn registers(values: &[u16]) -> Reply {
    Reply::Normal(Response::Registers {
        function: ReadFunction::HoldingRegisters,
        values: ReadValues::new(values.to_vec()).expect("1 to 125 values"),
    })
}

pub(crate) fn exception(function: FunctionCode, code: u8) -> Reply {
    Reply::Exception {
        function,
        code: ExceptionCode(code),
    }
}

/// The frame of any bytes: with their CRC behind them.
pub(crate) fn framed(body: &[u8]) -> Vec<u8> {
    [body, &rtu::check(body)].concat()
}

pub(crate) fn reply_frame(number: u16, reply: &Reply) -> Vec<u8> {
    rtu::encode_reply(unit(number), reply).as_bytes().to_vec()
}

/// A question to unit 17.
#[derive(Debug)]
pub(crate) struct Question {
    pub(crate) request: Request,
    pub(crate) frame: Frame,
    echo: Echo,
    echoes: Option<bool>,
}

impl Question {
    pub(crate) fn new(request: Request) -> Self {
        let frame = rtu::encode_request(unit(0x11), &request);
        Self {
            request,
            frame,
            echo: Echo::Auto,
            echoes: None,
        }
    }

    pub(crate) fn with(self, echo: Echo, echoes: Option<bool>) -> Self {
        Self {
            echo,
            echoes,
            ..self
        }
    }

    pub(crate) fn judge(&self, bytes: &[u8]) -> Verdict {
        let unit = unit(0x11);
        Expectation::new(unit, &self.request, &self.frame, self.echo, self.echoes).judge(bytes)
    }

    pub(crate) fn answer(&self, bytes: &[u8]) -> Option<Reply> {
        match self.judge(bytes) {
            Verdict::Answer(reply, _) => Some(reply),
            Verdict::Waiting(_) => None,
        }
    }

    /// What was seen on the way, whether the answer came or not.
    pub(crate) fn evidence(&self, bytes: &[u8]) -> Evidence {
        match self.judge(bytes) {
            Verdict::Answer(_, evidence) | Verdict::Waiting(evidence) => evidence,
        }
    }
}
