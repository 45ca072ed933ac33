//! Terms with what there is to say about each, in lines that fit a narrow terminal.

use std::fmt;

use crate::output::escape;

/// The longest line, unless a single word is longer.
const WIDTH: usize = 80;

/// Terms, one below the other, with what they mean beside them.
#[derive(Debug, Default)]
pub(super) struct Sheet {
    entries: Vec<Entry>,
}

#[derive(Debug)]
struct Entry {
    term: String,
    /// What stays in one line, each with what stands before the next.
    pieces: Vec<String>,
    /// How much further in it goes on in the lines after its first.
    hanging: usize,
}

impl Sheet {
    /// Adds a term and a text, which is broken at its spaces.
    pub(super) fn text(&mut self, term: &str, text: &str) {
        self.add(term, text.split(' ').map(escape).collect(), 0);
    }

    /// Adds a term and a list, which is broken between its items.
    pub(super) fn list(&mut self, term: &str, items: impl IntoIterator<Item = String>) {
        let items = items.into_iter();
        let mut pieces: Vec<String> = items.map(|item| escape(&item) + ",").collect();
        if let Some(last) = pieces.last_mut() {
            last.pop();
        }
        self.add(term, pieces, 0);
    }

    /// Adds a term and texts that each begin a line.
    pub(super) fn lines(&mut self, term: &str, texts: impl IntoIterator<Item = String>) {
        let mut term = term;
        for text in texts {
            self.add(term, text.split(' ').map(escape).collect(), 2);
            term = "";
        }
    }

    fn add(&mut self, term: &str, pieces: Vec<String>, hanging: usize) {
        self.entries.push(Entry {
            term: escape(term),
            pieces,
            hanging,
        });
    }
}

impl fmt::Display for Sheet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let terms = self.entries.iter().map(|entry| entry.term.chars().count());
        let indent = terms.max().unwrap_or_default() + 2;
        for Entry {
            term,
            pieces,
            hanging,
        } in &self.entries
        {
            let mut line = format!("{term:indent$}");
            let mut is_begun = false;
            for piece in pieces {
                if is_begun && line.chars().count() + 1 + piece.chars().count() > WIDTH {
                    writeln!(f, "{}", line.trim_end())?;
                    line = " ".repeat(indent + hanging);
                    is_begun = false;
                }
                if is_begun {
                    line.push(' ');
                }
                line.push_str(piece);
                is_begun = true;
            }
            writeln!(f, "{}", line.trim_end())?;
        }
        Ok(())
    }
}
