//! Polling: many meters on many lines, each read at its own fixed rate.
//!
//! * [`schedule`] says when: slots on round times, whatever the clocks do.
//! * [`site`] says what: the lines, the meters on them and where rows go, from a file or a command
//!   line; [`job`] is one set of points of one meter.
//! * [`line`](mod@line) reads what is due on one line, and hands on a [`Cycle`] for each row.
//! * [`news`] says what of it is worth telling, [`tally`] counts.

pub mod job;
pub mod line;
pub mod news;
pub mod schedule;
pub mod site;
pub mod tally;

pub use job::{Job, Manners, Subject};
pub use line::{Cycle, Effort, Event, LineLoop, PortError, Spared};
pub use news::{News, Watch};
pub use schedule::{Clocks, Every, EveryError, Moment, Schedule, Slot};
pub use site::{Site, SiteError, SiteLine, SiteOutput};
pub use tally::{Counts, Tally};
