//! What to try when something does not work, one sentence each.

use super::CommandError;
use crate::append::{Misfit, Problem};
use crate::client::Failure;
use crate::codec::{AddressError, ExceptionCode};
use crate::profile::assignment::AssignError;
use crate::profile::find::FindError;
use crate::profile::selector::SelectError;
use crate::profile::write_plan::WritePlanError;
use crate::transport::holder::Holders;
use crate::transport::listen::ListenError;
use crate::transport::{Existing, OpenError, PtyError};

/// What to make of a port that was lost.
const LOST_HINT: &str = "the adapter was unplugged, or the other side hung up; /dev/serial/by-id \
                         has a name that stays when it comes back";

/// Where meters can be simulated.
const PLACES: &str = "a name for a pty, a serial port, rtu+tcp://host:port or tcp://host:port";

/// What to try when a command cannot do its work.
pub(super) fn hint(error: &CommandError) -> Option<String> {
    let text = match error {
        CommandError::Unit(AddressError::UnitZero) => {
            "meters are 1 to 247; `meterpoll broadcast` writes to all of them at once"
        }
        CommandError::Unit(_) => {
            "units go to 247; to 255 only for meters whose profile says so, such as --meter pqm"
        }
        CommandError::Select(error) | CommandError::Assign(AssignError::Select(error)) => {
            return select_hint(error);
        }
        CommandError::ColumnClash { .. } => {
            "ask for it once, or use --layout long or another --format"
        }
        CommandError::Function { code: 7 | 8, .. } => {
            "without --meter it is sent all the same, and the meter may refuse it"
        }
        CommandError::Function { .. } => {
            "the other function reads its registers: see --function, or 3xxxx and 4xxxx with \
             --numbering modicon"
        }
        CommandError::Find(FindError::Unknown { .. }) => {
            "`meterpoll meters list` shows them; a profile file is named by its path"
        }
        CommandError::NoPort => "give a serial port with --port, or sim: for the simulated line",
        CommandError::UnknownSimulation { .. } => "the simulated line is named sim:",
        CommandError::Find(FindError::Misnamed { .. }) => "give both the same name",
        CommandError::Tcp { .. } => "give a serial port, or sim: for the simulated line",
        CommandError::NoPlace { .. } => PLACES,
        CommandError::Listen(ListenError::Address { .. }) => {
            "an address is host:port, such as 127.0.0.1:5020; port 0 is any that is free"
        }
        CommandError::Listen(ListenError::InUse { .. }) => {
            "take another port; port 0 is any that is free"
        }
        CommandError::UnitTwice { .. } => {
            "each unit is one meter: --meter pqm=17,18 --meter em24=1"
        }
        CommandError::Pty(PtyError::Exists {
            what: Existing::LinkToPty | Existing::LostLink,
            ..
        }) => {
            "a pty needs a name that is free; a simulation that was killed leaves its own behind: \
             remove it when none runs there any more"
        }
        CommandError::Pty(PtyError::Exists { .. }) => "a pty needs a name that is free",
        CommandError::NoPath { port } => {
            return Some(format!(
                "a serial port is named like /dev/ttyUSB0; ./{port} makes a pty of that name in this \
                 folder"
            ));
        }
        CommandError::HangUpForGood { .. } => "--port /tmp/meter gives the pty a name",
        CommandError::FaultNotShown { .. } => "rtu+tcp:// and ptys show all faults",
        CommandError::Open(error) => return open_hint(error),
        CommandError::Lost(_) => LOST_HINT,
        CommandError::Append(error) | CommandError::Unwritten { error, .. } => {
            return append_hint(&error.problem).map(str::to_owned);
        }
        _ => {
            let text = poll_hint(error).or_else(|| writing_hint(error));
            return text.map(str::to_owned);
        }
    };
    Some(text.to_owned())
}

