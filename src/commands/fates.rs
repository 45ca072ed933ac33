//! What became of writes, in words and exit codes.

use super::ExitCode;
use super::report::{self, Report};
use crate::client::Unwritten;
use crate::readings::Fault;
use crate::writing::{Fate, Unread};

/// Something that was to be done to one unit.
pub(super) struct Deed<'a> {
    /// `unit 17 on sim: at 9600 8N1`.
    pub(super) place: &'a str,
    /// The point or operation.
    pub(super) name: &'a str,
    /// The value it was to be given, with its unit.
    pub(super) value: Option<&'a str>,
    /// `written`, `done`.
    pub(super) done: &'static str,
    /// The command that shows what the meter holds, where one does.
    pub(super) find_out: Option<&'a str>,
}

/// What all units come to so far.
#[derive(Debug, Default)]
pub(super) struct Outcome(Option<ExitCode>);

impl Outcome {
    /// The worst code counts: unknown before everything else.
    pub(super) fn add(&mut self, code: ExitCode) {
        let rank = |code: ExitCode| match code {
            ExitCode::WriteUnknown => 4,
            ExitCode::Port => 3,
            ExitCode::Refused => 2,
            ExitCode::Done => 0,
            _ => 1,
        };
        if self.0.is_none_or(|so_far| rank(code) > rank(so_far)) {
            self.0 = Some(code);
        }
    }

    /// What to end with; a signal that stopped the program counts unless something is unknown.
    pub(super) fn code(&self, stopped: Option<ExitCode>) -> ExitCode {
        match (self.0, stopped) {
            (Some(ExitCode::WriteUnknown), _) => ExitCode::WriteUnknown,
            (_, Some(stopped)) => stopped,
            (code, None) => code.unwrap_or(ExitCode::Done),
        }
    }
}

/// Says what became of it and returns what that ends with.
pub(super) fn tell(deed: &Deed<'_>, fate: &Fate, report: &mut Report) -> ExitCode {
    let Deed { place, name, .. } = deed;
    match fate {
        Fate::ReadBack => {
            report.success(&format!("{} and read back", deed.told()));
            ExitCode::Done
        }
        Fate::Confirmed(Unread::Failed(fault)) => {
            let text = format!("confirmed by the meter, but reading it back failed ({fault})");
            report::problem(&format!("{place}, {name}"), &text);
            deed.advise(report);
            ExitCode::WriteUnknown
        }
        Fate::Confirmed(unread) => {
            let note = match unread {
                Unread::WriteOnly => "; it cannot be read back",
                Unread::Moved => {
                    "; from now on the meter may answer only with the new address or setting"
                }
                Unread::Momentary | Unread::NotAsked | Unread::Failed(_) => "",
            };
            report.success(&format!("{}{note}", deed.told()));
            ExitCode::Done
        }
        Fate::Accepted => {
            let text = "not confirmed: the meter has taken it and is still at work (05 \
                        ACKNOWLEDGE); it was not sent again";
            report::problem(&format!("{place}, {name}"), text);
            deed.advise(report);
            ExitCode::WriteUnknown
        }
        Fate::Otherwise(found) => {
            let value = deed.value.unwrap_or("another value");
            let text = format!("{value} was {}, and the meter holds {found}", deed.done);
            report::problem(&format!("{place}, {name}"), &text);
            report.advise("the meter keeps it within its own limits, or something else sets it");
            ExitCode::WriteUnknown
        }
        Fate::NotTried => {
            let text = format!("not {}: something before it was not", deed.done);
            report::problem(&format!("{place}, {name}"), &text);
            ExitCode::Done
        }
        Fate::Unwritten(why) => deed.unwritten(why, report),
        Fate::Torn(why) => {
            let text = format!("half of its registers are {}, and then:", deed.done);
            report::problem(&format!("{place}, {name}"), &text);
            deed.unwritten(why, report);
            deed.advise(report);
            ExitCode::WriteUnknown
        }
    }
}

impl Deed<'_> {
    /// `ct_primary: 200 A, written`.
    fn told(&self) -> String {
        let Self { name, done, .. } = self;
        match self.value {
            Some(value) => format!("{name}: {value}, {done}"),
            None => format!("{name}: {done}"),
        }
    }

    fn unwritten(&self, why: &Unwritten, report: &mut Report) -> ExitCode {
        let at = format!("{}, {}", self.place, self.name);
        match why {
            Unwritten::NotSent(failure) => {
                report.failure(&format!("{at}: not sent"), failure);
                ExitCode::of(0, &[Fault::from(failure)])
            }
            // Whatever stopped it says what to end with.
            Unwritten::Stopped => {
                report::problem(&at, &why.to_string());
                ExitCode::Done
            }
            Unwritten::Refused(code) => {
                report.refused(&at, *code);
                ExitCode::Refused
            }
            Unwritten::Unknown(failure) => {
                let place = format!("{at}: outcome unknown, it may be {} or not", self.done);
                report::unknown(&place, failure);
                self.advise(report);
                ExitCode::WriteUnknown
            }
        }
    }

    /// How to find out what the meter holds.
    fn advise(&self, report: &mut Report) {
        match self.find_out {
            Some(command) => report.advise(&format!("`{command}` shows what the meter holds now")),
            None => report
                .advise("it cannot be read back: see what the meter shows before it is done again"),
        }
    }
}
