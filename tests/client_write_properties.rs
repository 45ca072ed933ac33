//! Whatever a line does to writes: none is sent twice unless the unit said that it was busy, and what
//! is told of each is so.

mod support {
    pub(crate) mod cases;
    pub(crate) mod clock;
    pub(crate) mod script;
    pub(crate) mod written;
}

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};

use meterpoll::client::{Confirmation, Echo, Patience, QueryData, Unwritten, Ways};
use meterpoll::codec::{Response, Write};
use meterpoll::transport::LineSettings;
use proptest::prelude::*;

use support::cases::hold;
use support::script::{Bench, Chunk, read, unit};
use support::written::{block, confirmed, frame, ms, refused, sealed, set};

/// What the meter and its line do with one request.
#[derive(Debug, Clone, Copy)]
enum Event {
    /// It is done, and answered.
    Well,
    /// It is not heard.
    Unheard,
    /// It is done, and the answer is lost.
    Lost,
    /// It is done, and the answer comes when nobody listens any more, but is waited for.
    Late,
    /// It is done, and the answer is damaged.
    Damaged,
    /// It is done, and the answer breaks off.
    Cut,
    /// It is done, and answered twice in a row.
    Twice,
    /// Something between 0 and the value is stored, and told.
    Clamped,
    /// It is not done, for this reason.
    Refused(u8),
    /// It is done, and another unit talks.
    Stranger,
    /// It is done, with noise around the answer.
    Noise,
}

fn any_event() -> impl Strategy<Value = Event> {
    let code = prop_oneof![3 => Just(6), 1 => prop_oneof![Just(2), Just(4), Just(0x0B), Just(5)]];
    prop_oneof![
        6 => Just(Event::Well),
        1 => Just(Event::Unheard),
        1 => Just(Event::Lost),
        1 => Just(Event::Late),
        1 => Just(Event::Damaged),
        1 => Just(Event::Cut),
        1 => Just(Event::Twice),
        1 => Just(Event::Clamped),
        3 => code.prop_map(Event::Refused),
        1 => Just(Event::Stranger),
        1 => Just(Event::Noise),
    ]
}

/// What the meter holds, and what it was told.
#[derive(Default)]
struct State {
    registers: BTreeMap<u16, u16>,
    /// The writes that came, and whether each was answered with busy.
    heard: Vec<(Vec<u8>, bool)>,
}

impl State {
    fn hold(&mut self, frame: &[u8], event: Event) {
        let word = |at: usize| u16::from_be_bytes([frame[at], frame[at + 1]]);
        match frame[1] {
            6 => {
                let value = word(4);
                let value = if matches!(event, Event::Clamped) {
                    value / 2
                } else {
                    value
                };
                self.registers.insert(word(2), value);
            }
            16 => {
                for index in 0..word(4) {
                    let value = word(7 + 2 * usize::from(index));
                    self.registers.insert(word(2) + index, value);
                }
            }
            _ => {}
        }
    }

    fn answer(&self, frame: &[u8]) -> Vec<u8> {
        let word = |at: usize| u16::from_be_bytes([frame[at], frame[at + 1]]);
        let held = |address| self.registers.get(&address).copied().unwrap_or_default();
        match frame[1] {
            3 => {
                let mut body = vec![frame[0], 3, 2 * frame[5]];
                for index in 0..word(4) {
                    body.extend(held(word(2) + index).to_be_bytes());
                }
                sealed(&body)
            }
            6 => {
                let mut body = frame[..4].to_vec();
                body.extend(held(word(2)).to_be_bytes());
                sealed(&body)
            }
            _ => confirmed(frame),
        }
    }

    fn request(&mut self, frame: &[u8], event: Event) -> Vec<Chunk> {
        if frame[1] != 3 && frame[1] != 8 {
            self.heard
                .push((frame.to_vec(), matches!(event, Event::Refused(6))));
        }
        match event {
            Event::Unheard => return Vec::new(),
            Event::Refused(code) => return vec![(ms(10), refused(frame, code))],
            _ => self.hold(frame, event),
        }
        let mut answer = self.answer(frame);
        match event {
            Event::Lost => Vec::new(),
            Event::Late => vec![(ms(1700), answer)],
            Event::Damaged => {
                answer[2] ^= 0x10;
                vec![(ms(10), answer)]
            }
            Event::Cut => vec![(ms(10), answer[..answer.len() - 2].to_vec())],
            Event::Twice => vec![(ms(10), [answer.clone(), answer].concat())],
            Event::Stranger => {
                let other = sealed(&[18, 6, frame[2], frame[3], 0, 1]);
                vec![(ms(10), other), (ms(30), answer)]
            }
            Event::Noise => vec![
                (ms(5), vec![0, 0xFF]),
                (ms(10), answer),
                (ms(12), vec![0x55]),
            ],
            _ => vec![(ms(10), answer)],
        }
    }
}

