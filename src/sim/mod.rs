//! The simulated line `sim:`: meters inside the program, on the server side of the codec.
//!
//! A [`SimulatedLine`] is a [`crate::transport::Transport`] like a serial port; a frame sent into
//! it is answered by the [`Meter`]s on it. What a meter shows comes from its [`Model`]: a
//! [`Pqm`], a [`Pm290`] or an [`Em2x`], each of which measures a [`Load`].
//!
//! Meters take writes as their manuals say: registers hold what was written, and models do what they
//! are told to, as long as the line is there.
//!
//! * [`wave`] and [`load`]: three phases as a pure function of time and a seed. Nothing is stored
//!   between runs, yet counters rise until they are cleared, and every quantity agrees with the others.
//! * [`history`]: what has added up since 2020, the demand, the lowest and the highest; the same since
//!   something was cleared.
//! * [`pqm`], [`pm290`] and [`em2x`]: which of this stands behind which point, in whole steps of the
//!   registers.
//! * [`model`]: what a kind of meter holds and does, and how it differs from the others.
//! * [`meter`]: requests in, answers, exceptions or silence out.
//! * [`kinds`]: which model stands behind which profile.
//! * [`values`]: a file of values that meters hold whatever the load does.
//! * [`line`](mod@line): the transport.
//! * [`server`]: the line with clients of others on it.

pub mod em2x;
pub mod history;
pub mod kinds;
pub mod line;
pub mod load;
pub mod meter;
pub mod model;
pub mod pm290;
mod powers;
pub mod pqm;
pub mod server;
pub mod values;
pub mod wave;
mod words;

pub use em2x::Em2x;
pub use line::SimulatedLine;
pub use load::{Installation, Load};
pub use meter::Meter;
pub use model::{Blank, Content, Deed, Destiny, Measured, Model, Word};
pub use pm290::Pm290;
pub use pqm::Pqm;
pub use server::Server;
