//! A run of tests: all rounds, and verdicts at one level for all tests together.

use super::case::Case;
use crate::error::{Error, Result};
use crate::interrupt;
use etalon_stats::kolmogorov::{Uniformity, uniformity};
use etalon_stats::{Outcome, Protocol, Verdict, decide};
use rayon::prelude::*;
use serde::Serialize;
use std::time::Instant;

/// The result of a test.
#[derive(Debug, Clone, Serialize)]
pub struct Tested {
    /// Of the test.
    pub name: String,
    /// Statistic, p-value, verdict.
    #[serde(flatten)]
    pub outcome: Outcome,
}

/// The results of a run.
#[derive(Debug, Clone, Serialize)]
pub struct Validation {
    /// Probability that a run of right samplers rejects any.
    pub level: f64,
    /// Of the random numbers of all tests.
    pub seed: u64,
    /// In the order of the cases.
    pub tests: Vec<Tested>,
    /// Number of accepted tests.
    pub accepted: usize,
    /// Number of rejected tests.
    pub rejected: usize,
    /// Number of tests that could not be decided.
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

/// Prepares every case and applies `one` to it: to large cases one after the other, to the others in parallel. `None` for
/// those that an interruption left unfinished.
pub(super) fn of_each<T: Send>(cases: &[Case], one: impl Fn(&Case) -> Result<T> + Sync) -> Result<Vec<Option<T>>> {
    let finished = |case: &Case| match one(case) {
        Err(Error::Interrupted) => Ok(None),
        other => other.map(Some),
    };
    cases.iter().take_while(|_| !interrupt::requested()).for_each(Case::prepare);
    let small = cases.par_iter().map(|case| if case.is_large() { Ok(None) } else { finished(case).map(Some) });
    let small = small.collect::<Result<Vec<Option<Option<T>>>>>()?;
    cases.iter().zip(small).map(|(case, done)| done.map_or_else(|| finished(case), Ok)).collect()
}

/// Runs all `cases` at the level of `protocol`, shared among them, and calls `done` with the name of each finished one.
///
/// # Errors
/// [`Error::Parameter`] for an impossible protocol; those of [`Case::examine`] but for interruption.
pub fn run(cases: &[Case], protocol: &Protocol, done: &(dyn Fn(&str) + Sync)) -> Result<Validation> {
    let start = Instant::now();
    let protocol = Protocol { tests: cases.len(), ..*protocol };
    protocol.check()?;
    let first = of_each(cases, |case| {
        let outcome = case.examine(&protocol, 0);
        done(&case.name);
        outcome
    })?;
    let mut outcomes: Vec<Outcome> =
        first.into_iter().map(|first| first.unwrap_or_else(Outcome::interrupted)).collect();
    decide(&mut outcomes, protocol.level, |i| match cases[i].examine(&protocol, 1) {
        Err(Error::Interrupted) => Ok(Outcome::interrupted()),
        other => other,
    })?;
    let tested = cases.iter().zip(outcomes).map(|(case, outcome)| Tested { name: case.name.clone(), outcome });
    Ok(Validation::new(&protocol, tested.collect(), start))
}
