//! The text of a site file, and its values one by one: each right, or an error with its place.

use std::ops::Range;
use std::time::Duration;

use toml::Spanned;

use super::error::{SiteError, SiteProblem, Wrong};
use crate::polling::schedule::Every;

/// The longest time a file can give.
const LONGEST: Duration = Duration::from_secs(24 * 60 * 60);

/// The text that is being loaded: turns places in it into errors.
pub(super) struct Source<'a> {
    pub(super) file: &'a str,
    pub(super) text: &'a str,
}

impl Source<'_> {
    /// The line of a place in the text, from 1.
    pub(super) fn line_of(&self, offset: usize) -> usize {
        let bytes = self.text.bytes().take(offset);
        bytes.filter(|byte| *byte == b'\n').count() + 1
    }

    pub(super) fn error(
        &self,
        at: Range<usize>,
        key: impl Into<String>,
        problem: SiteProblem,
    ) -> SiteError {
        SiteError::Wrong(Box::new(Wrong {
            file: self.file.to_owned(),
            line: self.line_of(at.start),
            key: key.into(),
            problem,
        }))
    }

    pub(super) fn value<T>(
        &self,
        found: &Spanned<T>,
        key: impl Into<String>,
        expected: impl Into<String>,
    ) -> SiteError {
        let shown = self.text.get(found.span()).unwrap_or_default();
        let problem = SiteProblem::Value {
            found: shown.lines().map(str::trim).collect::<Vec<_>>().join(" "),
            expected: expected.into(),
        };
        self.error(found.span(), key, problem)
    }

    /// A name of a line, a meter or an output. A meter's can be part of the name of a file.
    pub(super) fn name(&self, name: &Spanned<String>, key: &str) -> Result<String, SiteError> {
        let text = name.as_ref();
        let fits = text.starts_with(char::is_alphanumeric)
            && text
                .chars()
                .all(|c| c.is_alphanumeric() || matches!(c, '_' | '-' | '.'));
        if fits {
            return Ok(text.clone());
        }
        Err(self.error(name.span(), key, SiteProblem::Name(text.clone())))
    }

    /// Names of which each is there once; `what` they are.
    pub(super) fn distinct<'a>(
        &self,
        names: impl Iterator<Item = &'a Spanned<String>>,
        what: &'static str,
    ) -> Result<Vec<String>, SiteError> {
        let mut found: Vec<(String, usize)> = Vec::new();
        for name in names {
            let key = format!("{what}s.name");
            let text = self.name(name, &key)?;
            if let Some((_, first)) = found.iter().find(|(known, _)| *known == text) {
                let first = self.line_of(*first);
                let problem = SiteProblem::Duplicate { what, first };
                return Err(self.error(name.span(), format!("{what}s.{text}.name"), problem));
            }
            found.push((text, name.span().start));
        }
        Ok(found.into_iter().map(|(name, _)| name).collect())
    }

    /// Which of the names is meant.
    pub(super) fn one_of(
        &self,
        name: &Spanned<String>,
        key: &str,
        what: &'static str,
        known: &[String],
    ) -> Result<usize, SiteError> {
        let place = known.iter().position(|known| known == name.as_ref());
        place.ok_or_else(|| {
            let problem = SiteProblem::Unknown {
                what,
                found: name.as_ref().clone(),
                known: known.to_vec(),
            };
            self.error(name.span(), key, problem)
        })
    }

    pub(super) fn duration(
        &self,
        found: &Spanned<String>,
        key: &str,
    ) -> Result<Duration, SiteError> {
        let time = humantime::parse_duration(found.as_ref()).ok();
        time.filter(|time| *time <= LONGEST).ok_or_else(|| {
            let expected = "a duration with its unit, such as \"500ms\", at most 24h";
            self.value(found, key, expected)
        })
    }

    pub(super) fn every(&self, found: &Spanned<String>, key: &str) -> Result<Every, SiteError> {
        let interval = self.duration(found, key)?;
        Every::new(interval).map_err(|_| self.value(found, key, "an interval, from 10ms to 24h"))
    }

    pub(super) fn timeout(
        &self,
        found: &Spanned<String>,
        key: &str,
    ) -> Result<Duration, SiteError> {
        let time = self.duration(found, key)?;
        if time.is_zero() {
            return Err(self.value(found, key, "above 0: no meter answers in no time"));
        }
        Ok(time)
    }

    pub(super) fn retries(&self, found: &Spanned<u32>, key: &str) -> Result<u32, SiteError> {
        let retries = *found.as_ref();
        if retries > 100 {
            return Err(self.value(found, key, "0 to 100"));
        }
        Ok(retries)
    }

    /// One of several words.
    pub(super) fn word<T: Copy>(
        &self,
        found: &Spanned<String>,
        key: &str,
        words: &[(&str, T)],
    ) -> Result<T, SiteError> {
        let known = words.iter().find(|(word, _)| word == found.as_ref());
        known.map(|(_, meaning)| *meaning).ok_or_else(|| {
            let words: Vec<String> = words.iter().map(|(word, _)| format!("{word:?}")).collect();
            let (last, others) = words
                .split_last()
                .map_or((String::new(), String::new()), |(last, others)| {
                    (last.clone(), others.join(", "))
                });
            self.value(found, key, format!("{others} or {last}"))
        })
    }
}
