//! The last answers, so that a second copy of one is not taken for the answer to something else.

use std::collections::VecDeque;
use std::time::Duration;

use crate::codec::{Frame, Response, Unit};

/// So many answers are kept at the most.
const MOST: usize = 16;

/// An answer that was believed.
struct Answer {
    at: Duration,
    unit: Unit,
    /// The request.
    frame: Frame,
    response: Response,
}

/// The last answers on a line.
#[derive(Default)]
pub(super) struct Recent(VecDeque<Answer>);

impl Recent {
    /// One more answer was believed at `at`.
    pub(super) fn note(&mut self, at: Duration, unit: Unit, frame: &Frame, response: &Response) {
        if self.0.len() == MOST {
            self.0.pop_front();
        }
        self.0.push_back(Answer {
            at,
            unit,
            frame: frame.clone(),
            response: response.clone(),
        });
    }

    /// Whether these registers were the unit's answer to another request since `since`.
    pub(super) fn holds(
        &self,
        since: Duration,
        unit: Unit,
        frame: &Frame,
        response: &Response,
    ) -> bool {
        matches!(response, Response::Registers { .. })
            && self.0.iter().any(|answer| {
                answer.at >= since
                    && answer.unit == unit
                    && answer.response == *response
                    && answer.frame != *frame
            })
    }
}
