//! Asking simulated meters and their models.

#![allow(dead_code, reason = "each test file uses its share")]

use std::collections::BTreeMap;

use jiff::{SignedDuration, Timestamp};
use meterpoll::codec::rtu::{check, decode_reply, encode_request};
use meterpoll::codec::value::{ByteOrder, Raw, RegisterType, encode, encode_integer};
use meterpoll::codec::{ReadFunction, RegisterRange, Reply, Request, Response, Unit, UnitRange};
use meterpoll::profile::identity::{Figure, Outcome};
use meterpoll::profile::{Missing, Point, Profile, Setup, Value};
use meterpoll::sim::{Content, Measured, Meter, Model};
use proptest::prelude::*;

pub(crate) fn at(time: &str) -> Timestamp {
    time.parse().unwrap()
}

pub(crate) fn seconds(seconds: i64) -> SignedDuration {
    SignedDuration::from_secs(seconds)
}

/// Any moment of a year, to the millisecond.
pub(crate) fn moment_of_2026() -> impl Strategy<Value = Timestamp> {
    (0_i64..365 * 86_400_000)
        .prop_map(|moment| at("2026-01-01T00:00:00Z") + SignedDuration::from_millis(moment))
}

pub(crate) fn unit(number: u16) -> Unit {
    Unit::new(number, UnitRange::Standard).unwrap()
}

/// The raw integer of a point at one instant.
pub(crate) fn number(measured: &dyn Measured, point: &str) -> i128 {
    match measured.content(point) {
        Some(Content::Number(number)) => number,
        other => panic!("{point} holds {other:?}"),
    }
}

pub(crate) fn raw(model: &dyn Model, point: &str, now: Timestamp) -> i128 {
    number(model.measure(now).as_ref(), point)
}

/// The registers of a point that is not a number.
pub(crate) fn words(model: &dyn Model, point: &str, now: Timestamp) -> Vec<u16> {
    match model.measure(now).content(point) {
        Some(Content::Other(value)) => {
            let kind = match &value {
                Raw::Time(_) => RegisterType::Time,
                Raw::Date(_) => RegisterType::Date,
                Raw::Text(text) => RegisterType::Ascii(u8::try_from(text.len()).unwrap()),
                _ => panic!("{point} holds {value:?}"),
            };
            encode(kind, ByteOrder::Abcd, &value).unwrap()
        }
        other => panic!("{point} holds {other:?}"),
    }
}

pub(crate) fn float(number: i128) -> f64 {
    f64::from(i32::try_from(number).unwrap())
}

/// The mean raw value of a point over the `span` seconds that end at `end`.
pub(crate) fn mean_before(model: &dyn Model, point: &str, end: Timestamp, span: i64) -> f64 {
    let step = span / 300;
    let sum: f64 = (0..300)
        .map(|sample| float(raw(model, point, end - seconds(step * sample + step / 2))))
        .sum();
    sum / 300.0
}

/// The registers of a point as a model fills them.
pub(crate) fn registers(point: &Point, measured: &dyn Measured) -> Vec<u16> {
    let registers = match measured.content(&point.name) {
        Some(Content::Number(number)) => encode_integer(point.kind, point.order, number),
        Some(Content::Other(value)) => encode(point.kind, point.order, &value),
        None => None,
    };
    registers.unwrap_or_else(|| panic!("{} holds nothing that fits", point.name))
}

/// What a point of a profile means, with the setup that it depends on.
pub(crate) fn value(
    profile: &Profile,
    measured: &dyn Measured,
    point: &str,
) -> Result<Value, Missing> {
    let point = profile.point(point).unwrap();
    let setup = Setup::of(std::slice::from_ref(point), Some(profile));
    let read: BTreeMap<String, Vec<u16>> = setup
        .points()
        .iter()
        .map(|point| (point.name.clone(), registers(point, measured)))
        .collect();
    point.interpret(&registers(point, measured), &setup.scales(&read))
}

/// The value of a point that is a number.
pub(crate) fn figure(profile: &Profile, measured: &dyn Measured, point: &str) -> f64 {
    let value = value(profile, measured, point).unwrap();
    value.to_string().parse().unwrap()
}

/// A frame with a right CRC: `body` is the unit and the data unit.
pub(crate) fn sealed(body: &[u8]) -> Vec<u8> {
    [body, &check(body)].concat()
}

/// The answer to a frame, which must be heard; `None` is silence.
pub(crate) fn answer(meter: &mut Meter, frame: &[u8], now: Timestamp) -> Option<Vec<u8>> {
    let answer = meter.answer(frame, now)?;
    Some(answer.as_bytes().to_vec())
}

