//! `broadcast`: written to all meters on the line at once, which none of them answers.

mod clock;
mod message;
mod verify;

use super::asking::units;
use super::careful::Consent;
use super::open_line::LinePlan;
use super::report::{self, Report};
use super::signals::Stop;
use super::{CommandError, ExitCode, print};
use crate::cli::BroadcastWrite;
use crate::client::{Client, Unwritten};
use crate::codec::{Broadcast, Unit, rtu};
use crate::profile::{Limits, find};
use crate::readings::Fault;
use crate::transport::{Clock, SystemClock, Timing};

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
    if !units.is_empty() && message.shown().is_empty() {
        return Err(CommandError::NoEffect {
            option: "--verify-units",
            what: "points that can be read",
        });
    }
    if arguments.care.dry_run {
        let writes = message.writes(SystemClock::new().utc_now())?;
        let frames = writes.iter().map(|write| {
            let frame = rtu::encode_broadcast(Broadcast, write);
            frame.to_string() + "\n"
        });
        return print(frames.collect::<String>().as_bytes());
    }
    let consent = Consent::of(message.hazards(), arguments.care)?;
    let line = LinePlan::new(&arguments.line, profile);
    let mut client = line.open()?;
    let place = format!("all meters on {}", line.name());
    if !report.is_quiet() {
        print(format!("# {place}\n{}", message.shown_first()).as_bytes())?;
    }
    let mut code = ExitCode::Done;
    let result = consent.obtain(&place, None).and_then(|()| {
        let stop = Stop::listen_while_writing();
        client.stop_when(stop.flag());
        code = send(arguments, &message, &line, &limits, &mut client, report)?;
        let sent = Sent {
            message: &message,
            at: client.utc_now(),
            line: &line,
            profile,
        };
        if code == ExitCode::Done && !units.is_empty() {
            code = verify::all(&sent, &units, &mut client, &stop, report);
        }
        if code != ExitCode::WriteUnknown
            && let Some(stopped) = stop.requested()
        {
            code = stopped;
        }
        Ok(())
    });
    let _ = client.finish();
    result.map(|()| code)
}

/// Sends the requests, each once.
fn send(
    arguments: &BroadcastWrite,
    message: &Message<'_>,
    line: &LinePlan<'_>,
    limits: &Limits,
    client: &mut Client,
    report: &mut Report,
) -> Result<ExitCode, CommandError> {
    let place = format!("all meters on {}", line.name());
    let timing = Timing::Paced(line.settings);
    let count = message.writes(client.utc_now())?.len();
    for index in 0..count {
        // A clock is right when the last byte has arrived: so much later than now.
        let frame = |write: &_| rtu::encode_broadcast(Broadcast, write).as_bytes().len();
        let length = message.writes(client.utc_now())?.get(index).map(frame);
        let on_its_way = timing.silence() + timing.transfer_time(length.unwrap_or_default());
        let writes = message.writes(client.utc_now() + on_its_way)?;
        let Some(write) = writes.get(index) else {
            break;
        };
        let patience = line.patience(limits);
        let not_sent = match index {
            0 => format!("{place}: not sent"),
            _ => format!("{place}: request {} of {count} not sent", index + 1),
        };
        match client.broadcast(write, arguments.turnaround, patience) {
            // Nobody answers a broadcast, so nobody refuses it.
            Ok(()) | Err(Unwritten::Refused(_)) => {}
            Err(Unwritten::Unknown(failure)) => {
                report::unknown(&format!("{place}: outcome unknown"), &failure);
                report.advise("read each meter to see what it holds; nothing is sent again");
                return Ok(ExitCode::WriteUnknown);
            }
            Err(Unwritten::NotSent(failure)) => {
                report.failure(&not_sent, &failure);
                return Ok(ExitCode::of(0, &[Fault::from(&failure)]));
            }
            Err(Unwritten::Stopped) => {
                report::problem(&not_sent, "the program was stopped");
                // Whatever stopped it says what to end with.
                return Ok(ExitCode::Terminated);
            }
        }
    }
    report.success(&format!("sent to {place}"));
    Ok(ExitCode::Done)
}
