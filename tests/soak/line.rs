//! One line: a client that asks, a meter that lies, and what comes of it.

use std::io::Write;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::thread;
use std::time::Duration;

use fastrand::Rng;
use meterpoll::client::{Client, Echo, QueryData, Ways};
use meterpoll::transport::serial::Serial;
use meterpoll::transport::{Clock, FaultScript, Line, LineSettings, Timing};

use crate::check::{Outcome, Raw, TIMEOUT};
use crate::meter::{Nature, RunningMeter, Stalls};
use crate::readings::{self, Readings};
use crate::tally::Tally;
use crate::truth::{Registers, UNITS, unit};
use crate::wire::{Watched, Wire};

/// So many questions are asked until the line is closed and opened again.
const SESSION: u64 = 400;

/// After so many questions the faults stop, and the line must read right again.
const CHECK: u64 = 40;

/// So many reads are tried then: on a busy machine one can fail that no fault has hit.
const READS: u64 = 3;

/// Reads during which the meter was late itself do not count among these; of those there are so many.
const DISTURBED_READS: u64 = 50;

/// An answer to something else must not be believed that comes this long after the request: twice
/// the time-out, and 32 ms for adapters.
const PROMISED: Duration = TIMEOUT
    .saturating_mul(2)
    .saturating_add(Duration::from_millis(32));

/// So much of what goes wrong on one line is told in full, with so many events.
const TOLD: u64 = 3;
const EVENTS: usize = 80;

/// What is known of the meter, and what it does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Raw registers, of which nothing is known.
    Unknown,
    /// Raw registers; either function reads them, and there is a loop-back. The line does not echo now
    /// and then: once a client has heard an echo it takes the answers to loop-backs for echoes, and
    /// does without a unit that it needs one of, for as long as it remembers late answers.
    Known,
    /// The same, and it stalls: no answer may be mistaken however late. What that rests on is not
    /// spoiled: that an answer bears its unit and function, and that loop-backs are answered.
    Stalling,
    /// Points of a profile.
    Profile,
}

impl Kind {
    pub(crate) const ALL: [Self; 4] = [Self::Unknown, Self::Known, Self::Stalling, Self::Profile];

    fn ways(self) -> Ways {
        match self {
            Self::Unknown => Ways::default(),
            Self::Known | Self::Stalling => Ways {
                interchangeable_reads: true,
                loopback: Some(QueryData::Any),
            },
            Self::Profile => readings::WAYS,
        }
    }

    fn registers(self) -> Registers {
        match self {
            Self::Unknown => Registers::Apart,
            Self::Known | Self::Stalling => Registers::Shared,
            Self::Profile => readings::REGISTERS,
        }
    }

    /// What is spoiled, at this rate.
    fn rules(self, rate: f64) -> Vec<String> {
        let timeout = humantime(TIMEOUT);
        match self {
            Self::Stalling => [3, 4]
                .map(|function| {
                    let without = "echo+echo-only+wrong-unit+stranger+wrong-function";
                    format!(
                        "any,rate={rate},timeout={timeout},function={function},without={without}"
                    )
                })
                .into(),
            Self::Known => {
                vec![format!(
                    "any,rate={rate},timeout={timeout},without=echo+echo-only"
                )]
            }
            Self::Unknown | Self::Profile => vec![format!("any,rate={rate},timeout={timeout}")],
        }
    }

    fn stalls(self) -> Option<Stalls> {
        // Beyond what is waited for, which is 72 ms; long enough that both functions and the loop-back
        // meet silence in one, and more than once.
        (self == Self::Stalling).then_some(Stalls {
            rate: 0.01,
            shortest: TIMEOUT * 4,
            longest: TIMEOUT * 30,
            apart: TIMEOUT * 10,
        })
    }
}

/// How fast the line is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Pace {
    /// 115200 baud, with its silences.
    Fast,
    /// As fast as it goes, without any silence in which noise would be seen.
    None,
}