/// The code of the exception that a data unit meets; `None` for a normal response.
pub(crate) fn exception(meter: &mut Meter, data_unit: &[u8], now: Timestamp) -> Option<u8> {
    let request = sealed(&[&[meter.unit().get()], data_unit].concat());
    let answer = meter.answer(&request, now).expect("an answer");
    match decode_reply(answer.as_bytes()) {
        Ok((_, Reply::Normal(_))) => None,
        Ok((_, Reply::Exception { code, .. })) => Some(code.0),
        Err(error) => panic!("{error}"),
    }
}

/// Reads registers with function 03; the exception code where that is refused.
pub(crate) fn read(
    meter: &mut Meter,
    start: u16,
    count: u16,
    now: Timestamp,
) -> Result<Vec<u16>, u8> {
    let request = Request::Read {
        function: ReadFunction::HoldingRegisters,
        range: RegisterRange::new(start, count).unwrap(),
    };
    let frame = encode_request(meter.unit(), &request);
    let answer = meter.answer(frame.as_bytes(), now).expect("an answer");
    match decode_reply(answer.as_bytes()) {
        Ok((_, Reply::Normal(Response::Registers { values, .. }))) => Ok(values.into_vec()),
        Ok((_, Reply::Exception { code, .. })) => Err(code.0),
        other => panic!("{other:?}"),
    }
}

/// Reads every readable point of a meter by itself: it is what the model measures, and it means
/// something.
pub(crate) fn every_point_reads_as_what_the_model_measures(
    meter: &mut Meter,
    model: &dyn Model,
    now: Timestamp,
) {
    let measured = model.measure(now);
    for point in &meter.profile().points.clone() {
        let [start, count] = [point.range.start().get(), point.range.count()];
        if !point.access.readable() {
            assert_eq!(read(meter, start, count, now), Err(2), "{}", point.name);
            continue;
        }
        let expected = registers(point, measured.as_ref());
        assert_eq!(
            read(meter, start, count, now),
            Ok(expected),
            "{}",
            point.name
        );
        let value = value(meter.profile(), measured.as_ref(), &point.name);
        assert!(value.is_ok(), "{}: {value:?}", point.name);
    }
}

/// Tests the identities of a profile on what a model measures.
pub(crate) fn every_identity_holds(profile: &Profile, measured: &dyn Measured) {
    assert!(!profile.identities.is_empty());
    for identity in &profile.identities {
        let outcome = identity.test(|point| {
            let value = figure(profile, measured, point);
            Some(Figure { value, step: 0.0 })
        });
        assert!(
            matches!(outcome, Outcome::Holds { .. }),
            "{}: {outcome:?}",
            identity.law
        );
    }
}

/// Writes one register with function 06; the exception code where that is refused.
pub(crate) fn write(meter: &mut Meter, address: u16, value: u16, now: Timestamp) -> Option<u8> {
    let [[a, b], [c, d]] = [address, value].map(u16::to_be_bytes);
    exception(meter, &[6, a, b, c, d], now)
}

/// Writes registers with function 16; the exception code where that is refused.
pub(crate) fn write_many(
    meter: &mut Meter,
    start: u16,
    values: &[u16],
    now: Timestamp,
) -> Option<u8> {
    exception(meter, &many(start, values), now)
}

/// The data unit of function 16.
pub(crate) fn many(start: u16, values: &[u16]) -> Vec<u8> {
    let count = u8::try_from(values.len()).unwrap();
    let [high, low] = start.to_be_bytes();
    let head = [16, high, low, 0, count, 2 * count];
    let values = values.iter().flat_map(|value| value.to_be_bytes());
    head.into_iter().chain(values).collect()
}

/// What a point of a meter reads as, with its setup as that reads.
pub(crate) fn shown(meter: &mut Meter, point: &str, now: Timestamp) -> String {
    let profile = meter.profile().clone();
    let mut registers = |name: &str| {
        let range = profile.point(name).unwrap().range;
        read(meter, range.start().get(), range.count(), now).unwrap()
    };
    let point = profile.point(point).unwrap();
    let setup = Setup::of(std::slice::from_ref(point), Some(&profile));
    let names = setup.points().iter().map(|point| &point.name);
    let scales = setup.scales(&names.map(|name| (name.clone(), registers(name))).collect());
    let value = point.interpret(&registers(&point.name), &scales);
    value.unwrap().to_string()
}

/// The same as a number.
pub(crate) fn reading(meter: &mut Meter, point: &str, now: Timestamp) -> f64 {
    shown(meter, point, now).parse().unwrap()
}

/// Tests the identities of a meter's profile on what it reads as.
pub(crate) fn every_identity_holds_when_read(meter: &mut Meter, now: Timestamp) {
    for identity in meter.profile().identities.clone() {
        let mut values = BTreeMap::new();
        for point in identity.law.points() {
            values.insert(point.to_owned(), reading(meter, point, now));
        }
        let outcome = identity.test(|point| {
            let value = values[point];
            Some(Figure { value, step: 0.0 })
        });
        assert!(
            matches!(outcome, Outcome::Holds { .. }),
            "{}: {outcome:?}",
            identity.law
        );
    }
}
