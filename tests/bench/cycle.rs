//! How long it takes to read a meter on a paced line, beside the physical sum of the requests and
//! beside other ways of asking for the same points. Takes the path of a pty whose other end answers
//! at the pace of 9600 8N1, as `tests/bench/run` provides.

use std::sync::Arc;
use std::time::{Duration, Instant};

use meterpoll::client::{Client, Echo, Patience};
use meterpoll::codec::{AddressError, RegisterRange, Request, Unit, UnitRange};
use meterpoll::profile::plan::{Cost, Plan, Rules};
use meterpoll::profile::selector::{Reading, select};
use meterpoll::profile::{Limits, Point, builtin};
use meterpoll::transport::serial::Serial;
use meterpoll::transport::{Line, LineSettings, SystemClock, Timing};

const CYCLES: u32 = 5;

/// What a well-known logger fills at the most to merge two reads.
const FIXED_GAP: u32 = 50;

const TARGET: f64 = 1.02;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let Some(path) = std::env::args().nth(1).filter(|path| path.starts_with('/')) else {
        println!("cycle: skipped, no pty given");
        return Ok(());
    };
    let settings = LineSettings::default();
    let serial = Serial::open(&path, settings)?;
    let clock = Arc::new(SystemClock::new());
    let line = Line::new(Box::new(serial), clock, Timing::Paced(settings))?;
    let mut client = Client::new(line, Echo::Auto);
    let profile = builtin::find("pqm").ok_or("no PQM")?.profile();
    let limits = &profile.limits;
    let cost = Cost::new(settings, limits.pause, limits.typical_answer);
    for what in ["@default", "*"] {
        let reading = Reading {
            profile: Some(&profile),
            ..Reading::default()
        };
        let points = select(&[what.to_owned()], reading)?;
        let plan = Plan::new(&points, limits.read_function(), &Rules::of(&profile), cost);
        let ours: Vec<RegisterRange> = plan.reads.iter().map(|read| read.range).collect();
        for (name, reads) in [
            ("one request a point", singly(&points)),
            ("a fixed gap of 50 registers", merged(&points, limits)?),
            ("the plan", ours),
        ] {
            let physical: Duration = reads.iter().map(|read| cost.of(read.count())).sum();
            print!(
                "{:<12} {name:<28} {:>4} requests  line time {:>9.1} ms",
                format!("pqm {what}"),
                reads.len(),
                milliseconds(physical),
            );
            if what == "@default" {
                let took = cycle(&mut client, limits, &reads)?;
                let ratio = took.as_secs_f64() / physical.as_secs_f64();
                print!(
                    "  measured {:>9.1} ms  ratio {ratio:.4}",
                    milliseconds(took)
                );
                if name == "the plan" {
                    let verdict = if ratio <= TARGET { "met" } else { "MISSED" };
                    print!("  target {TARGET}: {verdict}");
                }
            }
            println!();
        }
    }
    Ok(())
}

/// Each point by itself.
fn singly(points: &[Point]) -> Vec<RegisterRange> {
    points.iter().map(|point| point.range).collect()
}

/// Whatever lies up to a fixed gap apart in one request, from the first register on.
fn merged(points: &[Point], limits: &Limits) -> Result<Vec<RegisterRange>, AddressError> {
    let mut ranges: Vec<RegisterRange> = singly(points);
    ranges.sort_unstable();
    let mut reads: Vec<RegisterRange> = Vec::new();
    for range in ranges {
        let start = u32::from(range.start().get());
        if let Some(last) = reads.last_mut()
            && start <= last.end() + FIXED_GAP
        {
            let end = last.end().max(range.end());
            let count = u16::try_from(end - u32::from(last.start().get()));
            if let Ok(count) = count
                && count <= limits.read_registers
            {
                *last = RegisterRange::new(last.start().get(), count)?;
                continue;
            }
        }
        reads.push(range);
    }
    Ok(reads)
}

/// The mean time of some cycles after one to warm up.
fn cycle(
    client: &mut Client,
    limits: &Limits,
    reads: &[RegisterRange],
) -> Result<Duration, Box<dyn std::error::Error>> {
    let unit = Unit::new(1, UnitRange::Standard)?;
    let mut once = || {
        reads.iter().try_for_each(|range| {
            let request = Request::Read {
                function: limits.read_function(),
                range: *range,
            };
            let answer = client.request(unit, &request, Patience::default());
            answer.map(drop)
        })
    };
    once()?;
    let start = Instant::now();
    for _ in 0..CYCLES {
        once()?;
    }
    Ok(start.elapsed() / CYCLES)
}

fn milliseconds(time: Duration) -> f64 {
    time.as_secs_f64() * 1000.0
}
