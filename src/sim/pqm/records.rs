//! What is counted and kept: pulses, the data logs and the event record. Everything starts at the
//! beginning of 2020, or when it was cleared.

use jiff::Timestamp;

use super::DAY;
use super::state::{Cleared, State};
use super::words::{date_of, time_of};
use crate::sim::model::Content;
use crate::sim::wave::{Moment, PERIOD_SECONDS};

/// What data log 1 records, by the end of the points' names, and its bytes.
const LOGGED: [(&str, i128); 7] = [
    ("current_a", 2),
    ("current_b", 2),
    ("current_c", 2),
    ("p3", 4),
    ("q3", 4),
    ("pf3", 2),
    ("frequency", 2),
];

/// The memory of the logs: 512 blocks of 64 registers (manual page 248).
const LOG_BYTES: i128 = 512 * 64 * 2;

/// Seconds between two records: the factory setting.
const LOG_INTERVAL: i128 = 3600;

/// Seconds between two pulses on the inputs 1 and 2; nothing is wired to 3 and 4.
const PULSES: [i128; 2] = [20, 45];

/// When the one event was.
pub(super) fn event() -> Timestamp {
    Moment::in_first_week(5 * DAY + 27_000)
}

/// What the point of this name holds.
pub(super) fn content(point: &str, moment: Moment, state: &State) -> Option<Content> {
    let seconds = since_2020(moment);
    let start = Moment::in_first_week(0);
    let pulses = state.cleared(Cleared::Pulses);
    let before = pulses.map_or(0, |cleared| since_2020(Moment::of(cleared)));
    let [first, second] = PULSES.map(|every| seconds / every - before / every);
    let cleared = |what| {
        state
            .cleared(what)
            .map_or(start, |at| state.by_its_clock(at))
    };
    let has_event = state.cleared(Cleared::Events).is_none();
    Some(match point {
        "pulse_count_cleared_time" => time_of(cleared(Cleared::Pulses)),
        "pulse_count_cleared_date" => date_of(cleared(Cleared::Pulses)),
        "event_cleared_time" => time_of(cleared(Cleared::Events)),
        "event_cleared_date" => date_of(cleared(Cleared::Events)),
        "log1_start_time" | "log2_start_time" => time_of(start),
        "log1_start_date" | "log2_start_date" => date_of(start),
        _ => Content::Number(match point {
            "pulse_input_1" => first,
            "pulse_input_2" => second,
            "pulse_input_total" => first + second,
            "event_count" => i128::from(has_event),
            "pulse_input_3" | "pulse_input_4" | "event_trace_cause" | "event_internal_fault" => 0,
            _ => return log(point, seconds).map(Content::Number),
        }),
    })
}

fn since_2020(moment: Moment) -> i128 {
    let seconds = i128::from(moment.week) * i128::from(PERIOD_SECONDS) + i128::from(moment.second);
    seconds.max(0)
}

/// The data logs: 1 runs and circulates, 2 has never run.
fn log(point: &str, seconds: i128) -> Option<i128> {
    let assigned = point
        .strip_prefix("log_assign_")
        .or_else(|| point.strip_prefix("log_number_"));
    if let Some(name) = assigned {
        // 1 is log 1 as a code and as a bit.
        let is_logged = LOGGED.iter().any(|(logged, _)| *logged == name);
        return Some(i128::from(is_logged));
    }
    let record: i128 = LOGGED.iter().map(|(_, bytes)| bytes).sum();
    let (room, written) = (LOG_BYTES / record, seconds / LOG_INTERVAL);
    Some(match point {
        "log1_interval" | "log2_interval" => LOG_INTERVAL,
        "log1_record_size" => record,
        "log1_total_records" => room,
        // The oldest one, where the next one goes.
        "log1_first_record" if written > room => written % room,
        "log1_next_record" => written % room,
        "log1_status" => 1,
        "log1_records_used" => written.min(room),
        "log1_next_reading" => LOG_INTERVAL - seconds % LOG_INTERVAL,
        "log1_start_address" | "log1_first_record" | "log2_start_address" | "log2_record_size"
        | "log2_total_records" | "log2_first_record" | "log2_next_record" | "log2_status"
        | "log2_records_used" | "log2_next_reading" => 0,
        _ => return None,
    })
}
