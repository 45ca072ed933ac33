//! `--verify-units`: which meters hold what was broadcast.

use std::time::Duration;

use jiff::Timestamp;
use jiff::civil::Time;

use super::message::Message;
use crate::client::Client;
use crate::codec::Unit;
use crate::codec::value::RegisterType;
use crate::commands::ExitCode;
use crate::commands::asking::Asking;
use crate::commands::open_line::LinePlan;
use crate::commands::report::{self, Report};
use crate::commands::signals::Stop;
use crate::profile::write_plan::Change;
use crate::profile::{Limits, Point, Profile, Scales, Value};

/// A clock that was set this far from now is right: as much as a meter may lose between hearing and
/// obeying, and the seconds it may show without their parts.
const CLOCK_TOLERANCE: Duration = Duration::from_secs(2);

const DAY: Duration = Duration::from_secs(24 * 60 * 60);

/// Something that was broadcast, at a time.
pub(super) struct Sent<'a> {
    pub(super) message: &'a Message<'a>,
    pub(super) at: Timestamp,
    pub(super) line: &'a LinePlan<'a>,
    pub(super) profile: Option<&'a Profile>,
}

/// Reads every unit and says which of them hold what was sent.
pub(super) fn all(
    sent: &Sent<'_>,
    units: &[Unit],
    client: &mut Client,
    stop: &Stop,
    report: &mut Report,
) -> ExitCode {
    let Sent {
        message,
        at,
        line,
        profile,
    } = *sent;
    let limits = profile.map_or_else(Limits::default, |profile| profile.limits.clone());
    let asking = Asking::new(line, profile, &message.shown, limits.read_function());
    let mut code = ExitCode::Done;
    for (index, unit) in units.iter().copied().enumerate() {
        if stop.requested().is_some() {
            report::untried_units(units.len() - index);
            break;
        }
        let taken = asking.ask(unit, client, report);
        let wanted = wanted(message, at, client.utc_now());
        let readings = message.shown.iter().zip(&taken.row.readings).enumerate();
        for (index, (point, reading)) in readings {
            let name = message.written(index);
            let place = format!("unit {unit} on {}, {name}", asking.line);
            let mut wanted = wanted
                .iter()
                .filter_map(|values| values.get(index)?.as_ref());
            let problem = match reading {
                Ok(found) if wanted.any(|wanted| is_same(point, found, wanted)) => {
                    report.success(&format!("unit {unit}: {name} is {}", shown(point, found)));
                    continue;
                }
                Ok(found) => format!("was sent, and the meter holds {}", shown(point, found)),
                Err(fault) => format!("was sent, and could not be read ({fault})"),
            };
            report::problem(&place, &problem);
            code = ExitCode::WriteUnknown;
        }
    }
    code
}

/// What the points may show by now: a clock goes on, and may be a little before or behind.
fn wanted(message: &Message<'_>, sent: Timestamp, now: Timestamp) -> [Vec<Option<Value>>; 3] {
    let since = Duration::try_from(now.duration_since(sent)).unwrap_or_default();
    let sooner = since.saturating_sub(CLOCK_TOLERANCE);
    [since, sooner, since + CLOCK_TOLERANCE].map(|since| {
        let changes = message.changes(sent + since, since).unwrap_or_default();
        let value = |change: &Change| {
            change
                .point
                .interpret(&change.registers, &Scales::default())
        };
        changes
            .iter()
            .map(|(_, change)| value(change).ok())
            .collect()
    })
}

/// Whether a point holds what it should; a clock goes on while it is read.
fn is_same(point: &Point, found: &Value, wanted: &Value) -> bool {
    if point.kind != RegisterType::Time {
        return found == wanted;
    }
    let time = |value: &Value| value.to_string().parse::<Time>().ok();
    let (Some(found), Some(wanted)) = (time(found), time(wanted)) else {
        return false;
    };
    let apart = found.duration_until(wanted).unsigned_abs();
    apart <= CLOCK_TOLERANCE || apart + CLOCK_TOLERANCE >= DAY
}

fn shown(point: &Point, value: &Value) -> String {
    match &point.unit {
        Some(unit) if value.is_number() => format!("{value} {unit}"),
        _ => value.to_string(),
    }
}
