//! A unit that is read again is planned for by what was measured, not by what its profile says.

mod support {
    pub(crate) mod clock;
    pub(crate) mod fussy;
    pub(crate) mod script;
}

use std::time::Duration;

use meterpoll::profile::Limits;

use support::fussy::{Fussy, Run, points};
use support::script::true_reply;

fn with_holes() -> Limits {
    Limits {
        read_holes: true,
        ..Limits::default()
    }
}

#[test]
fn a_slow_meter_is_read_through_a_hole_the_second_time() {
    // A hole of 15 registers costs 31.25 ms, a request of its own 20.8 ms and the time to answer.
    let answer = |frame: &[u8]| vec![(Duration::from_millis(40), true_reply(frame))];
    let mut run = Run::on(answer, &with_holes());
    run.read_all(&points([0, 16]));
    assert_eq!(run.requests(), [(0, 1), (16, 1)]);
    run.read_all(&points([0, 16]));
    assert_eq!(run.requests(), [(0, 17)]);
}

#[test]
fn a_plan_that_changes_after_a_refusal_goes_by_what_was_measured_as_well() {
    let meter = Fussy::new(Some(3)).limit(20);
    let slow = move |frame: &[u8]| {
        let answer = meter.answer(frame).into_iter();
        let slow = answer.map(|(_, bytes)| (Duration::from_millis(100), bytes));
        slow.collect()
    };
    let mut run = Run::on(slow, &with_holes());
    // When nothing was known yet, the last two were two requests.
    run.read_all(&points((0..40).chain([0x100, 0x110])));
    assert_eq!(run.requests(), [(0, 40), (0, 20), (20, 20), (0x100, 17)]);
}
