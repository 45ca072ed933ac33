//! Polling: many meters on many lines, each read at its own fixed rate.
//!
//! * [`schedule`] says when: slots on round times, whatever the clocks do.

pub mod schedule;

pub use schedule::{Every, EveryError, Moment, Schedule, Slot};
