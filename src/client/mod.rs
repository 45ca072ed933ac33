//! One request and its one answer: everything about believing a reply.
//!
//! RTU replies carry no number and no address, so a late one looks like the answer to whatever was
//! asked next. Three things keep a wrong number out:
//!
//! * [`belief`] decides alone whether bytes are the answer to *this* request: unit, function, byte
//!   count and CRC all have to be what the request implies.
//! * `attempt` sends a request once and keeps the silences and the one deadline.
//! * `request` repeats the *same* request, so that a late answer to an earlier attempt is still a
//!   right one, and decides how a late answer to anything else is told from the right one: what
//!   each way costs and proves is written there.
//! * [`write`](mod@write) sends a write, once, and tells what is known of it.
//! * `debts` remembers the answers that may still come after failed attempts; they are waited for
//!   before a *different* request goes out, and before the line is left. `recent` remembers those
//!   that have come, which a repeater may send again.
//! * `transaction` holds all this together: the [`Client`].
//!
//! A port that was lost is opened again before the next request: `regain`. Beside that,
//! `answer_times` keeps how long each unit takes to answer, for planning, and [`counters`] what has
//! happened to each.

mod answer_times;
mod attempt;
pub mod belief;
pub mod counters;
mod debts;
pub mod failure;
pub mod patience;
mod recent;
mod regain;
mod request;
mod transaction;
pub mod write;

pub use belief::Echo;
pub use counters::Counters;
pub use failure::Failure;
pub use patience::{Patience, QueryData, Ways};
pub use transaction::Client;
pub use write::{Confirmation, Unwritten};
