//! What it costs to know what to send: unpacking each built-in meter and planning what is read
//! when nothing is named, and planning 800 points.

use std::hint::black_box;
use std::time::{Duration, Instant};

use meterpoll::codec::value::{ByteOrder, RegisterType};
use meterpoll::codec::{AddressError, ReadFunction, RegisterRange};
use meterpoll::profile::plan::{Cost, Plan, Rules};
use meterpoll::profile::selector::{Reading, select};
use meterpoll::profile::{Limits, Point, builtin};
use meterpoll::transport::LineSettings;

const RUNS: usize = 2000;
const WARM_UP: usize = 200;

const UNPACKED: Duration = Duration::from_micros(500);
const PLANNED: Duration = Duration::from_millis(1);

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for meter in builtin::all() {
        let found = measure(|| {
            let profile = meter.profile();
            let reading = Reading {
                profile: Some(&profile),
                ..Reading::default()
            };
            let points = select(&[], reading).unwrap_or_default();
            let rules = Rules::of(&profile);
            let limits = &profile.limits;
            let cost = Cost::new(profile.line, limits.pause, limits.typical_answer);
            black_box(Plan::new(&points, limits.read_function(), &rules, cost));
        });
        report(
            &format!("unpack {} and plan @default", meter.name),
            &found,
            UNPACKED,
        );
    }
    for Layout {
        what,
        points,
        limits,
    } in layouts()?
    {
        let rules = Rules::new(&limits);
        let found = measure(|| {
            let settings = LineSettings::default();
            let cost = Cost::new(settings, limits.pause, limits.typical_answer);
            let function = ReadFunction::HoldingRegisters;
            black_box(Plan::new(black_box(&points), function, &rules, cost));
        });
        report(
            &format!("plan {} points, {what}", points.len()),
            &found,
            PLANNED,
        );
    }
    Ok(())
}

/// 800 points somewhere.
struct Layout {
    what: &'static str,
    points: Vec<Point>,
    limits: Limits,
}

/// Without a hole between them, and with holes and points that must be alone.
fn layouts() -> Result<[Layout; 3], AddressError> {
    let point = |start| {
        let range = RegisterRange::new(start, 1)?;
        Ok(Point::raw(range, RegisterType::U16, ByteOrder::Abcd))
    };
    let contiguous = (0..800).map(point).collect::<Result<Vec<_>, _>>()?;
    let mut scattered = (0..800)
        .map(|index| point(index + index / 7 + index / 31))
        .collect::<Result<Vec<_>, _>>()?;
    let mut fenced = scattered.clone();
    for alone in fenced.iter_mut().step_by(9) {
        alone.alone = true;
    }
    // What comes first in the list need not come first on the line.
    scattered.reverse();
    let with_holes = Limits {
        read_holes: true,
        typical_answer: Duration::from_millis(40),
        ..Limits::default()
    };
    let layout = |what, points, limits: &Limits| Layout {
        what,
        points,
        limits: limits.clone(),
    };
    Ok([
        layout("no hole", contiguous, &Limits::default()),
        layout("holes", scattered, &with_holes),
        layout("holes, every 9th alone", fenced, &with_holes),
    ])
}

/// Times of many runs after some to warm up, the fastest first.
fn measure(mut run: impl FnMut()) -> Vec<Duration> {
    for _ in 0..WARM_UP {
        run();
    }
    let mut times: Vec<Duration> = (0..RUNS)
        .map(|_| {
            let start = Instant::now();
            run();
            start.elapsed()
        })
        .collect();
    times.sort_unstable();
    times
}

fn report(what: &str, times: &[Duration], target: Duration) {
    let at = |share: usize| times[(times.len() - 1) * share / 100];
    let us = |time: Duration| time.as_secs_f64() * 1e6;
    let verdict = if at(50) <= target { "met" } else { "MISSED" };
    println!(
        "{what:<40} best {:>7.1} us  median {:>7.1} us  p99 {:>7.1} us  target {:>6.1} us: {verdict}",
        us(at(0)),
        us(at(50)),
        us(at(99)),
        us(target)
    );
}