impl Pace {
    const SETTINGS: LineSettings = LineSettings {
        baud: 115_200,
        parity: meterpoll::transport::Parity::None,
        stop_bits: meterpoll::transport::StopBits::One,
    };

    const fn timing(self) -> Timing {
        match self {
            Self::Fast => Timing::Paced(Self::SETTINGS),
            Self::None => Timing::Unpaced,
        }
    }
}

/// What one line has to do.
#[derive(Debug, Clone)]
pub(crate) struct Plan {
    pub(crate) number: u64,
    pub(crate) seed: u64,
    pub(crate) transactions: u64,
    pub(crate) faults: f64,
    pub(crate) kind: Kind,
    pub(crate) pace: Pace,
}

/// What asks.
enum Asker {
    Raw(Raw),
    Profile(Box<Readings>),
}

/// A line at work.
struct Work<'a> {
    plan: &'a Plan,
    clock: &'a Arc<dyn Clock>,
    wire: Arc<Wire>,
    meter: RunningMeter,
    asker: Asker,
    /// Asks in the place of a raw asker when the faults are over.
    checker: Raw,
    chance: Rng,
    check_chance: Rng,
    tally: Tally,
}

/// Runs a line until its transactions are done.
pub(crate) fn run(plan: &Plan, clock: &Arc<dyn Clock>) -> Tally {
    let Plan { kind, .. } = *plan;
    let script = FaultScript::parse(kind.rules(plan.faults)).expect("rules that are right");
    let wire = Arc::new(Wire::default());
    let nature = Nature {
        registers: kind.registers(),
        script,
        stalls: kind.stalls().filter(|_| plan.faults > 0.0),
        seed: plan.seed,
    };
    let mut work = Work {
        plan,
        clock,
        meter: RunningMeter::start(nature, &wire, clock),
        wire,
        asker: match kind {
            Kind::Profile => Asker::Profile(Box::new(Readings::new())),
            _ => Asker::Raw(Raw::new(kind.registers(), kind.ways())),
        },
        checker: Raw::new(kind.registers(), kind.ways()),
        chance: Rng::with_seed(!plan.seed),
        check_chance: Rng::with_seed(plan.seed.rotate_left(32)),
        tally: Tally::default(),
    };
    while !work.is_done() {
        work.session();
    }
    let counts = work.meter.counts();
    work.tally.add_faults(&counts);
    let mishaps = &work.meter.mishaps;
    work.tally.stalls += mishaps.stalls.load(Ordering::Relaxed);
    work.tally.withheld += mishaps.withheld.load(Ordering::Relaxed);
    work.tally
}

