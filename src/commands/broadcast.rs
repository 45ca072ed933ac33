//! `broadcast`: written to all meters on the line at once, which none of them answers.

mod clock;
mod message;
mod verify;

use jiff::Timestamp;

use super::asking::units;
use super::careful::Consent;
use super::open_line::LinePlan;
use super::report::{self, Report};
use super::signals::Stop;
use super::{CommandError, ExitCode, print, print_frames};
use crate::cli::BroadcastWrite;
use crate::client::{Client, Patience, Unwritten};
use crate::codec::{Broadcast, Unit, rtu};
use crate::profile::{Limits, find};
use crate::readings::Fault;
use crate::transport::{Clock, SystemClock};

use self::message::Message;
use self::verify::Sent;

/// Sends what was asked for, and reads meters afterwards where that was asked for too.
pub(super) fn run(
    arguments: &BroadcastWrite,
    report: &mut Report,
) -> Result<ExitCode, CommandError> {
    let profile = arguments.meter.as_deref().map(find::find).transpose()?;
    let profile = profile.as_ref();
    let message = Message::new(arguments, profile)?;
    let limits = profile.map_or_else(Limits::default, |profile| profile.limits.clone());
    let typed = arguments.verify_units.as_ref();
    let units: Vec<Unit> = typed.map_or(Ok(Vec::new()), |typed| units(typed, &limits))?;
    if !units.is_empty() && message.shown.is_empty() {
        return Err(CommandError::NoEffect {
            option: "--verify-units",
            what: "points that can be read",
        });
    }
    if arguments.care.dry_run {
        let writes = message.writes(SystemClock::new().utc_now())?;
        let frame = |write| rtu::encode_broadcast(Broadcast, write);
        return print_frames(writes.iter().map(frame));
    }
    let consent = Consent::of(message.hazards.clone(), arguments.care)?;
    let line = LinePlan::new(&arguments.line, profile);
    let mut client = line.open()?;
    let place = format!("all meters on {}", line.name());
    if !report.is_quiet() {
        print(format!("# {place}\n{}", message.shown_first()).as_bytes())?;
    }
    for warning in message.warnings() {
        report::warning(&warning);
    }
    let result = consent.obtain(&place, None).map(|()| {
        let stop = Stop::listen_while_writing();
        client.stop_when(stop.flag());
        let patience = line.patience(&limits);
        let code = match send(arguments, &message, &place, patience, &mut client, report) {
            Ok(at) if !units.is_empty() => {
                let sent = Sent {
                    message: &message,
                    at,
                    line: &line,
                    profile,
                };
                verify::all(&sent, &units, &mut client, &stop, report)
            }
            Ok(_) => ExitCode::Done,
            Err(code) => code,
        };
        match stop.requested() {
            Some(stopped) if code != ExitCode::WriteUnknown => stopped,
            _ => code,
        }
    });
    // Whatever became of it, no late answer is left to whoever opens the port next; a port that is
    // lost has none.
    let _ = client.finish();
    result
}

/// Sends the requests, each once, and returns when the first of them had left.
///
/// # Errors
/// What to end with, when one was not sent.
fn send(
    arguments: &BroadcastWrite,
    message: &Message<'_>,
    place: &str,
    patience: Patience,
    client: &mut Client,
    report: &mut Report,
) -> Result<Timestamp, ExitCode> {
    let count = message.requests();
    let mut first = None;
    for index in 0..count {
        let make = |time| message.write(index, time);
        let not_sent = match index {
            0 => format!("{place}: not sent"),
            _ => format!(
                "{place}: request {} of {count} not sent, those before it were",
                index + 1
            ),
        };
        match client.broadcast(&make, arguments.turnaround, patience) {
            Ok(at) => first = first.or(Some(at)),
            Err(Unwritten::Unknown(failure)) => {
                report::unknown(&format!("{place}: outcome unknown"), &failure);
                report.advise("read each meter to see what it holds; nothing is sent again");
                return Err(ExitCode::WriteUnknown);
            }
            Err(Unwritten::NotSent(failure)) => {
                report.failure(&not_sent, &failure);
                return Err(ExitCode::of(0, &[Fault::from(&failure)]));
            }
            // Nobody answers a broadcast, so nobody refuses it.
            Err(Unwritten::Stopped | Unwritten::Refused(_)) => {
                report::problem(&not_sent, "the program was stopped");
                // Whatever stopped it says what to end with.
                return Err(ExitCode::Done);
            }
        }
    }
    report.success(&format!("sent to {place}"));
    Ok(first.unwrap_or_else(|| client.utc_now()))
}
