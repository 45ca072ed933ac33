//! One rule: its text read into what it does and when.

use std::fmt;
use std::time::Duration;

use fastrand::Rng;

use super::effect::{Choice, Effect, Moment, Pace};
use super::error::{RuleProblem, near};
use super::kind::FaultKind;
use super::values::{self, Reader};
use super::when::{Asked, Numbers, When};

/// What `late`, and the `rest` of a cut, are relative to.
const TIMEOUT: Duration = Duration::from_secs(1);

/// Two of the 16 ms that a common adapter holds bytes back.
const SPLIT_GAP: Duration = Duration::from_millis(16);

const BYTE_PACE: Duration = Duration::from_millis(20);
const GARBAGE_PACE: Duration = Duration::from_millis(1);
const STRANGER_PACE: Duration = Duration::from_millis(200);
const DELAY: Duration = Duration::from_millis(40);

/// Of so many that `any` picks, one is a late answer.
const ONE_LATE_IN: u8 = 10;

/// What a kind that `any` does not pick by itself weighs when it is asked for.
const WEIGHT_IF_ASKED_FOR: u32 = 2;

/// A rule of a fault script. Prints as it was typed.
#[derive(Debug, Clone, PartialEq)]
pub struct FaultRule {
    text: String,
    kind: FaultKind,
    effect: Effect,
    when: When,
    rate: f64,
    seed: Option<u64>,
}

impl FaultRule {
    /// Reads a rule; the text is trimmed.
    pub(super) fn parse(text: &str) -> Result<Self, RuleProblem> {
        let (kind, mut fields) = Fields::split(text)?;
        let effect = effect(kind, &mut fields)?;
        let when = When {
            on: fields.key("on", Numbers::parse)?.unwrap_or_default(),
            unit: fields.key("for", values::unit)?,
            function: fields.key("function", values::function)?,
        };
        let rule = Self {
            text: text.to_owned(),
            kind,
            effect,
            when,
            rate: fields.key("rate", values::rate)?.unwrap_or(1.0),
            seed: fields.key("seed", values::seed)?,
        };
        fields.finish()?;
        Ok(rule)
    }

    /// The kind of fault.
    pub fn kind(&self) -> FaultKind {
        self.kind
    }

    /// Whether a fault of this kind can come of it: its own, or one that `any` picks.
    pub fn may_be(&self, kind: FaultKind) -> bool {
        match &self.effect {
            Effect::Any(choices) => choices.iter().any(|choice| choice.kind == kind),
            _ => self.kind == kind,
        }
    }

    /// The rule as it was typed.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The seed of its own, where it has one.
    pub(super) fn seed(&self) -> Option<u64> {
        self.seed
    }

    /// What happens to this request by this rule, `any` worked out; `None` when it does not apply.
    pub(super) fn decide(&self, asked: Asked, chance: &mut Rng) -> Option<(FaultKind, &Effect)> {
        if !self.when.holds(asked) || chance.f64() >= self.rate {
            return None;
        }
        match &self.effect {
            Effect::Any(choices) => {
                pick(choices, chance).map(|choice| (choice.kind, &choice.effect))
            }
            effect => Some((self.kind, effect)),
        }
    }
}

impl fmt::Display for FaultRule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

/// One in ten is late; the others by weight.
fn pick<'a>(choices: &'a [Choice], chance: &mut Rng) -> Option<&'a Choice> {
    let is_late = |choice: &&Choice| choice.kind == FaultKind::Late;
    let late = choices.iter().find(is_late);
    let others = || choices.iter().filter(|choice| !is_late(choice));
    let all: u32 = others().map(|choice| weight(choice.kind)).sum();
    if all == 0 || late.is_some() && chance.u8(0..ONE_LATE_IN) == 0 {
        return late;
    }
    let mut at = chance.u32(0..all);
    others().find(|choice| match at.checked_sub(weight(choice.kind)) {
        Some(left) => {
            at = left;
            false
        }
        None => true,
    })
}