/// A value for one register, or for two.
fn any_write() -> impl Strategy<Value = Write> {
    let address = 0x1028_u16..0x102A;
    prop_oneof![
        (address.clone(), 1..50_u16).prop_map(|(address, value)| set(address, value)),
        (address, 1..50_u16).prop_map(|(address, value)| block(address, &[value, value + 1])),
    ]
}

/// The registers that a write sets.
fn registers(write: &Write) -> Vec<(u16, u16)> {
    match write {
        Write::Register { address, value } => vec![(address.get(), *value)],
        Write::Registers(block) => {
            let start = block.range().start().get();
            (start..).zip(block.values().iter().copied()).collect()
        }
        Write::Coil { .. } => Vec::new(),
    }
}

#[test]
fn no_write_is_sent_twice_and_what_is_told_of_it_is_so() {
    let ways = prop_oneof![Just(None), Just(Some(QueryData::Any))];
    let run = (
        prop::collection::vec((any_write(), any::<bool>()), 1..6),
        prop::collection::vec(any_event(), 40),
        any::<bool>(),
        ways,
    );
    hold(500, &run, |(steps, events, echoes, loopback)| {
        let mut bench = Bench::with(LineSettings::default(), Echo::Auto);
        let state: Arc<Mutex<State>> = Arc::default();
        let meter = Arc::clone(&state);
        let mut events = events.into_iter();
        // What the program asks first: whether the line echoes.
        let mut is_first = true;
        bench.line.meter(move |frame| {
            let event = events.next().filter(|_| !is_first);
            is_first = false;
            let mut chunks = meter
                .lock()
                .unwrap()
                .request(frame, event.unwrap_or(Event::Well));
            if echoes {
                chunks.insert(0, (ms(0), frame.to_vec()));
            }
            chunks
        });
        let patience = Patience {
            ways: Ways {
                interchangeable_reads: false,
                loopback,
            },
            ..Patience::default()
        };
        let known = bench.client.request(unit(17), &read(0, 1), patience);
        prop_assert!(known.is_ok() && bench.client.echoes() == Some(echoes));
        for (write, is_read) in steps {
            let before = state.lock().unwrap().heard.len();
            let result = bench.client.write(unit(17), &write, patience);
            let held = |(address, value): &(u16, u16)| {
                state.lock().unwrap().registers.get(address) == Some(value)
            };
            let heard = state.lock().unwrap().heard[before..].to_vec();
            prop_assert!(heard.iter().all(|(sent, _)| *sent == frame(&write)));
            let busy = heard.iter().filter(|(_, is_busy)| *is_busy).count();
            prop_assert!(heard.len() <= busy + 1, "{result:?} {heard:?}");
            match result {
                Ok(Confirmation::Done) => prop_assert!(registers(&write).iter().all(held)),
                Ok(Confirmation::Stored(value)) => {
                    let stored = registers(&write)[0];
                    prop_assert!(stored.1 != value && held(&(stored.0, value)));
                }
                Err(Unwritten::NotSent(_) | Unwritten::Stopped) => prop_assert!(heard.is_empty()),
                Ok(Confirmation::Accepted) | Err(Unwritten::Refused(_) | Unwritten::Unknown(_)) => {
                    prop_assert!(!heard.is_empty());
                }
            }
            if is_read
                && let Ok(response) = bench.client.request(unit(17), &read(0x1028, 3), patience)
            {
                let Response::Registers { values, .. } = response else {
                    return Err(TestCaseError::fail(format!("{response:?}")));
                };
                let state = state.lock().unwrap();
                let held = |address| state.registers.get(&address).copied().unwrap_or_default();
                let truth: Vec<u16> = (0x1028..0x102B).map(held).collect();
                prop_assert_eq!(values.into_vec(), truth);
            }
        }
        Ok(())
    });
}
