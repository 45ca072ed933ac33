//! Meters on a pty that keep the pace of a real line and note when each request came.

use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant, SystemTime};

use meterpoll::transport::LineSettings;

use crate::pty::{PtyMeter, answer};

/// When an answer is there.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Pace {
    /// When request, 3.5 characters of silence and answer have had their time at 9600 8N1.
    Line,
    /// So long after the request.
    Takes(Duration),
}

/// A request: to which unit, when, and what the wall clock showed, since 1970.
#[derive(Debug, Clone, Copy)]
struct Asked {
    unit: u8,
    at: Instant,
    wall: Duration,
}

/// Units 1 to 4 on one pty.
pub(crate) struct Meters {
    pty: PtyMeter,
    asked: Arc<Mutex<Vec<Asked>>>,
}

impl Meters {
    pub(crate) fn new(pace: Pace) -> Self {
        let asked = Arc::new(Mutex::new(Vec::new()));
        let notes = Arc::clone(&asked);
        let pty = PtyMeter::new(Box::new(move |request| {
            let at = Instant::now();
            let wall = SystemTime::UNIX_EPOCH.elapsed().unwrap_or_default();
            let unit = request.first().copied().unwrap_or_default();
            let answer = (1..=4).find_map(|unit| answer(unit, request));
            let answer = answer.unwrap_or_default();
            notes.lock().unwrap().push(Asked { unit, at, wall });
            let takes = match pace {
                Pace::Takes(time) => time,
                Pace::Line => on_the_wire(request.len() + answer.len()),
            };
            thread::sleep((at + takes).saturating_duration_since(Instant::now()));
            answer
        }));
        Self { pty, asked }
    }

    /// The path a client opens.
    pub(crate) fn path(&self) -> &str {
        self.pty.path()
    }

    fn asked(&self) -> Vec<Asked> {
        self.asked.lock().unwrap().clone()
    }

    /// How long after a round second each request to unit 1 came.
    pub(crate) fn lateness(&self) -> Vec<Duration> {
        // The wall clock is set by some microseconds all the time, and a request may so seem early.
        let early = Duration::from_millis(990);
        let second = |wall: Duration| {
            let behind = Duration::from_nanos(u64::from(wall.subsec_nanos()));
            if behind < early {
                behind
            } else {
                Duration::ZERO
            }
        };
        let asked = self.asked().into_iter().filter(|asked| asked.unit == 1);
        asked.map(|asked| second(asked.wall)).collect()
    }

    /// From each request to unit 1 to the one to unit 4 behind it.
    pub(crate) fn cycles(&self) -> Vec<Duration> {
        let asked = self.asked();
        let cycles = asked.chunks(4).filter_map(|cycle| match cycle {
            [first, _, _, last] => Some(last.at.duration_since(first.at)),
            _ => None,
        });
        cycles.collect()
    }

    /// From each request to the next, so many at the most.
    pub(crate) fn periods(&self, most: usize) -> Vec<Duration> {
        let asked = self.asked();
        let periods = asked.windows(2).take(most);
        periods
            .map(|pair| pair[1].at.duration_since(pair[0].at))
            .collect()
    }
}

/// So many characters at 9600 8N1, and 3.5 of silence between request and answer.
fn on_the_wire(characters: usize) -> Duration {
    let settings = LineSettings::default();
    settings.transfer_time(characters) + settings.silence()
}