/// What to try when nothing can be written.
fn writing_hint(error: &CommandError) -> Option<&'static str> {
    Some(match error {
        CommandError::Assign(AssignError::NoValue { .. } | AssignError::Nothing) => {
            "values are written ct_primary=200 or 0x1028=500"
        }
        CommandError::Assign(AssignError::Several { .. }) => {
            "name each point with its value, such as tariff_1_cost=1 tariff_2_cost=1"
        }
        CommandError::Assign(AssignError::NotOne { .. }) => "name the points, each with its value",
        CommandError::WritePlan(WritePlanError::Function { .. }) => {
            "leave --function out: the meter's own is taken"
        }
        CommandError::WritePlan(WritePlanError::TooMany { .. }) => "write them in several calls",
        CommandError::MovesFirst { .. } => "write what changes that last, or by itself",
        CommandError::NeedsMeter { .. } => {
            "give the register's own number, 0x and its digits, or leave --dry-run out"
        }
        CommandError::NeedsYes { .. } => "--yes says that it is meant",
        CommandError::NoOperation { near, .. } if !near.is_empty() => return None,
        CommandError::NoOperation { .. } => "`execute-operation --list` shows them",
        CommandError::CarriesNothing { .. } => "leave --function out, or give 16",
        CommandError::BroadcastRead { .. } => {
            "give points and values, NAME=VALUE, or the name of one operation"
        }
        CommandError::BroadcastUnknown => "name the meter with --meter, or send it with --force",
        CommandError::NotBroadcast { .. } => {
            "--force sends it all the same; --verify-units shows which meters have taken it"
        }
        CommandError::BroadcastOnly { .. } => "`meterpoll broadcast` writes it",
        CommandError::NoTimeZone { .. } => "set the variable TZ, to Europe/Berlin say",
        CommandError::OneAddress { .. } => "give each meter its own, in calls of their own",
        CommandError::NoMoment { .. } => {
            "give now, or a date and time such as 2026-11-22T13:27:10.015"
        }
        _ => return None,
    })
}

const fn poll_hint(error: &CommandError) -> Option<&'static str> {
    Some(match error {
        CommandError::Clash { .. } => {
            "each port is one line with meters on it, and each file belongs to one output"
        }
        CommandError::NoInterval { .. } => {
            "give an interval such as --every 1m, in a site file every = \"1m\"; --once needs none"
        }
        CommandError::Columns { .. } => {
            "give each an output of its own, put {meter} into its path, or take another layout or \
             format"
        }
        CommandError::Path { .. } => "a % is written %%",
        _ => return None,
    })
}

fn select_hint(error: &SelectError) -> Option<String> {
    let text = match error {
        SelectError::UnknownPoint { near, .. } if !near.is_empty() => return None,
        SelectError::UnknownPoint { groups, .. } | SelectError::NoMatch { groups, .. } => {
            return Some(format!(
                "groups are {}; '*' is every point",
                groups.join(", ")
            ));
        }
        SelectError::Lonely { .. } => {
            "ask for its register by itself, and for those before and behind it apart; points by \
             name need no such care"
        }
        SelectError::PointForm { .. } => "type, factor and unit are for registers by address",
        SelectError::FunctionClash { .. } => "leave --function out: 3xxxx is 4, 4xxxx is 3",
        SelectError::NoPoint { .. } => {
            "points are named (current_a), matched (current_*) or grouped (@energy)"
        }
        SelectError::NoMeter { .. } => "name the meter with --meter, or registers as 0x0000+10",
        SelectError::Malformed { .. } => {
            "registers are written 0x006B, 107, 0x6B+3 or 0x11F:u32/CDAB*0.1=kWh"
        }
        _ => return None,
    };
    Some(text.to_owned())
}

fn append_hint(problem: &Problem) -> Option<&'static str> {
    Some(match problem {
        Problem::Misfit(Misfit::OpenQuote { .. }) => {
            "close the quote, or go on in another file: --on-schema-change new-file"
        }
        Problem::Misfit(_) => {
            "the file is as it was; --on-schema-change new-file goes on in another, name.2.csv"
        }
        Problem::Device => {
            "without --output rows go to stdout, from where a shell leads them anywhere"
        }
        Problem::Locked { .. } => {
            "look at what has it open (`fuser FILE` tells); nothing is written without the lock"
        }
        Problem::Lock(_) => {
            "some network file systems have no locks: take a folder on a disk of this machine"
        }
        Problem::Write { .. } | Problem::Short { .. } | Problem::Sync { .. } => {
            "make room on the disk, or look for a limit: `df`, `quota`, `ulimit -f`"
        }
        _ => return None,
    })
}

