//! What `poll` costs and how well it keeps its times: many lines at once, a cycle beside its plan, a
//! run as from cron, the period beside a slow meter (and mbpoll's, where that is installed), and a
//! day on a clock that costs no time.
//!
//! Times are taken at the meters' end of the lines, so what the machine takes to wake a meter up is
//! in them as well. Targets are printed beside the results; none of them fails it.

mod paced;
mod process;
#[path = "../support/pty.rs"]
mod pty;
mod rows;
#[path = "../support"]
mod support {
    pub(crate) mod clock;
    pub(crate) mod polled;
}

use std::error::Error;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::{Duration, Instant};

use meterpoll::output::polling::Board;
use meterpoll::polling::{Event, LineLoop, Tally, Watch};
use meterpoll::profile::plan::Cost;
use meterpoll::transport::{Clock, LineSettings};

use paced::{Meters, Pace};
use process::{Watched, resident_kib};
use support::polled::{job, noon, seconds, switched};

/// What the standard and the line itself take for ten registers of one meter at 9600 8N1.
fn exchange() -> Duration {
    Cost::new(LineSettings::default(), Duration::ZERO, Duration::ZERO).of(10)
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("bench_polling");
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder)?;
    many_lines(&folder)?;
    periods(&folder)?;
    from_cron(&folder)?;
    a_day();
    std::fs::remove_dir_all(&folder)?;
    Ok(())
}

/// A result beside its target.
fn verdict(what: &str, found: f64, unit: &str, target: f64) {
    let verdict = if found <= target { "met" } else { "MISSED" };
    println!("  {what:52}{found:10.3} {unit:4} target {target} {unit}: {verdict}");
}

fn milliseconds(time: Duration) -> f64 {
    time.as_secs_f64() * 1000.0
}

/// The one of which `percent` of all are no greater.
fn rank(times: &mut [Duration], percent: usize) -> f64 {
    times.sort_unstable();
    let index = (times.len() * percent).div_ceil(100).saturating_sub(1);
    times.get(index).copied().map_or(f64::NAN, milliseconds)
}

/// From the first request of a cycle to the fourth, the median beside what was planned: three
/// exchanges.
fn beside_the_plan(cycles: &mut [Duration]) -> f64 {
    rank(cycles, 50) / milliseconds(3 * exchange())
}

/// 64 lines of 4 meters each, every second.
fn many_lines(folder: &Path) -> Result<(), Box<dyn Error>> {
    const LINES: usize = 64;
    const SECONDS: u64 = 20;
    println!("{LINES} lines of 4 meters each at 9600 8N1, every 1s for {SECONDS} s:");
    let lines: Vec<Meters> = (0..LINES).map(|_| Meters::new(Pace::Line)).collect();
    let site = folder.join("site.toml");
    std::fs::write(&site, rows::site(lines.iter().map(Meters::path)))?;
    let poll = Watched::start(folder, &["poll", "--config", "site.toml"])?;
    thread::sleep(Duration::from_secs(SECONDS));
    let usage = poll.usage();
    let took = poll.stop()?;
    // A slot is a round second, and the first meter of a line has nobody to wait for.
    let mut late: Vec<Duration> = lines.iter().flat_map(Meters::lateness).collect();
    println!(
        "  {:52}{:10}",
        "slots, the first meter of each line",
        late.len()
    );
    verdict("a slot begins late, p99", rank(&mut late, 99), "ms", 20.0);
    verdict("  at the most", rank(&mut late, 100), "ms", 20.0);
    let mut cycles: Vec<Duration> = lines.iter().flat_map(Meters::cycles).collect();
    let ratio = beside_the_plan(&mut cycles);
    println!(
        "  {:52}{ratio:10.3}",
        "a cycle's time / what was planned, median"
    );
    if let Some(usage) = usage {
        verdict("peak resident memory", usage.peak_mib, "MiB", 16.0);
        let share = usage.busy.as_secs_f64() / took.as_secs_f64() * 100.0;
        verdict("of one core", share, "%", 10.0);
    }
    rows::check(&folder.join("log.csv"))?;
    println!();
    Ok(())
}

