//! What a meter does when it is told to.

use toml::Spanned;

use super::point::{label_table, named, only_with, parsed, writable};
use super::writing::{broadcasting, hazard};
use super::{SharedLabels, Source, scaling};
use crate::codec::value::{ByteOrder, RegisterType};
use crate::codec::{FunctionCode, RegisterAddress, RegisterRange};
use crate::profile::error::{Problem, ProfileError};
use crate::profile::format::{DataTable, OperationTable};
use crate::profile::model::Limits;
use crate::profile::point::{Access, Labels, Point};
use crate::profile::writing::{Action, Broadcasting, CommandRegisters, Operation, Writing};

/// What operations are checked against.
pub(super) struct Known<'a> {
    pub(super) points: &'a [Point],
    pub(super) labels: &'a SharedLabels,
    pub(super) limits: &'a Limits,
    pub(super) command_registers: Option<CommandRegisters>,
}

impl Known<'_> {
    fn has(&self, function: FunctionCode) -> bool {
        self.limits.functions.contains(&function)
    }

    /// What the profile says of the danger of writing to this register.
    fn hazard_at(&self, register: u16) -> Option<String> {
        let place = RegisterRange::new(register, 1).ok()?;
        let mut points = self
            .points
            .iter()
            .filter(|point| point.range.overlaps(place));
        points.find_map(|point| point.writing().hazard.clone())
    }
}

/// All operations, no two of one name or with one effect; those with numbers first, by these.
pub(super) fn operations(
    source: &Source<'_>,
    tables: &[Spanned<OperationTable>],
    known: &Known<'_>,
) -> Result<Vec<Operation>, ProfileError> {
    let mut operations: Vec<Operation> = Vec::with_capacity(tables.len());
    for table in tables {
        let found = operation(source, table, known)?;
        let name = &table.as_ref().name;
        for (other, before) in operations.iter().zip(tables) {
            let what = if other.name == found.name {
                "name"
            } else if is_same(&other.action, &found.action) {
                "effect"
            } else {
                continue;
            };
            let first = source.line_of(before.as_ref().name.span().start);
            let problem = Problem::DuplicateOperation { what, first };
            let key = format!("operations.{}", found.name);
            return Err(source.error(name.span(), key, problem));
        }
        operations.push(found);
    }
    operations.sort_by_key(|operation| match operation.action {
        Action::Number { number, .. } => number.into(),
        Action::Register { .. } => u32::MAX,
    });
    Ok(operations)
}

fn is_same(one: &Action, other: &Action) -> bool {
    match (one, other) {
        (Action::Number { number: one, .. }, Action::Number { number: other, .. }) => one == other,
        (one, other) => one == other,
    }
}

fn operation(
    source: &Source<'_>,
    table: &Spanned<OperationTable>,
    known: &Known<'_>,
) -> Result<Operation, ProfileError> {
    let at = table.span();
    let table = table.as_ref();
    source.name(&table.name, "operations.name")?;
    let name = table.name.as_ref();
    let key = |key: &str| format!("operations.{name}.{key}");
    let action = match (&table.number, &table.register, &table.value) {
        (Some(number), None, None) => Action::Number {
            number: by_number(source, number, known, &key("number"))?,
            data: table
                .data
                .as_ref()
                .map(|found| data(source, table, found, known))
                .transpose()?
                .map(Box::new),
        },
        (None, Some(register), Some(value)) if table.data.is_none() => Action::Register {
            address: by_register(source, register, known, &key("register"))?,
            value: *value.as_ref(),
        },
        _ => {
            let what = "give number, with data or without, or register and value";
            return Err(source.error(at, format!("operations.{name}"), Problem::Conflict(what)));
        }
    };
    let told = hazard(source, table.hazard.as_ref(), &key("hazard"))?;
    if let Some(with) = &table.only_with {
        scaling::depends(source, with, known.points, &key("only_with"))?;
    }
    Ok(Operation {
        name: name.clone(),
        about: table.about.clone(),
        hazard: match action {
            Action::Register { address, .. } => told.or_else(|| known.hazard_at(address.get())),
            Action::Number { .. } => told,
        },
        broadcast: match &table.broadcast {
            None => Broadcasting::Unmarked,
            Some(word) => {
                let functions = functions(&action, known);
                broadcasting(source, word, &functions, known.limits, &key("broadcast"))?
            }
        },
        action,
        only_with: table.only_with.as_ref().map(only_with),
        verified: table.verified,
        page: table.page.clone(),
    })
}

