//! The digital inputs of the EM24-DIN (page 12): meters that give a pulse now and then.

use crate::sim::wave::Moment;

/// A meter on an input.
struct Input {
    /// What it is, by the code of that input.
    kind: i128,
    /// Seconds from one pulse to the next. A pulse lasts one of them and closes the input.
    interval: u64,
    /// What a pulse stands for, in tenths.
    weight: i128,
    /// The code of the decimals: 0 for three, 2 for one.
    format: u32,
}

/// An external counter, gas, and cold water: each counter with other decimals.
const INPUTS: [Input; 3] = [
    Input {
        kind: 6,
        interval: 600,
        weight: 1,
        format: 0,
    },
    Input {
        kind: 2,
        interval: 300,
        weight: 1,
        format: 1,
    },
    Input {
        kind: 1,
        interval: 120,
        weight: 10,
        format: 2,
    },
];

/// The register of a point that belongs to an input.
pub(super) fn get(point: &str, moment: Moment) -> Option<i128> {
    let seconds = moment.since_2020();
    if point == "digital_input_status" {
        let open = |(bit, input): (u32, &Input)| {
            i128::from(!seconds.is_multiple_of(input.interval)) << bit
        };
        return Some((0..).zip(&INPUTS).map(open).sum());
    }
    if let Some(number) = point.strip_prefix("counter_") {
        let input = numbered(number)?;
        let tenths = i128::from(seconds / input.interval) * input.weight;
        return Some(tenths * 10_i128.pow(2 - input.format));
    }
    let (number, what) = point.strip_prefix("digital_input_")?.split_once('_')?;
    let input = numbered(number)?;
    match what {
        "type" => Some(input.kind),
        "prescaler" => Some(input.weight),
        "format" => Some(input.format.into()),
        _ => None,
    }
}

fn numbered(number: &str) -> Option<&'static Input> {
    let index = ["1", "2", "3"].iter().position(|name| *name == number)?;
    INPUTS.get(index)
}
