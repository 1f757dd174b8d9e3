//! A run of tests: all rounds, and the verdicts on all of them together.

use super::case::Case;
use crate::error::{Error, Result};
use crate::interrupt;
use etalon_stats::kolmogorov::{Uniformity, uniformity};
use etalon_stats::{Outcome, Protocol, Verdict, decide};
use rayon::prelude::*;
use serde::Serialize;
use std::time::Instant;

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
    /// Probability that a run of right samplers rejects any.
    pub level: f64,
    pub seed: u64,
    pub tests: Vec<Tested>,
    pub accepted: usize,
    pub rejected: usize,
    pub inconclusive: usize,
    /// Whether the process was asked to stop before all tests were finished; those that were not are inconclusive.
    pub interrupted: bool,
    /// Whether the p-values are uniform, as those of right samplers are.
    #[serde(rename = "evenness")]
    pub uniformity: Uniformity,
    /// Wall-clock time of the run.
    pub seconds: f64,
}

impl Validation {
    fn new(protocol: &Protocol, tests: Vec<Tested>, start: Instant) -> Self {
        let count = |verdict| tests.iter().filter(|test| test.outcome.verdict == verdict).count();
        let p: Vec<f64> = tests.iter().filter_map(|test| test.outcome.continuous_p()).collect();
        Self {
            level: protocol.level,
            seed: protocol.seed,
            accepted: count(Verdict::Accept),
            rejected: count(Verdict::Reject),
            inconclusive: count(Verdict::Inconclusive),
            interrupted: tests.iter().any(|test| test.outcome.interrupted),
            uniformity: uniformity(&p),
            seconds: start.elapsed().as_secs_f64(),
            tests,
        }
    }
}

/// Does something with every case: with large ones one after the other, with the others side by side.
pub(super) fn of_each<T: Send>(cases: &[Case], one: impl Fn(&Case) -> Result<T> + Sync) -> Result<Vec<T>> {
    let small = cases.par_iter().map(|case| if case.is_large() { Ok(None) } else { one(case).map(Some) });
    let small = small.collect::<Result<Vec<Option<T>>>>()?;
    cases.iter().zip(small).map(|(case, done)| done.map_or_else(|| one(case), Ok)).collect()
}

/// Runs all `cases` at the level of `protocol`, shared among them, and calls `done` after each.
pub fn run(cases: &[Case], protocol: &Protocol, done: &(dyn Fn(&str) + Sync)) -> Result<Validation> {
    let start = Instant::now();
    let protocol = Protocol { tests: cases.len(), ..*protocol };
    protocol.check()?;
    cases.iter().take_while(|_| !interrupt::requested()).for_each(Case::prepare);
    let examine = |case: &Case, round| match case.examine(&protocol, round) {
        Err(Error::Interrupted) => Ok(Outcome::interrupted()),
        other => other,
    };
    let first = |case: &Case| {
        let outcome = examine(case, 0);
        done(&case.name);
        outcome
    };
    let mut outcomes = of_each(cases, first)?;
    decide(&mut outcomes, protocol.level, |i| examine(&cases[i], 1))?;
    let tested = cases.iter().zip(outcomes).map(|(case, outcome)| Tested { name: case.name.clone(), outcome });
    Ok(Validation::new(&protocol, tested.collect(), start))
}
