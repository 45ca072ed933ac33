//! Writing points of a unit: what they hold before, the writes themselves, and what they hold
//! afterwards.
//!
//! * [`before`](mod@before) reads what is to be written, and what the meter's rules ask for.
//! * [`carry_out`](mod@carry_out) sends the writes, each once, until one is not confirmed.
//! * [`check`](mod@check) reads back what was confirmed.
//! * [`fate`] is what became of each change.

pub mod before;
pub mod carry_out;
pub mod check;
pub mod fate;

pub use before::{Before, before};
pub use carry_out::{Receipt, carry_out};
pub use check::check;
pub use fate::{Fate, Unread};
