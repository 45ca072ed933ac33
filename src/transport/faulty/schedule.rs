//! Bytes that are on their way: each piece with the time at which it arrives.

use std::time::Duration;

/// Pieces that are kept at most; when there are more, the oldest go. A test that never asks for
/// what it caused stays small.
const MOST_PIECES: usize = 1024;

/// Something that arrives.
#[derive(Debug, Clone)]
pub(super) enum Event {
    /// Bytes, `every` apart; zero is all at once.
    Bytes { bytes: Vec<u8>, every: Duration },
    /// The port is lost.
    HangUp,
}

/// What arrives, and when its next byte does.
#[derive(Debug, Clone)]
pub(super) struct Piece {
    pub(super) at: Duration,
    pub(super) event: Event,
}

impl Piece {
    /// Bytes that arrive all at once.
    pub(super) const fn whole(at: Duration, bytes: Vec<u8>) -> Self {
        let every = Duration::ZERO;
        Self {
            at,
            event: Event::Bytes { bytes, every },
        }
    }
}

/// What comes next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Next {
    /// So many bytes were copied; 0: none is due.
    Bytes(usize),
    /// The port is lost.
    HangUp,
}

/// All pieces on their way; of those at one time the one put in first comes first.
#[derive(Debug, Default)]
pub(super) struct Schedule(Vec<Piece>);

impl Schedule {
    pub(super) fn add(&mut self, pieces: impl IntoIterator<Item = Piece>) {
        self.0.extend(pieces);
        let surplus = self.0.len().saturating_sub(MOST_PIECES);
        self.0.drain(..surplus);
    }

    pub(super) fn clear(&mut self) {
        self.0.clear();
    }

    /// When the next piece arrives.
    pub(super) fn next_at(&self) -> Option<Duration> {
        self.first().map(|(_, at)| at)
    }

    /// Bytes on their way.
    pub(super) fn waiting(&self) -> usize {
        let bytes = self.0.iter().map(|piece| match &piece.event {
            Event::Bytes { bytes, .. } => bytes.len(),
            Event::HangUp => 0,
        });
        bytes.sum()
    }

    /// Index and time of what comes first.
    fn first(&self) -> Option<(usize, Duration)> {
        let times = self.0.iter().map(|piece| piece.at).enumerate();
        times.min_by_key(|(place, at)| (*at, *place))
    }

    /// Copies what has arrived by `now` and fits, from one piece.
    pub(super) fn take(&mut self, into: &mut [u8], now: Duration) -> Next {
        let Some((place, _)) = self.first().filter(|(_, at)| *at <= now) else {
            return Next::Bytes(0);
        };
        let Some(piece) = self.0.get_mut(place) else {
            return Next::Bytes(0);
        };
        let Event::Bytes { bytes, every } = &mut piece.event else {
            self.0.remove(place);
            return Next::HangUp;
        };
        let room = if every.is_zero() {
            into.len()
        } else {
            into.len().min(1)
        };
        let count = bytes.len().min(room);
        for (place, byte) in into.iter_mut().zip(bytes.drain(..count)) {
            *place = byte;
        }
        piece.at += *every;
        if bytes.is_empty() {
            self.0.remove(place);
        }
        Next::Bytes(count)
    }

    /// Whether what comes first, by `now`, is that the port is lost.
    pub(super) fn is_hang_up_next(&self, now: Duration) -> bool {
        let first = self.first().and_then(|(place, _)| self.0.get(place));
        first.is_some_and(|piece| piece.at <= now && matches!(piece.event, Event::HangUp))
    }

    /// Whether the port has been lost by `now`. If so, that is over with.
    pub(super) fn take_hang_up(&mut self, now: Duration) -> bool {
        let is_due = |piece: &Piece| piece.at <= now && matches!(piece.event, Event::HangUp);
        let place = self.0.iter().position(is_due);
        place.map(|place| self.0.remove(place)).is_some()
    }

    /// Throws away the bytes that have arrived by `now`.
    pub(super) fn discard(&mut self, now: Duration) {
        self.0.retain_mut(|piece| match &mut piece.event {
            Event::Bytes { bytes, every } => {
                while piece.at <= now && !bytes.is_empty() {
                    let count = if every.is_zero() { bytes.len() } else { 1 };
                    bytes.drain(..count);
                    piece.at += *every;
                }
                !bytes.is_empty()
            }
            Event::HangUp => true,
        });
    }
}