fn weight(kind: FaultKind) -> u32 {
    match kind.weight() {
        0 => WEIGHT_IF_ASKED_FOR,
        weight => weight,
    }
}

/// What a rule of this kind does; takes its value and its own keys out of the fields.
fn effect(kind: FaultKind, fields: &mut Fields<'_>) -> Result<Effect, RuleProblem> {
    Ok(match kind {
        FaultKind::Late => Effect::Late {
            time_outs: fields.value(values::time_outs)?,
            timeout: timeout(fields)?,
        },
        FaultKind::Delay => Effect::Delay(fields.value(values::time)?.unwrap_or(DELAY)),
        FaultKind::Silence => Effect::Silence,
        FaultKind::Cut => {
            let timeout = timeout(fields)?;
            let rest = fields.key("rest", values::time_outs)?;
            Effect::Cut {
                keep: fields.value(values::bytes)?,
                rest: rest.map(|rest| timeout.mul_f64(rest)),
            }
        }
        FaultKind::Split => Effect::Split {
            first: fields.value(values::bytes)?,
            gap: fields.key("gap", values::time)?.unwrap_or(SPLIT_GAP),
        },
        FaultKind::Drip => Effect::Drip(fields.value(values::pace)?.unwrap_or(BYTE_PACE)),
        FaultKind::Endless => Effect::Endless(pace(fields, BYTE_PACE)?),
        FaultKind::Before => Effect::Before {
            noise: fields.value(values::noise)?,
            gap: gap(fields)?,
        },
        FaultKind::After => Effect::After {
            noise: fields.value(values::noise)?,
            gap: gap(fields)?,
        },
        FaultKind::Echo => Effect::Echo {
            bytes: fields.value(values::bytes)?,
            gap: gap(fields)?,
        },
        FaultKind::EchoOnly => Effect::EchoOnly,
        FaultKind::Twice => Effect::Twice(gap(fields)?),
        FaultKind::Crc => Effect::Crc,
        FaultKind::CrcSwapped => Effect::CrcSwapped,
        FaultKind::Flip => Effect::Flip(fields.value(values::bit)?),
        FaultKind::Burst => Effect::Burst(fields.value(values::bits)?),
        FaultKind::WrongUnit => Effect::WrongUnit(fields.value(values::unit)?),
        FaultKind::Stranger => Effect::Stranger {
            unit: fields.value(values::unit)?,
            gap: gap(fields)?,
        },
        FaultKind::StrangerOnly => Effect::StrangerOnly {
            unit: fields.value(values::unit)?,
            pace: pace(fields, STRANGER_PACE)?,
        },
        FaultKind::WrongFunction => Effect::WrongFunction(fields.value(values::function)?),
        FaultKind::WrongCount => Effect::WrongCount(fields.value(values::change)?),
        FaultKind::Oversize => Effect::Oversize,
        FaultKind::Exception => Effect::Exception(fields.value(values::code)?),
        FaultKind::ExceptionFor => Effect::ExceptionFor(fields.value(values::function)?),
        FaultKind::Garbage => Effect::Garbage(pace(fields, GARBAGE_PACE)?),
        FaultKind::HangUp => {
            Effect::HangUp(fields.value(values::moment)?.unwrap_or(Moment::During))
        }
        FaultKind::Any => any(fields)?,
    })
}

fn timeout(fields: &mut Fields<'_>) -> Result<Duration, RuleProblem> {
    Ok(fields.key("timeout", values::span)?.unwrap_or(TIMEOUT))
}

fn gap(fields: &mut Fields<'_>) -> Result<Duration, RuleProblem> {
    Ok(fields.key("gap", values::time)?.unwrap_or_default())
}

fn pace(fields: &mut Fields<'_>, every: Duration) -> Result<Pace, RuleProblem> {
    Ok(Pace {
        every: fields.key("every", values::pace)?.unwrap_or(every),
        lasts: fields.key("lasts", values::time)?,
    })
}

