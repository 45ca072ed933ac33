//! Readings, and meters, as people and programs want them.
//!
//! Every format of readings is a [`Sink`] that takes one [`Row`] after the other. A row goes out in
//! one write. Formats of lines are a [`LineFormat`]: the same lines go to a [`Stream`] and into files
//! (see [`append`](crate::append)). Loop-back tests have sinks of their own, see [`loopback`]. What a meter's profile says is a [`profile::Shown`].

pub mod changes;
pub mod columns;
pub mod csv;
pub mod influx;
pub mod json;
pub mod loopback;
pub mod operations;
pub mod polling;
pub mod profile;
pub mod status;
mod stream;
pub mod table;
pub mod verification;

use std::io;

use jiff::Timestamp;

use crate::append::Start;
use crate::profile::Point;
use crate::readings::{Fault, Row};

pub use csv::{LongCsv, WideCsv};
pub use influx::Influx;
pub use json::{Json, JsonLines};
pub use stream::Stream;
pub use table::{Heading, Table};

/// Takes rows and prints them.
pub trait Sink {
    /// Prints one meter's readings; `points` are what they are readings of.
    ///
    /// # Errors
    /// What the destination says.
    fn row(&mut self, points: &[Point], row: &Row) -> io::Result<()>;

    /// Prints what comes after the last row.
    ///
    /// # Errors
    /// What the destination says.
    fn finish(&mut self) -> io::Result<()>;
}

/// Rows as lines, which can be appended to others of their kind.
pub trait LineFormat {
    /// How a file of rows with these points begins: its header, or what each of its lines begins
    /// with.
    ///
    /// # Errors
    /// None in memory.
    fn start(&self, points: &[Point]) -> io::Result<Start>;

    /// One meter's readings as whole lines: one, or one for each of the `points` that they are
    /// readings of.
    ///
    /// # Errors
    /// A number that JSON does not have; none known.
    fn lines(&self, points: &[Point], row: &Row) -> io::Result<Vec<u8>>;
}

impl<F: LineFormat + ?Sized> LineFormat for Box<F> {
    fn start(&self, points: &[Point]) -> io::Result<Start> {
        (**self).start(points)
    }

    fn lines(&self, points: &[Point], row: &Row) -> io::Result<Vec<u8>> {
        (**self).lines(points, row)
    }
}

/// Time as every output prints it: RFC 3339, UTC, milliseconds.
pub fn time(row: &Row) -> String {
    rfc3339(row.time)
}

fn rfc3339(time: Timestamp) -> String {
    format!("{time:.3}")
}

/// The status of a row or a reading.
pub fn status(fault: Option<Fault>) -> String {
    fault.map_or_else(|| "ok".to_owned(), |fault| fault.to_string())
}

/// Text from a meter or a file made safe for a terminal: control characters are shown, not sent.
pub fn escape(text: &str) -> String {
    text.chars()
        .flat_map(|c| {
            let shown = if c.is_control() {
                c.escape_default().collect()
            } else {
                vec![c]
            };
            shown.into_iter()
        })
        .collect()
}
