//! The soak: many reads on many lines that lie, on real pseudo terminals, and each value is looked
//! at. At the other end of each line is a meter that holds something else in every register of every
//! unit, so that any mix-up shows.
//!
//! `cargo bench --bench soak -- --transactions 20000 --faults 0.3 --seed 7 --lines 32`
//!
//! A transaction is a request on a line and what comes of it; so many of them, in all, are spoiled as
//! the rate says. The same seed gives the same questions on each line, and to the n-th request on it
//! the same fault; times differ, so that now and then a request is sent once more or less.
//!
//! Exit code 1 when a wrong value was believed, when a line did not read right after its faults were
//! over, or when memory or descriptors grew; 2 when the options are wrong.
//!
//! # Nobody is blamed for what the machine does
//!
//! On a loaded machine any thread can be held up, for longer than the time-out of 20 ms. What that
//! could spoil, and why it does not:
//!
//! * *The meter.* The client promises not to believe an answer to something else that comes within
//!   twice the time-out, and one that comes later can be believed by right. So the meter must never be
//!   later than it means to be: it does not hear a request that it finds too long after the client
//!   has sent it, and does not write an answer that it finds too long after it was due (see
//!   [`meter`]). Both then look like silence, and are counted as withheld.
//! * *The meter between its look at the clock and the end of its write, and the kernel between that
//!   and the client.* Nothing can keep an answer from being late there. But the client's side can prove
//!   that it was: when the port was found empty more than the promised time after the request, and the
//!   answer came after that, then it came too late, and it counts as excused and not as wrong (see
//!   [`wire`]). The proof rests on nothing but one clock and what the client itself was given, so no
//!   answer that the client was given in time is ever excused. A client that does not wait as long as
//!   it promises, or does not look before it asks, is never excused either, for the port was not found
//!   empty then. On lines where answers can be told apart however late they are, by alternating
//!   functions and by loop-backs, late answers are no excuse.
//! * *The client.* It counts its own waiting from after its write, so being held up makes it wait
//!   longer. Answers that arrive meanwhile are at the port when it looks, and it looks before each
//!   request. An answer that it finds only after its time-out is missing, which is no error; only a
//!   read after faults has to succeed, and it has several attempts at that.

#[cfg(unix)]
mod check;
#[cfg(unix)]
mod line;
#[cfg(unix)]
mod meter;
#[cfg(unix)]
mod options;
#[cfg(unix)]
mod process;
#[cfg(unix)]
mod readings;
#[cfg(unix)]
mod tally;
#[cfg(unix)]
mod truth;
#[cfg(unix)]
mod wire;

#[cfg(unix)]
#[path = "../support/pty.rs"]
mod pty;
#[cfg(unix)]
#[path = "../support/truthful.rs"]
mod truthful;

#[cfg(unix)]
fn main() -> std::process::ExitCode {
    use std::process::ExitCode;

    match options::Options::parse(std::env::args().skip(1)) {
        Ok(options) if run(&options) => ExitCode::SUCCESS,
        Ok(_) => ExitCode::from(1),
        Err(error) => {
            eprintln!("error: {error}");
            eprintln!("usage: soak [--transactions N] [--faults RATE] [--seed N] [--lines N]");
            ExitCode::from(2)
        }
    }
}

#[cfg(not(unix))]
fn main() {
    println!("soak: skipped, no pseudo terminals here");
}

/// Runs all lines and prints what came of it; whether all is well.
#[cfg(unix)]
fn run(options: &options::Options) -> bool {
    use std::sync::Arc;
    use std::thread;
    use std::time::Duration;

    use meterpoll::transport::{Clock, SystemClock};

    /// By then the lines are all at work, and what they need has been allocated.
    const WARM_UP: Duration = Duration::from_secs(2);
    const LOOK: Duration = Duration::from_millis(100);
    /// So often a long run says how far it is.
    const WORD: Duration = Duration::from_secs(60);

    let before = process::Usage::now();
    let clock: Arc<dyn Clock> = Arc::new(SystemClock::new());
    let lines: Vec<_> = (0..options.lines)
        .map(|number| {
            let plan = options.line(number);
            let clock = Arc::clone(&clock);
            thread::spawn(move || line::run(&plan, &clock))
        })
        .collect();
    let mut usage = process::Growth::since(before, options.lines);
    let mut next_word = WORD;
    while !lines.iter().all(thread::JoinHandle::is_finished) {
        thread::sleep(LOOK);
        if clock.now() >= WARM_UP {
            usage.look();
        }
        if clock.now() >= next_word {
            let running = lines.iter().filter(|line| !line.is_finished()).count();
            let (minutes, memory) = (next_word.as_secs() / 60, usage.resident_kib());
            eprintln!("{minutes} min: {running} lines at work, {memory} KiB");
            next_word += WORD;
        }
    }
    let mut tally = tally::Tally::default();
    for line in lines {
        match line.join() {
            Ok(of_line) => tally.add(&of_line),
            Err(_) => tally.broken += 1,
        }
    }
    let usage = usage.end();
    println!("{options}");
    println!("{tally}");
    println!("{usage}");
    println!("seconds        {:.1}", clock.now().as_secs_f64());
    let is_well = tally.is_well() && usage.is_well();
    println!("{}", if is_well { "all well" } else { "FAILED" });
    is_well
}