fn open_hint(error: &OpenError) -> Option<String> {
    let text = match error {
        OpenError::NotThere { .. } => {
            "`meterpoll ports` lists the ports; plugging an adapter in shows a new one (a program \
             such as brltty can take it away again)"
        }
        OpenError::NotSerial { .. } => "`meterpoll ports` lists the ports",
        OpenError::Busy {
            holders: Holders::Seen(_),
            ..
        } => "--wait 30s waits longer for it to end",
        OpenError::Busy { .. } => {
            "another program has it open, a cron job or ModemManager perhaps; --wait 30s waits longer"
        }
        OpenError::NotPermitted {
            group: Some(group), ..
        } => {
            return Some(format!(
                "`sudo usermod -aG {group} $USER` and a new login give access"
            ));
        }
        OpenError::NotPermitted { group: None, .. } => {
            "an administrator or a udev rule must let you use it"
        }
        OpenError::Settings { .. } => "try another --baud",
        _ => return None,
    };
    Some(text.to_owned())
}

/// What to make of a meter that refuses to be written to.
pub(super) fn write_hint(code: ExceptionCode) -> Option<&'static str> {
    Some(match code {
        ExceptionCode::ILLEGAL_FUNCTION => {
            "the meter may take the other function, --function 6 or 16"
        }
        ExceptionCode::ILLEGAL_DATA_ADDRESS => {
            "the meter has no such registers, or none that can be written"
        }
        ExceptionCode::ILLEGAL_DATA_VALUE => "the meter does not take this value, or not now",
        _ => return failure_hint(&Failure::Exception(code)),
    })
}

/// What to try when a request fails.
pub(super) fn failure_hint(failure: &Failure) -> Option<&'static str> {
    Some(match failure {
        Failure::Silence { .. } => {
            "check --unit, --baud, --parity and --stop-bits against the meter, then power and \
             wiring (A and B swapped?); a slow meter needs a longer --timeout"
        }
        Failure::OnlyEcho => {
            "the adapter hears itself but no meter: check --unit, --baud and --parity, then the \
             wiring behind the adapter"
        }
        Failure::Damaged { .. } | Failure::Truncated { .. } => {
            "check --baud, --parity and --stop-bits, then cable, termination and bias resistors"
        }
        Failure::Mismatch { .. } => {
            "a late answer or a second master on the line; a longer --timeout helps with the first"
        }
        Failure::Ambiguous => {
            "the meter has missed more than one read: a longer --timeout helps when it is slow; else \
             try again in ten seconds"
        }
        Failure::NeverQuiet { .. } => {
            "another master may be talking on this line, or its bias resistors are missing"
        }
        Failure::Exception(ExceptionCode::ILLEGAL_FUNCTION) => {
            "registers by address can be read with the other function, --function 3 or 4"
        }
        Failure::Exception(ExceptionCode::ILLEGAL_DATA_ADDRESS) => {
            "the meter has no such registers, or not as many at once; addresses are as on the \
             wire, from 0 (for 40001 and the like see --numbering modicon)"
        }
        Failure::Exception(ExceptionCode::SERVER_DEVICE_FAILURE) => {
            "the meter itself failed: its display or its manual may say why"
        }
        Failure::Exception(ExceptionCode::ACKNOWLEDGE) => {
            "the meter is still at work on something: ask again later"
        }
        Failure::Exception(ExceptionCode::SERVER_DEVICE_BUSY) => {
            "the meter is there but busy, perhaps somebody is at its keys: ask again later"
        }
        Failure::Exception(ExceptionCode::MEMORY_PARITY_ERROR) => {
            "the memory of the meter is damaged: it needs service"
        }
        Failure::Exception(ExceptionCode::GATEWAY_PATH_UNAVAILABLE) => {
            "a gateway on the way has no path to this unit: check its setup, and --unit"
        }
        Failure::Exception(ExceptionCode::GATEWAY_TARGET_DEVICE_FAILED_TO_RESPOND) => {
            "a gateway on the way got no answer from the unit: check --unit, then power and wiring \
             behind the gateway"
        }
        Failure::Port(_) => LOST_HINT,
        Failure::Stopped | Failure::Exception(_) => return None,
    })
}
