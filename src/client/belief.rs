//! Whether bytes are the answer: the one place where that is decided.
//!
//! Pure: all bytes since the request went out come in, a verdict goes out, so any split of the
//! same bytes gives the same result. Nothing is believed on its prefix alone.

use crate::codec::length::{self, Direction};
use crate::codec::rtu::{self, Frame};
use crate::codec::{Reply, Request, Response, Unit, Write};

/// What to make of our own bytes coming back, as they do where a two-wire adapter keeps its
/// receiver on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Echo {
    /// An echo is recognised and dropped. Where the answer repeats the request, one copy is the
    /// answer: of a loop-back (08) until the line has been seen to echo, of a write (05, 06) only
    /// once it has been seen not to.
    #[default]
    Auto,
    /// The line echoes: the first copy of the request is never the answer.
    On,
    /// The line does not echo.
    Off,
}

/// What a request implies for its answer.
#[derive(Debug)]
pub struct Expectation<'a> {
    unit: Unit,
    request: &'a Request,
    frame: &'a Frame,
    /// The first copy of the own frame is an echo, not an answer.
    drop_echo: bool,
    /// The line can echo, for all that is known.
    can_echo: bool,
    /// Bytes of the normal answer, CRC included.
    length: usize,
}

/// What the bytes so far amount to.
#[derive(Debug, PartialEq, Eq)]
pub enum Verdict {
    /// This is the answer, and what came before it.
    Answer(Reply, Evidence),
    /// Not yet.
    Waiting(Evidence),
}

/// What was seen beside or in place of the answer.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct Evidence {
    /// Copies of the own request.
    pub echoes: usize,
    /// Valid frames of other units.
    pub others: usize,
    /// Bytes that belong to nothing.
    pub stray: usize,
    /// The longest beginning of an answer at the end of the bytes: how much of it is there, and
    /// how long it will be.
    pub begun: Option<(usize, usize)>,
    /// An answer that is whole but for its CRC, and how sure it is that it was the answer.
    pub damaged: Option<Certainty>,
    /// A valid frame of the unit that is not the answer, in words.
    pub mismatch: Option<String>,
}

/// How sure it is that damaged bytes were the answer, so that no other one comes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Certainty {
    /// Noise or the own echo can look the same.
    Doubtful,
    /// Only an echo that was damaged itself can look the same.
    Likely,
    /// It cannot have been an echo either.
    Certain,
}

impl<'a> Expectation<'a> {
    /// What `request`, sent to `unit` as `frame`, implies. `echoes` says whether the line does so,
    /// as far as it has been seen.
    pub fn new(
        unit: Unit,
        request: &'a Request,
        frame: &'a Frame,
        echo: Echo,
        echoes: Option<bool>,
    ) -> Self {
        let (drop_echo, can_echo) = match echo {
            Echo::On => (true, true),
            Echo::Off => (false, false),
            Echo::Auto => {
                let can_echo = echoes != Some(false);
                let is_write = matches!(request, Request::Write(_));
                let must_drop = echoes == Some(true) || !is_mirrored(request);
                (must_drop || is_write && can_echo, can_echo)
            }
        };
        Self {
            unit,
            request,
            frame,
            drop_echo,
            can_echo,
            length: answer_length(request),
        }
    }

    /// Judges all bytes received since the request went out.
    pub fn judge(&self, received: &[u8]) -> Verdict {
        self.judge_to(received).0
    }

