//! A client in a long talk with several units on a bad line, beside a model of that line: no value
//! is ever wrong, every request ends within its deadline and is one write, t3.5 is kept before each,
//! and the first read on a good line is right.

use std::sync::{Arc, Mutex};
use std::time::Duration;

use meterpoll::client::{Echo, Failure, Patience, QueryData, Ways};
use meterpoll::codec::rtu::{decode_request, encode_reply};
use meterpoll::codec::{ReadFunction, ReadValues, RegisterRange, Reply, Request, Response};
use meterpoll::transport::{Clock, LineSettings};

use super::cursor::Cursor;
use super::model::{Manner, Model};
use super::script::{Bench, truth, unit};

/// The time-out.
const T: Duration = Duration::from_secs(1);

/// Two periods of an adapter that holds bytes back.
const ADAPTER: Duration = Duration::from_millis(32);

/// What a busy unit and a fault of memory cost beside the attempts: four requests, and waits of 100,
/// 200 and 400 ms.
const BUSY: (u32, Duration) = (4, Duration::from_millis(700));

/// So many requests at the most.
const MOST: usize = 24;

struct Session {
    bench: Bench,
    settings: LineSettings,
    model: Arc<Mutex<Model>>,
    patience: Patience,
    has_lost_port: bool,
}

/// Carries out what the bytes say.
pub(crate) fn session(data: &[u8]) {
    let mut cursor = Cursor::new(data);
    let mut session = Session::new(&mut cursor);
    let mut left = MOST;
    loop {
        let (address, count) = (cursor.byte(), 1 + cursor.byte() % 5);
        let number = cursor.pick(&[17, 17, 17, 18, 4]);
        session.patience.retries = u32::from(cursor.byte() % 3);
        let idle = u64::from(cursor.byte());
        session.bench.clock.advance(Duration::from_millis(idle * 4));
        if cursor.below(64) == 0 {
            session.lose_port(&mut cursor);
        }
        let function = cursor.pick(&[
            ReadFunction::HoldingRegisters,
            ReadFunction::HoldingRegisters,
            ReadFunction::InputRegisters,
        ]);
        // The requests for some registers start like their answers.
        let mut start = u16::from(address % 16) + cursor.pick(&[0, 0x0240, 0x02A0, 0x0440]);
        if session.model().makes_copies() {
            // Nothing is asked twice: the copy of one answer would be taken, rightly, for the next,
            // and leave two that look like the answer to something else.
            start = 0x0240 + 8 * u16::try_from(left).expect("a small number");
        }
        // What the line does with this request is in the bytes behind it.
        session.model().cursor = cursor.clone();
        if session.reads(number, function, start, count.into()) == Outcome::Chance {
            return;
        }
        cursor = session.model().cursor.clone();
        left -= 1;
        if cursor.is_over() || left == 0 {
            break;
        }
    }
    session.ends();
}

/// What became of a read.
#[derive(Debug, PartialEq, Eq)]
enum Outcome {
    Right,
    Failed,
    /// Wrong, but by bytes that nobody has sent as a frame: damage that the CRC does not show.
    Chance,
}

impl Session {
    fn new(cursor: &mut Cursor) -> Self {
        let settings = LineSettings {
            baud: cursor.pick(&[9600, 9600, 19_200, 115_200]),
            ..LineSettings::default()
        };
        let manner = cursor.pick(&[Manner::Late, Manner::Late, Manner::Copies]);
        let echo = cursor.pick(&[false, false, true]);
        let ways = Ways {
            interchangeable_reads: cursor.chance(),
            loopback: cursor.pick(&[None, Some(QueryData::Zero), Some(QueryData::Any)]),
        };
        let bench = Bench::with(settings, Echo::Auto);
        let model = Arc::new(Mutex::new(Model::new(Cursor::new(&[]), manner, echo)));
        let (meter, clock) = (Arc::clone(&model), Arc::clone(&bench.clock));
        bench.line.meter(move |frame| {
            let end = clock.now() + settings.transfer_time(frame.len());
            meter.lock().expect("one thread").answer(frame, end)
        });
        Self {
            bench,
            settings,
            model,
            patience: Patience {
                timeout: T,
                longest_answer: T,
                ways,
                ..Patience::default()
            },
            has_lost_port: false,
        }
    }

