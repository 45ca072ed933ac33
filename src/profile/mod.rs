//! What a meter is: its points, scales, limits and rules, and how to read them cheaply.
//!
//! * [`model`] and [`point`]: the checked form that everything else works with.
//! * [`format`](mod@format) and [`load`]: the TOML file and its strict loader.
//! * [`advice`]: what a profile that loads may lack all the same.
//! * [`scaling`] and [`setup`]: scales, and the setup registers that some of them follow from.
//! * [`identity`]: what must hold between the values of a meter.
//! * [`packed`]: how a profile lies in the program.
//! * [`builtin`] and [`find`]: the meters inside the program, and where a name or a path leads.
//! * [`selector`]: what a person types to choose points or raw registers.
//! * [`plan`]: which requests fetch a set of points in the least time on this line.
//! * [`assignment`]: what a person types to write them.
//! * [`write_plan`]: which requests write them.
//! * [`value`]: what a point's registers mean.
//! * [`encoding`]: which registers mean that.
//! * [`writing`]: what may be written, and what a meter does when it is told to.

pub mod advice;
pub mod assignment;
pub mod builtin;
pub mod encoding;
pub mod error;
pub mod find;
pub mod format;
pub mod identity;
pub mod load;
pub mod model;
pub mod packed;
pub mod plan;
pub mod point;
pub mod scaling;
pub mod selector;
pub mod setup;
pub mod value;
pub mod write_plan;
pub mod writing;

pub use encoding::EncodeError;
pub use error::ProfileError;
pub use model::{Limits, LoopbackData, Profile};

pub use plan::Plan;
pub use point::Point;
pub use setup::{Scales, Setup};
pub use value::{Missing, Value};
pub use writing::Operation;
