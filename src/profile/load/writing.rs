//! What a point says about being written.

use std::ops::Range;

use toml::Spanned;

use super::point::only_with;
use super::{Source, scaling, unknown};
use crate::codec::FunctionCode;
use crate::codec::value::RegisterType;
use crate::profile::error::{Problem, ProfileError};
use crate::profile::format::PointTable;
use crate::profile::model::Limits;
use crate::profile::point::{Access, Point};
use crate::profile::writing::{Broadcasting, Moves, WriteFunction, Writing};

/// What is to be known before the point of this row is written; `None` where that is nothing. Which
/// points there are is checked when all of them are known.
pub(super) fn writing(
    source: &Source<'_>,
    row: &PointTable,
    kind: RegisterType,
    access: Access,
    limits: &Limits,
) -> Result<Option<Writing>, ProfileError> {
    let key = |key: &str| format!("{}.{key}", row.name.as_ref());
    if !access.writable()
        && let Some((name, at)) = first_key(row)
    {
        let problem = Problem::Conflict("only a point that can be written has this");
        return Err(source.error(at, key(name), problem));
    }
    if access.readable()
        && let Some(shown_by) = &row.shown_by
    {
        let problem = Problem::Conflict("only a point that cannot be read is shown by another");
        return Err(source.error(shown_by.span(), key("shown_by"), problem));
    }
    let numbers = Numbers {
        source,
        row,
        kind,
        step: row.step.as_ref().map_or(1, |step| *step.as_ref()),
    };
    numbers.check_step()?;
    let function = row
        .write_function
        .as_ref()
        .map(|code| write_function(source, code, kind, limits, &key("write_function")))
        .transpose()?;
    let broadcast = match &row.broadcast {
        None => Broadcasting::Unmarked,
        Some(word) => {
            let functions = match function {
                Some(function) => vec![function.into()],
                None => vec![
                    FunctionCode::WriteSingleRegister,
                    FunctionCode::WriteMultipleRegisters,
                ],
            };
            broadcasting(source, word, &functions, limits, &key("broadcast"))?
        }
    };
    let writing = Writing {
        hazard: hazard(source, row.hazard.as_ref(), &key("hazard"))?,
        momentary: row.momentary.as_ref().is_some_and(|is| *is.as_ref()),
        moves: row
            .moves
            .as_ref()
            .map(|what| moves(source, what, &key("moves")))
            .transpose()?,
        step: row.step.as_ref().map_or(0, |step| *step.as_ref()),
        allowed: numbers.allowed()?,
        also: numbers.also()?,
        function,
        broadcast,
        only_with: row
            .writable_with
            .as_ref()
            .map(|with| only_with(with.as_ref())),
        shown_by: row.shown_by.as_ref().map(|name| name.as_ref().clone()),
    };
    Ok(Some(writing).filter(|writing| *writing != Writing::default()))
}

/// The first key there is that says something about writing.
fn first_key(row: &PointTable) -> Option<(&'static str, Range<usize>)> {
    fn at<T>(found: Option<&Spanned<T>>) -> Option<Range<usize>> {
        found.map(Spanned::span)
    }
    let keys = [
        ("hazard", at(row.hazard.as_ref())),
        ("momentary", at(row.momentary.as_ref())),
        ("moves", at(row.moves.as_ref())),
        ("step", at(row.step.as_ref())),
        ("allowed", at(row.allowed.as_ref())),
        ("also", at(row.also.as_ref())),
        ("write_function", at(row.write_function.as_ref())),
        ("broadcast", at(row.broadcast.as_ref())),
        ("writable_with", at(row.writable_with.as_ref())),
        ("shown_by", at(row.shown_by.as_ref())),
    ];
    let keys = keys.into_iter();
    keys.filter_map(|(key, at)| Some((key, at?)))
        .min_by_key(|(_, at)| at.start)
}

/// A clause that tells what is at stake.
pub(super) fn hazard(
    source: &Source<'_>,
    found: Option<&Spanned<String>>,
    key: &str,
) -> Result<Option<String>, ProfileError> {
    match found {
        Some(text) if text.as_ref().trim().is_empty() => {
            Err(source.value(text, key, "a few words that complete \"this ...\""))
        }
        found => Ok(found.map(|text| text.as_ref().clone())),
    }
}

fn moves(source: &Source<'_>, what: &Spanned<String>, key: &str) -> Result<Moves, ProfileError> {
    match what.as_ref().as_str() {
        "address" => Ok(Moves::Address),
        "port" => Ok(Moves::Port),
        _ => Err(source.value(what, key, "\"address\" or \"port\"")),
    }
}

/// `allowed` or `only`, on a meter that obeys one of these functions on address 0.
pub(super) fn broadcasting(
    source: &Source<'_>,
    word: &Spanned<String>,
    functions: &[FunctionCode],
    limits: &Limits,
    key: &str,
) -> Result<Broadcasting, ProfileError> {
    let broadcasting = match word.as_ref().as_str() {
        "allowed" => Broadcasting::Allowed,
        "only" => Broadcasting::Only,
        _ => return Err(source.value(word, key, "\"allowed\" or \"only\"")),
    };
    let obeyed = &limits.broadcast_functions;
    if functions.iter().any(|function| obeyed.contains(function)) {
        return Ok(broadcasting);
    }
    let codes: Vec<String> = functions
        .iter()
        .map(|code| code.get().to_string())
        .collect();
    let codes = codes.join(" or ");
    let expected = format!("of use without {codes} in limits.broadcast_functions");
    Err(source.value(word, key, expected))
}

