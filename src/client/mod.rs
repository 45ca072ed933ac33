//! One request and its one answer: everything about believing a reply.
//!
//! RTU replies carry no number and no address, so a late one looks like the answer to whatever was
//! asked next. Three things keep a wrong number out:
//!
//! * [`belief`] decides alone whether bytes are the answer to *this* request: unit, function, byte
//!   count and CRC all have to be what the request implies.
//! * [`transaction`] keeps the silences, the one deadline and the retries, which repeat the *same*
//!   request, so that a late answer to an earlier attempt is still a right one.
//! * `debts` remembers the answers that may still come after failed attempts; they are waited for
//!   before a *different* request goes out, and before the line is left.
//!
//! A port that was lost is opened again before the next request: `regain`. Beside that, `answer_times` keeps how long each unit takes to answer, for planning.

mod answer_times;
pub mod belief;
mod debts;
pub mod failure;
mod regain;
pub mod transaction;

pub use belief::Echo;
pub use failure::Failure;
pub use transaction::{Client, Patience};