/// The functions that can tell a meter to do this.
fn functions(action: &Action, known: &Known<'_>) -> Vec<FunctionCode> {
    let single = match action {
        // Nothing goes with the number of function 05.
        Action::Number { data: Some(_), .. } => None,
        Action::Number { data: None, .. } => Some(FunctionCode::WriteSingleCoil),
        Action::Register { .. } => Some(FunctionCode::WriteSingleRegister),
    };
    let by_commands =
        matches!(action, Action::Register { .. }) || known.command_registers.is_some();
    let several = by_commands.then_some(FunctionCode::WriteMultipleRegisters);
    single.into_iter().chain(several).collect()
}

fn by_number(
    source: &Source<'_>,
    number: &Spanned<u16>,
    known: &Known<'_>,
    key: &str,
) -> Result<u16, ProfileError> {
    if known.has(FunctionCode::WriteSingleCoil) || known.command_registers.is_some() {
        return Ok(*number.as_ref());
    }
    let expected = "of use without 5 in limits.functions or command_registers";
    Err(source.value(number, key, expected))
}

fn by_register(
    source: &Source<'_>,
    register: &Spanned<u16>,
    known: &Known<'_>,
    key: &str,
) -> Result<RegisterAddress, ProfileError> {
    let writes = [
        FunctionCode::WriteSingleRegister,
        FunctionCode::WriteMultipleRegisters,
    ];
    if writes.into_iter().any(|function| known.has(function)) {
        return Ok(RegisterAddress(*register.as_ref()));
    }
    let shown = Spanned::new(register.span(), register.as_ref());
    Err(source.value(&shown, key, "of use without 6 or 16 in limits.functions"))
}

/// What goes with the number, as a point behind it.
fn data(
    source: &Source<'_>,
    operation: &OperationTable,
    table: &Spanned<DataTable>,
    known: &Known<'_>,
) -> Result<Point, ProfileError> {
    let (at, table) = (table.span(), table.as_ref());
    let name = operation.name.as_ref();
    let key = |key: &str| format!("operations.{name}.data.{key}");
    let Some(commands) = known.command_registers else {
        let problem = Problem::Conflict("without command_registers there is no place for it");
        return Err(source.error(at, format!("operations.{name}.data"), problem));
    };
    let kind: RegisterType = parsed(source, &table.kind, key("type"))?;
    // The code and the number are written with it.
    let most = known.limits.write_registers.saturating_sub(BEFORE_DATA);
    let start = commands.address.get().checked_add(BEFORE_DATA);
    let range = start
        .filter(|_| kind.registers() <= most)
        .and_then(|start| RegisterRange::new(start, kind.registers()).ok());
    let Some(range) = range else {
        let expected = format!("a type of at most {most} registers, that fit behind the number");
        return Err(source.value(&table.kind, &key("type"), expected));
    };
    let limits = table
        .range
        .as_ref()
        .map(|range| writable(source, range, kind, &key("range")))
        .transpose()?;
    let labels = match &table.labels {
        None => Labels::None,
        Some(labels) => named(source, labels, kind, known.labels, &key("labels"))?,
    };
    Ok(Point {
        name: name.clone(),
        about: table.about.clone(),
        access: Access::Write,
        writing: named_alone(&labels, limits),
        limits,
        labels,
        label_table: table.labels.as_ref().and_then(label_table),
        verified: operation.verified,
        page: operation.page.clone(),
        ..Point::raw(range, kind, ByteOrder::default())
    })
}

/// Of codes that have names, those alone mean something to an operation.
fn named_alone(labels: &Labels, limits: Option<(i128, i128)>) -> Option<Box<Writing>> {
    let Labels::Codes(names) = labels else {
        return None;
    };
    let is_within = |code: &&u16| {
        let code = i128::from(**code);
        limits.is_none_or(|(lowest, highest)| (lowest..=highest).contains(&code))
    };
    let allowed = names.keys().filter(is_within);
    Some(Box::new(Writing {
        allowed: allowed.copied().map(i64::from).collect(),
        ..Writing::default()
    }))
}

/// The registers before the data: the code and the number.
const BEFORE_DATA: u16 = 2;
