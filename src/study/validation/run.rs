//! A run of tests: all rounds, and the verdicts on all of them together.

use super::case::Case;
use crate::error::Result;
use crate::stats::{Outcome, Protocol, Verdict, decide};
use rayon::prelude::*;
use serde::Serialize;

/// A test's name and what it found.
#[derive(Debug, Clone, Serialize)]
pub struct Tested {
    pub name: String,
    #[serde(flatten)]
    pub outcome: Outcome,
}

/// What a run found.
#[derive(Debug, Clone, Serialize)]
pub struct Validation {
    /// Probability that a run of true claims rejects any.
    pub level: f64,
    pub tests: Vec<Tested>,
    pub accepted: usize,
    pub rejected: usize,
    pub inconclusive: usize,
}

impl Validation {
    fn new(level: f64, tests: Vec<Tested>) -> Self {
        let count = |verdict| tests.iter().filter(|test| test.outcome.verdict == verdict).count();
        Self {
            level,
            accepted: count(Verdict::Accept),
            rejected: count(Verdict::Reject),
            inconclusive: count(Verdict::Inconclusive),
            tests,
        }
    }
}

/// Runs all `cases` at the level of `protocol`, shared among them, and calls `done` after each.
pub fn run(cases: &[Case], protocol: &Protocol, done: &(dyn Fn(&str) + Sync)) -> Result<Validation> {
    let protocol = Protocol { tests: cases.len(), ..*protocol };
    protocol.check()?;
    let examine = |case: &Case| {
        let outcome = case.examine(&protocol, 0);
        done(&case.name);
        outcome
    };
    let mut outcomes = cases.par_iter().map(examine).collect::<Result<Vec<_>>>()?;
    decide(&mut outcomes, protocol.level, |i| cases[i].examine(&protocol, 1))?;
    let tested = cases.iter().zip(outcomes).map(|(case, outcome)| Tested { name: case.name.clone(), outcome });
    Ok(Validation::new(protocol.level, tested.collect()))
}
