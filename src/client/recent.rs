//! The last answers, so that a second copy of one is not taken for the answer to something else.

use std::collections::{BTreeMap, VecDeque};
use std::time::Duration;

use crate::codec::{Frame, Response, Unit};

/// So many answers are kept at the most.
const MOST: usize = 64;

/// An answer that was believed, or came late and was thrown away.
struct Answer {
    at: Duration,
    unit: Unit,
    /// The request.
    frame: Frame,
    response: Response,
}

/// The last answers on a line.
#[derive(Default)]
pub(super) struct Recent {
    answers: VecDeque<Answer>,
    /// How long after them second copies have come.
    delays: BTreeMap<Unit, Duration>,
}

impl Recent {
    /// One more answer came at `at`.
    pub(super) fn note(&mut self, at: Duration, unit: Unit, frame: &Frame, response: &Response) {
        if self.answers.len() == MOST {
            self.answers.pop_front();
        }
        self.answers.push_back(Answer {
            at,
            unit,
            frame: frame.clone(),
            response: response.clone(),
        });
    }

    /// How long ago, but not before `since`, these registers were the unit's answer to another
    /// request.
    pub(super) fn age(
        &self,
        (since, now): (Duration, Duration),
        unit: Unit,
        frame: &Frame,
        response: &Response,
    ) -> Option<Duration> {
        let is_it = |answer: &&Answer| {
            answer.at >= since
                && answer.unit == unit
                && answer.response == *response
                && answer.frame != *frame
        };
        matches!(response, Response::Registers { .. })
            .then(|| self.answers.iter().rev().find(is_it))
            .flatten()
            .map(|answer| now.saturating_sub(answer.at))
    }

    /// A second copy of an answer of the unit has come so long after the first.
    pub(super) fn learn_delay(&mut self, unit: Unit, delay: Duration) {
        let known = self.delays.entry(unit).or_default();
        *known = delay.max(*known);
    }

    /// How long after an answer of the unit its second copy comes, on a line that makes them.
    pub(super) fn delay(&self, unit: Unit) -> Option<Duration> {
        self.delays.get(&unit).copied()
    }
}
