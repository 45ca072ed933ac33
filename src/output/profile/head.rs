//! What a meter is, apart from its points.

use humantime::format_duration as time;
use rust_decimal::Decimal;

use super::sheet::Sheet;
use crate::codec::FunctionCode;
use crate::output::escape;
use crate::profile::model::Limits;
use crate::profile::{Point, Profile};

/// Name and title, and what there is to say about the meter as a whole.
pub(super) fn head(profile: &Profile) -> String {
    let mut sheet = Sheet::default();
    sheet.text("manual", &profile.manual);
    sheet.text("line", &format!("{} from the factory", profile.line));
    limits(&mut sheet, &profile.limits);
    match &profile.identification {
        None => sheet.text("recognised", "by no register"),
        Some(known) => {
            let codes: Vec<String> = known.codes.iter().map(u16::to_string).collect();
            let codes = codes.join(" or ");
            sheet.text("recognised", &format!("{} holds {codes}", known.point));
        }
    }
    let groups = profile.groups.iter();
    sheet.list(
        "groups",
        groups.map(|group| format!("@{} ({})", group.name, group.members.len())),
    );
    sheet.lines("factors", profile.factors.iter().map(ToString::to_string));
    let identities = profile.identities.iter().map(|identity| {
        let percent = (identity.tolerance * Decimal::ONE_HUNDRED).normalize();
        format!("{}, within {percent} %", identity.law)
    });
    sheet.lines("identities", identities);
    sheet.text("points", &count(&profile.points));
    format!("{}: {}\n\n{sheet}", profile.name, escape(&profile.title))
}

/// How many there are, and how many of them are not verified.
pub(super) fn count(points: &[Point]) -> String {
    let all = points.len();
    match points.iter().filter(|point| !point.verified).count() {
        0 => format!("{all}, all verified"),
        unverified => format!("{all}, {unverified} not verified"),
    }
}

fn limits(sheet: &mut Sheet, limits: &Limits) {
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
    let holes = if limits.read_holes {
        "holes between points allowed"
    } else {
        "no holes between points"
    };
    let mut read = format!("at most {} registers, {holes}", limits.read_registers);
    if let Some(size) = limits.table_registers {
        read = format!("{read}, within a table of {size}");
    }
    sheet.text("one read", &read);
    sheet.text(
        "one write",
        &format!("at most {} registers", limits.write_registers),
    );
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
