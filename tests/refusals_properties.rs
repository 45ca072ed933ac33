//! Whatever a meter does not give, and however it says so: every point that it gives by itself
//! arrives, with its true value, and no lesson makes a later reading dearer than asking for each
//! point alone.

mod support {
    pub(crate) mod cases;
    pub(crate) mod clock;
    pub(crate) mod fussy;
    pub(crate) mod script;
}

use std::time::Duration;

use meterpoll::profile::{Limits, Point};
use proptest::prelude::*;

use support::cases::runner;
use support::fussy::{Fussy, Run, point, statuses};

fn any_points() -> impl Strategy<Value = Vec<Point>> {
    let count = prop_oneof![4 => Just(1_u16), 2 => Just(2), 1 => Just(4)];
    let place = (0_u16..120, count);
    prop::collection::vec(place, 1..60).prop_map(|places| {
        places
            .into_iter()
            .map(|(start, count)| point(start, count))
            .collect()
    })
}

/// A meter that says what it does not give may lack any registers. Of one that does not say so it
/// cannot be told from its silence whether it is there, so it gives each point by itself.
fn any_meter() -> impl Strategy<Value = Fussy> {
    let gone = prop::collection::vec(0_u32..120, 0..6);
    let borders = prop::collection::vec(0_u32..124, 0..3);
    let says = prop_oneof![Just(Some(2_u8)), Just(Some(3)), Just(None)];
    (prop_oneof![Just(125_u32), 4_u32..40], gone, borders, says).prop_map(
        |(limit, missing, borders, says)| Fussy {
            limit,
            missing,
            borders,
            says,
        },
    )
}

#[test]
fn what_the_meter_gives_by_itself_arrives_whatever_it_refuses_beside_it() {
    runner(1200)
        .run(
            &(any_meter(), any_points(), any::<bool>(), 4_u16..=125),
            |(mut meter, points, read_holes, read_registers)| {
                let is_asked = |register: u32| {
                    let mut points = points.iter().map(|point| point.range);
                    points.any(|range| {
                        (u32::from(range.start().get())..range.end()).contains(&register)
                    })
                };
                if meter.says.is_none() {
                    meter.missing.retain(|register| !is_asked(*register));
                    meter.borders.retain(|border| {
                        let mut points = points.iter().map(|point| point.range);
                        !points.any(|range| {
                            u32::from(range.start().get()) < *border && *border < range.end()
                        })
                    });
                }
                let limits = Limits {
                    read_holes,
                    read_registers,
                    ..Limits::default()
                };
                let refused = points.iter().filter(|point| !meter.gives(point.range));
                let code = meter.says.unwrap_or_default();
                let refused = refused.map(|point| format!("{} exception:{code}\n", point.name));
                let expected = refused.collect::<Vec<_>>().concat();
                let mut run = Run::with(meter, &limits);
                for time in 0..4 {
                    let (row, _) = run.read(&points);
                    prop_assert_eq!(statuses(&points, &row), expected.as_str());
                    let requests = run.requests().len();
                    prop_assert!(time < 3 || requests <= points.len());
                }
                Ok(())
            },
        )
        .unwrap_or_else(|error| panic!("{error}"));
}

/// What a bad line does to an answer.
#[derive(Debug, Clone, Copy)]
enum Fault {
    None,
    Lost,
    /// It begins so many milliseconds after the request.
    Late(u64),
    Damaged,
    Truncated,
}

fn any_fault() -> impl Strategy<Value = Fault> {
    prop_oneof![
        6 => Just(Fault::None),
        1 => Just(Fault::Lost),
        // The client waits for late answers for as long again as its time-out.
        1 => (100_u64..1900).prop_map(Fault::Late),
        1 => Just(Fault::Damaged),
        1 => Just(Fault::Truncated),
    ]
}

#[test]
fn no_value_is_ever_wrong_on_a_bad_line() {
    let faults = prop::collection::vec(any_fault(), 1..40);
    runner(600)
        .run(
            &(any_meter(), any_points(), any::<bool>(), faults),
            |(meter, points, read_holes, faults)| {
                let limits = Limits {
                    read_holes,
                    ..Limits::default()
                };
                let mut faults = faults.into_iter().cycle();
                let answer = move |frame: &[u8]| {
                    let mut answer = meter.answer(frame);
                    for (delay, bytes) in &mut answer {
                        match faults.next() {
                            Some(Fault::Lost) => bytes.clear(),
                            Some(Fault::Late(late)) => *delay = Duration::from_millis(late),
                            Some(Fault::Damaged) => bytes[2] ^= 0x10,
                            Some(Fault::Truncated) => bytes.truncate(bytes.len() / 2),
                            Some(Fault::None) | None => {}
                        }
                    }
                    answer.retain(|(_, bytes)| !bytes.is_empty());
                    answer
                };
                let mut run = Run::on(answer, &limits);
                for _ in 0..3 {
                    let (row, _) = run.read(&points);
                    // It compares what is there with the truth.
                    statuses(&points, &row);
                }
                Ok(())
            },
        )
        .unwrap_or_else(|error| panic!("{error}"));
}
