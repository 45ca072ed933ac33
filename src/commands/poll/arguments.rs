//! From what was typed to what is polled.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use jiff::Timestamp;

use crate::cli::{Layout, LineArguments, Poll, RowFormat, SchemaChange};
use crate::commands::CommandError;
use crate::commands::asking::units;
use crate::commands::open_line::{SIMULATED, check_port, echo, manners, settings};
use crate::polling::site::{
    ColumnUnits, FailedRows, OnSchemaChange, PathError, PathTemplate, RowForm, RowSync, load,
};
use crate::polling::{Every, Job, Site, SiteLine, SiteOutput, Subject};
use crate::profile::selector::{Reading, select};
use crate::profile::{Limits, find};
use crate::transport::LineSettings;

/// What is polled: what a site file says, or the command line.
pub(super) fn site(arguments: &Poll) -> Result<Site, CommandError> {
    let site = match &arguments.config {
        Some(path) => load::file(path)?,
        None => typed(arguments)?,
    };
    for line in &site.lines {
        check_port(&line.port)?;
    }
    if let Some(problem) = clash(&site) {
        return Err(CommandError::Clash {
            file: arguments
                .config
                .as_ref()
                .map(|file| file.display().to_string()),
            problem,
        });
    }
    if !arguments.once
        && let Some(job) = site.jobs.iter().find(|job| job.every.is_none())
    {
        let what = job.subject.to_string();
        return Err(CommandError::NoInterval { what });
    }
    Ok(site)
}

/// What of a site would get in its own way, in a sentence.
fn clash(site: &Site) -> Option<String> {
    let mut ports: BTreeMap<&str, &str> = BTreeMap::new();
    for line in site.lines.iter().filter(|line| line.port != SIMULATED) {
        if let Some(first) = ports.insert(&line.port, &line.name) {
            let (port, second) = (&line.port, &line.name);
            return Some(format!("lines {first} and {second} have one port, {port}"));
        }
    }
    let is_idle = |index: &usize| site.jobs.iter().all(|job| job.subject.line != *index);
    let idle = (0..site.lines.len()).find(is_idle);
    if let Some(line) = idle.and_then(|index| site.lines.get(index)) {
        return Some(format!("there is no meter on line {}", line.name));
    }
    let mut files: BTreeMap<PathBuf, usize> = BTreeMap::new();
    for job in &site.jobs {
        let output = site.outputs.get(job.output)?;
        let Some(path) = &output.path else {
            continue;
        };
        let file = path.at(&job.subject.file_name, Timestamp::UNIX_EPOCH);
        let first = *files.entry(file).or_insert(job.output);
        if first != job.output {
            let first = &site.outputs.get(first)?.name;
            let (second, path) = (&output.name, path.text());
            return Some(format!(
                "outputs {first} and {second} have one file, {path}"
            ));
        }
    }
    None
}

fn typed(arguments: &Poll) -> Result<Site, CommandError> {
    let profile = arguments.meter.as_deref().map(find::find).transpose()?;
    let profile = profile.as_ref();
    let limits = profile.map_or_else(Limits::default, |profile| profile.limits.clone());
    let units = match &arguments.unit {
        Some(typed) => units(typed, &limits)?,
        // clap wants it where there is no site file.
        None => Vec::new(),
    };
    let reading = Reading {
        profile,
        ..Reading::default()
    };
    let points = select(&arguments.what, reading)?;
    let factory = profile.map_or_else(LineSettings::default, |profile| profile.line);
    let line = line(&arguments.line, factory);
    // The interval was checked where it was typed.
    let every = arguments.every.and_then(|every| Every::new(every).ok());
    let name = profile.map_or("", |profile| &profile.name);
    let is_alone = units.len() == 1;
    let jobs = units.into_iter().enumerate().map(|(meter, unit)| {
        let subject = Subject {
            name: name.to_owned(),
            file_name: match name {
                "" => format!("unit-{unit}"),
                name if is_alone => name.to_owned(),
                name => format!("{name}-{unit}"),
            },
            line: 0,
            unit,
            manners: manners(&arguments.line),
        };
        Job {
            meter,
            every,
            ..Job::new(subject, profile, points.clone(), line.settings)
        }
    });
    Ok(Site {
        jobs: jobs.collect(),
        outputs: vec![output(arguments)?],
        lines: vec![line],
    })
}

fn line(typed: &LineArguments, factory: LineSettings) -> SiteLine {
    let port = typed.port.clone().unwrap_or_default();
    SiteLine {
        name: port.clone(),
        port,
        settings: settings(typed.baud, typed.parity, typed.stop_bits, factory),
        echo: echo(typed),
        settle: typed.settle,
        wait: typed.wait,
    }
}

fn output(arguments: &Poll) -> Result<SiteOutput, CommandError> {
    let path = arguments.output.output.as_deref();
    let path = path.map(template).transpose()?;
    Ok(SiteOutput {
        name: path
            .as_ref()
            .map_or("stdout", PathTemplate::text)
            .to_owned(),
        path,
        form: form(arguments)?,
        syncing: if arguments.output.no_sync {
            RowSync::Never
        } else {
            RowSync::Each
        },
        on_schema_change: match arguments.output.on_schema_change {
            SchemaChange::Refuse => OnSchemaChange::Refuse,
            SchemaChange::NewFile => OnSchemaChange::NewFile,
        },
        failed: if arguments.skip_failed {
            FailedRows::Skipped
        } else {
            FailedRows::Written
        },
    })
}

fn template(path: &Path) -> Result<PathTemplate, CommandError> {
    let text = path.to_str().ok_or(PathError::NotUtf8);
    text.and_then(|text| PathTemplate::new("", text))
        .map_err(|problem| CommandError::Path {
            path: path.display().to_string(),
            problem,
        })
}

/// The form of rows. Options that would do nothing are refused.
fn form(arguments: &Poll) -> Result<RowForm, CommandError> {
    let no_effect = |option, what| Err(CommandError::NoEffect { option, what });
    let format = arguments.format.unwrap_or(RowFormat::Csv);
    match (format, arguments.layout) {
        (RowFormat::Csv, Some(Layout::Long)) if arguments.units => no_effect("--units", "wide CSV"),
        (RowFormat::Csv, Some(Layout::Long)) => Ok(RowForm::LongCsv),
        (RowFormat::Csv, _) if arguments.units => Ok(RowForm::WideCsv(ColumnUnits::Shown)),
        (RowFormat::Csv, _) => Ok(RowForm::WideCsv(ColumnUnits::Left)),
        (_, Some(_)) => no_effect("--layout", "--format csv"),
        _ if arguments.units => no_effect("--units", "--format csv"),
        (RowFormat::Jsonl, None) => Ok(RowForm::JsonLines),
        (RowFormat::Influx, None) => Ok(RowForm::Influx),
    }
}
