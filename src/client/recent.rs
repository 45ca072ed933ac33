//! The last answers, so that a second copy of one is not taken for the answer to something else.

use std::collections::{BTreeMap, VecDeque};
use std::time::Duration;

use crate::codec::{Frame, Reply, Unit};

/// So many answers are kept at the most.
const MOST: usize = 64;

/// A delay by which copies come is forgotten after this long without another copy.
const MEMORY: Duration = Duration::from_secs(60);

/// An answer that was believed, or came late and was thrown away.
struct Answer {
    at: Duration,
    unit: Unit,
    /// The request.
    frame: Frame,
    reply: Reply,
}

/// How long after an answer its second copy comes.
#[derive(Clone, Copy)]
struct Delay {
    time: Duration,
    /// When that was last seen.
    at: Duration,
    /// Seen once, it can be a coincidence: registers that were the same, and moved.
    is_sure: bool,
}

/// The last answers on a line.
#[derive(Default)]
pub(super) struct Recent {
    answers: VecDeque<Answer>,
    delays: BTreeMap<Unit, Delay>,
}

impl Recent {
    /// One more answer came at `at`.
    pub(super) fn note(&mut self, at: Duration, unit: Unit, frame: &Frame, reply: &Reply) {
        if self.answers.len() == MOST {
            self.answers.pop_front();
        }
        self.answers.push_back(Answer {
            at,
            unit,
            frame: frame.clone(),
            reply: reply.clone(),
        });
    }

    /// When, but not before `since`, the unit last gave just this answer to another request.
    pub(super) fn before(
        &self,
        since: Duration,
        unit: Unit,
        frame: &Frame,
        reply: &Reply,
    ) -> Option<Duration> {
        let is_it = |answer: &&Answer| {
            answer.at >= since
                && answer.unit == unit
                && answer.reply == *reply
                && answer.frame != *frame
        };
        self.answers
            .iter()
            .rev()
            .find(is_it)
            .map(|answer| answer.at)
    }

    /// Whether the unit has answered this very request since `since`.
    pub(super) fn is_repeated(&self, since: Duration, unit: Unit, frame: &Frame) -> bool {
        self.answers
            .iter()
            .any(|answer| answer.at >= since && answer.unit == unit && answer.frame == *frame)
    }

    /// At `now`, a second copy of an answer of the unit has come so long after the first.
    pub(super) fn learn_delay(&mut self, now: Duration, unit: Unit, delay: Duration) {
        let known = self.known_delay(unit, now);
        self.delays.insert(
            unit,
            Delay {
                time: known.map_or(delay, |known| known.time.max(delay)),
                at: now,
                is_sure: known.is_some(),
            },
        );
    }

    /// How long after an answer of the unit its second copy comes, on a line that makes them.
    pub(super) fn delay(&self, unit: Unit, now: Duration) -> Option<Duration> {
        let known = self.known_delay(unit, now).filter(|known| known.is_sure);
        known.map(|known| known.time)
    }

    fn known_delay(&self, unit: Unit, now: Duration) -> Option<Delay> {
        let known = self.delays.get(&unit).copied();
        known.filter(|known| now.saturating_sub(known.at) < MEMORY)
    }
}