    /// The same, and how many of the bytes that took: up to the end of the answer, or all of them.
    pub(super) fn judge_to(&self, received: &[u8]) -> (Verdict, usize) {
        let mut evidence = Evidence::default();
        let mut at = 0;
        while let Some(rest) = received.get(at..).filter(|rest| !rest.is_empty()) {
            if self.drop_echo && rest.starts_with(self.frame.as_bytes()) && !self.is_over(&evidence)
            {
                evidence.echoes += 1;
                at += self.frame.as_bytes().len();
                continue;
            }
            if let Some(frame) = self.candidate(rest) {
                match rtu::decode_reply(frame) {
                    // A short answer can be the start of our own echo, byte for byte.
                    Ok(_) if self.may_be_echo(frame) => {
                        let found = "what may be the echo of the request";
                        evidence.mismatch = Some(found.to_owned());
                        at += frame.len();
                        continue;
                    }
                    Ok((_, reply)) if self.is_answered_by(&reply) => {
                        // An answer that is not whole yet can hold what looks like an exception.
                        if evidence.begun.is_none() {
                            let end = at + frame.len();
                            return (Verdict::Answer(reply, evidence), end);
                        }
                        at += frame.len();
                        continue;
                    }
                    Ok(_) => {}
                    Err(_) => {
                        let certainty = self.certainty(frame, &evidence);
                        evidence.damaged = evidence.damaged.max(Some(certainty));
                    }
                }
            } else if self.begins(rest) {
                let wanted = self.length_of(rest);
                evidence.begun.get_or_insert((rest.len(), wanted));
            }
            at += self.skip(rest, &mut evidence);
        }
        (Verdict::Waiting(evidence), received.len())
    }

    /// How many of the first bytes are of no use any more: whatever comes behind them, no echo, no
    /// answer and no frame of another unit begins there.
    pub(super) fn useless(&self, received: &[u8]) -> usize {
        let own = self.frame.as_bytes();
        let is_useless = |at: &usize| {
            let rest = received.get(*at..).unwrap_or_default();
            // So many bytes tell the length of any frame.
            let is_told = rest.len() >= own.len();
            let is_frame = || match length::of_frame(rest, Direction::Response) {
                Some(length) => {
                    length > rest.len() || rtu::checked_window(rest, 0, length).is_some()
                }
                None => false,
            };
            is_told && !self.begins(rest) && !rest.starts_with(own) && !is_frame()
        };
        (0..received.len()).take_while(is_useless).count()
    }

    /// How sure it is that a damaged answer was one.
    fn certainty(&self, damaged: &[u8], evidence: &Evidence) -> Certainty {
        // Unit, function and byte count are too many bytes for noise; two of them are not.
        let is_counted =
            self.byte_count().is_some() && damaged.get(1) == Some(&self.request.function().get());
        if !is_counted || self.begins(self.frame.as_bytes()) {
            Certainty::Doubtful
        } else if self.can_echo && evidence.echoes == 0 {
            Certainty::Likely
        } else {
            Certainty::Certain
        }
    }

    /// An echo is dropped once where the answer looks the same, else as often as it comes.
    fn is_over(&self, evidence: &Evidence) -> bool {
        is_mirrored(self.request) && evidence.echoes > 0
    }

    /// Steps over a valid frame that is no answer, as a whole, or over one stray byte.
    fn skip(&self, rest: &[u8], evidence: &mut Evidence) -> usize {
        let whole = length::of_frame(rest, Direction::Response)
            .and_then(|length| rtu::checked_window(rest, 0, length));
        let Some(frame) = whole else {
            evidence.stray += 1;
            return 1;
        };
        if frame.first() == Some(&self.unit.get()) {
            evidence.mismatch = Some(self.describe(frame));
        } else {
            evidence.others += 1;
        }
        frame.len()
    }

