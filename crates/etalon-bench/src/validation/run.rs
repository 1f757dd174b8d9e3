//! A run of tests: all rounds, verdicts at one level for all tests together, and p-values in ascending order beside those of
//! right samplers at each rank.

use super::case::Case;
use etalon_core::error::{Error, Result};
use etalon_core::interrupt;
use etalon_stats::multiple::{Uniformity, holm_level, uniformity};
use etalon_stats::{Finding, Outcome, Protocol, Verdict, causes, decide, explanations};
use rayon::prelude::*;
use serde::Serialize;
use statrs::distribution::{Beta, ContinuousCDF};
use std::time::Instant;

#[derive(Debug, Clone, Serialize)]
pub struct Tested {
    pub name: String,
    /// Statistic, p-value, verdict.
    #[serde(flatten)]
    pub outcome: Outcome,
}

impl Tested {
    /// It among other tests: those whose names differ in the last part only are of one kind.
    fn finding(&self) -> Finding<'_> {
        let kind = self.name.rsplit_once('/').map_or(self.name.as_str(), |(kind, _)| kind);
        Finding { name: &self.name, kind, outcome: &self.outcome }
    }
}

#[derive(Debug, Clone, Serialize)]
pub struct Validation {
    /// Probability that a run of right samplers rejects any.
    pub level: f64,
    pub seed: u64,
    pub tests: Vec<Tested>,
    pub accepted: usize,
    pub rejected: usize,
    /// Number of tests that could not be decided.
    pub inconclusive: usize,
    /// Whether the process was asked to stop before all tests were finished; those that were not are inconclusive.
    pub interrupted: bool,
    /// Whether the p-values are uniform, as those of right samplers are.
    pub uniformity: Uniformity,
    /// Wall-clock time of the run.
    pub seconds: f64,
    /// What its tests cannot see, if they are all of one sampler or BSDF.
    pub unseen: Option<&'static str>,
}

/// The share of right samplers inside [`Ranked::interval`].
const INSIDE: f64 = 0.99;

/// One p-value at its rank i of n, from 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ranked {
    pub p: f64,
    pub verdict: Verdict,
    /// i/(n + 1), the expected p-value of right samplers at this rank.
    pub expected: f64,
    /// Contains 99 % of the p-values of right samplers at this rank.
    pub interval: [f64; 2],
    /// Holm's threshold: a smaller p-value is rejected, if all before it are.
    pub threshold: f64,
}

impl Validation {
    pub(super) fn new(protocol: &Protocol, mut tests: Vec<Tested>, start: Instant) -> Self {
        // Of several explanations those are kept that hold for all tests of the same cause.
        let explanations = explanations(&tests.iter().map(Tested::finding).collect::<Vec<_>>());
        tests.iter_mut().zip(explanations).for_each(|(test, explained)| test.outcome.mistake = explained);
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
            unseen: if let [_] = tests.as_slice() { Some(etalon_stats::UNSEEN) } else { None },
            tests,
        }
    }

    /// A line for each cause for which tests do not accept.
    pub fn causes(&self) -> Vec<String> {
        causes(&self.tests.iter().map(Tested::finding).collect::<Vec<_>>())
    }

    /// The p-values of all tests that have one of continuous distribution, in ascending order.
    pub fn ranked(&self) -> Vec<Ranked> {
        let tests = self.tests.iter().map(|test| &test.outcome);
        let mut known: Vec<(f64, Verdict)> =
            tests.filter_map(|outcome| Some((outcome.continuous_p()?, outcome.verdict))).collect();
        // Sort by p-value: the rank of each decides its expected value and its threshold.
        known.sort_by(|a, b| a.0.total_cmp(&b.0));
        let n = known.len();
        // Holm's step-down ranks all tests that have a p-value.
        let mut all: Vec<f64> = self.tests.iter().filter_map(|test| test.outcome.p).collect();
        all.sort_by(f64::total_cmp);
        let ranked = |(i, (p, verdict)): (usize, (f64, Verdict))| {
            // The i-th smallest of n uniform random numbers is distributed as Beta(i, n − i + 1).
            let beta = Beta::new((i + 1) as f64, (n - i) as f64);
            let quantile = |share: f64| beta.as_ref().map_or(share, |beta| beta.inverse_cdf(share));
            Ranked {
                p,
                verdict,
                expected: (i + 1) as f64 / (n + 1) as f64,
                interval: [quantile(0.5 * (1.0 - INSIDE)), quantile(0.5 * (1.0 + INSIDE))],
                threshold: holm_level(self.level, self.tests.len(), all.partition_point(|&smaller| smaller < p)),
            }
        };
        known.into_iter().enumerate().map(ranked).collect()
    }
}

/// Prepares every case and applies `one` to it: to large cases one after the other, to the others in parallel. `None` for
/// those that an interruption left unfinished.
fn of_each<T: Send>(cases: &[Case], one: impl Fn(&Case) -> Result<T> + Sync) -> Result<Vec<Option<T>>> {
    let finished = |case: &Case| match interrupt::check().and_then(|()| one(case)) {
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
/// [`Error::Parameter`] for an impossible protocol; those of [`Case::examine`] except interruption.
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

#[cfg(test)]
mod tests {
    use super::super::{select, suite};
    use super::*;
    use etalon_stats::SampleCount;

    #[test]
    fn ranks_ascend_and_thresholds_decide() {
        let cases = select(suite::cases(), &["warp".to_owned()]).unwrap();
        let protocol = Protocol { samples: SampleCount::Fixed(20_000), ..Protocol::default() };
        let found = run(&cases, &protocol, &|_| ()).unwrap();
        let ranked = found.ranked();
        assert!(ranked.len() > 3 && ranked.len() <= found.tests.len());
        for pair in ranked.windows(2) {
            assert!(
                pair[0].p <= pair[1].p && pair[0].expected < pair[1].expected && pair[0].threshold < pair[1].threshold
            );
        }
        for test in &ranked {
            assert!(test.interval[0] < test.expected && test.expected < test.interval[1], "{test:?}");
            assert!(test.verdict != Verdict::Reject || test.p < test.threshold, "{test:?}");
        }
    }
}
