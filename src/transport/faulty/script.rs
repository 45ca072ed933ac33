//! A fault script: rules in their order, and the chance of each.

use fastrand::Rng;

use super::effect::Effect;
use super::error::{FaultScriptError, RulePlace};
use super::kind::FaultKind;
use super::rule::FaultRule;
use super::when::Asked;

/// What goes wrong, and when: rules, parsed from text as described in [`super`]. By default nothing
/// ever goes wrong.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FaultScript {
    rules: Vec<FaultRule>,
    seed: u64,
}

/// What happens to a request, and the chance that is left for its details.
pub(super) struct Decision<'a> {
    pub(super) kind: FaultKind,
    pub(super) effect: &'a Effect,
    pub(super) chance: Rng,
}

impl FaultScript {
    /// Reads rules, each as typed after `--fault`.
    ///
    /// # Errors
    /// [`FaultScriptError`] for the first rule that is none.
    pub fn parse(
        rules: impl IntoIterator<Item = impl AsRef<str>>,
    ) -> Result<Self, FaultScriptError> {
        let mut script = Self::default();
        for rule in rules {
            script.add(rule.as_ref(), None)?;
        }
        Ok(script)
    }

    /// Reads the text of a file: a rule a line; blank lines, and those that begin with `#`, are
    /// passed over.
    ///
    /// # Errors
    /// [`FaultScriptError`] for the first rule that is none, with its line.
    pub fn from_text(text: &str) -> Result<Self, FaultScriptError> {
        let mut script = Self::default();
        for (line, rule) in (1..).zip(text.lines().map(str::trim)) {
            if !rule.is_empty() && !rule.starts_with('#') {
                script.add(rule, Some(line))?;
            }
        }
        Ok(script)
    }

    /// These rules, and those of another script after them; its seed has no say.
    #[must_use]
    pub fn followed_by(mut self, other: Self) -> Self {
        self.rules.extend(other.rules);
        self
    }

    fn add(&mut self, rule: &str, line: Option<usize>) -> Result<(), FaultScriptError> {
        let rule = rule.trim();
        let parsed = FaultRule::parse(rule).map_err(|problem| FaultScriptError {
            place: RulePlace {
                rule: rule.to_owned(),
                line,
            },
            problem,
        })?;
        self.rules.push(parsed);
        Ok(())
    }

    /// The same rules with this seed for those without a `seed=` of their own; else it is 0.
    #[must_use]
    pub const fn with_seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }

    /// The rules, in the order in which they are tried.
    pub fn rules(&self) -> &[FaultRule] {
        &self.rules
    }

    /// The first rule that applies decides.
    pub(super) fn decide(&self, asked: Asked) -> Option<Decision<'_>> {
        self.rules.iter().enumerate().find_map(|(place, rule)| {
            let mut chance = self.chance(place, rule, asked.number);
            let (kind, effect) = rule.decide(asked, &mut chance)?;
            Some(Decision {
                kind,
                effect,
                chance,
            })
        })
    }

    /// The chance of one rule for one request. It comes from nothing but the seed, the text of the
    /// rule and the number of the request, so that neither a rule added elsewhere nor what another
    /// rule decided changes it. A text that is there again is told apart by how often it was there
    /// before: two rules of the same text are two chances.
    fn chance(&self, place: usize, rule: &FaultRule, number: u64) -> Rng {
        let earlier = self.rules.iter().take(place);
        let again = earlier.filter(|earlier| earlier.text() == rule.text());
        let seed = rule.seed().unwrap_or(self.seed);
        let parts = [hash(rule.text()), again.count() as u64, number];
        Rng::with_seed(
            parts
                .into_iter()
                .fold(mix(seed), |seed, part| mix(seed ^ mix(part))),
        )
    }
}

/// FNV-1a, 64 bits: the same for ever, which the hash of the standard library does not promise.
fn hash(text: &str) -> u64 {
    text.bytes().fold(0xCBF2_9CE4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01B3)
    })
}

/// The finalizer of `SplitMix64`: neighbouring numbers become unlike ones.
fn mix(number: u64) -> u64 {
    let number = number.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let number = (number ^ (number >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let number = (number ^ (number >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    number ^ (number >> 31)
}
