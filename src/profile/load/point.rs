//! One point of the file, checked.

use std::sync::Arc;

use toml::Spanned;

use super::{SharedLabels, Source, scaling, writing};
use crate::codec::value::RegisterType;
use crate::codec::{FunctionCode, ReadFunction, RegisterRange};
use crate::profile::error::{Problem, ProfileError};
use crate::profile::format::{LabelTable, LabelsKey, NoValueTable, OnlyWithTable, PointTable};
use crate::profile::model::Limits;
use crate::profile::point::{Access, Labels, Marker, Names, NoValue, OnlyWith, Point};
use crate::profile::value::Missing;

/// The points of one row: one, or as many as it repeats, each checked against itself and the meter's
/// limits.
pub(super) fn row(
    source: &Source<'_>,
    row: &PointTable,
    shared: &SharedLabels,
    limits: &Limits,
) -> Result<Vec<Point>, ProfileError> {
    let first = point(source, row, shared, limits)?;
    let Some(repeat) = &row.repeat else {
        return Ok(vec![first]);
    };
    let key = |key: &str| format!("{}.{key}", first.name);
    let (start, width) = (first.range.start().get(), first.range.count());
    let most = (0x1_0000 - u32::from(start)) / u32::from(width);
    if !(2..=most).contains(&u32::from(*repeat.as_ref())) {
        let expected = format!("2 or more, of which {most} lie within 0xFFFF");
        return Err(source.value(repeat, &key("repeat"), expected));
    }
    let places = (0..*repeat.as_ref()).map(|place| {
        let start = start + place * width;
        Ok(Point {
            name: format!("{}_{}", first.name, place + 1),
            range: range(source, row, start, first.kind, limits, &key)?,
            ..first.clone()
        })
    });
    places.collect()
}

fn point(
    source: &Source<'_>,
    row: &PointTable,
    shared: &SharedLabels,
    limits: &Limits,
) -> Result<Point, ProfileError> {
    let name = row.name.as_ref().clone();
    source.name(&row.name, "points.name")?;
    let key = |key: &str| format!("{name}.{key}");
    let kind: RegisterType = parsed(source, &row.kind, key("type"))?;
    let order = match &row.order {
        Some(order) => parsed(source, order, key("order"))?,
        None => crate::codec::value::ByteOrder::default(),
    };
    let range = range(source, row, *row.address.as_ref(), kind, limits, &key)?;
    let scaling = scaling::scaling(source, row, kind, &key)?;
    let labels = match &row.labels {
        None => Labels::None,
        Some(labels) => named(source, labels, kind, shared, &key("labels"))?,
    };
    let access = access(source, row.access.as_ref(), &key("access"))?;
    Ok(Point {
        about: row.about.clone(),
        range,
        kind,
        order,
        scaling,
        unit: row.unit.clone().filter(|unit| !unit.is_empty()),
        access,
        limits: row
            .range
            .as_ref()
            .map(|range| writable(source, range, kind, &key("range")))
            .transpose()?,
        labels,
        label_table: row.labels.as_ref().and_then(label_table),
        no_value: row
            .no_value
            .as_ref()
            .map(|marker| no_value(source, marker, kind, &key("no_value")))
            .transpose()?,
        only_with: row.only_with.as_ref().map(only_with),
        alone: row.alone,
        function: row
            .function
            .as_ref()
            .map(|code| read_function(source, code, limits, &key("function")))
            .transpose()?,
        writing: writing::writing(source, row, kind, access, limits)?.map(Box::new),
        verified: row.verified,
        page: row.page.clone(),
        name,
    })
}

/// What a point depends on; whether there is such a point is checked when all are known.
pub(super) fn only_with(table: &OnlyWithTable) -> OnlyWith {
    OnlyWith {
        point: table.point.as_ref().clone(),
        codes: table.codes.as_ref().map(|codes| codes.as_ref().clone()),
    }
}

/// The name of the table that labels stand in, where points share it.
pub(super) fn label_table(labels: &Spanned<LabelsKey>) -> Option<Arc<str>> {
    match labels.as_ref() {
        LabelsKey::Shared(name) => Some(name.as_str().into()),
        LabelsKey::Own(_) => None,
    }
}

pub(super) fn parsed<T: std::str::FromStr<Err: std::fmt::Display>>(
    source: &Source<'_>,
    text: &Spanned<String>,
    key: String,
) -> Result<T, ProfileError> {
    text.as_ref()
        .parse()
        .map_err(|error: T::Err| source.error(text.span(), key, Problem::Syntax(error.to_string())))
}

fn range(
    source: &Source<'_>,
    row: &PointTable,
    start: u16,
    kind: RegisterType,
    limits: &Limits,
    key: &impl Fn(&str) -> String,
) -> Result<RegisterRange, ProfileError> {
    let count = kind.registers();
    let past_end = |end: String| {
        let problem = Problem::PastEnd { start, count, end };
        source.error(row.address.span(), key("address"), problem)
    };
    if count > limits.read_registers {
        let problem = Problem::TooWide {
            count,
            most: limits.read_registers,
        };
        return Err(source.error(row.kind.span(), key("type"), problem));
    }
    if let Some(size) = limits.table_registers
        && start / size != start.saturating_add(count - 1) / size
    {
        return Err(past_end(format!("the end of its table of {size}")));
    }
    RegisterRange::new(start, count).map_err(|_| past_end("0xFFFF, the last address".to_owned()))
}