    /// The bytes that would be the whole answer, if they start like one and are all there.
    fn candidate<'b>(&self, rest: &'b [u8]) -> Option<&'b [u8]> {
        if !self.begins(rest) {
            return None;
        }
        rest.get(..self.length_of(rest))
    }

    /// Whether the bytes, as far as they go, start like the answer: unit, function, byte count.
    fn begins(&self, rest: &[u8]) -> bool {
        let function = self.request.function();
        let is = |index: usize, wanted: u8| rest.get(index).is_none_or(|byte| *byte == wanted);
        if !is(0, self.unit.get()) {
            return false;
        }
        if rest.get(1) == Some(&function.exception()) {
            return true;
        }
        is(1, function.get()) && self.byte_count().is_none_or(|count| is(2, count))
    }

    /// How long the answer that starts like this is.
    fn length_of(&self, rest: &[u8]) -> usize {
        if rest.get(1) == Some(&self.request.function().exception()) {
            length::EXCEPTION_BYTES
        } else {
            self.length
        }
    }

    /// The byte count the answer must carry, where it carries one.
    fn byte_count(&self) -> Option<u8> {
        match self.request {
            Request::Read { range, .. } => u8::try_from(2 * range.count()).ok(),
            _ => None,
        }
    }

    fn may_be_echo(&self, answer: &[u8]) -> bool {
        let own = self.frame.as_bytes();
        self.drop_echo && answer.len() < own.len() && own.starts_with(answer)
    }

    fn is_answered_by(&self, reply: &Reply) -> bool {
        match reply {
            Reply::Exception { function, .. } => *function == self.request.function(),
            Reply::Normal(response) => matches(self.request, response),
        }
    }

    fn describe(&self, frame: &[u8]) -> String {
        match rtu::decode_reply(frame) {
            Err(error) => format!("a malformed frame: {error}"),
            Ok((_, Reply::Exception { function, code })) => {
                format!("{code} to {function}")
            }
            Ok((_, Reply::Normal(response))) => match (self.request, response) {
                (
                    Request::Read { function, range },
                    Response::Registers {
                        function: answered,
                        values,
                    },
                ) if *function == answered => {
                    let (found, asked) = (values.count(), range.count());
                    format!("{found} registers, and {asked} asked for")
                }
                (Request::ReturnQueryData(sent), Response::QueryData(found)) => {
                    format!("0x{found:04X}, and 0x{sent:04X} was sent")
                }
                (
                    Request::Write(Write::Register { address, .. }),
                    Response::Register { address: found, .. },
                )
                | (
                    Request::Write(Write::Coil { address, .. }),
                    Response::Coil { address: found, .. },
                ) => format!("{found} written, and {address} was sent"),
                (Request::Write(Write::Registers(block)), Response::RegistersWritten(found)) => {
                    format!(
                        "{}+{} written, and {}+{} was sent",
                        found.start(),
                        found.count(),
                        block.start(),
                        block.count()
                    )
                }
                (_, response) => format!("an answer to {}", response.function()),
            },
        }
    }
}

impl Evidence {
    /// Whether an answer has begun, so that it is worth waiting for its end.
    pub const fn has_begun(&self) -> bool {
        self.begun.is_some()
    }
}

/// Whether the normal answer repeats the request byte for byte.
pub(super) const fn is_mirrored(request: &Request) -> bool {
    matches!(
        request,
        Request::ReturnQueryData(_) | Request::Write(Write::Coil { .. } | Write::Register { .. })
    )
}

/// Bytes of the normal answer, CRC included.
pub fn answer_length(request: &Request) -> usize {
    let registers = match request {
        Request::Read { range, .. } => usize::from(range.count()),
        _ => 0,
    };
    match length::rule(request.function().get(), Direction::Response) {
        Some(length::Rule::Fixed(bytes)) => bytes,
        Some(length::Rule::Counted { rest, .. }) => rest + 2 * registers,
        // Every function a request can have is in the table.
        None => length::MOST_FRAME_BYTES,
    }
}

/// Whether a response is what the request implies, field by field. The value that function 06
/// answers is the one the meter has stored, which it may have put into its own limits.
fn matches(request: &Request, response: &Response) -> bool {
    match (request, response) {
        (
            Request::Read { function, range },
            Response::Registers {
                function: answered,
                values,
            },
        ) => function == answered && values.count() == range.count(),
        (
            Request::Write(Write::Coil { address, on }),
            Response::Coil {
                address: answered,
                on: state,
            },
        ) => address == answered && on == state,
        (
            Request::Write(Write::Register { address, .. }),
            Response::Register {
                address: answered, ..
            },
        ) => address == answered,
        (Request::Write(Write::Registers(block)), Response::RegistersWritten(range)) => {
            block.range() == *range
        }
        (Request::ReadExceptionStatus, Response::ExceptionStatus(_)) => true,
        (Request::ReturnQueryData(word), Response::QueryData(answered)) => word == answered,
        _ => false,
    }
}
