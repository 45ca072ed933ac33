//! Answers that have not come and may still do so.
//!
//! After a failed attempt its answer can be on the way, and it would look like the answer to
//! whatever is asked next. So it is remembered until it has come or until nobody has to reckon
//! with it any more: as long again as it was given to begin, and for the same unit at least as
//! long as the meter may take at the worst, whatever shorter time-out was asked for. The unit in
//! every frame tells answers of different meters apart; waiting for those as well keeps two of them
//! from talking at once.

use std::time::Duration;

use super::belief::{Echo, Expectation, Verdict};
use super::transaction::{ADAPTER_LATENCY, Patience};
use crate::codec::{Frame, Request, Unit};

/// A request that was sent more often than it was answered.
struct Debt {
    unit: Unit,
    request: Request,
    frame: Frame,
    answers: u32,
    /// Until when nobody else is asked.
    line_until: Duration,
    /// Until when the unit is not asked anything else.
    unit_until: Duration,
    patience: Patience,
}

/// All debts of a line, at most one a unit.
#[derive(Default)]
pub(super) struct Debts(Vec<Debt>);

impl Debts {
    /// One more answer is to be expected to a request that has left the line at `sent` and whose
    /// answer takes `transfer`.
    pub(super) fn owe(
        &mut self,
        (unit, request, frame): (Unit, &Request, &Frame),
        patience: Patience,
        sent: Duration,
        transfer: Duration,
    ) {
        let begin = sent + patience.timeout + transfer + ADAPTER_LATENCY;
        let line_until = begin + patience.timeout;
        let unit_until = begin + patience.timeout.max(patience.longest_answer);
        let before = self.answers(unit);
        self.0.retain(|debt| debt.unit != unit);
        self.0.push(Debt {
            unit,
            request: request.clone(),
            frame: frame.clone(),
            answers: before + 1,
            line_until,
            unit_until,
            patience,
        });
    }

    /// How many answers a unit owes.
    pub(super) fn answers(&self, unit: Unit) -> u32 {
        let debt = self.0.iter().find(|debt| debt.unit == unit);
        debt.map_or(0, |debt| debt.answers)
    }

    /// One answer of a unit has come, at `now`. One that was late says that the next can be as
    /// late.
    pub(super) fn paid(&mut self, unit: Unit, now: Duration) {
        for debt in self.0.iter_mut().filter(|debt| debt.unit == unit) {
            debt.answers -= 1;
            let again = now + debt.patience.longest_answer;
            debt.unit_until = debt.unit_until.max(again);
        }
        self.0.retain(|debt| debt.answers > 0);
    }

    /// Until when to wait before `next` goes out, or before the line is left when there is no
    /// next; `None` when it need not wait. The same request may go out at once: a late answer to it
    /// is right.
    pub(super) fn wait_until(
        &mut self,
        next: Option<(Unit, &Frame)>,
        now: Duration,
    ) -> Option<Duration> {
        self.0.retain(|debt| debt.unit_until > now);
        let until = |debt: &Debt| match next {
            Some((_, frame)) if debt.frame == *frame => None,
            Some((unit, _)) if debt.unit != unit => Some(debt.line_until),
            _ => Some(debt.unit_until),
        };
        self.0
            .iter()
            .filter_map(until)
            .max()
            .filter(|until| *until > now)
    }

    /// The unit of which `received` holds an answer that is owed.
    pub(super) fn paid_by(
        &self,
        received: &[u8],
        echo: Echo,
        echoes: Option<bool>,
    ) -> Option<Unit> {
        let is_paid = |debt: &&Debt| {
            let expectation = Expectation::new(debt.unit, &debt.request, &debt.frame, echo, echoes);
            matches!(expectation.judge(received), Verdict::Answer(..))
        };
        self.0.iter().find(is_paid).map(|debt| debt.unit)
    }
}
