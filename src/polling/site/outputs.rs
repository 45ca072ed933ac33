//! `[[outputs]]`, checked.

use std::path::Path;

use toml::Spanned;

use super::error::{SiteError, SiteProblem};
use super::format::OutputTable;
use super::source::Source;
use super::{ColumnUnits, FailedRows, OnSchemaChange, PathTemplate, RowForm, RowSync, SiteOutput};

/// The formats there are.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Format {
    Csv,
    JsonLines,
    Influx,
}

/// The outputs of a site; stdout when there are none.
pub(super) fn outputs(
    source: &Source<'_>,
    folder: &Path,
    tables: &[OutputTable],
) -> Result<Vec<SiteOutput>, SiteError> {
    if tables.is_empty() {
        return Ok(vec![SiteOutput::stdout()]);
    }
    tables
        .iter()
        .map(|table| output(source, folder, table))
        .collect()
}

impl SiteOutput {
    /// Wide CSV on stdout.
    pub fn stdout() -> Self {
        Self {
            name: "stdout".to_owned(),
            path: None,
            form: RowForm::WideCsv(ColumnUnits::Left),
            syncing: RowSync::Each,
            on_schema_change: OnSchemaChange::Refuse,
            failed: FailedRows::Written,
        }
    }
}

fn output(
    source: &Source<'_>,
    folder: &Path,
    table: &OutputTable,
) -> Result<SiteOutput, SiteError> {
    let name = table.name.as_ref().clone();
    let key = |key: &str| format!("outputs.{name}.{key}");
    let path = table.path.as_ref().map(|path| {
        PathTemplate::new(folder, path.as_ref())
            .map_err(|error| source.error(path.span(), key("path"), SiteProblem::Path(error)))
    });
    let is_said = |flag: Option<&Spanned<bool>>| flag.is_some_and(|flag| *flag.as_ref());
    let changes = [
        ("refuse", OnSchemaChange::Refuse),
        ("new-file", OnSchemaChange::NewFile),
    ];
    let on_schema_change = table.on_schema_change.as_ref();
    let on_schema_change =
        on_schema_change.map(|change| source.word(change, &key("on_schema_change"), &changes));
    Ok(SiteOutput {
        path: path.transpose()?,
        form: form(source, table, &key)?,
        syncing: if is_said(table.no_sync.as_ref()) {
            RowSync::Never
        } else {
            RowSync::Each
        },
        on_schema_change: on_schema_change
            .transpose()?
            .unwrap_or(OnSchemaChange::Refuse),
        failed: if is_said(table.skip_failed.as_ref()) {
            FailedRows::Skipped
        } else {
            FailedRows::Written
        },
        name,
    })
}

fn form(
    source: &Source<'_>,
    table: &OutputTable,
    key: &dyn Fn(&str) -> String,
) -> Result<RowForm, SiteError> {
    let formats = [
        ("csv", Format::Csv),
        ("jsonl", Format::JsonLines),
        ("influx", Format::Influx),
    ];
    let format = table.format.as_ref();
    let format = format.map(|format| source.word(format, &key("format"), &formats));
    let format = format.transpose()?.unwrap_or(Format::Csv);
    let layouts = [("wide", false), ("long", true)];
    let layout = table.layout.as_ref();
    let is_long = layout.map(|layout| source.word(layout, &key("layout"), &layouts));
    let is_long = is_long.transpose()?;
    let no_effect = |at, name: &str, what| {
        let problem = SiteProblem::Conflict(what);
        Err(source.error(at, key(name), problem))
    };
    let is_wide = format == Format::Csv && is_long != Some(true);
    if let Some(layout) = &table.layout
        && format != Format::Csv
    {
        return no_effect(layout.span(), "layout", "only CSV has a layout");
    }
    if let Some(units) = &table.units
        && !is_wide
    {
        return no_effect(
            units.span(),
            "units",
            "only wide CSV has units in its header",
        );
    }
    Ok(match (format, is_wide) {
        (Format::Csv, true) => {
            let units = table.units.as_ref().is_some_and(|units| *units.as_ref());
            RowForm::WideCsv(if units {
                ColumnUnits::Shown
            } else {
                ColumnUnits::Left
            })
        }
        (Format::Csv, false) => RowForm::LongCsv,
        (Format::JsonLines, _) => RowForm::JsonLines,
        (Format::Influx, _) => RowForm::Influx,
    })
}
