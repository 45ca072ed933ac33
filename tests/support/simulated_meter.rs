//! `simulated_meter TTY`: the meters of the simulated line on a terminal: an EM24-DIN, unit 1, a
//! PM290, unit 2, an EM21, unit 3, and a PQM, unit 17.
//!
//! They answer until it is killed or the line hangs up, and then it ends with exit code 0. With a
//! pair of pseudo terminals any Modbus client can be tried on them.

use std::process::ExitCode;
use std::time::Duration;

use meterpoll::codec::length::{Direction, of_frame};
use meterpoll::sim::{Meter, SimulatedLine};
use meterpoll::transport::serial::Serial;
use meterpoll::transport::{Clock, LineSettings, SystemClock, Transport, TransportError};

/// How long the line may be silent inside a request: a little over t3.5 at 9600 baud.
const GAP: Duration = Duration::from_millis(5);

/// How long one wait for a request takes; it ends in no other way when there is none.
const PATIENCE: Duration = Duration::from_secs(1);

fn main() -> ExitCode {
    let Some(tty) = std::env::args().nth(1) else {
        eprintln!("usage: simulated_meter TTY");
        return ExitCode::from(2);
    };
    let mut line = match Serial::open(&tty, LineSettings::default()) {
        Ok(line) => line,
        Err(error) => {
            eprintln!("error: {error}");
            return ExitCode::from(3);
        }
    };
    serve(&mut line, &SimulatedLine::meters(0), &SystemClock::new());
    ExitCode::SUCCESS
}

/// Answers what comes over `line` until it is lost, and returns how it was lost.
pub(crate) fn serve(
    line: &mut dyn Transport,
    meters: &[Meter],
    clock: &dyn Clock,
) -> TransportError {
    let mut heard = Vec::new();
    loop {
        if let Err(lost) = turn(&mut heard, line, meters, clock) {
            return lost;
        }
    }
}

/// Hears some bytes or a gap, and answers the request that either of them has completed.
fn turn(
    heard: &mut Vec<u8>,
    line: &mut dyn Transport,
    meters: &[Meter],
    clock: &dyn Clock,
) -> Result<(), TransportError> {
    let mut chunk = [0; 256];
    let wait = if heard.is_empty() { PATIENCE } else { GAP };
    let count = line.receive(&mut chunk, wait)?;
    heard.extend_from_slice(&chunk[..count]);
    let request: Vec<u8> = match of_frame(heard, Direction::Request) {
        Some(length) if length <= heard.len() => heard.drain(..length).collect(),
        // The gap ends what has no known length, and what will never be whole.
        _ if count == 0 => std::mem::take(heard),
        _ => return Ok(()),
    };
    let now = clock.utc_now();
    let mut answers = meters.iter().map(|meter| meter.answer(&request, now));
    answers.try_for_each(|answer| match answer {
        Some(answer) => line.send(answer.as_bytes()),
        None => Ok(()),
    })
}
