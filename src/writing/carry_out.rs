//! The writes themselves: each once, in their order, until one is not confirmed.

use std::sync::Arc;

use log::info;

use crate::client::{Client, Confirmation, Patience, Unwritten};
use crate::codec::{Request, Unit, rtu};
use crate::profile::write_plan::PlannedWrite;

/// What came of a change when its writes were sent.
#[derive(Debug, Clone)]
pub enum Reply {
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
/// says so.
pub fn carry_out(
    client: &mut Client,
    unit: Unit,
    planned: &[PlannedWrite],
    changes: usize,
    patience: Patience,
    is_over: &dyn Fn() -> bool,
) -> Vec<Reply> {
    let mut replies: Vec<Reply> = vec![Reply::NotTried; changes];
    for planned in planned {
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
        if result.is_err() {
            break;
        }
    }
    replies
}

impl Reply {
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
