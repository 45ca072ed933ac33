//! How a file of rows begins.

use std::fmt;

use super::cells::cells;

/// How a file of rows begins.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Start {
    /// With this line, which names the columns of CSV; without its line end.
    Header(Vec<u8>),
    /// With any of the lines, which all begin so.
    Prefix(&'static str),
}

/// Why a file is none that such rows belong into. Prints as a clause.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Misfit {
    /// A column is another one.
    Column {
        /// Which one, from 1.
        number: usize,
        /// What it is.
        found: String,
        /// What it would have to be.
        expected: String,
    },
    /// There are too few columns.
    NoColumn {
        /// The first that is not there, from 1.
        number: usize,
        /// What it would have to be.
        expected: String,
    },
    /// There are too many columns.
    MoreColumns {
        /// The first that is too many, from 1.
        number: usize,
        /// What it is.
        found: String,
    },
    /// U+FEFF comes first.
    ByteOrderMark,
    /// Lines end in CR LF.
    CarriageReturn,
    /// The first line is not of this kind.
    Prefix {
        /// What it begins with.
        found: String,
        /// What it would have to begin with.
        expected: &'static str,
    },
    /// A quote is open where the file ends: rows would be part of a text.
    OpenQuote {
        /// The line in which it is opened, from 1.
        line: u64,
    },
}

impl fmt::Display for Misfit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Column {
                number,
                found,
                expected,
            } => write!(
                f,
                "it has other columns: column {number} is '{found}', not '{expected}'"
            ),
            Self::NoColumn { number, expected } => write!(
                f,
                "it has fewer columns: there is no column {number}, '{expected}'"
            ),
            Self::MoreColumns { number, found } => write!(
                f,
                "it has more columns: column {number}, '{found}', is not among those to be written"
            ),
            Self::ByteOrderMark => {
                f.write_str("it begins with a byte order mark, as from a spreadsheet")
            }
            Self::CarriageReturn => {
                f.write_str("its lines end in CR LF, as from a spreadsheet, and not in LF")
            }
            Self::Prefix { found, expected } => write!(
                f,
                "it holds something else: its first line begins with '{found}', not with \
                 '{expected}'"
            ),
            Self::OpenQuote { line } => {
                write!(f, "a quote that is opened in line {line} is never closed")
            }
        }
    }
}

impl Start {
    /// What comes before the first row of an empty file.
    pub fn head(&self) -> Vec<u8> {
        match self {
            Self::Header(header) => [header.as_slice(), b"\n"].concat(),
            Self::Prefix(_) => Vec::new(),
        }
    }

    /// Whether a first line without its end can be what is left of one of ours.
    pub(super) fn can_be_torn(&self, line: &[u8]) -> bool {
        match self {
            Self::Header(header) => header.starts_with(line),
            Self::Prefix(prefix) => {
                line.starts_with(prefix.as_bytes()) || prefix.as_bytes().starts_with(line)
            }
        }
    }

    /// Whether a file whose first line is this one, without its line end, is one of ours.
    pub(super) fn fits(&self, line: &[u8]) -> Result<(), Misfit> {
        if line.starts_with("\u{feff}".as_bytes()) {
            return Err(Misfit::ByteOrderMark);
        }
        match self {
            Self::Header(header) if header == line => Ok(()),
            Self::Header(header) => {
                let (unended, ending) = match line.strip_suffix(b"\r") {
                    Some(unended) => (unended, Err(Misfit::CarriageReturn)),
                    // Other quotes around the same names change nothing.
                    None => (line, Ok(())),
                };
                columns(header, unended).and(ending)
            }
            Self::Prefix(prefix) if line.starts_with(prefix.as_bytes()) => Ok(()),
            Self::Prefix(expected) => Err(Misfit::Prefix {
                found: shown(line),
                expected,
            }),
        }
    }

    /// How many cells a row has, where that is known.
    pub(super) fn width(&self) -> Option<usize> {
        match self {
            Self::Header(header) => Some(cells(header)?.len()),
            Self::Prefix(_) => None,
        }
    }
}

/// Whether two headers name the same columns.
fn columns(expected: &[u8], found: &[u8]) -> Result<(), Misfit> {
    let read = |line: &[u8]| cells(line).unwrap_or_else(|| vec![line.to_vec()]);
    let (expected, found) = (read(expected), read(found));
    for number in 1..=expected.len().max(found.len()) {
        let cells = (found.get(number - 1), expected.get(number - 1));
        return Err(match cells {
            (Some(found), Some(expected)) if found == expected => continue,
            (Some(found), Some(expected)) => Misfit::Column {
                number,
                found: shown(found),
                expected: shown(expected),
            },
            (Some(found), None) => Misfit::MoreColumns {
                number,
                found: shown(found),
            },
            (None, Some(expected)) => Misfit::NoColumn {
                number,
                expected: shown(expected),
            },
            (None, None) => break,
        });
    }
    Ok(())
}

/// As much of a text as fits into a message.
fn shown(text: &[u8]) -> String {
    const MOST: usize = 40;
    let text = String::from_utf8_lossy(text);
    let mut shown: String = text.chars().take(MOST).collect();
    if shown.len() < text.len() {
        shown.push_str("...");
    }
    shown
}