    fn model(&self) -> std::sync::MutexGuard<'_, Model> {
        self.model.lock().expect("one thread")
    }

    /// Once in a session the port is lost, and comes back.
    fn lose_port(&mut self, cursor: &mut Cursor) {
        if !std::mem::replace(&mut self.has_lost_port, true) {
            let at = self.bench.now() + Duration::from_millis(cursor.below(2000) as u64);
            self.bench.line.hang_up(at);
            let back = at + Duration::from_millis(cursor.below(6000) as u64);
            self.bench.line.come_back(back);
        }
    }

    fn reads(&mut self, number: u16, function: ReadFunction, start: u16, count: u16) -> Outcome {
        let range = RegisterRange::new(start, count).expect("a range");
        let deadline = self.deadline(count);
        let request = Request::Read { function, range };
        let unit = unit(number);
        let result = self.bench.client.request(unit, &request, self.patience);
        let now = self.bench.now();
        assert!(now <= deadline, "{now:?} is after {deadline:?}: {result:?}");
        match result {
            Ok(Response::Registers { values, .. }) => {
                let registers = range.start().get()..;
                let expected = registers.map(|address| truth(unit.get(), address));
                if values
                    .as_slice()
                    .iter()
                    .copied()
                    .eq(expected.take(count.into()))
                {
                    return Outcome::Right;
                }
                self.is_chance(number, &values);
                Outcome::Chance
            }
            Ok(other) => panic!("{other:?}"),
            Err(_) => Outcome::Failed,
        }
    }

    /// A wrong value must not be one that the meter has sent for something else.
    fn is_chance(&self, number: u16, values: &ReadValues) {
        for function in [ReadFunction::HoldingRegisters, ReadFunction::InputRegisters] {
            let values = values.clone();
            let reply = Reply::Normal(Response::Registers { function, values });
            let frame = encode_reply(unit(number), &reply);
            let is_sent = |sent: &Vec<u8>| sent == frame.as_bytes();
            assert!(
                !self.model().frames.iter().any(is_sent),
                "{frame} is for something else"
            );
        }
    }

    /// When a request for so many registers is over at the latest.
    fn deadline(&self, count: u16) -> Duration {
        const LOOPBACK_CHARACTERS: usize = 8;
        let answer = self
            .settings
            .transfer_time(5 + 2 * usize::from(count.max(5)));
        let request = self.settings.transfer_time(LOOPBACK_CHARACTERS);
        // Until the line is silent; then the request, the time-out, the answer.
        let attempt = self.settings.silence() + T + request + T + answer + ADAPTER;
        let retries = self.patience.retries;
        let ways = self.patience.ways;
        let mut attempts = 1 + retries + BUSY.0;
        attempts += u32::from(ways.interchangeable_reads) * (1 + retries);
        attempts += u32::from(ways.loopback.is_some()) * (1 + retries);
        let mut held = T;
        if self.model().makes_copies() {
            // Four more looks, and as long as a copy may take.
            attempts += 4 * (1 + retries);
            held += T * (1 + retries);
        }
        let last_sent = self
            .bench
            .line
            .sent()
            .last()
            .map_or(Duration::ZERO, |sent| sent.at);
        let owed = last_sent + request + T + answer + ADAPTER + T;
        let regained = T * (1 + retries);
        owed.max(self.bench.now()) + held + regained + attempt * attempts + BUSY.1
    }

    /// The line is good from now on.
    fn ends(mut self) {
        if self.has_lost_port || self.model().makes_copies() {
            self.bench.clock.advance(T * 10);
        }
        self.model().manner = Manner::Good;
        self.patience.retries = 0;
        let function = ReadFunction::HoldingRegisters;
        if self.has_lost_port {
            // Perhaps it is only noticed now.
            self.reads(17, function, 0x0E00, 1);
        }
        let outcome = self.reads(17, function, 0x0F00, 2);
        assert_eq!(outcome, Outcome::Right);
        for sent in self.bench.line.sent() {
            assert!(sent.silence >= self.settings.silence(), "{sent:?}");
            assert!(decode_request(&sent.frame).is_ok(), "{sent:?}");
        }
        let finished: Result<(), Failure> = self.bench.client.finish();
        assert!(finished.is_ok(), "{finished:?}");
    }
}
