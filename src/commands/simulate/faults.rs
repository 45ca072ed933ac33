//! What goes wrong: the rules that were typed, and those in a file.

use crate::cli::Simulate;
use crate::commands::{CommandError, HiddenKinds};
use crate::sim::server::Framing;
use crate::transport::faulty::{FaultCounts, FaultKind, FaultRule, FaultScript, FaultScriptError};

/// All rules, those that were typed first; `comes_back` tells whether the line is there again after it
/// was lost.
pub(super) fn script(
    arguments: &Simulate,
    framing: Framing,
    comes_back: bool,
) -> Result<FaultScript, CommandError> {
    let wrong = |file: Option<&String>| {
        let file = file.cloned();
        move |problem: FaultScriptError| CommandError::Faults {
            file,
            problem: Box::new(problem),
        }
    };
    let mut script = FaultScript::parse(&arguments.fault).map_err(wrong(None))?;
    if let Some(path) = &arguments.fault_script {
        let file = path.display().to_string();
        let text = std::fs::read_to_string(path).map_err(|source| {
            let file = file.clone();
            CommandError::FaultsUnreadable { file, source }
        })?;
        let more = FaultScript::from_text(&text).map_err(wrong(Some(&file)))?;
        script = script.followed_by(more);
    }
    let is_hidden = |rule: &&FaultRule| !framing.shows(rule.kind());
    if let Some(rule) = script.rules().iter().find(is_hidden) {
        return Err(CommandError::FaultNotShown {
            rule: rule.text().to_owned(),
            kinds: match rule.kind() {
                FaultKind::Any => HiddenKinds::Some,
                _ => HiddenKinds::All,
            },
        });
    }
    let hangs_up = |rule: &&FaultRule| rule.may_be(FaultKind::HangUp);
    if let Some(rule) = script.rules().iter().find(hangs_up).filter(|_| !comes_back) {
        return Err(CommandError::HangUpForGood {
            rule: rule.text().to_owned(),
        });
    }
    Ok(script)
}

/// `faults: late 1, silence 2`; `None` when none happened.
pub(super) fn told(counts: &FaultCounts) -> Option<String> {
    let faults: Vec<String> = counts
        .faults()
        .map(|(kind, count)| format!("{kind} {count}"))
        .collect();
    (!faults.is_empty()).then(|| format!("faults: {}", faults.join(", ")))
}
