//! Which requests a rule is for.

/// What is known of a request before it is answered.
#[derive(Debug, Clone, Copy)]
pub(super) struct Asked {
    /// Its number, from 1.
    pub(super) number: u64,
    /// The unit byte; `None` in an empty frame.
    pub(super) unit: Option<u8>,
    /// The function byte; `None` in a frame that ends before it.
    pub(super) function: Option<u8>,
}

/// When a rule applies, apart from chance.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct When {
    pub(super) on: Numbers,
    pub(super) unit: Option<u8>,
    pub(super) function: Option<u8>,
}

impl When {
    pub(super) fn holds(&self, asked: Asked) -> bool {
        self.on.contain(asked.number)
            && (self.unit.is_none() || self.unit == asked.unit)
            && (self.function.is_none() || self.function == asked.function)
    }
}

/// Numbers of requests, from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) enum Numbers {
    /// All of them.
    #[default]
    All,
    /// From one to another, both included: `3-5`; `3` is `3-3`.
    Range(u64, u64),
    /// The first one and then one in so many: `1/4` is 1, 5, 9 and on.
    Every(u64, u64),
}

impl Numbers {
    fn contain(self, number: u64) -> bool {
        match self {
            Self::All => true,
            Self::Range(first, last) => (first..=last).contains(&number),
            Self::Every(first, step) => number
                .checked_sub(first)
                .is_some_and(|past| past.is_multiple_of(step)),
        }
    }

    /// Reads `3`, `3-5`, `3-`, `1/4`; the error says what is allowed.
    pub(super) fn parse(text: &str) -> Result<Self, &'static str> {
        let numbers = if let Some((first, step)) = text.split_once('/') {
            pair(first, step).map(|(first, step)| Self::Every(first, step))
        } else if let Some(first) = text.strip_suffix('-') {
            super::values::ordinal(first).map(|first| Self::Range(first, u64::MAX))
        } else {
            let (first, last) = text.split_once('-').unwrap_or((text, text));
            pair(first, last)
                .filter(|(first, last)| first <= last)
                .map(|(first, last)| Self::Range(first, last))
        };
        numbers.ok_or("numbers of requests from 1: 3, 3-5, 3- or 1/4 (one in 4, from the 1st)")
    }
}

fn pair(first: &str, second: &str) -> Option<(u64, u64)> {
    Some((
        super::values::ordinal(first)?,
        super::values::ordinal(second)?,
    ))
}
