//! What is hazardous is asked for first: on a terminal by a question, elsewhere by --yes.

use std::io::{self, BufRead, IsTerminal, Write};

use super::CommandError;
use super::signals::Stop;
use crate::cli::Care;
use crate::output::escape;

/// Something that nobody wants by accident.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Hazard {
    /// The point or operation.
    pub(super) name: String,
    /// What it does, in a few words.
    pub(super) what: String,
}

/// Whether somebody is asked before something is done.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Consent {
    /// Nothing is hazardous, or it was said to be meant.
    Given,
    /// There is a terminal to ask at.
    Ask(Vec<Hazard>),
}

impl Consent {
    /// What `care` says about these hazards.
    ///
    /// # Errors
    /// [`CommandError::NeedsYes`] where nobody can be asked.
    pub(super) fn of(hazards: Vec<Hazard>, care: Care) -> Result<Self, CommandError> {
        let Some(first) = hazards.first() else {
            return Ok(Self::Given);
        };
        if care.yes {
            return Ok(Self::Given);
        }
        if io::stdin().is_terminal() && io::stderr().is_terminal() {
            return Ok(Self::Ask(hazards));
        }
        Err(CommandError::NeedsYes {
            name: first.name.clone(),
            hazard: first.what.clone(),
        })
    }

    /// Asks, where that is needed, and returns when the answer is yes. `whom` is who it is done to;
    /// `stop` listens to signals already, and lets them end the program meanwhile.
    ///
    /// # Errors
    /// [`CommandError::Declined`] for any other answer, and for none.
    pub(super) fn obtain(&self, whom: &str, stop: Option<&Stop>) -> Result<(), CommandError> {
        let Self::Ask(hazards) = self else {
            return Ok(());
        };
        match stop {
            Some(stop) => stop.while_asking(|| ask(hazards, whom)),
            None => ask(hazards, whom),
        }
    }
}

fn ask(hazards: &[Hazard], whom: &str) -> Result<(), CommandError> {
    let hazards = hazards.iter();
    let lines = hazards.flat_map(|Hazard { name, what }| [name, " ", what, "\n"]);
    let question = lines.chain(["Do this to ", whom, "? Type yes: "]);
    let question: String = question.collect();
    let mut answer = String::new();
    let mut terminal = io::stderr().lock();
    let asked = write!(terminal, "{}", escape_lines(&question)).and_then(|()| terminal.flush());
    let read = asked.and_then(|()| io::stdin().lock().read_line(&mut answer));
    // What somebody was about to type as the terminal closed is no answer.
    let is_typed = read.is_ok() && answer.ends_with('\n');
    if is_typed && matches!(answer.trim(), "yes" | "y" | "Yes" | "YES") {
        return Ok(());
    }
    if !is_typed {
        // The message after this begins on a line of its own.
        let _ = writeln!(terminal);
    }
    Err(CommandError::Declined {
        place: whom.to_owned(),
    })
}

/// Profiles are files of somebody.
fn escape_lines(text: &str) -> String {
    let lines: Vec<_> = text.split('\n').map(escape).collect();
    lines.join("\n")
}