/// The period with a meter that takes 50 ms.
fn periods(folder: &Path) -> Result<(), Box<dyn Error>> {
    const CYCLES: u64 = 20;
    println!("every 1s with a meter that takes 50 ms, {CYCLES} cycles:");
    let slow = || Meters::new(Pace::Takes(Duration::from_millis(50)));
    let (ours, theirs) = (slow(), slow());
    let poll = ["poll", "-p", ours.path(), "-a", "1", "0x0000+10"];
    let file = ["--every", "1s", "-o", "period.csv"];
    let poll = Watched::start(folder, &[poll.as_slice(), &file].concat())?;
    let paced = Meters::new(Pace::Line);
    let four = ["poll", "-p", paced.path(), "-a", "1-4", "0x0000+10"];
    let file = ["--every", "1s", "-o", "cycle.csv"];
    let four = Watched::start(folder, &[four.as_slice(), &file].concat())?;
    let line = "-m rtu -a 1 -b 9600 -P none -0 -r 0 -c 10 -l 1000 -q".split(' ');
    let mbpoll = std::process::Command::new("mbpoll")
        .args(line)
        .arg(theirs.path())
        .stdin(std::process::Stdio::null())
        .stdout(std::process::Stdio::null())
        .stderr(std::process::Stdio::null())
        .spawn();
    thread::sleep(Duration::from_millis(CYCLES * 1060 + 1000));
    poll.stop()?;
    four.stop()?;
    let spread = |name: &str, meters: &Meters| {
        let periods = meters.periods(usize::try_from(CYCLES).unwrap_or(usize::MAX));
        let sum: Duration = periods.iter().sum();
        let count = u32::try_from(periods.len()).unwrap_or(1).max(1);
        let of = |found: Option<&Duration>| found.map_or(f64::NAN, Duration::as_secs_f64);
        println!(
            "  {name:10} mean {:.4} s, {:.4} to {:.4} s, {count} periods",
            (sum / count).as_secs_f64(),
            of(periods.iter().min()),
            of(periods.iter().max()),
        );
        let off = periods.iter().map(|period| {
            let second = Duration::from_secs(1);
            milliseconds(period.abs_diff(second))
        });
        off.fold(0.0, f64::max)
    };
    let off = spread("meterpoll", &ours);
    verdict("off by, at the most", off, "ms", 5.0);
    match mbpoll {
        Ok(mut child) => {
            child.kill()?;
            child.wait()?;
            spread("mbpoll", &theirs);
        }
        Err(_) => println!("  mbpoll     not installed"),
    }
    println!("meanwhile four meters on a line at 9600 8N1:");
    let ratio = beside_the_plan(&mut paced.cycles());
    verdict("a cycle's time / what was planned, median", ratio, "", 1.02);
    println!();
    Ok(())
}

/// A run as from cron.
fn from_cron(folder: &Path) -> Result<(), Box<dyn Error>> {
    const RUNS: usize = 50;
    println!("one run as from cron, ten registers at 9600 8N1, {RUNS} times:");
    let meters = Meters::new(Pace::Line);
    let poll = ["poll", "-p", meters.path(), "-a", "1", "0x0000+10"];
    for (name, besides) in [
        ("to stdout", ["--once", "-q"].as_slice()),
        (
            "to a file, --no-sync",
            &["--once", "-o", "cron.csv", "--no-sync"],
        ),
        ("to a file", &["--once", "-o", "cron.csv"]),
    ] {
        let arguments = [poll.as_slice(), besides].concat();
        let mut times = Vec::new();
        for _ in 0..RUNS {
            let start = Instant::now();
            process::run(folder, &arguments)?;
            times.push(start.elapsed());
        }
        let p99 = rank(&mut times, 99);
        verdict(&format!("{name}, median"), rank(&mut times, 50), "ms", 50.0);
        println!("  {:52}{p99:10.3} ms", "  p99");
    }
    let wire = milliseconds(exchange());
    println!("  {:52}{wire:10.3} ms\n", "of which the wire takes");
    Ok(())
}

/// A day of one line on the fake clock.
fn a_day() {
    println!("a day of four meters, every 1s, on a clock that costs no time:");
    let clock = noon();
    let jobs = [
        job("em24", 1, &["frequency"], seconds(1)),
        job("pm290", 2, &["frequency"], seconds(1)),
        job("em21", 3, &["frequency"], seconds(1)),
        job("pqm", 17, &["frequency"], seconds(1)),
    ];
    let site = rows::on_one_line(jobs.to_vec());
    let (mut board, mut tally, mut watch) = (Board::new(&site), Tally::default(), Watch::default());
    let mut after_an_hour = None;
    let mut rows = 0_u64;
    let mut deliver = |event| {
        if let Event::Cycle(cycle) = event {
            rows += 1;
            tally.add(&cycle);
            board.heed(&cycle);
            drop(watch.heed(&cycle));
            if after_an_hour.is_none() && cycle.slot.due >= seconds(3600) {
                after_an_hour = resident_kib("self");
            }
        }
    };
    let start = Instant::now();
    let mut open = || Ok(switched(&clock, Vec::new()));
    let stop = || clock.now() >= seconds(24 * 3600);
    LineLoop::new(jobs.iter().enumerate(), &*clock, &mut open).endless(&stop, &mut deliver);
    let took = start.elapsed().as_secs_f64();
    let complete: u64 = (0..jobs.len()).map(|job| tally.of(job).complete).sum();
    println!("  {:52}{rows:10}, {complete} of them complete", "rows");
    verdict("time", took, "s", 60.0);
    if let (Some(before), Some(after)) = (after_an_hour, resident_kib("self")) {
        let grown = after.saturating_sub(before);
        verdict(
            "memory grows after the first hour by",
            f64::from(grown),
            "KiB",
            256.0,
        );
    }
}
