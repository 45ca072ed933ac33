//! Properties on the same cases every time, and without files of what failed before.

#![allow(dead_code, reason = "each test file uses its share")]

use proptest::prelude::*;
use proptest::test_runner::{RngAlgorithm, TestRng, TestRunner};

/// Runs so many cases.
pub(crate) fn runner(cases: u32) -> TestRunner {
    let config = ProptestConfig {
        cases,
        failure_persistence: None,
        ..ProptestConfig::default()
    };
    let rng = TestRng::deterministic_rng(RngAlgorithm::ChaCha);
    TestRunner::new_with_rng(config, rng)
}

/// Runs a property on so many cases.
#[track_caller]
pub(crate) fn hold<S: Strategy>(
    cases: u32,
    strategy: &S,
    property: impl Fn(S::Value) -> Result<(), TestCaseError>,
) {
    runner(cases)
        .run(strategy, property)
        .unwrap_or_else(|error| panic!("{error}"));
}
