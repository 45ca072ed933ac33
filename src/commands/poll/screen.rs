//! The live table: drawn over itself on a terminal, at most four times a second.

use std::io::{self, Write};
use std::time::Duration;

use jiff::Timestamp;

use crate::output::polling::Board;

/// The least time from one drawing to the next.
const LEAST: Duration = Duration::from_millis(250);

/// Where the size of the terminal cannot be had.
const USUAL: (usize, usize) = (80, 24);

/// The table as it stands on the terminal.
pub(super) struct Screen {
    /// How many lines of it stand above the cursor.
    lines: usize,
    drawn: Option<Duration>,
}

impl Screen {
    /// An empty one.
    pub(super) const fn new() -> Self {
        Self {
            lines: 0,
            drawn: None,
        }
    }

    /// Draws the table, unless that was done just now.
    pub(super) fn draw_at_times(&mut self, board: &Board, now: Duration, utc: Timestamp) {
        let is_early = self.drawn.is_some_and(|drawn| now < drawn + LEAST);
        if !is_early {
            self.drawn = Some(now);
            self.draw(board, utc);
        }
    }

    /// Draws the table in place of what is there.
    pub(super) fn draw(&mut self, board: &Board, utc: Timestamp) {
        let (width, height) = size();
        let lines = board.lines(utc, width, height.saturating_sub(1));
        let mut text = self.back();
        for line in &lines {
            text.push_str(line);
            text.push('\n');
        }
        self.lines = lines.len();
        put(&text);
    }

    /// Takes the table away, so that something else can be said.
    pub(super) fn erase(&mut self) {
        let text = self.back();
        self.lines = 0;
        self.drawn = None;
        put(&text);
    }

    /// Lets it stand.
    pub(super) const fn leave(&mut self) {
        self.lines = 0;
    }

    /// To the first line of the table, with nothing behind it.
    fn back(&self) -> String {
        match self.lines {
            0 => String::new(),
            lines => format!("\x1b[{lines}A\r\x1b[J"),
        }
    }
}

/// What does not take it is no terminal any more, and nobody looks.
fn put(text: &str) {
    let mut out = io::stdout().lock();
    let _ = out.write_all(text.as_bytes()).and_then(|()| out.flush());
}

/// Columns and lines.
#[cfg(unix)]
fn size() -> (usize, usize) {
    match rustix::termios::tcgetwinsize(io::stdout()) {
        Ok(size) if size.ws_col > 0 && size.ws_row > 0 => (size.ws_col.into(), size.ws_row.into()),
        _ => USUAL,
    }
}

/// Columns and lines.
#[cfg(not(unix))]
const fn size() -> (usize, usize) {
    USUAL
}
