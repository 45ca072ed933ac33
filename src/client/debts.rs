//! Answers that have not come and may still do so.
//!
//! After a failed attempt its answer can be on the way, and it would look like the answer to
//! whatever is asked next. So it is *awaited* until it has come or until nobody has to reckon with
//! it any more: as long again as it was given to begin, and for the same unit at least as long as
//! the meter may take at the worst, whatever shorter time-out was asked for. The unit in every
//! frame tells answers of different meters apart; waiting for those as well keeps two of them from
//! talking at once.
//!
//! An answer that did not come in that time is *overdue*: it is not waited for any more, but
//! remembered for some time, for it can come still.

use std::collections::BTreeMap;
use std::time::Duration;

use super::belief::{Echo, Expectation, Verdict};
use super::patience::Patience;
use super::transaction::ADAPTER_LATENCY;
use crate::codec::{Frame, FunctionCode, Reply, Request, Unit};

/// An answer that is overdue is remembered for this long at least, and for ten times what the meter
/// may take. Then it is forgotten: a unit is not to be lost for ever because nothing proves it away.
const LEAST_MEMORY: Duration = Duration::from_secs(10);

/// A request that was sent and not answered.
struct Debt {
    request: Request,
    frame: Frame,
    /// When the request had left the line.
    sent: Duration,
    /// Until when nobody else is asked.
    line_until: Duration,
    /// Until when the unit is not asked anything else.
    unit_until: Duration,
    /// From when on nobody reckons with it any more.
    forget_at: Duration,
    longest_answer: Duration,
    /// The meter's ways tell it from other answers, however late it is.
    can_be_told: bool,
    /// The unit has said that it is at work on it, or busy.
    is_put_off: bool,
}

/// What one unit owes.
#[derive(Default)]
struct Account {
    /// Answers that are waited for, in the order of their requests.
    awaited: Vec<Debt>,
    /// Answers that are not waited for any more, in the order of their requests.
    overdue: Vec<Debt>,
    /// Until when nothing else is asked, whatever comes.
    held_until: Option<Duration>,
}

/// An answer that was owed and has come.
pub(super) struct Late {
    pub(super) unit: Unit,
    pub(super) frame: Frame,
    pub(super) reply: Reply,
    /// How many of the bytes it was found in it takes, together with all before it.
    pub(super) end: usize,
}

/// What is asked next.
#[derive(Clone, Copy)]
pub(super) enum Next<'a> {
    /// This.
    Request(Unit, &'a Frame),
    /// Something that no answer to anything before may be taken for.
    Unlike(Unit),
    /// Anything of this unit: what it owes itself is another matter.
    AnyOf(Unit),
    /// Nothing: the line is left.
    Nothing,
}

/// All debts of a line.
#[derive(Default)]
pub(super) struct Debts(BTreeMap<Unit, Account>);

impl Account {
    fn expire(&mut self, now: Duration) {
        let is_late = |debt: &mut Debt| debt.unit_until <= now;
        self.overdue.extend(self.awaited.extract_if(.., is_late));
        self.overdue.retain(|debt| debt.forget_at > now);
        self.held_until = self.held_until.filter(|until| *until > now);
    }

    fn all(&self) -> impl Iterator<Item = &Debt> {
        self.overdue.iter().chain(&self.awaited)
    }

    /// The answer to the oldest of equal requests is there: which of them it answers, nothing in it
    /// tells, and the others can still be answered. Returns the debt that is paid.
    fn pay(&mut self, frame: &Frame) -> Option<Debt> {
        // What was put off last of all: to ask again is what the unit wants.
        [false, true].into_iter().find_map(|is_put_off| {
            let is_it = |debt: &Debt| debt.frame == *frame && debt.is_put_off == is_put_off;
            [&mut self.overdue, &mut self.awaited]
                .into_iter()
                .find_map(|debts| Some(debts.remove(debts.iter().position(is_it)?)))
        })
    }

