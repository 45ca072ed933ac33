//! Who holds a port that is in use. Linux tells of each process which files it has open, to root
//! and to the user whose process it is.

use std::fmt;

/// Of many holders so many are named.
const NAMED: usize = 3;

/// Who holds a port, as far as it is known. Prints as the end of `in use by`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Holders {
    /// Nobody looked, or this system does not tell.
    Unknown,
    /// No process that we may see has it open.
    Unseen,
    /// These have it open, at least one, by their numbers.
    Seen(Vec<Holder>),
}

/// A process that has a port open.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Holder {
    /// The name of its program, at most 15 bytes of it, its control characters escaped: a process
    /// can give itself any.
    pub name: String,
    /// Its number.
    pub process: u32,
}

impl fmt::Display for Holder {
    /// `mbpoll (process 1234)`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} (process {})", self.name, self.process)
    }
}

impl fmt::Display for Holders {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let holders = match self {
            Self::Unknown => return f.write_str("another program"),
            Self::Unseen => {
                return f.write_str("another program (of another user, perhaps)");
            }
            Self::Seen(holders) => holders,
        };
        let mut words: Vec<String> = holders.iter().take(NAMED).map(Holder::to_string).collect();
        match holders.len().saturating_sub(NAMED) {
            0 => {}
            more => words.push(format!("{more} more")),
        }
        match words.split_last() {
            Some((last, [])) => f.write_str(last),
            Some((last, before)) => write!(f, "{} and {last}", before.join(", ")),
            None => f.write_str("another program"),
        }
    }
}

/// Who has the port of this name open.
#[cfg(target_os = "linux")]
pub fn of(port: &str) -> Holders {
    use std::fs;

    // A name under /dev/serial is a link; processes have the device itself open.
    let (Ok(device), Ok(entries)) = (fs::canonicalize(port), fs::read_dir("/proc")) else {
        return Holders::Unknown;
    };
    let processes = entries
        .filter_map(|entry| entry.ok()?.file_name().to_str()?.parse().ok())
        .filter(|process| has_open(*process, &device));
    let mut holders: Vec<Holder> = processes.map(holder).collect();
    if holders.is_empty() {
        return Holders::Unseen;
    }
    holders.sort_unstable_by_key(|holder| holder.process);
    Holders::Seen(holders)
}

/// Who has the port of this name open: this system does not tell.
#[cfg(not(target_os = "linux"))]
pub const fn of(_: &str) -> Holders {
    Holders::Unknown
}

/// Whether a process is seen to have a file open; one that has ended meanwhile has none.
#[cfg(target_os = "linux")]
fn has_open(process: u32, device: &std::path::Path) -> bool {
    let Ok(files) = std::fs::read_dir(format!("/proc/{process}/fd")) else {
        return false;
    };
    files
        .filter_map(|file| std::fs::read_link(file.ok()?.path()).ok())
        .any(|file| file == device)
}

#[cfg(target_os = "linux")]
fn holder(process: u32) -> Holder {
    let name = std::fs::read(format!("/proc/{process}/comm")).unwrap_or_default();
    let name = String::from_utf8_lossy(name.trim_ascii_end());
    let name = name.chars().flat_map(|c| {
        let shown = if c.is_control() {
            c.escape_default().collect()
        } else {
            vec![c]
        };
        shown.into_iter()
    });
    let name: String = name.collect();
    Holder {
        name: if name.is_empty() {
            "a program".to_owned()
        } else {
            name
        },
        process,
    }
}
