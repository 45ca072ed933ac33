//! What a meter is, apart from its points.

use humantime::format_duration as time;
use rust_decimal::Decimal;

use super::sheet::Sheet;
use super::terms;
use crate::codec::FunctionCode;
use crate::output::escape;
use crate::profile::identity::Identity;
use crate::profile::model::Identification;
use crate::profile::writing::{Broadcasting, ClockPoints, CommandRegisters};
use crate::profile::{LoopbackData, Profile};
use crate::words::counted;

/// Name and title, and what there is to say about the meter as a whole.
pub(super) fn head(profile: &Profile) -> String {
    let mut sheet = Sheet::default();
    sheet.text("manual", &profile.manual);
    sheet.text("line", &format!("{} unless told otherwise", profile.line));
    limits(&mut sheet, profile);
    telling(&mut sheet, profile);
    match &profile.identification {
        None => sheet.text("recognised", "by no register"),
        Some(known) => sheet.list("recognised", recognised(profile, known)),
    }
    let groups = profile.groups.iter();
    sheet.list(
        "groups",
        groups.map(|group| format!("@{} ({})", group.name, group.members.len())),
    );
    sheet.lines("factors", profile.factors.iter().map(ToString::to_string));
    sheet.lines("identities", identities(&profile.identities));
    sheet.text("holds", &super::count(&profile.points));
    format!("{}: {}\n\n{sheet}", profile.name, escape(&profile.title))
}

/// `device_code holds 57 (EM21 AV5), 58 (EM21 AV6)`, in its parts.
fn recognised(profile: &Profile, known: &Identification) -> Vec<String> {
    let labels = profile.point(&known.point).map(terms::labels);
    let labels = labels.unwrap_or_default();
    let mut codes: Vec<String> = Vec::new();
    for code in known.codes.iter().map(u16::to_string) {
        let name = labels.iter().find(|(number, _)| *number == code);
        let name = name.map(|(_, name)| format!(" ({name})"));
        codes.push(code + &name.unwrap_or_default());
    }
    if let Some(first) = codes.first_mut() {
        *first = format!("{} holds {first}", known.point);
    }
    codes
}

/// The formulas, those of one tolerance together.
fn identities(identities: &[Identity]) -> Vec<String> {
    let mut lines = Vec::new();
    let mut last = None;
    for Identity { law, tolerance } in identities {
        if last != Some(tolerance) {
            let percent = (tolerance * Decimal::ONE_HUNDRED).normalize();
            lines.push(format!("within {percent} %:"));
            last = Some(tolerance);
        }
        lines.push(law.to_string());
    }
    lines
}

/// What it says of status, clock and commands.
fn telling(sheet: &mut Sheet, profile: &Profile) {
    if !profile.status_bits.is_empty() {
        let bits = profile.status_bits.iter();
        sheet.list(
            "status bits",
            bits.map(|(mask, name)| format!("0x{mask:02X}={name}")),
        );
    }
    if let Some(commands) = &profile.command_registers {
        let CommandRegisters { address, code } = commands;
        let text = format!("{address} takes {code}, the number of an operation and its data");
        sheet.text("commands", &text);
    }
    if let Some(ClockPoints { time, date }) = &profile.clock {
        sheet.text("clock", &format!("set by {time} and {date}"));
    }
    let rules = profile.distinct.iter().map(|rule| {
        let except: Vec<String> = rule.except.iter().map(u16::to_string).collect();
        let except = match except.len() {
            0 => String::new(),
            _ => format!(", {} apart", except.join(", ")),
        };
        format!("{}{except}: {}", rule.about, rule.points.join(", "))
    });
    sheet.lines("distinct", rules);
}

/// What is marked for all meters at once.
fn marked(profile: &Profile) -> String {
    let is_marked = |broadcast| broadcast != Broadcasting::Unmarked;
    let points = profile.points.iter();
    let points = points.filter(|point| is_marked(point.writing().broadcast));
    let operations = profile.operations.iter();
    let operations = operations.filter(|operation| is_marked(operation.broadcast));
    let names: Vec<&str> = points
        .map(|point| point.name.as_str())
        .chain(operations.map(|operation| operation.name.as_str()))
        .collect();
    match names.len() {
        0 => "of nothing".to_owned(),
        _ => format!("of {} alone", names.join(", ")),
    }
}

fn limits(sheet: &mut Sheet, profile: &Profile) {
    let limits = &profile.limits;
    sheet.text("units", &format!("1 to {}", limits.units.highest()));
    sheet.list("functions", limits.functions.iter().copied().map(named));
    if limits.interchangeable_reads {
        sheet.text("", "03 and 04 read the same registers");
    }
    let broadcast = limits.broadcast_functions.iter().copied().map(named);
    match limits.broadcast_functions.len() {
        0 => sheet.text("broadcast", "none"),
        _ => sheet.list("broadcast", broadcast),
    }
    if limits.broadcasts_marked_only {
        sheet.text("", &marked(profile));
    }
    match limits.loopback_data {
        LoopbackData::Any => {}
        LoopbackData::Zero => sheet.text("loop-back", "sends back 0000 alone"),
    }
    let holes = if limits.read_holes {
        "holes between points allowed"
    } else {
        "no holes between points"
    };
    let mut read = format!("at most {}, {holes}", registers(limits.read_registers));
    if let Some(size) = limits.table_registers {
        read = format!("{read}, within a table of {size}");
    }
    sheet.text("one read", &read);
    let write = format!("at most {}", registers(limits.write_registers));
    sheet.text("one write", &write);
    let mut answer = format!("within {}", time(limits.longest_answer));
    if !limits.typical_answer.is_zero() {
        answer = format!("{answer}, after {} as a rule", time(limits.typical_answer));
    }
    sheet.text("answers", &answer);
    if !limits.pause.is_zero() {
        sheet.text(
            "pause",
            &format!("{} before each request", time(limits.pause)),
        );
    }
}

/// `03 Read Holding Registers`.
fn named(function: FunctionCode) -> String {
    let name = function.name().unwrap_or_default();
    format!("{:02} {name}", function.get())
}

fn registers(count: u16) -> String {
    counted(count, "register", "registers")
}
