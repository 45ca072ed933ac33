//! What a loop-back test says of the line.

use std::fmt;

use super::{LineEcho, Noticed, Summary};
use crate::words::counted;

/// A line that loses more tries than so many of a hundred is bad. A read that is tried three times,
/// as reads are, then still fails about once in eight thousand times.
pub const MOST_LOST_PERCENT: u64 = 5;

/// Whether the line is good.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// Every word came back, and nothing else was heard but perhaps our echo.
    Good,
    /// The same, but the meter refused some words or all of them, which takes a line as good as an
    /// answer does.
    Refused,
    /// Some words did not come back, at most [`MOST_LOST_PERCENT`] of a hundred; or there was
    /// damage, noise, a late answer or somebody else on the line; or what came back may have been an
    /// echo.
    Doubtful,
    /// More words than that were lost, or all of them.
    Bad,
    /// Nothing but our own echo came back.
    OnlyEcho,
    /// Nothing was tried.
    Untried,
}

impl Verdict {
    /// One word for programs.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Doubtful => "doubtful",
            Self::Bad => "bad",
            Self::OnlyEcho => "only-echo",
            Self::Refused => "refused",
            Self::Untried => "untried",
        }
    }
}

impl Summary {
    /// Tries that the line, and not the meter, lost.
    pub const fn lost(&self) -> u64 {
        self.failed.lost()
    }

    /// What all this says of the line.
    pub fn verdict(&self) -> Verdict {
        let Self { tries, failed, .. } = *self;
        let lost = self.lost();
        let is_clean = self.noticed == Noticed::default() && self.echo != LineEcho::Unknown;
        if tries == 0 {
            Verdict::Untried
        } else if lost == tries && failed.only_echo > 0 && self.echo != LineEcho::Absent {
            Verdict::OnlyEcho
        } else if lost == tries || lost * 100 > tries * MOST_LOST_PERCENT {
            Verdict::Bad
        } else if lost > 0 || !is_clean {
            Verdict::Doubtful
        } else if failed.refused > 0 {
            Verdict::Refused
        } else {
            Verdict::Good
        }
    }

    /// What is not as it should be, as `2 noise bytes`.
    fn faults(&self) -> Vec<String> {
        let Self {
            failed, noticed, ..
        } = self;
        let found = [
            (failed.refused, "refusal", "refusals"),
            (failed.damaged, "damaged answer", "damaged answers"),
            (failed.truncated, "answer broken off", "answers broken off"),
            (failed.mismatched, "wrong answer", "wrong answers"),
            (noticed.noise, "noise byte", "noise bytes"),
            (noticed.late, "late answer", "late answers"),
            (
                noticed.others,
                "frame of other units",
                "frames of other units",
            ),
        ];
        let mut faults: Vec<String> = found
            .into_iter()
            .filter(|(count, ..)| *count > 0)
            .map(|(count, one, many)| counted(count, one, many))
            .collect();
        if self.answered > 0 && self.echo == LineEcho::Unknown {
            faults.push("and what came back may be our echo".to_owned());
        }
        faults
    }
}

impl fmt::Display for Summary {
    /// The verdict in words: `the line is good: 20 of 20 answered, no damage, no noise`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            tries, answered, ..
        } = self;
        let line = match self.verdict() {
            Verdict::Untried => return f.write_str("nothing was tried"),
            Verdict::Refused => {
                let refused = self.failed.refused;
                return write!(
                    f,
                    "the line carries every frame, but the meter refused {refused} of {tries}"
                );
            }
            Verdict::OnlyEcho => {
                return f
                    .write_str("the line is bad: only our own echo comes back, no meter answers");
            }
            Verdict::Good => {
                return write!(
                    f,
                    "the line is good: {answered} of {tries} answered, no damage, no noise"
                );
            }
            Verdict::Doubtful => "doubtful",
            Verdict::Bad => "bad",
        };
        let answered = match answered {
            0 => "none".to_owned(),
            _ => answered.to_string(),
        };
        write!(f, "the line is {line}: {answered} of {tries} answered")?;
        for fault in self.faults() {
            write!(f, ", {fault}")?;
        }
        Ok(())
    }
}
