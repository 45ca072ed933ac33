//! Polling: many meters on many lines, each read at its own fixed rate.
//!
//! * [`schedule`] says when: slots on round times, whatever the clocks do.
//! * [`site`] says what: the lines, the meters on them and where rows go, from a file or a command
//!   line; [`job`] is one set of points of one meter.

pub mod job;
pub mod schedule;
pub mod site;

pub use job::{Job, Manners, Subject};
pub use schedule::{Every, EveryError, Moment, Schedule, Slot};
pub use site::{Site, SiteError, SiteLine, SiteOutput};
