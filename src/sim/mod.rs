//! The simulated line `sim:`: meters inside the program, on the server side of the codec.
//!
//! * [`wave`] and [`load`]: three phases as a pure function of time and a seed. Nothing is stored
//!   between runs, yet counters only ever rise, and every quantity agrees with the others.
//! * [`history`]: what has added up since 2020, the demand, the lowest and the highest.

pub mod history;
pub mod load;
pub mod wave;

pub use load::Load;
