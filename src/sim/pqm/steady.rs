//! What stays as it is while nothing is wrong: status words, diagnosis, the user map.

use crate::sim::model::Content;
use crate::sim::words::text;

/// What the point of this name holds.
pub(super) fn content(point: &str) -> Option<Content> {
    if point == "message_buffer" {
        return Some(text("SIMULATED METER"));
    }
    let raw = WORDS.iter().find(|(name, _)| *name == point);
    let raw = raw
        .map(|(_, raw)| *raw)
        .or_else(|| is_clear(point).then_some(0));
    raw.map(|raw| Content::Number(i128::from(raw)))
}

const WORDS: [(&str, u16); 8] = [
    // A and B are closed; C and D are pulse inputs, open between two pulses.
    ("switch_inputs", 0x0300),
    // Data log 1 is running.
    ("general_status", 0x0008),
    ("encrypted_passcode", 0x1B9D),
    ("adc_reference", 2048),
    ("power_loss_fine", 0),
    ("power_loss_coarse", 0),
    ("current_key", 0),
    ("internal_fault", 0),
];

/// Whether it is a condition of a relay, and there is none, or part of the user map, and it maps
/// nothing.
fn is_clear(point: &str) -> bool {
    let relays = ["alarm", "aux1", "aux2", "aux3"];
    let is_condition = relays.iter().any(|relay| {
        point
            .strip_prefix(relay)
            .is_some_and(|rest| rest.starts_with("_active_") || rest.starts_with("_pickup_"))
    });
    is_condition || point.starts_with("user_map_data_") || point.starts_with("user_map_index_")
}
