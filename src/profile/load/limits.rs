//! `[limits]`, checked.

use std::time::Duration;

use toml::Spanned;

use super::Source;
use crate::codec::{FunctionCode, ReadFunction, RegisterBlock, RegisterRange, UnitRange};
use crate::profile::error::ProfileError;
use crate::profile::format::LimitsTable;
use crate::profile::model::{Limits, LoopbackData};

/// The limits, each within those of the standard.
pub(super) fn limits(source: &Source<'_>, table: &LimitsTable) -> Result<Limits, ProfileError> {
    let default = Limits::default();
    let units = match &table.highest_unit {
        None => default.units,
        Some(unit) => match unit.as_ref() {
            247 => UnitRange::Standard,
            255 => UnitRange::Extended,
            _ => return Err(source.value(unit, "limits.highest_unit", "247 or 255")),
        },
    };
    let functions: Vec<FunctionCode> = match &table.functions {
        None => default.functions,
        Some(codes) => functions(source, codes)?,
    };
    let mut broadcast_functions = Vec::new();
    for code in &table.broadcast_functions {
        let key = "limits.broadcast_functions";
        let function = function(source, code, key)?;
        if !matches!(code.as_ref(), 5 | 6 | 16) {
            return Err(source.value(code, key, "5, 6 or 16, a function that writes"));
        }
        if !functions.contains(&function) {
            return Err(source.value(code, key, "one of limits.functions"));
        }
        broadcast_functions.push(function);
    }
    let loopback_data = loopback_data(source, table, &functions)?;
    let broadcasts_marked_only = marked_only(source, table)?;
    let table_registers = table
        .table_registers
        .as_ref()
        .map(|size| source.bounded(Some(size), "limits.table_registers", 0x8000))
        .transpose()?;
    Ok(Limits {
        units,
        functions,
        interchangeable_reads: table.interchangeable_reads,
        broadcast_functions,
        broadcasts_marked_only,
        loopback_data,
        read_registers: source.bounded(
            table.read_registers.as_ref(),
            "limits.read_registers",
            RegisterRange::MOST,
        )?,
        write_registers: source.bounded(
            table.write_registers.as_ref(),
            "limits.write_registers",
            RegisterBlock::MOST,
        )?,
        read_holes: table.read_holes,
        table_registers,
        typical_answer: source.duration(
            table.typical_answer.as_ref(),
            "limits.typical_answer",
            default.typical_answer,
        )?,
        longest_answer: longest_answer(source, table, default.longest_answer)?,
        pause: source.duration(table.pause.as_ref(), "limits.pause", default.pause)?,
    })
}

/// Whether what is marked is all that may be written to all meters at once.
fn marked_only(source: &Source<'_>, table: &LimitsTable) -> Result<bool, ProfileError> {
    let key = "limits.broadcast";
    let Some(word) = &table.broadcast else {
        return Ok(false);
    };
    let is_marked = match word.as_ref().as_str() {
        "any" => false,
        "marked" => true,
        _ => return Err(source.value(word, key, "\"any\" or \"marked\"")),
    };
    if table.broadcast_functions.is_empty() {
        return Err(source.value(word, key, "of use without limits.broadcast_functions"));
    }
    Ok(is_marked)
}

/// What function 08 sends back, which only a meter that has it can say.
fn loopback_data(
    source: &Source<'_>,
    table: &LimitsTable,
    functions: &[FunctionCode],
) -> Result<LoopbackData, ProfileError> {
    let key = "limits.loopback_data";
    let Some(word) = &table.loopback_data else {
        return Ok(LoopbackData::default());
    };
    let data = match word.as_ref().as_str() {
        "any" => LoopbackData::Any,
        "zero" => LoopbackData::Zero,
        _ => return Err(source.value(word, key, "\"any\" or \"zero\"")),
    };
    if functions.contains(&FunctionCode::Diagnostics) {
        return Ok(data);
    }
    Err(source.value(word, key, "of use without 8 in limits.functions"))
}

/// The time-out where none is asked for, so it is above zero.
fn longest_answer(
    source: &Source<'_>,
    table: &LimitsTable,
    default: Duration,
) -> Result<Duration, ProfileError> {
    let key = "limits.longest_answer";
    let time = source.duration(table.longest_answer.as_ref(), key, default)?;
    match &table.longest_answer {
        Some(text) if time.is_zero() => Err(source.value(text, key, "a time above 0s")),
        _ => Ok(time),
    }
}

fn functions(
    source: &Source<'_>,
    codes: &Spanned<Vec<Spanned<u8>>>,
) -> Result<Vec<FunctionCode>, ProfileError> {
    let key = "limits.functions";
    let functions: Vec<FunctionCode> = codes
        .as_ref()
        .iter()
        .map(|code| function(source, code, key))
        .collect::<Result<_, _>>()?;
    let reads = [ReadFunction::HoldingRegisters, ReadFunction::InputRegisters];
    if !reads
        .iter()
        .any(|read| functions.contains(&FunctionCode::from(*read)))
    {
        return Err(source.value(codes, key, "a list with 3 or 4 in it, to read with"));
    }
    Ok(functions)
}

fn function(
    source: &Source<'_>,
    code: &Spanned<u8>,
    key: &str,
) -> Result<FunctionCode, ProfileError> {
    match FunctionCode::try_from(*code.as_ref()) {
        Ok(FunctionCode::Other(_)) | Err(_) => {
            Err(source.value(code, key, "3, 4, 5, 6, 7, 8 or 16"))
        }
        Ok(known) => Ok(known),
    }
}
