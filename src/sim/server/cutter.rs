//! What clients send, cut into requests.

use std::time::Duration;

use super::Framing;
use crate::codec::length::{Direction, MOST_FRAME_BYTES, of_frame};
use crate::codec::{DecodeError, mbap, rtu};

/// A piece of what a client sent.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Cut {
    /// A frame with a right CRC, to whatever unit.
    Request {
        /// The client's number for it, where it has one.
        transaction: Option<u16>,
        /// The frame as it is on a serial line.
        frame: Vec<u8>,
    },
    /// So many bytes that are no frame.
    Damaged {
        /// How many.
        bytes: usize,
    },
    /// Bytes after which nothing can be made sense of.
    Hopeless(DecodeError),
}

/// What one client has sent and nothing came of yet: never more than a frame and a chunk.
#[derive(Debug)]
pub(super) struct Cutter {
    framing: Framing,
    heard: Vec<u8>,
    /// Bytes thrown away of what is too long for a frame, until the next silence.
    dropped: usize,
    last: Duration,
}

impl Cutter {
    pub(super) const fn new(framing: Framing) -> Self {
        Self {
            framing,
            heard: Vec::new(),
            dropped: 0,
            last: Duration::ZERO,
        }
    }

    /// Takes bytes that came at `now`.
    pub(super) fn push(&mut self, bytes: &[u8], now: Duration) -> Vec<Cut> {
        let mut cuts: Vec<Cut> = self.over(now).into_iter().collect();
        self.last = now;
        self.heard.extend_from_slice(bytes);
        match self.framing {
            Framing::Rtu { .. } => self.cut_frames(&mut cuts),
            Framing::Tcp => self.cut_by_headers(&mut cuts),
        }
        cuts
    }

    /// What silence until `now` has ended.
    pub(super) fn over(&mut self, now: Duration) -> Option<Cut> {
        self.deadline().filter(|deadline| *deadline <= now)?;
        let heard = std::mem::take(&mut self.heard);
        let dropped = std::mem::take(&mut self.dropped);
        // A function of which nobody here knows how long its requests are.
        if dropped == 0 && rtu::open(&heard).is_ok() {
            return Some(Cut::Request {
                transaction: None,
                frame: heard,
            });
        }
        Some(Cut::Damaged {
            bytes: heard.len() + dropped,
        })
    }

    /// When silence ends what was heard.
    pub(super) fn deadline(&self) -> Option<Duration> {
        let has_heard = !self.heard.is_empty() || self.dropped > 0;
        match self.framing {
            Framing::Rtu { gap } if has_heard => Some(self.last.saturating_add(gap)),
            _ => None,
        }
    }

    /// Cuts frames off that are whole and right. What begins otherwise is what a meter hears: noise
    /// up to the next silence.
    fn cut_frames(&mut self, cuts: &mut Vec<Cut>) {
        while self.dropped == 0
            && let Some(length) = of_frame(&self.heard, Direction::Request)
            && rtu::open(self.heard.get(..length).unwrap_or_default()).is_ok()
        {
            cuts.push(Cut::Request {
                transaction: None,
                frame: self.heard.drain(..length).collect(),
            });
        }
        if self.dropped > 0 || self.heard.len() > MOST_FRAME_BYTES {
            self.dropped += self.heard.len();
            self.heard.clear();
        }
    }

    fn cut_by_headers(&mut self, cuts: &mut Vec<Cut>) {
        loop {
            let length = match mbap::of_frame(&self.heard) {
                Ok(Some(length)) if length <= self.heard.len() => length,
                Ok(_) => return,
                Err(error) => {
                    self.heard.clear();
                    return cuts.push(Cut::Hopeless(error));
                }
            };
            let frame: Vec<u8> = self.heard.drain(..length).collect();
            if let Ok((header, data_unit)) = mbap::open(&frame) {
                cuts.push(Cut::Request {
                    transaction: Some(header.transaction),
                    frame: rtu::seal(header.unit, data_unit).as_bytes().to_vec(),
                });
            }
        }
    }
}
