//! What to try when a loop-back test found something.

use crate::client::Failure;
use crate::commands::hints::failure_hint;
use crate::readings::loopback::{Summary, Verdict};

/// What to try; `last` is why the last try that failed did. Nothing where all is well.
pub(super) fn advice(
    summary: &Summary,
    meter: &str,
    last: Option<&Failure>,
) -> Option<&'static str> {
    let Summary {
        answered,
        failed,
        noticed,
        ..
    } = summary;
    match summary.verdict() {
        Verdict::Good | Verdict::Untried => return None,
        Verdict::Refused if meter.is_empty() => {
            return Some(
                "name the meter with --meter: a profile knows what its meter sends back, and \
                 whether it has function 08 at all",
            );
        }
        Verdict::Refused => return Some("is it the meter of --meter, and is nobody at its keys?"),
        Verdict::OnlyEcho => return failure_hint(&Failure::OnlyEcho),
        Verdict::Doubtful | Verdict::Bad => {}
    }
    if *answered == 0 {
        return last.and_then(failure_hint);
    }
    // From here on answers get through, so that unit, speed and parity are right.
    if noticed.late > 0 {
        Some("answers come after their time: with a longer --timeout they count")
    } else if failed.damaged + failed.truncated + noticed.noise > 0 {
        Some(
            "answers get through, so the setting is right: check the cable, its termination at \
             both ends, bias resistors and shield",
        )
    } else if noticed.others + failed.mismatched > 0 {
        Some("a second master may be talking on this line")
    } else if failed.silent + failed.only_echo > 0 {
        Some(
            "answers get through, so the setting is right: check cable and contacts, or give a \
             meter that is slow at times a longer --timeout",
        )
    } else {
        None
    }
}
