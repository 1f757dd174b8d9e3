//! Calibration of the harness: whether the p-values of right samplers are as small as stated over many seeds, and no smaller.

use super::case::Case;
use super::run::of_each;
use crate::error::{Error, Result};
use etalon_stats::kolmogorov::{Uniformity, uniformity};
use etalon_stats::multiple::sidak;
use etalon_stats::{Outcome, Protocol, SampleCount};
use rayon::prelude::*;
use serde::Serialize;

/// The p-values of one test.
#[derive(Debug, Clone, Serialize)]
pub struct Calibrated {
    /// Name of the test.
    pub name: String,
    /// Of its p-values over the seeds.
    pub uniformity: Uniformity,
    /// Whether they are smaller than uniform ones, at the level of this test.
    pub skewed: bool,
    /// Whether they are larger than uniform ones, at that level: right samplers are rejected less often than stated, as where
    /// p-values are bounds or take few values.
    pub conservative: bool,
    /// The violation of the first exact check that failed.
    pub violation: Option<String>,
}

/// The result of a calibration.
#[derive(Debug, Clone, Serialize)]
pub struct Calibration {
    /// Number of seeds.
    pub seeds: u64,
    /// Samples of each test at each seed.
    pub samples: u64,
    /// Probability that any p-values of a right harness on right samplers are called too small.
    pub level: f64,
    /// Of the p-values of all tests together.
    pub uniformity: Uniformity,
    /// Share of p-values below 0.05.
    pub below_5_percent: f64,
    /// Share of p-values below 0.01.
    pub below_1_percent: f64,
    /// One for each finished test.
    pub tests: Vec<Calibrated>,
    /// Tests with skewed p-values or a violation.
    pub skewed: usize,
    /// Whether the process was asked to stop before all tests were finished; those that were not are left out.
    pub interrupted: bool,
    /// Whether nothing is skewed, violated or unfinished.
    pub accepted: bool,
    /// The p-values of all tests and seeds.
    #[serde(skip)]
    pub p: Vec<f64>,
}

/// Samples and cells of a calibration: few, so that many seeds are quick, but hundreds of samples per cell, so that the
/// statistic is chi-square distributed.
const SAMPLES: u64 = 20_000;
const CELLS: usize = 50;

/// Runs every case under `seeds` seeds that follow one another from the protocol's, and tests by Smirnov's
/// one-sided statistic whether p-values are too small, all together and test by test, at the protocol's level in all.
///
/// # Errors
/// [`Error::Parameter`] for an impossible protocol or number of seeds; those of [`Case::examine`] but for interruption.
pub fn calibrate(cases: &[Case], protocol: &Protocol, seeds: u64, done: &(dyn Fn(&str) + Sync)) -> Result<Calibration> {
    if !(5..=100_000).contains(&seeds) {
        return Err(Error::parameter("seeds", format!("{seeds} seeds")).with_hint("use 5 to 100000 seeds"));
    }
    let samples = if let SampleCount::Fixed(n) = protocol.samples { n } else { SAMPLES };
    let protocol = Protocol { samples: SampleCount::Fixed(samples), cells: CELLS, tests: cases.len(), ..*protocol };
    protocol.check()?;
    // All seeds of a case in parallel, unless its tables are large.
    let finished = of_each(cases, |case| {
        let at = |i| case.examine(&Protocol { seed: protocol.seed.wrapping_add(i), ..protocol }, 0);
        let outcomes: Result<Vec<Outcome>> =
            if case.is_large() { (0..seeds).map(at).collect() } else { (0..seeds).into_par_iter().map(at).collect() };
        done(&case.name);
        outcomes
    })?;
    let interrupted = finished.iter().any(Option::is_none);
    let finished: Vec<(&Case, Vec<Outcome>)> =
        cases.iter().zip(finished).filter_map(|(case, outcomes)| Some((case, outcomes?))).collect();
    // Half of the level for all p-values together, half shared among the tests.
    let own = sidak(0.5 * protocol.level, cases.len());
    // Smirnov's test of the p-values of each case, then of all together.
    let tests: Vec<Calibrated> = finished
        .iter()
        .map(|(case, outcomes)| {
            let p: Vec<f64> = outcomes.iter().filter_map(Outcome::continuous_p).collect();
            let found = uniformity(&p);
            let violation = outcomes.iter().find_map(|outcome| outcome.violation.clone());
            let skewed = found.p_too_small < own;
            let conservative = !skewed && found.p < own;
            Calibrated { name: case.name.clone(), uniformity: found, skewed, conservative, violation }
        })
        .collect();
    let p: Vec<f64> = finished.iter().flat_map(|(_, outcomes)| outcomes).filter_map(Outcome::continuous_p).collect();
    let below = |level: f64| p.iter().filter(|p| **p < level).count() as f64 / p.len().max(1) as f64;
    let all = uniformity(&p);
    let skewed = tests.iter().filter(|test| test.skewed || test.violation.is_some()).count();
    Ok(Calibration {
        seeds,
        samples,
        level: protocol.level,
        uniformity: all,
        below_5_percent: below(0.05),
        below_1_percent: below(0.01),
        interrupted,
        accepted: !interrupted && skewed == 0 && all.p_too_small >= 0.5 * protocol.level,
        tests,
        skewed,
        p,
    })
}

#[cfg(test)]
mod tests {
    use super::super::{select, suite};
    use super::*;
    use etalon_stats::{Line, Sample, density, sampler};

    fn skewed(power: f64) -> Case {
        Case::of("skewed", Line::UNIT, move || {
            let draw = move |u: &[f64]| Some(Sample::new(u[0].powf(power)));
            (sampler(1, draw), density(|_: f64| 1.0))
        })
    }

    #[test]
    fn p_values_of_right_samplers_may_be_larger_than_uniform_ones_and_those_of_wrong_ones_are_smaller() {
        let right = select(suite::cases(), &["warp".to_owned()]).unwrap();
        let found = calibrate(&right, &Protocol::default(), 20, &|_| ()).unwrap();
        assert!(found.accepted && found.uniformity.count == 20 * right.len(), "{found:?}");
        // An error of 2 %, which a single run would accept most of the time.
        let found = calibrate(&[skewed(1.02)], &Protocol::default(), 40, &|_| ()).unwrap();
        assert!(!found.accepted && found.skewed == 1, "{:?}", found.tests);
        assert!(calibrate(&[skewed(1.0)], &Protocol::default(), 2, &|_| ()).is_err());
        // Few samples in each of many outcomes: p-values are bounds.
        let bounds = select(suite::cases(), &["table/cdf/even/65535".to_owned()]).unwrap();
        let found = calibrate(&bounds, &Protocol::default(), 300, &|_| ()).unwrap();
        let test = &found.tests[0];
        assert!(found.accepted && test.conservative && test.uniformity.p < 1e-3, "{test:?}");
    }
}
