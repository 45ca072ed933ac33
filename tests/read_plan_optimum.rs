//! The read plan is never illegal and never dearer than the best of all plans: beside every way of
//! grouping the points there is, under all rules together.

#[path = "support/cases.rs"]
mod cases;

use std::collections::BTreeMap;
use std::time::Duration;

use meterpoll::codec::value::{ByteOrder, RegisterType};
use meterpoll::codec::{ReadFunction, RegisterRange};
use meterpoll::profile::plan::{Cost, Plan, Rules};
use meterpoll::profile::point::Access;
use meterpoll::profile::{Limits, Point, Profile};
use meterpoll::transport::{LineSettings, Parity};
use proptest::prelude::*;

use self::cases::runner;

const HOLDING: ReadFunction = ReadFunction::HoldingRegisters;
const INPUT: ReadFunction = ReadFunction::InputRegisters;

fn range((start, count): (u16, u16)) -> RegisterRange {
    RegisterRange::new(start, count).expect("a range")
}

/// A point of any width; the planner looks at its place alone.
fn point(place: (u16, u16)) -> Point {
    Point::raw(range(place), RegisterType::U16, ByteOrder::Abcd)
}

/// A meter, what was asked of it, and what it was found to refuse.
#[derive(Debug)]
struct Case {
    profile: Profile,
    asked: Vec<Point>,
    refused: Vec<(ReadFunction, RegisterRange)>,
    settings: LineSettings,
    pause: Duration,
    answer: Duration,
}

impl Case {
    fn rules(&self) -> Rules {
        let mut rules = Rules::of(&self.profile);
        for (function, range) in &self.refused {
            rules.refuse(*function, *range);
        }
        rules
    }

    fn cost(&self) -> Cost {
        Cost::new(self.settings, self.pause, Duration::ZERO).with_answer(self.answer)
    }

    /// T(N) = (8 + 5 + 2N) c + 2 t3.5 + d, a pause in place of the second silence where it is
    /// longer.
    fn price(&self, registers: u32) -> Duration {
        let silence = self.settings.silence();
        self.settings.transfer_time(13)
            + silence
            + silence.max(self.pause)
            + self.answer
            + self.settings.transfer_time(2) * registers
    }

    /// The function a point is read with.
    fn function(point: &Point) -> ReadFunction {
        point.function.unwrap_or(HOLDING)
    }

    /// Whether both functions read the same registers.
    fn is_one_table(&self, one: ReadFunction, other: ReadFunction) -> bool {
        one == other || self.profile.limits.interchangeable_reads
    }

    /// The points of the profile that lie among the registers a function reads.
    fn known(&self, function: ReadFunction) -> impl Iterator<Item = &Point> {
        let points = self.profile.points.iter();
        points.filter(move |point| self.is_one_table(Self::function(point), function))
    }

    /// The registers of a read that fetches these points, if it is legal.
    fn legal(&self, group: &[&Point]) -> Option<u32> {
        let function = Self::function(group[0]);
        let start = group.iter().map(|point| first(point)).min()?;
        let end = group.iter().map(|point| point.range.end()).max()?;
        let is = |rule: bool| rule.then_some(end - start);
        if group.iter().any(|point| Self::function(point) != function) {
            return None;
        }
        // A single point is read as it is, and so are several on the same registers.
        if group.iter().all(|point| point.range == group[0].range)
            && (group.iter().all(|point| self.must_be_alone(point)) || group.len() == 1)
        {
            return Some(end - start);
        }
        let limits = &self.profile.limits;
        let is_named = |register: u32| {
            let mut points = group.iter().copied().chain(self.ordinary(function));
            points.any(|point| (first(point)..point.range.end()).contains(&register))
        };
        is(!group.iter().any(|point| self.must_be_alone(point))
            && (limits.read_holes || (start..end).all(is_named))
            && self.is_open(function, start, end))
    }

    /// Whether a point is kept from others: it says so, or its own registers could not be read for
    /// several points.
    fn must_be_alone(&self, point: &Point) -> bool {
        let inside = |border: u32| {
            self.wholes(Self::function(point))
                .any(|whole| first(whole) < border && border < whole.range.end())
        };
        let (start, end) = (first(point), point.range.end());
        point.alone
            || inside(start)
            || inside(end)
            || !self.is_open(Self::function(point), start, end)
    }

