//! What became of a change.

use std::sync::Arc;

use crate::client::Unwritten;
use crate::readings::Fault;

/// What became of one change.
#[derive(Debug)]
pub enum Fate {
    /// The meter has confirmed it, and reads back what was written.
    ReadBack,
    /// The meter has confirmed it; it was not read back.
    Confirmed(Unread),
    /// The meter has taken it and was still at work (exception 05); it does not read back yet, or was
    /// not read back.
    Accepted,
    /// The meter holds another value than was written: this one, as the point shows it.
    Otherwise(String),
    /// It was refused, is unknown or was not sent.
    Unwritten(Arc<Unwritten>),
    /// The same of the rest of its registers, and the first of them were written.
    Torn(Arc<Unwritten>),
    /// It was not sent, for something before it was not done.
    NotTried,
}

/// Why a confirmed change was not read back.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unread {
    /// Nobody wanted it to be.
    NotAsked,
    /// The point can only be written.
    WriteOnly,
    /// The point does something and does not keep what is written.
    Momentary,
    /// The meter is reached in another way from now on.
    Moved,
    /// Reading it failed.
    Failed(Fault),
}