fn write_function(
    source: &Source<'_>,
    code: &Spanned<u8>,
    kind: RegisterType,
    limits: &Limits,
    key: &str,
) -> Result<WriteFunction, ProfileError> {
    let function = match code.as_ref() {
        6 if kind.registers() > 1 => {
            let expected = format!("16: function 6 writes one register, {kind} takes more");
            return Err(source.value(code, key, expected));
        }
        6 => WriteFunction::SingleRegister,
        16 => WriteFunction::MultipleRegisters,
        _ => return Err(source.value(code, key, "6 or 16")),
    };
    if limits.functions.contains(&function.into()) {
        return Ok(function);
    }
    Err(source.value(code, key, "one of limits.functions"))
}

/// The raw numbers that a point takes.
struct Numbers<'a> {
    source: &'a Source<'a>,
    row: &'a PointTable,
    kind: RegisterType,
    step: u16,
}

impl Numbers<'_> {
    fn key(&self, key: &str) -> String {
        format!("{}.{key}", self.row.name.as_ref())
    }

    fn conflict<T>(&self, found: &Spanned<T>, key: &str, what: &'static str) -> ProfileError {
        let problem = Problem::Conflict(what);
        self.source.error(found.span(), self.key(key), problem)
    }

    fn check_step(&self) -> Result<(), ProfileError> {
        let Some(step) = &self.row.step else {
            return Ok(());
        };
        // That of a time is one of milliseconds.
        if !self.kind.is_integer() && self.kind != RegisterType::Time {
            return Err(self.conflict(step, "step", "only an integer or a time has a step"));
        }
        if self.step < 2 {
            let key = self.key("step");
            return Err(self.source.value(step, &key, "2 or more"));
        }
        Ok(())
    }

    /// Whether `range` has it; all numbers where there is none.
    fn is_in_range(&self, number: i64) -> bool {
        match self
            .row
            .range
            .as_ref()
            .map(|range| range.as_ref().as_slice())
        {
            Some([lowest, highest]) => (*lowest..=*highest).contains(&number),
            // Any other list was refused when the range was read.
            _ => true,
        }
    }

    fn allowed(&self) -> Result<Vec<i64>, ProfileError> {
        let Some(list) = &self.row.allowed else {
            return Ok(Vec::new());
        };
        if self.row.step.is_some() {
            return Err(self.conflict(list, "allowed", "give either allowed or step"));
        }
        let numbers = self.listed(list, "allowed")?;
        for (number, found) in numbers.iter().zip(list.as_ref()) {
            if !self.is_in_range(*number) {
                let key = self.key("allowed");
                return Err(self.source.value(found, &key, "within range"));
            }
        }
        Ok(numbers)
    }

    fn also(&self) -> Result<Vec<i64>, ProfileError> {
        let Some(list) = &self.row.also else {
            return Ok(Vec::new());
        };
        if self.row.range.is_none() || self.row.allowed.is_some() {
            let what = "give it with a range: allowed names every number itself";
            return Err(self.conflict(list, "also", what));
        }
        let numbers = self.listed(list, "also")?;
        for (number, found) in numbers.iter().zip(list.as_ref()) {
            if self.is_in_range(*number) && number % i64::from(self.step) == 0 {
                let key = self.key("also");
                return Err(self.source.value(found, &key, "beyond range and step"));
            }
        }
        Ok(numbers)
    }

    /// Numbers of the type, each once.
    fn listed(
        &self,
        list: &Spanned<Vec<Spanned<i64>>>,
        key: &str,
    ) -> Result<Vec<i64>, ProfileError> {
        let Some((least, most)) = self.kind.bounds() else {
            let what = "only an integer has a list of numbers";
            return Err(self.conflict(list, key, what));
        };
        if list.as_ref().is_empty() {
            return Err(self.source.value(list, &self.key(key), "a list of numbers"));
        }
        let mut numbers = Vec::with_capacity(list.as_ref().len());
        for found in list.as_ref() {
            let number = *found.as_ref();
            if !(least..=most).contains(&number.into()) {
                let kind = self.kind;
                let expected = format!("within {least} to {most}, what {kind} holds");
                return Err(self.source.value(found, &self.key(key), expected));
            }
            if numbers.contains(&number) {
                return Err(self.conflict(found, key, "this number is in the list twice"));
            }
            numbers.push(number);
        }
        Ok(numbers)
    }
}

/// Checks what the rows refer to when they speak of writing.
pub(super) fn references(
    source: &Source<'_>,
    rows: &[PointTable],
    points: &[Point],
) -> Result<(), ProfileError> {
    for row in rows {
        let key = |key: &str| format!("{}.{key}", row.name.as_ref());
        if let Some(with) = &row.writable_with {
            scaling::depends(source, with.as_ref(), points, &key("writable_with"))?;
        }
        let Some(name) = &row.shown_by else {
            continue;
        };
        let named = points.iter().find(|point| point.name == *name.as_ref());
        let shown = named.ok_or_else(|| unknown(source, name, "point", &key("shown_by")))?;
        // The type of the row was parsed when its points were made.
        if !shown.access.readable() || shown.kind.to_string() != *row.kind.as_ref() {
            let expected = format!("a point of type {} that can be read", row.kind.as_ref());
            return Err(source.value(name, &key("shown_by"), expected));
        }
    }
    Ok(())
}