    /// Whether nothing stands in the way of a read of these registers.
    fn is_open(&self, function: ReadFunction, start: u32, end: u32) -> bool {
        let limits = &self.profile.limits;
        let table = |register: u32| {
            let size = limits.table_registers?;
            Some(register / u32::from(size))
        };
        let is_touched = |point: &Point| first(point) < end && start < point.range.end();
        let is_covered = |(of, refused): &(ReadFunction, RegisterRange)| {
            self.is_one_table(*of, function)
                && !self.is_part(function, *refused)
                && start <= u32::from(refused.start().get())
                && refused.end() <= end
        };
        end - start <= u32::from(limits.read_registers)
            && table(start) == table(end - 1)
            && !self.barriers(function).any(is_touched)
            && !self.refused.iter().any(is_covered)
    }

    /// Points of the profile that must not be read in company, and those asked for.
    fn barriers(&self, function: ReadFunction) -> impl Iterator<Item = &Point> {
        let known = self.known(function).filter(move |point| {
            is_apart(point) && !self.ordinary(function).any(|other| holds(other, point))
        });
        let asked = self.asked.iter().filter(move |point| {
            let others = || {
                let others = self.asked.iter().filter(|other| !other.alone);
                others.filter(|other| Self::function(other) == function)
            };
            point.alone
                && Self::function(point) == function
                && !others().any(|other| holds(other, point))
                && !self.wholes(function).any(|whole| holds(whole, point))
        });
        known.chain(asked)
    }

    fn ordinary(&self, function: ReadFunction) -> impl Iterator<Item = &Point> {
        self.known(function).filter(|point| !is_apart(point))
    }

    /// Ordinary points with registers that are another point when they are read alone.
    fn wholes(&self, function: ReadFunction) -> impl Iterator<Item = &Point> {
        let shared = move |part: &&Point| {
            is_apart(part) && self.ordinary(function).any(|other| holds(other, part))
        };
        self.ordinary(function).filter(move |whole| {
            let mut parts = self.known(function).filter(shared);
            parts.any(|part| first(part) < whole.range.end() && first(whole) < part.range.end())
        })
    }

    /// Whether such a point begins or ends inside one of those.
    fn is_part(&self, function: ReadFunction, range: RegisterRange) -> bool {
        let inside =
            |border: u32, whole: &Point| first(whole) < border && border < whole.range.end();
        self.wholes(function).any(|whole| {
            inside(u32::from(range.start().get()), whole) || inside(range.end(), whole)
        })
    }

    /// The least that any way of grouping the points costs.
    fn least<'a>(&self, rest: &'a [Point], groups: &mut Vec<Vec<&'a Point>>) -> Option<Duration> {
        let Some((next, rest)) = rest.split_first() else {
            let prices = groups
                .iter()
                .map(|group| Some(self.price(self.legal(group)?)));
            return prices.sum();
        };
        let mut best: Option<Duration> = None;
        for index in 0..=groups.len() {
            if index == groups.len() {
                groups.push(Vec::new());
            }
            groups[index].push(next);
            let found = self.least(rest, groups);
            best = best.into_iter().chain(found).min();
            groups[index].pop();
            groups.retain(|group| !group.is_empty());
        }
        best
    }
}

fn first(point: &Point) -> u32 {
    u32::from(point.range.start().get())
}

fn is_apart(point: &Point) -> bool {
    point.alone || !point.access.readable()
}

fn holds(whole: &Point, part: &Point) -> bool {
    whole.range.contains(part.range)
}

fn any_function() -> impl Strategy<Value = ReadFunction> {
    prop_oneof![9 => Just(HOLDING), 1 => Just(INPUT)]
}

fn any_place() -> impl Strategy<Value = (u16, u16)> {
    (0_u16..60, 1_u16..9)
}

fn any_point() -> impl Strategy<Value = Point> {
    let function = prop::option::weighted(0.2, any_function());
    let marks = (prop::bool::weighted(0.1), prop::bool::weighted(0.1));
    (any_place(), function, marks).prop_map(|(place, function, (alone, write_only))| Point {
        alone,
        function,
        access: if write_only {
            Access::Write
        } else {
            Access::Read
        },
        ..point(place)
    })
}

