//! What a fault makes of a request and of its answer: what arrives, and when.

use std::time::Duration;

use fastrand::Rng;

use super::effect::{CountChange, Effect, Moment, Pace};
use super::schedule::{Event, Piece};
use super::spoil;
use super::stream::{Source, Stream};

/// What `late` is without a value, in time-outs: past the first, and before the second is over.
const LATE: std::ops::RangeInclusive<f64> = 1.1..=1.9;

/// A request whose answer does not come as it should.
pub(super) struct Case {
    pub(super) effect: Effect,
    pub(super) chance: Rng,
    pub(super) request: Vec<u8>,
    /// When its last byte has left the wire.
    pub(super) end: Duration,
}

/// What arrives.
#[derive(Default)]
pub(super) struct Arrival {
    pub(super) pieces: Vec<Piece>,
    pub(super) stream: Option<Stream>,
}

impl Arrival {
    fn of(pieces: impl Into<Vec<Piece>>) -> Self {
        Self {
            pieces: pieces.into(),
            stream: None,
        }
    }

    const fn stream(stream: Stream) -> Self {
        Self {
            pieces: Vec::new(),
            stream: Some(stream),
        }
    }
}

/// What becomes of the answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Fate {
    /// It is taken whole and spoiled.
    Spoiled,
    /// It is lost.
    Lost,
}

impl Case {
    /// Whether this fault has a use for the answer of the meter.
    pub(super) const fn fate(&self) -> Fate {
        match self.effect {
            Effect::Silence
            | Effect::EchoOnly
            | Effect::StrangerOnly { .. }
            | Effect::Garbage(_) => Fate::Lost,
            _ => Fate::Spoiled,
        }
    }

    /// What arrives whether the meter answers or not.
    pub(super) fn at_once(&mut self) -> Arrival {
        let own = self.request.first().copied().unwrap_or_default();
        match self.effect {
            Effect::Echo { bytes, .. } => {
                let count = bytes.map_or(self.request.len(), |bytes| bytes.min(self.request.len()));
                let echo = self.request.get(..count).unwrap_or_default();
                Arrival::of([Piece::whole(self.end, echo.to_vec())])
            }
            Effect::EchoOnly => Arrival::of([Piece::whole(self.end, self.request.clone())]),
            Effect::Stranger { unit, .. } => {
                let frame = spoil::stranger(&self.request, unit, &mut self.chance);
                Arrival::of([Piece::whole(self.end, frame)])
            }
            Effect::StrangerOnly { unit, pace } => {
                let source = Source::Stranger {
                    request: self.request.clone(),
                    unit: spoil::other_unit(own, unit, &mut self.chance),
                    chance: self.chance.clone(),
                };
                Arrival::stream(Stream::new(source, self.end + pace.every, pace))
            }
            Effect::Garbage(pace) => {
                let source = Source::Garbage(self.chance.clone());
                Arrival::stream(Stream::new(source, self.end, pace))
            }
            _ => Arrival::default(),
        }
    }

    /// What arrives of the answer that the meter has given by `now`.
    pub(super) fn answer(self, frame: Vec<u8>, now: Duration) -> Arrival {
        let Self {
            effect,
            mut chance,
            end,
            ..
        } = self;
        let chance = &mut chance;
        let length = frame.len();
        let spoiled = match effect {
            Effect::Late { time_outs, timeout } => {
                let time_outs = time_outs
                    .unwrap_or_else(|| LATE.start() + chance.f64() * (LATE.end() - LATE.start()));
                return whole(now.max(end + timeout.mul_f64(time_outs)), frame);
            }
            Effect::Delay(delay) => return whole(now.max(end + delay), frame),
            Effect::Echo { gap, .. } | Effect::Stranger { gap, .. } => {
                return whole(now.max(end + gap), frame);
            }
            Effect::Cut { keep, rest } => {
                let (kept, cut) = parts(frame, spoil::part(keep, length, chance));
                let mut pieces = vec![Piece::whole(now, kept)];
                pieces.extend(rest.map(|rest| Piece::whole(now.max(end + rest), cut)));
                return Arrival::of(pieces);
            }
            Effect::Split { first, gap } => {
                let (first, second) = parts(frame, spoil::part(first, length, chance));
                return two(now, first, gap, second);
            }
            Effect::Drip(every) => {
                let bytes = frame;
                let event = Event::Bytes { bytes, every };
                return Arrival::of([Piece { at: now, event }]);
            }
            Effect::Endless(pace) => return endless(&frame, now, pace),
            Effect::Before { noise, gap } => {
                let noise = spoil::noise(noise.as_deref(), chance);
                return two(now, noise, gap, frame);
            }
            Effect::After { noise, gap } => {
                let noise = spoil::noise(noise.as_deref(), chance);
                return two(now, frame, gap, noise);
            }
            Effect::Twice(gap) => return two(now, frame.clone(), gap, frame),
            Effect::HangUp(moment) => {
                let heard = match moment {
                    Moment::During => spoil::part(None, length, chance),
                    Moment::Before | Moment::After => length,
                };
                let event = Event::HangUp;
                let (heard, _) = parts(frame, heard);
                return Arrival::of([Piece::whole(now, heard), Piece { at: now, event }]);
            }
            Effect::Crc => spoil::wrong_crc(frame),
            Effect::CrcSwapped => spoil::swapped_crc(frame),
            Effect::Flip(bit) => spoil::flip(frame, bit, chance),
            Effect::Burst(bits) => spoil::burst(frame, bits, chance),
            Effect::WrongUnit(unit) => spoil::wrong_unit(&frame, unit, chance),
            Effect::WrongFunction(function) => spoil::wrong_function(&frame, function),
            Effect::WrongCount(how) => {
                let how = how.or_else(|| chance.choice(CountChange::ALL));
                spoil::wrong_count(&frame, how.unwrap_or(CountChange::Odd))
            }
            Effect::Oversize => spoil::oversize(&frame),
            Effect::Exception(code) => spoil::exception(&frame, code, chance),
            Effect::ExceptionFor(function) => spoil::exception_for(&frame, function, chance),
            // `any` is worked out before, and the others lose the answer.
            Effect::Silence
            | Effect::EchoOnly
            | Effect::StrangerOnly { .. }
            | Effect::Garbage(_)
            | Effect::Any(_) => return Arrival::default(),
        };
        whole(now, spoiled)
    }
}

fn whole(at: Duration, bytes: Vec<u8>) -> Arrival {
    Arrival::of([Piece::whole(at, bytes)])
}

fn two(at: Duration, first: Vec<u8>, gap: Duration, second: Vec<u8>) -> Arrival {
    Arrival::of([Piece::whole(at, first), Piece::whole(at + gap, second)])
}

/// The first `count` bytes, and the others.
fn parts(mut bytes: Vec<u8>, count: usize) -> (Vec<u8>, Vec<u8>) {
    let rest = bytes.split_off(count.min(bytes.len()));
    (bytes, rest)
}

/// The answer without its CRC, over and over.
fn endless(frame: &[u8], from: Duration, pace: Pace) -> Arrival {
    let bytes = spoil::body(frame).to_vec();
    let source = Source::Cycle { bytes, at: 0 };
    Arrival::stream(Stream::new(source, from, pace))
}
