//! The strict loader of site files: TOML text to a checked [`Site`], or one error with file, line
//! and key.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use toml::Spanned;

use super::error::{SiteError, SiteProblem};
use super::format::{DefaultsTable, LineTable, MeterTable, SiteFile};
use super::source::Source;
use super::{Site, SiteLine, outputs, syntax};
use crate::client::Echo;
use crate::codec::{Unit, UnitRange};
use crate::polling::job::{Job, Manners, Subject};
use crate::polling::schedule::Every;
use crate::profile::find::FindError;
use crate::profile::selector::{Reading, select};
use crate::profile::{Profile, find};
use crate::transport::{LineSettings, Parity, StopBits};

/// How often a read is repeated when nothing else is said.
const RETRIES: u32 = 2;

/// How long a busy port is waited for when nothing else is said.
const WAIT: Duration = Duration::from_secs(5);

/// Loads a site file. Relative paths in it are below its folder.
///
/// # Errors
/// [`SiteError`] for the first thing that is wrong.
pub fn file(path: &Path) -> Result<Site, SiteError> {
    let name = path.display().to_string();
    let bytes = fs::read(path).map_err(|source| SiteError::Unreadable {
        file: name.clone(),
        source,
    })?;
    let text = String::from_utf8(bytes).map_err(|error| {
        let good = error
            .as_bytes()
            .iter()
            .take(error.utf8_error().valid_up_to());
        SiteError::NotUtf8 {
            line: good.filter(|byte| **byte == b'\n').count() + 1,
            file: name.clone(),
        }
    })?;
    let folder = path.parent().unwrap_or(Path::new("")).to_owned();
    load(&name, &text, folder)
}

/// Loads the text of one; `file` is how errors name it, and relative paths are below `folder`.
///
/// # Errors
/// [`SiteError`] for the first thing that is wrong.
pub fn load(file: &str, text: &str, folder: impl Into<PathBuf>) -> Result<Site, SiteError> {
    let source = Source { file, text };
    let table: SiteFile = toml::from_str(text).map_err(|error| syntax::explain(&source, &error))?;
    Loader {
        source,
        folder: folder.into(),
        profiles: BTreeMap::new(),
    }
    .site(&table)
}

struct Loader<'a> {
    source: Source<'a>,
    folder: PathBuf,
    /// Each is loaded once, however many meters are of its kind.
    profiles: BTreeMap<String, Arc<Profile>>,
}

/// A meter as far as it can be told without its line.
struct Placed<'a> {
    table: &'a MeterTable,
    /// `meters.main`.
    key: String,
    line: usize,
    profile: Option<Arc<Profile>>,
}

/// What is read of a meter, at one rate.
struct Set<'a> {
    points: &'a [String],
    /// Where the points are named, or the meter.
    at: std::ops::Range<usize>,
    every: Option<&'a Spanned<String>>,
    output: Option<&'a Spanned<String>>,
}