fn any_limits() -> impl Strategy<Value = Limits> {
    let table = prop::option::of(prop_oneof![Just(16_u16), Just(25), Just(256)]);
    let most = prop_oneof![Just(125_u16), 4_u16..30];
    (most, any::<bool>(), table, any::<bool>()).prop_map(
        |(read_registers, read_holes, table_registers, interchangeable_reads)| Limits {
            read_registers,
            read_holes,
            table_registers,
            interchangeable_reads,
            ..Limits::default()
        },
    )
}

fn any_case() -> impl Strategy<Value = Case> {
    let settings = (
        prop_oneof![Just(1200_u32), Just(9600), Just(115_200)],
        prop_oneof![Just(Parity::None), Just(Parity::Even)],
    );
    let settings = settings.prop_map(|(baud, parity)| LineSettings {
        baud,
        parity,
        ..LineSettings::default()
    });
    let times = (0_u64..30, 0_u64..30);
    let times = times
        .prop_map(|(pause, answer)| (Duration::from_millis(pause), Duration::from_millis(answer)));
    let known = prop::collection::vec(any_point(), 0..=5);
    // Points of the profile are asked for as well as registers by address.
    let asked = prop::collection::vec((any_point(), any::<prop::sample::Index>()), 0..=7);
    let refused = prop::collection::vec((any_function(), any_place()), 0..=2);
    // Around the tables of 256 registers as well.
    let far = prop_oneof![Just(0_u16), Just(240)];
    (any_limits(), known, asked, refused, settings, times, far).prop_map(
        |(limits, mut points, asked, refused, settings, (pause, answer), far)| {
            let moved = |range: RegisterRange| (range.start().get() + far, range.count());
            for point in &mut points {
                point.range = range(moved(point.range));
            }
            let asked = asked.into_iter().map(|(raw, index)| {
                let known: Vec<&Point> = points.iter().filter(|p| p.access.readable()).collect();
                match known.len() {
                    some @ 1.. if index.index(2) == 0 => known[index.index(some)].clone(),
                    _ => Point {
                        access: Access::Read,
                        range: range(moved(raw.range)),
                        ..raw
                    },
                }
            });
            Case {
                asked: asked.collect(),
                refused: refused
                    .into_iter()
                    .map(|(function, (start, count))| (function, range((start + far, count))))
                    .collect(),
                profile: Profile {
                    name: String::new(),
                    title: String::new(),
                    manual: String::new(),
                    line: settings,
                    limits,
                    identification: None,
                    groups: Vec::new(),
                    factors: Vec::new(),
                    identities: Vec::new(),
                    operations: Vec::new(),
                    command_registers: None,
                    clock: None,
                    status_bits: BTreeMap::new(),
                    distinct: Vec::new(),
                    points,
                },
                settings,
                pause,
                answer,
            }
        },
    )
}

#[test]
fn no_way_of_grouping_the_points_is_cheaper_than_the_plan() {
    runner(2000)
        .run(&any_case(), |case| {
            let plan = Plan::new(&case.asked, HOLDING, &case.rules(), case.cost());
            let mut planned: Vec<usize> = Vec::new();
            let mut total = Duration::ZERO;
            for read in &plan.reads {
                let group: Vec<&Point> = read
                    .points
                    .iter()
                    .map(|index| &case.asked[*index])
                    .collect();
                let count = case.legal(&group);
                prop_assert_eq!(count, Some(u32::from(read.range.count())), "{:?}", read);
                let functions = group.iter().map(|point| Case::function(point));
                prop_assert!(functions.eq(group.iter().map(|_| read.function)));
                prop_assert!(group.iter().all(|point| read.range.contains(point.range)));
                total += case.price(u32::from(read.range.count()));
                planned.extend(&read.points);
            }
            planned.sort_unstable();
            prop_assert_eq!(planned, (0..case.asked.len()).collect::<Vec<usize>>());
            prop_assert_eq!(plan.cost(case.cost()), total);
            let best = case.least(&case.asked, &mut Vec::new());
            prop_assert_eq!(Some(total), best.or(Some(Duration::ZERO)));
            Ok(())
        })
        .unwrap_or_else(|error| panic!("{error}"));
}