fn access(
    source: &Source<'_>,
    access: Option<&Spanned<String>>,
    key: &str,
) -> Result<Access, ProfileError> {
    let Some(text) = access else {
        return Ok(Access::Read);
    };
    match text.as_ref().as_str() {
        "read" => Ok(Access::Read),
        "write" => Ok(Access::Write),
        "read-write" => Ok(Access::ReadWrite),
        _ => Err(source.value(text, key, "\"read\", \"write\" or \"read-write\"")),
    }
}

/// The raw numbers that may be written.
pub(super) fn writable(
    source: &Source<'_>,
    range: &Spanned<Vec<i64>>,
    kind: RegisterType,
    key: &str,
) -> Result<(i128, i128), ProfileError> {
    let Some((least, most)) = kind.bounds() else {
        let problem = Problem::Conflict("only an integer has a range");
        return Err(source.error(range.span(), key, problem));
    };
    if let [lowest, highest] = *range.as_ref().as_slice() {
        let (lowest, highest) = (i128::from(lowest), i128::from(highest));
        if least <= lowest && lowest <= highest && highest <= most {
            return Ok((lowest, highest));
        }
    }
    let expected = format!("[lowest, highest] within {least} to {most}, what {kind} holds");
    Err(source.value(range, key, expected))
}

fn read_function(
    source: &Source<'_>,
    code: &Spanned<u8>,
    limits: &Limits,
    key: &str,
) -> Result<ReadFunction, ProfileError> {
    let function = match code.as_ref() {
        3 => ReadFunction::HoldingRegisters,
        4 => ReadFunction::InputRegisters,
        _ => return Err(source.value(code, key, "3 or 4")),
    };
    if limits.functions.contains(&FunctionCode::from(function)) {
        return Ok(function);
    }
    Err(source.value(code, key, "one of limits.functions"))
}

fn no_value(
    source: &Source<'_>,
    table: &Spanned<NoValueTable>,
    kind: RegisterType,
    key: &str,
) -> Result<NoValue, ProfileError> {
    let conflict = |what| Err(source.error(table.span(), key, Problem::Conflict(what)));
    let marker = match (table.as_ref().high_word, &table.as_ref().raw) {
        (Some(word), None) => Marker::HighWord(word),
        (None, Some(raw)) => Marker::Raw(raw_marker(source, raw, kind, key)?),
        _ => return conflict("give either high_word or raw"),
    };
    let means = &table.as_ref().means;
    let missing = match means.as_ref().as_str() {
        "overflow" => Missing::Overflow,
        "absent" => Missing::Absent,
        _ => {
            let key = format!("{key}.means");
            return Err(source.value(means, &key, "\"overflow\" or \"absent\""));
        }
    };
    Ok(NoValue { marker, missing })
}

/// A number that can be found in the registers: another would never mark anything.
fn raw_marker(
    source: &Source<'_>,
    raw: &Spanned<i64>,
    kind: RegisterType,
    key: &str,
) -> Result<i128, ProfileError> {
    let number = i128::from(*raw.as_ref());
    match kind.bounds() {
        Some((least, most)) if kind != RegisterType::Letter => {
            if (least..=most).contains(&number) {
                return Ok(number);
            }
            let expected = format!("within {least} to {most}, what {kind} holds");
            Err(source.value(raw, &format!("{key}.raw"), expected))
        }
        _ => {
            let problem = Problem::Conflict("only an integer has a raw marker; use high_word");
            Err(source.error(raw.span(), format!("{key}.raw"), problem))
        }
    }
}

/// Labels, of a type that can have them.
pub(super) fn named(
    source: &Source<'_>,
    labels: &Spanned<LabelsKey>,
    kind: RegisterType,
    shared: &SharedLabels,
    key: &str,
) -> Result<Labels, ProfileError> {
    let names = match labels.as_ref() {
        LabelsKey::Own(table) => Arc::new(label_names(source, table, key)?),
        LabelsKey::Shared(name) => shared.get(name).cloned().ok_or_else(|| {
            let problem = Problem::Unknown {
                what: "label table",
                found: name.clone(),
            };
            source.error(labels.span(), key, problem)
        })?,
    };
    match kind {
        RegisterType::Bits => Ok(Labels::Bits(names)),
        RegisterType::U16 | RegisterType::I16 | RegisterType::Hex => Ok(Labels::Codes(names)),
        _ => {
            let problem = Problem::Conflict("only u16, i16, hex and bits have labels");
            Err(source.error(labels.span(), key, problem))
        }
    }
}

/// Labels by number. `1` and `0x1` are one number, so a table can clash with itself.
pub(super) fn label_names(
    source: &Source<'_>,
    table: &LabelTable,
    key: &str,
) -> Result<Names, ProfileError> {
    let mut names = Names::new();
    let mut rows: Vec<_> = table.iter().collect();
    rows.sort_by_key(|(code, _)| code.span().start);
    for (code, name) in rows {
        let number = self::code(source, code, key)?;
        if let Some(first) = names.insert(number, name.clone()) {
            let problem = Problem::LabelClash {
                code: code.as_ref().clone(),
                first,
                second: name.clone(),
            };
            return Err(source.error(code.span(), key, problem));
        }
    }
    Ok(names)
}

/// A code as a key: decimal or `0x`.
pub(super) fn code(
    source: &Source<'_>,
    written: &Spanned<String>,
    key: &str,
) -> Result<u16, ProfileError> {
    let expected = "a code: 0 to 65535, or 0x0 to 0xFFFF";
    number(written.as_ref()).ok_or_else(|| source.value(written, key, expected))
}

/// The number that a code stands for.
pub(in crate::profile) fn number(code: &str) -> Option<u16> {
    match code.strip_prefix("0x") {
        Some(hex) => u16::from_str_radix(hex, 16).ok(),
        None => code.parse().ok(),
    }
}