    fn is_settled(&self) -> bool {
        self.awaited.is_empty() && self.overdue.is_empty() && self.held_until.is_none()
    }
}

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
        let unit_until = begin + patience.at_the_most();
        self.0.entry(unit).or_default().awaited.push(Debt {
            request: request.clone(),
            frame: frame.clone(),
            sent,
            line_until: begin + patience.timeout,
            unit_until,
            forget_at: unit_until + patience.at_the_most().saturating_mul(10).max(LEAST_MEMORY),
            longest_answer: patience.longest_answer,
            can_be_told: patience.ways.tell_late_answers(),
            is_put_off: false,
        });
    }

    /// Whether anything is waited for.
    pub(super) fn is_owed(&self) -> bool {
        let waits = |account: &Account| !account.awaited.is_empty() || account.held_until.is_some();
        self.0.values().any(waits)
    }

    /// Something may come of a unit until then that nobody can tell from an answer.
    pub(super) fn hold(&mut self, unit: Unit, until: Duration) {
        let account = self.0.entry(unit).or_default();
        account.held_until = account.held_until.max(Some(until));
    }

    /// How many answers a unit owes.
    pub(super) fn count(&self, unit: Unit) -> usize {
        self.0.get(&unit).map_or(0, |account| account.all().count())
    }

    /// An answer to this request of a unit has come, at `now`. When it was late, the next can be as
    /// late.
    pub(super) fn answered(&mut self, unit: Unit, frame: &Frame, now: Duration) {
        let Some(account) = self.0.get_mut(&unit) else {
            return;
        };
        account.pay(frame);
        for debt in &mut account.awaited {
            debt.unit_until = debt.unit_until.max(now + debt.longest_answer);
        }
        if account.is_settled() {
            self.0.remove(&unit);
        }
    }

    /// The same, of an answer that proves that no answer to what the unit was asked before comes any
    /// more.
    pub(super) fn answered_at_last(&mut self, unit: Unit, frame: &Frame) {
        if let Some(account) = self.0.get_mut(&unit)
            && let Some(paid) = account.pay(frame)
        {
            account.overdue.retain(|debt| debt.sent >= paid.sent);
        }
    }

    /// The unit has put off this request. It should not answer it now, but some do: where that could
    /// be told, it is not waited for.
    pub(super) fn put_off(&mut self, unit: Unit, frame: &Frame) {
        if let Some(account) = self.0.get_mut(&unit)
            && let Some(debt) = account.pay(frame)
        {
            let debts = if debt.can_be_told {
                &mut account.overdue
            } else {
                &mut account.awaited
            };
            debts.push(Debt {
                is_put_off: true,
                ..debt
            });
        }
    }

    /// What was the answer to this request, for all that can be told, has come damaged.
    pub(super) fn answered_badly(&mut self, unit: Unit, frame: &Frame) {
        if let Some(account) = self.0.get_mut(&unit) {
            account.pay(frame);
        }
    }

    /// How many answers to loop-backs are owed.
    pub(super) fn loop_backs(&self, unit: Unit) -> usize {
        let is_one = |debt: &&Debt| debt.request.function() == FunctionCode::Diagnostics;
        let count = |account: &Account| account.all().filter(is_one).count();
        self.0.get(&unit).map_or(0, count)
    }

    /// Whether an answer to this very request is waited for.
    pub(super) fn awaits(&self, unit: Unit, frame: &Frame) -> bool {
        let awaited = |account: &Account| account.awaited.iter().any(|debt| debt.frame == *frame);
        self.0.get(&unit).is_some_and(awaited)
    }

    /// Whether an answer with this function could come from the unit that belongs to another
    /// request than this.
    pub(super) fn doubt(&self, unit: Unit, request: &Request, frame: &Frame) -> bool {
        self.0.get(&unit).is_some_and(|account| {
            let function = request.function();
            account
                .all()
                .any(|debt| debt.request.function() == function && debt.frame != *frame)
        })
    }

    /// Reckons no longer with overdue answers of this function.
    pub(super) fn forget(&mut self, unit: Unit, function: FunctionCode) {
        if let Some(account) = self.0.get_mut(&unit) {
            account
                .overdue
                .retain(|debt| debt.request.function() != function);
        }
    }

    /// Stops waiting for what has not come in time, and forgets what is long overdue.
    pub(super) fn expire(&mut self, now: Duration) {
        for account in self.0.values_mut() {
            account.expire(now);
        }
        self.0.retain(|_, account| !account.is_settled());
    }

    /// Until when to wait before `next`; `None` when it need not wait. The same request may go out
    /// at once: a late answer to it is right.
    pub(super) fn wait_until(&mut self, next: Next<'_>, now: Duration) -> Option<Duration> {
        self.expire(now);
        let until = |unit: Unit, debt: &Debt| match next {
            Next::Request(asked, frame) if asked == unit && debt.frame == *frame => None,
            Next::AnyOf(asked) if asked == unit => None,
            Next::Request(asked, _) | Next::Unlike(asked) | Next::AnyOf(asked) if asked != unit => {
                Some(debt.line_until)
            }
            _ => Some(debt.unit_until),
        };
        let held = |unit: Unit, account: &Account| match next {
            Next::Request(asked, _) | Next::Unlike(asked) if asked != unit => None,
            Next::AnyOf(_) => None,
            _ => account.held_until,
        };
        self.0
            .iter()
            .flat_map(|(unit, account)| {
                let debts = account.awaited.iter().filter_map(|debt| until(*unit, debt));
                debts.chain(held(*unit, account))
            })
            .max()
            .filter(|until| *until > now)
    }

    /// An answer in `received` that is owed, and is none to `asked`.
    pub(super) fn late_in(
        &self,
        received: &[u8],
        asked: Option<(Unit, &Frame)>,
        echo: Echo,
        echoes: Option<bool>,
    ) -> Option<Late> {
        let all = self
            .0
            .iter()
            .flat_map(|(unit, account)| account.all().map(|debt| (*unit, debt)));
        let mut late = all.filter_map(|(unit, debt)| {
            if asked.is_some_and(|(asked, frame)| asked != unit || debt.frame == *frame) {
                return None;
            }
            let expectation = Expectation::new(unit, &debt.request, &debt.frame, echo, echoes);
            match expectation.judge_to(received) {
                (Verdict::Answer(reply, _), end) => Some(Late {
                    unit,
                    frame: debt.frame.clone(),
                    reply,
                    end,
                }),
                _ => None,
            }
        });
        late.next()
    }
}
