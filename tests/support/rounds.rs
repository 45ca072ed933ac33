//! How often a test tries what is left to chance.

/// So often, unless the environment says how often with `METERPOLL_ROUNDS`.
pub(crate) fn rounds(few: usize) -> usize {
    let asked = std::env::var("METERPOLL_ROUNDS").ok();
    asked.map_or(few, |asked| asked.parse().expect("a number of rounds"))
}
