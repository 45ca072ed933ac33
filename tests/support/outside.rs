//! Clients whose every byte was written down before, on a fake clock.

#![allow(dead_code, reason = "each test file uses its share")]

use std::collections::VecDeque;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use meterpoll::sim::server::{Framing, Server, Service, State};
use meterpoll::sim::{Meter, SimulatedLine};
use meterpoll::transport::faulty::FaultScript;
use meterpoll::transport::{
    Afterwards, ClientId, Clock, Heard, OpenError, Outside, TransportError,
};

use super::clock::FakeClock;

/// What happened: when, in milliseconds, to which client.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Seen {
    Said(u64, u64, Vec<u8>),
    HungUp(u64, u64),
}

/// What comes from outside, and when.
pub(crate) struct ScriptedOutside {
    clock: Arc<FakeClock>,
    script: VecDeque<(Duration, Heard)>,
    seen: Arc<Mutex<Vec<Seen>>>,
    afterwards: Afterwards,
}

impl ScriptedOutside {
    fn note(&self, event: impl FnOnce(u64) -> Seen) {
        let now = u64::try_from(self.clock.now().as_millis()).unwrap();
        self.seen.lock().unwrap().push(event(now));
    }
}

impl Outside for ScriptedOutside {
    fn hear(&mut self, wait: Duration) -> Result<Heard, TransportError> {
        let now = self.clock.now();
        let next = self.script.front().map(|(at, _)| at.saturating_sub(now));
        match next.filter(|left| *left <= wait) {
            None => {
                self.clock.sleep(wait);
                Ok(Heard::Nothing)
            }
            Some(left) => {
                self.clock.sleep(left);
                Ok(self.script.pop_front().unwrap().1)
            }
        }
    }

    fn say(&mut self, client: ClientId, bytes: &[u8]) -> Result<(), TransportError> {
        self.note(|now| Seen::Said(now, client.0, bytes.to_vec()));
        let said = self.seen.lock().unwrap().len();
        assert!(said < 100_000, "it says more and more");
        Ok(())
    }

    fn hang_up(&mut self, client: ClientId) -> Result<Afterwards, OpenError> {
        self.note(|now| Seen::HungUp(now, client.0));
        Ok(self.afterwards)
    }

    fn finish(&mut self, _: Duration) {}
}

/// A server with the four meters, and what happens outside.
pub(crate) struct Scene {
    pub(crate) service: Service,
    pub(crate) afterwards: Afterwards,
    /// What a look at the clock costs.
    pub(crate) look: Duration,
    script: Vec<(Duration, Heard)>,
}

pub(crate) const GAP: Duration = Duration::from_millis(20);

impl Scene {
    pub(crate) fn new(framing: Framing) -> Self {
        Self {
            service: Service {
                framing,
                answer_time: Duration::ZERO,
                script: FaultScript::default(),
                count: None,
            },
            afterwards: Afterwards::Open,
            look: Duration::ZERO,
            script: Vec::new(),
        }
    }

    pub(crate) fn rtu() -> Self {
        Self::new(Framing::Rtu { gap: GAP })
    }

    pub(crate) fn tcp() -> Self {
        Self::new(Framing::Tcp)
    }

    pub(crate) fn faults(mut self, rules: &[&str]) -> Self {
        self.service.script = FaultScript::parse(rules).unwrap();
        self
    }

    /// Bytes of a client at this millisecond.
    pub(crate) fn at(mut self, at: u64, client: u64, bytes: impl AsRef<[u8]>) -> Self {
        let heard = Heard::Bytes(ClientId(client), bytes.as_ref().to_vec());
        self.script.push((Duration::from_millis(at), heard));
        self
    }

    pub(crate) fn leaves(mut self, at: u64, client: u64) -> Self {
        let heard = Heard::Left(ClientId(client));
        self.script.push((Duration::from_millis(at), heard));
        self
    }

    /// Plays it until this millisecond, or until the server ends.
    pub(crate) fn until(self, end: u64) -> Played {
        let clock = Arc::new(FakeClock::new());
        clock.costs(self.look);
        let seen = Arc::default();
        let outside = ScriptedOutside {
            clock: Arc::clone(&clock),
            script: self.script.into(),
            seen: Arc::clone(&seen),
            afterwards: self.afterwards,
        };
        let meters: Vec<Meter> = SimulatedLine::meters(1);
        let mut server = Server::new(outside, meters, self.service, clock.clone());
        let end = Duration::from_millis(end);
        let mut state = State::Serving;
        let mut turns = 0;
        while state == State::Serving && clock.now() < end {
            state = server.turn(end.saturating_sub(clock.now())).unwrap();
            turns += 1;
            assert!(turns < 100_000, "it goes round without waiting");
        }
        let seen = seen.lock().unwrap().clone();
        Played {
            seen,
            server,
            state,
            end: u64::try_from(clock.now().as_millis()).unwrap(),
            turns,
        }
    }
}

/// What came of it.
pub(crate) struct Played {
    pub(crate) seen: Vec<Seen>,
    pub(crate) server: Server<ScriptedOutside>,
    pub(crate) state: State,
    pub(crate) end: u64,
    pub(crate) turns: usize,
}