impl Work<'_> {
    fn is_done(&self) -> bool {
        self.tally.broken > 0 || self.meter.counts().requests >= self.plan.transactions
    }

    /// Opens the line, asks for a while, and closes it as the program does.
    fn session(&mut self) {
        self.tally.sessions += 1;
        let port = Serial::open(&self.meter.path, Pace::SETTINGS).expect("a pty that is free");
        let watched = Watched::new(port, Arc::clone(&self.wire), Arc::clone(self.clock));
        let timing = self.plan.pace.timing();
        let line = Line::new(Box::new(watched), Arc::clone(self.clock), timing);
        let mut client = Client::new(line.expect("a port that is there"), Echo::Auto);
        if let Asker::Profile(readings) = &mut self.asker {
            readings.forget();
        }
        for question in 1..=SESSION {
            self.ask(&mut client);
            if question % CHECK == 0 || self.is_done() {
                self.check(&mut client);
            }
            if self.is_done() {
                break;
            }
        }
        for number in UNITS {
            self.tally.add_client(client.counters(unit(number)));
        }
        // What is held back in a stall no client that is just opened can know of; the check before
        // has seen to it that nothing is.
        if client.finish().is_err() {
            self.tally.broken += 1;
        }
    }

    /// Asks something, and counts what comes of it.
    fn ask(&mut self, client: &mut Client) {
        self.tally.questions += 1;
        let start = self.clock.now();
        let outcomes = match &mut self.asker {
            Asker::Raw(raw) => vec![raw.ask(client, &mut self.chance)],
            Asker::Profile(readings) => readings.ask(client, &mut self.chance, false),
        };
        self.judge(start, &outcomes);
    }

    /// The faults are over: the line must read right. They begin again behind it.
    fn check(&mut self, client: &mut Client) {
        let mut failed = 0;
        let mut is_right = false;
        for _ in 0..READS + DISTURBED_READS {
            self.rest();
            let withheld = self.meter.withheld();
            let start = self.clock.now();
            // Of its own chance: what is asked besides does not depend on how often this is.
            let outcomes = match &mut self.asker {
                Asker::Raw(_) => vec![self.checker.ask(client, &mut self.check_chance)],
                Asker::Profile(readings) => readings.ask(client, &mut self.check_chance, true),
            };
            let is_disturbed = self.meter.withheld() != withheld || !self.wire.is_idle();
            self.judge(start, &outcomes);
            is_right = outcomes
                .iter()
                .all(|outcome| matches!(outcome, Outcome::Right));
            if is_right {
                break;
            }
            failed += u64::from(!is_disturbed);
            if failed == READS {
                break;
            }
            if is_disturbed {
                thread::sleep(TIMEOUT);
            }
        }
        let recoveries = &mut self.tally.recoveries;
        match (is_right, failed) {
            (true, 0) => recoveries.first += 1,
            (true, _) => recoveries.later += 1,
            (false, READS) => {
                recoveries.never += 1;
                self.tell("did not read right after its faults", "");
            }
            (false, _) => recoveries.untold += 1,
        }
        self.wire.be_true(false);
    }

    /// Waits until nothing is on its way any more, and nothing new goes wrong.
    fn rest(&self) {
        self.wire.be_true(true);
        while !self.wire.is_idle() {
            thread::sleep(Duration::from_millis(1));
        }
    }

    fn judge(&mut self, start: Duration, outcomes: &[Outcome]) {
        for outcome in outcomes {
            self.tally.add_outcome(outcome);
        }
        let mut wrong = outcomes.iter().filter_map(|outcome| match outcome {
            Outcome::Wrong {
                place,
                expected,
                found,
            } => Some(format!("{place}\nexpected {expected}\nfound    {found}")),
            _ => None,
        });
        let Some(first) = wrong.next() else {
            return;
        };
        let count = 1 + wrong.count() as u64;
        let registers = self.plan.kind.registers();
        // Where answers can be told apart however late they are, being late is no excuse.
        let is_excused =
            self.plan.kind != Kind::Stalling && self.wire.was_too_late(start, PROMISED, registers);
        let what = if is_excused {
            self.tally.excused += count;
            "believed what came too late"
        } else {
            self.tally.wrong += count;
            "WRONG"
        };
        self.tell(what, &first);
        // What follows from it is over by then.
        let was_true = self.wire.is_true();
        self.rest();
        thread::sleep(PROMISED);
        self.wire.be_true(was_true);
    }

    /// Says what happened, with the last that went over the line.
    fn tell(&self, what: &str, detail: &str) {
        let Tally { wrong, excused, .. } = self.tally;
        if wrong + excused + self.tally.recoveries.never > TOLD {
            return;
        }
        let Plan {
            number,
            seed,
            kind,
            pace,
            ..
        } = self.plan;
        let now = self.clock.now().as_secs_f64() * 1000.0;
        let mut out = std::io::stdout().lock();
        // Where nobody reads what is printed, the exit code tells.
        let _ = writeln!(
            out,
            "line {number} ({kind:?}, pace {pace:?}, seed {seed}) {what} at {now:.3} ms\n{detail}"
        );
        let events = self.wire.events();
        for event in &events[events.len().saturating_sub(EVENTS)..] {
            let _ = writeln!(out, "    {event}");
        }
    }
}

/// A time as fault rules take it.
fn humantime(time: Duration) -> String {
    format!("{}ms", time.as_millis())
}