impl Loader<'_> {
    fn site(mut self, table: &SiteFile) -> Result<Site, SiteError> {
        let line_names = table.lines.iter().map(|line| &line.name);
        let line_names = self.source.distinct(line_names, "line")?;
        if line_names.is_empty() {
            return Err(self.needed("lines", "a site has one at least"));
        }
        if table.meters.is_empty() {
            return Err(self.needed("meters", "a site has one at least"));
        }
        self.source
            .distinct(table.meters.iter().map(|meter| &meter.name), "meter")?;
        let output_names = table.outputs.iter().map(|output| &output.name);
        let output_names = self.source.distinct(output_names, "output")?;
        let outputs = outputs::outputs(&self.source, &self.folder, &table.outputs)?;

        let placed = table.meters.iter();
        let placed: Vec<Placed<'_>> = placed
            .map(|meter| self.place(meter, &line_names))
            .collect::<Result<_, _>>()?;
        let lines = table.lines.iter().zip(&line_names).enumerate();
        let lines: Vec<SiteLine> = lines
            .map(|(index, (line, name))| self.line(index, line, name, &placed))
            .collect::<Result<_, _>>()?;
        let mut jobs = Vec::new();
        for (index, meter) in placed.iter().enumerate() {
            let Some(line) = lines.get(meter.line) else {
                continue;
            };
            let found = self.jobs(meter, line.settings, &table.defaults, &output_names)?;
            jobs.extend(found.into_iter().map(|job| Job {
                meter: index,
                ..job
            }));
        }
        Ok(Site {
            lines,
            jobs,
            outputs,
        })
    }

    fn needed(&self, key: &str, what: &'static str) -> SiteError {
        self.source.error(0..0, key, SiteProblem::Needed(what))
    }

    fn place<'t>(
        &mut self,
        table: &'t MeterTable,
        lines: &[String],
    ) -> Result<Placed<'t>, SiteError> {
        let key = format!("meters.{}", table.name.as_ref());
        let source = &self.source;
        let line = match &table.line {
            Some(line) => source.one_of(line, &format!("{key}.line"), "line", lines)?,
            None if lines.len() == 1 => 0,
            None => {
                let problem = SiteProblem::Needed("there are several lines");
                return Err(source.error(table.name.span(), format!("{key}.line"), problem));
            }
        };
        let profile = match &table.profile {
            None => None,
            Some(name) => Some(self.profile(name, &format!("{key}.profile"))?),
        };
        Ok(Placed {
            table,
            key,
            line,
            profile,
        })
    }

    fn profile(&mut self, name: &Spanned<String>, key: &str) -> Result<Arc<Profile>, SiteError> {
        let known = self.profiles.get(name.as_ref()).cloned();
        if let Some(profile) = known {
            return Ok(profile);
        }
        let found = self.find(name.as_ref()).map_err(|error| {
            let problem = SiteProblem::Find(error);
            self.source.error(name.span(), key, problem)
        })?;
        let found = Arc::new(found);
        let name = name.as_ref().clone();
        self.profiles.insert(name, Arc::clone(&found));
        Ok(found)
    }

    /// As `--meter` finds it, but that a file is below the folder of the site's.
    fn find(&self, name: &str) -> Result<Profile, FindError> {
        match find::origin(name)? {
            find::Origin::File(path) => {
                let path = self.folder.join(path);
                find::Origin::File(path).profile()
            }
            other => other.profile(),
        }
    }

    fn line(
        &self,
        index: usize,
        table: &LineTable,
        name: &str,
        placed: &[Placed<'_>],
    ) -> Result<SiteLine, SiteError> {
        let (source, key) = (&self.source, |key: &str| format!("lines.{name}.{key}"));
        if table.port.as_ref().is_empty() {
            return Err(source.value(&table.port, key("port"), "a port"));
        }
        let echoes = [("auto", Echo::Auto), ("on", Echo::On), ("off", Echo::Off)];
        let echo = table.echo.as_ref();
        let echo = echo.map(|echo| source.word(echo, &key("echo"), &echoes));
        let duration = |found: Option<&Spanned<String>>, name: &str, default| {
            found.map_or(Ok(default), |time| source.duration(time, &key(name)))
        };
        Ok(SiteLine {
            name: name.to_owned(),
            port: table.port.as_ref().clone(),
            settings: self.settings(index, table, name, placed)?,
            echo: echo.transpose()?.unwrap_or(Echo::Auto),
            settle: duration(table.settle.as_ref(), "settle", Duration::ZERO)?,
            wait: duration(table.wait.as_ref(), "wait", WAIT)?,
        })
    }

    /// The setting of a line: what is said of it, and else what its meters leave the factory with.
    fn settings(
        &self,
        index: usize,
        table: &LineTable,
        name: &str,
        placed: &[Placed<'_>],
    ) -> Result<LineSettings, SiteError> {
        let (source, key) = (&self.source, |key: &str| format!("lines.{name}.{key}"));
        let mut factory: Vec<LineSettings> = Vec::new();
        let profiles = placed.iter().filter(|meter| meter.line == index);
        for profile in profiles.filter_map(|meter| meter.profile.as_deref()) {
            if !factory.contains(&profile.line) {
                factory.push(profile.line);
            }
        }
        let is_complete =
            table.baud.is_some() && table.parity.is_some() && table.stop_bits.is_some();
        if factory.len() > 1 && !is_complete {
            let settings = factory.iter().map(LineSettings::to_string).collect();
            let problem = SiteProblem::Settings(settings);
            return Err(source.error(table.name.span(), format!("lines.{name}"), problem));
        }
        let factory = factory.first().copied().unwrap_or_default();
        let baud = match &table.baud {
            Some(baud) if *baud.as_ref() < 50 => {
                return Err(source.value(baud, key("baud"), "a speed from 50 bits a second"));
            }
            Some(baud) => *baud.as_ref(),
            None => factory.baud,
        };
        let parities = [
            ("none", Parity::None),
            ("even", Parity::Even),
            ("odd", Parity::Odd),
        ];
        let parity = table.parity.as_ref();
        let parity = parity.map(|parity| source.word(parity, &key("parity"), &parities));
        let stop_bits = match &table.stop_bits {
            None => factory.stop_bits,
            Some(bits) => match bits.as_ref() {
                1 => StopBits::One,
                2 => StopBits::Two,
                _ => return Err(source.value(bits, key("stop_bits"), "1 or 2")),
            },
        };
        Ok(LineSettings {
            baud,
            parity: parity.transpose()?.unwrap_or(factory.parity),
            stop_bits,
        })
    }

    fn jobs(
        &self,
        meter: &Placed<'_>,
        settings: LineSettings,
        defaults: &DefaultsTable,
        outputs: &[String],
    ) -> Result<Vec<Job>, SiteError> {
        let Placed { table, key, .. } = meter;
        let profile = meter.profile.as_deref();
        let units = profile.map_or(UnitRange::Standard, |profile| profile.limits.units);
        let unit = Unit::new(*table.unit.as_ref(), units).map_err(|error| {
            let problem = SiteProblem::Unit(error);
            self.source
                .error(table.unit.span(), format!("{key}.unit"), problem)
        })?;
        let subject = Subject {
            name: table.name.as_ref().clone(),
            file_name: table.name.as_ref().clone(),
            line: meter.line,
            unit,
            manners: self.manners(table, key, defaults)?,
        };
        let sets = self.sets(table, key)?.into_iter();
        sets.map(|set| {
            let reading = Reading {
                profile,
                ..Reading::default()
            };
            let points = select(set.points, reading).map_err(|error| {
                let problem = SiteProblem::Select(error);
                self.source
                    .error(set.at.clone(), format!("{key}.points"), problem)
            })?;
            let every = self.every(set.every, table, key, defaults)?;
            let output = set.output.or(table.output.as_ref());
            let output = self.output(output, table, key, defaults, outputs)?;
            Ok(Job {
                every,
                output,
                ..Job::new(subject.clone(), profile, points, settings)
            })
        })
        .collect()
    }

    fn sets<'t>(&self, table: &'t MeterTable, key: &str) -> Result<Vec<Set<'t>>, SiteError> {
        let one = Set {
            points: table.points.as_ref().map_or(&[], |points| points.as_ref()),
            at: table
                .points
                .as_ref()
                .map_or(table.name.span(), Spanned::span),
            every: None,
            output: None,
        };
        if table.groups.is_empty() {
            return Ok(vec![one]);
        }
        if table.points.is_some() {
            let problem = SiteProblem::Conflict("a meter has points or groups, not both");
            return Err(self.source.error(one.at, format!("{key}.points"), problem));
        }
        let groups = table.groups.iter().map(|group| {
            let group = group.as_ref();
            Set {
                points: group.points.as_ref(),
                at: group.points.span(),
                every: group.every.as_ref(),
                output: group.output.as_ref(),
            }
        });
        Ok(groups.collect())
    }

    fn manners(
        &self,
        table: &MeterTable,
        key: &str,
        defaults: &DefaultsTable,
    ) -> Result<Manners, SiteError> {
        let source = &self.source;
        let name = |is_own: bool, name: &str| {
            let place = if is_own { key } else { "defaults" };
            format!("{place}.{name}")
        };
        let timeout = table.timeout.as_ref().or(defaults.timeout.as_ref());
        let timeout =
            timeout.map(|time| source.timeout(time, &name(table.timeout.is_some(), "timeout")));
        let retries = table.retries.as_ref().or(defaults.retries.as_ref());
        let retries =
            retries.map(|count| source.retries(count, &name(table.retries.is_some(), "retries")));
        let pause = table.pause.as_ref().or(defaults.pause.as_ref());
        let pause = pause.map(|time| source.duration(time, &name(table.pause.is_some(), "pause")));
        Ok(Manners {
            timeout: timeout.transpose()?,
            retries: retries.transpose()?.unwrap_or(RETRIES),
            pause: pause.transpose()?,
        })
    }

    /// The interval of a set, else of its meter, else of all.
    fn every(
        &self,
        own: Option<&Spanned<String>>,
        table: &MeterTable,
        key: &str,
        defaults: &DefaultsTable,
    ) -> Result<Option<Every>, SiteError> {
        let of_meter = own.or(table.every.as_ref());
        let (found, key) = match (of_meter, &defaults.every) {
            (Some(found), _) => (found, format!("{key}.every")),
            (None, Some(found)) => (found, "defaults.every".to_owned()),
            (None, None) => return Ok(None),
        };
        self.source.every(found, &key).map(Some)
    }

    /// The output of a set, else of its meter, else of all, else the only one.
    fn output(
        &self,
        own: Option<&Spanned<String>>,
        table: &MeterTable,
        key: &str,
        defaults: &DefaultsTable,
        outputs: &[String],
    ) -> Result<usize, SiteError> {
        match (own, &defaults.output) {
            (Some(name), _) => {
                let key = format!("{key}.output");
                self.source.one_of(name, &key, "output", outputs)
            }
            (None, Some(name)) => self
                .source
                .one_of(name, "defaults.output", "output", outputs),
            (None, None) if outputs.len() <= 1 => Ok(0),
            (None, None) => {
                let problem = SiteProblem::Needed("there are several outputs");
                Err(self
                    .source
                    .error(table.name.span(), format!("{key}.output"), problem))
            }
        }
    }
}