/// All kinds but those left out, each as it is without values. What has no end lasts two
/// time-outs: a client that waits for silence before it asks again would never ask again.
fn any(fields: &mut Fields<'_>) -> Result<Effect, RuleProblem> {
    let timeout = timeout(fields)?;
    let with = fields.key("with", values::kinds)?.unwrap_or_default();
    let without = fields.key("without", values::kinds)?.unwrap_or_default();
    let is_wanted = |kind: FaultKind| {
        let is_usual = kind == FaultKind::Late || kind.weight() > 0;
        kind != FaultKind::Any && (is_usual || with.contains(&kind)) && !without.contains(&kind)
    };
    let mut choices = Vec::new();
    for kind in FaultKind::all().filter(|kind| is_wanted(*kind)) {
        let mut effect = effect(kind, &mut Fields::none(kind))?;
        match &mut effect {
            Effect::Late { timeout: whose, .. } => *whose = timeout,
            Effect::Endless(pace) | Effect::StrangerOnly { pace, .. } | Effect::Garbage(pace) => {
                pace.lasts = Some(timeout * 2);
            }
            _ => {}
        }
        choices.push(Choice { kind, effect });
    }
    if choices.is_empty() {
        return Err(RuleProblem::NothingLeft);
    }
    Ok(Effect::Any(choices))
}

/// The parts of a rule that have not been read yet.
struct Fields<'a> {
    kind: FaultKind,
    value: Option<&'a str>,
    keys: Vec<(&'static str, &'a str)>,
}

impl<'a> Fields<'a> {
    /// A rule that is its kind alone.
    const fn none(kind: FaultKind) -> Self {
        Self {
            kind,
            value: None,
            keys: Vec::new(),
        }
    }

    /// Takes a rule apart; only keys that its kind has a use for pass.
    fn split(text: &'a str) -> Result<(FaultKind, Self), RuleProblem> {
        let mut parts = text.split(',').map(|part| match part.split_once('=') {
            Some((name, value)) => (name.trim(), Some(value.trim())),
            None => (part.trim(), None),
        });
        let (name, value) = parts.next().unwrap_or_default();
        let kind = FaultKind::named(name).ok_or_else(|| RuleProblem::UnknownKind {
            found: name.to_owned(),
            near: near(name, FaultKind::all().map(FaultKind::name)),
        })?;
        let mut fields = Self::none(kind);
        fields.value = value;
        for (key, value) in parts {
            let known = kind.keys().find(|known| *known == key);
            let known = known.ok_or_else(|| RuleProblem::UselessKey {
                kind: kind.name(),
                found: key.to_owned(),
                allowed: near(key, kind.keys()),
            })?;
            if fields.keys.iter().any(|(key, _)| *key == known) {
                let key = key.to_owned();
                return Err(RuleProblem::Repeated { key });
            }
            fields.keys.push((known, value.unwrap_or_default()));
        }
        Ok((kind, fields))
    }

    /// The value of the kind itself, where there is one.
    fn value<T>(&mut self, read: Reader<T>) -> Result<Option<T>, RuleProblem> {
        let found = self.value.take();
        found
            .map(|found| value(self.kind.name(), found, read))
            .transpose()
    }

    /// The value of a key, where it is there.
    fn key<T>(&mut self, key: &'static str, read: Reader<T>) -> Result<Option<T>, RuleProblem> {
        let place = self.keys.iter().position(|(found, _)| *found == key);
        let found = place.map(|place| self.keys.swap_remove(place).1);
        found.map(|found| value(key, found, read)).transpose()
    }

    /// Everything has been read.
    fn finish(self) -> Result<(), RuleProblem> {
        match self.value {
            None => Ok(()),
            Some(found) => Err(RuleProblem::NoValue {
                kind: self.kind.name(),
                found: found.to_owned(),
            }),
        }
    }
}

fn value<T>(key: &'static str, found: &str, read: Reader<T>) -> Result<T, RuleProblem> {
    read(found).map_err(|allowed| RuleProblem::Value {
        key,
        found: found.to_owned(),
        allowed,
    })
}
