//! The writes themselves: each once, in their order, until one is not confirmed.

use std::sync::Arc;

use log::info;

use crate::client::{Client, Confirmation, Patience, Unwritten};
use crate::codec::{Request, Unit, rtu};
use crate::profile::write_plan::PlannedWrite;

/// What came of a change when its writes were sent.
#[derive(Debug, Clone)]
pub enum Receipt {
    /// The meter has confirmed all of them.
    Confirmed,
    /// It has confirmed one with another value than it was sent: this one.
    Stored(u16),
    /// It has taken one and was still at work.
    Accepted,
    /// One was not confirmed, and none before it was.
    Unwritten(Arc<Unwritten>),
    /// One was not confirmed, and others before it were.
    Torn(Arc<Unwritten>),
    /// None was sent.
    NotTried,
}

/// Sends writes to one unit in their order, each once, and tells what came of each of the `changes`
/// that they make. After the first that is not confirmed none is sent any more, nor when `is_over`
/// says so; a value that the meter has put into its own limits is a confirmation all the same.
pub fn carry_out(
    client: &mut Client,
    unit: Unit,
    planned: &[PlannedWrite],
    changes: usize,
    patience: Patience,
    is_over: &dyn Fn() -> bool,
) -> Vec<Receipt> {
    let mut replies: Vec<Receipt> = vec![Receipt::NotTried; changes];
    let mut rest = planned;
    while let [planned, after @ ..] = rest {
        rest = after;
        let result = if is_over() {
            Err(Unwritten::Stopped)
        } else {
            let request = Request::Write(planned.write.clone());
            let frame = rtu::encode_request(unit, &request);
            info!("unit {unit}: writing {frame}");
            client.write(unit, &planned.write, patience)
        };
        let result = result.map_err(Arc::new);
        for index in &planned.changes {
            if let Some(reply) = replies.get_mut(*index) {
                *reply = reply.followed_by(&result);
            }
        }
        match &result {
            Ok(Confirmation::Done) => {}
            // The rest of a point of which one half is wrong would not make it right.
            Ok(Confirmation::Stored(_)) if !goes_on(planned, after) => {}
            _ => break,
        }
    }
    replies
}

/// Whether the next write is a part of the same point.
fn goes_on(planned: &PlannedWrite, after: &[PlannedWrite]) -> bool {
    let next = after.first();
    next.is_some_and(|next| {
        next.changes
            .iter()
            .any(|index| planned.changes.contains(index))
    })
}

impl Receipt {
    /// What came of a change that is one write.
    pub fn of(result: Result<Confirmation, Unwritten>) -> Self {
        Self::NotTried.followed_by(&result.map_err(Arc::new))
    }

    /// Whether nothing has gone wrong so far.
    pub const fn is_no_failure(&self) -> bool {
        matches!(self, Self::Confirmed | Self::Stored(_) | Self::NotTried)
    }

    /// This one, and what came of the next of the change's writes.
    fn followed_by(&self, next: &Result<Confirmation, Arc<Unwritten>>) -> Self {
        match (self, next) {
            (Self::NotTried | Self::Confirmed, Ok(Confirmation::Done)) => Self::Confirmed,
            (before, Ok(Confirmation::Done)) => before.clone(),
            (_, Ok(Confirmation::Stored(value))) => Self::Stored(*value),
            (_, Ok(Confirmation::Accepted)) => Self::Accepted,
            (Self::NotTried, Err(why)) => Self::Unwritten(Arc::clone(why)),
            (_, Err(why)) => Self::Torn(Arc::clone(why)),
        }
    }
}
