//! A meter on a scripted line that does not give everything, and what a run makes of it.

#![allow(dead_code, reason = "each test file uses its share")]

use std::ops::Range;
use std::time::Duration;

use meterpoll::client::Patience;
use meterpoll::codec::rtu::{self, Destination};
use meterpoll::codec::value::{ByteOrder, RegisterType};
use meterpoll::codec::{ExceptionCode, ReadFunction, RegisterRange, Reply, Request};
use meterpoll::profile::plan::{Cost, Rules};
use meterpoll::profile::{Limits, Point};
use meterpoll::readings::{Inquiry, Memory, Row, Trouble, take};
use meterpoll::transport::LineSettings;

use super::script::{Bench, Chunk, true_reply, truth, unit};

/// What a meter does not give, and how it says so.
#[derive(Debug, Clone)]
pub(crate) struct Fussy {
    /// The most registers at once.
    pub(crate) limit: u32,
    /// Registers it does not have.
    pub(crate) missing: Vec<u32>,
    /// No read covers both the register before one of these and the register itself.
    pub(crate) borders: Vec<u32>,
    /// What it does with what it does not give: an exception code, or silence.
    pub(crate) says: Option<u8>,
}

impl Fussy {
    /// A meter that gives everything, and says so when it does not.
    pub(crate) const fn new(says: Option<u8>) -> Self {
        Self {
            limit: 125,
            missing: Vec::new(),
            borders: Vec::new(),
            says,
        }
    }

    pub(crate) fn limit(self, limit: u32) -> Self {
        Self { limit, ..self }
    }

    pub(crate) fn without(mut self, registers: Range<u32>) -> Self {
        self.missing.extend(registers);
        self
    }

    pub(crate) fn border(mut self, at: u32) -> Self {
        self.borders.push(at);
        self
    }

    /// Whether it gives these registers in one request.
    pub(crate) fn gives(&self, range: RegisterRange) -> bool {
        let start = u32::from(range.start().get());
        let registers = start..range.end();
        let crosses = |border: &u32| start < *border && *border < range.end();
        range.end() - start <= self.limit
            && !self.missing.iter().any(|gone| registers.contains(gone))
            && !self.borders.iter().any(crosses)
    }

    /// What it answers, 40 ms after the request.
    pub(crate) fn answer(&self, frame: &[u8]) -> Vec<Chunk> {
        let Ok((Destination::Unit(unit), Request::Read { function, range })) =
            rtu::decode_request(frame)
        else {
            panic!("no read: {}", rtu::Hex(frame));
        };
        let answer = match self.says {
            _ if self.gives(range) => true_reply(frame),
            None => return Vec::new(),
            Some(code) => {
                let reply = Reply::Exception {
                    function: function.into(),
                    code: ExceptionCode(code),
                };
                rtu::encode_reply(unit, &reply).as_bytes().to_vec()
            }
        };
        vec![(Duration::from_millis(40), answer)]
    }
}

/// Points of one register each.
pub(crate) fn points(addresses: impl IntoIterator<Item = u16>) -> Vec<Point> {
    addresses.into_iter().map(|start| point(start, 1)).collect()
}

/// A point of up to four registers; its raw words are what tests compare.
pub(crate) fn point(start: u16, count: u16) -> Point {
    let kind = match count {
        1 => RegisterType::U16,
        2 => RegisterType::U32,
        4 => RegisterType::U64,
        _ => panic!("no integer has {count} registers"),
    };
    let range = RegisterRange::new(start, count).expect("a range");
    Point::raw(range, kind, ByteOrder::Abcd)
}

/// What a true reading of a point shows.
pub(crate) fn true_value(number: u8, point: &Point) -> String {
    let start = point.range.start().get();
    let words = (start..=u16::MAX).take(usize::from(point.range.count()));
    let value = words.fold(0_u64, |value, address| {
        value << 16 | u64::from(truth(number, address))
    });
    value.to_string()
}

/// One unit that is read again and again.
pub(crate) struct Run {
    pub(crate) bench: Bench,
    pub(crate) patience: Patience,
    memory: Memory,
    seen: usize,
    refuses: bool,
}

impl Run {
    pub(crate) fn new(meter: Fussy) -> Self {
        Self::with(meter, &Limits::default())
    }

    pub(crate) fn with(meter: Fussy, limits: &Limits) -> Self {
        let refuses = meter.says.is_some();
        Self {
            refuses,
            ..Self::on(move |frame| meter.answer(frame), limits)
        }
    }

    pub(crate) fn on(
        meter: impl FnMut(&[u8]) -> Vec<Chunk> + Send + 'static,
        limits: &Limits,
    ) -> Self {
        let bench = Bench::new();
        bench.line.meter(meter);
        Self {
            bench,
            patience: Patience::default(),
            memory: Memory::new(Rules::new(limits)),
            seen: 0,
            refuses: false,
        }
    }

    /// Reads points of unit 17 once.
    pub(crate) fn read(&mut self, points: &[Point]) -> (Row, Vec<Trouble>) {
        let inquiry = Inquiry {
            unit: unit(17),
            meter: "",
            points,
            setup: &meterpoll::profile::Setup::default(),
            function: ReadFunction::HoldingRegisters,
            cost: Cost::new(LineSettings::default(), Duration::ZERO, Duration::ZERO),
            patience: self.patience,
        };
        let taken = take(&mut self.bench.client, &inquiry, &mut self.memory);
        (taken.row, taken.troubles)
    }

    /// The same where nothing goes wrong: every value is the true one.
    #[track_caller]
    pub(crate) fn read_all(&mut self, points: &[Point]) {
        let (row, troubles) = self.read(points);
        assert_eq!(statuses(points, &row), "");
        assert!(troubles.is_empty(), "{troubles:?}");
    }

    /// Start and count of the reads sent since the last call. The second look at a refusal that is
    /// like one before is told by other tests.
    pub(crate) fn requests(&mut self) -> Vec<(u16, u16)> {
        let sent = self.bench.line.sent();
        let new = sent[self.seen..]
            .iter()
            .map(|sent| match rtu::decode_request(&sent.frame) {
                Ok((_, Request::Read { range, .. })) => (range.start().get(), range.count()),
                other => panic!("no read: {other:?}"),
            });
        let mut new: Vec<(u16, u16)> = new.collect();
        if self.refuses {
            new.dedup();
        }
        self.seen = sent.len();
        new
    }
}

/// The readings that are no true value: `0x0007 timeout`, one a line.
pub(crate) fn statuses(points: &[Point], row: &Row) -> String {
    let mut lines = Vec::new();
    for (point, reading) in points.iter().zip(&row.readings) {
        match reading {
            Ok(value) => assert_eq!(
                value.to_string(),
                true_value(row.unit.get(), point),
                "{}",
                point.name
            ),
            Err(fault) => lines.push(format!("{} {fault}\n", point.name)),
        }
    }
    lines.concat()
}
