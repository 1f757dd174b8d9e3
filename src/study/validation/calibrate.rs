//! The harness tests itself: over many seeds, are the p-values of samplers that are right spread evenly?

use super::case::Case;
use super::run::of_each;
use crate::error::{Error, Result};
use crate::interrupt;
use crate::stats::kolmogorov::{Evenness, evenness};
use crate::stats::multiple::sidak;
use crate::stats::{Outcome, Protocol, Samples};
use rayon::prelude::*;
use serde::Serialize;

/// The p-values of one test.
#[derive(Debug, Clone, Serialize)]
pub struct Calibrated {
    pub name: String,
    pub evenness: Evenness,
    /// Whether they are spread so unevenly that chance does not explain it.
    pub uneven: bool,
    /// The fault of the first seed at which an exact check failed.
    pub fault: Option<String>,
}

/// What many seeds found.
#[derive(Debug, Clone, Serialize)]
pub struct Calibration {
    pub seeds: u64,
    /// Samples of each test at each seed.
    pub samples: u64,
    /// Probability that a right harness on right samplers is called uneven anywhere.
    pub level: f64,
    /// Of the p-values of all tests together.
    pub evenness: Evenness,
    /// Share of p-values below 5 % and below 1 %.
    pub below_5_percent: f64,
    pub below_1_percent: f64,
    pub tests: Vec<Calibrated>,
    /// Tests that are uneven or at fault.
    pub uneven: usize,
    /// Whether the process was asked to stop before all tests were finished; those that were not are left out.
    pub interrupted: bool,
    pub accepted: bool,
    #[serde(skip)]
    pub p: Vec<f64>,
}

/// Samples and cells of a calibration: few, so that many seeds are quick, and hundreds of samples per cell, so that the
/// chi-square distribution is the statistic's own.
const SAMPLES: u64 = 20_000;
const CELLS: usize = 50;

/// Runs every case under `seeds` seeds that follow one another from the protocol's, and tests by Kolmogorov and Smirnov
/// whether p-values are even, all together and test by test, at the protocol's level in all.
pub fn calibrate(cases: &[Case], protocol: &Protocol, seeds: u64, done: &(dyn Fn(&str) + Sync)) -> Result<Calibration> {
    if !(5..=100_000).contains(&seeds) {
        return Err(Error::parameter("seeds", format!("{seeds} seeds")).with_hint("use 5 to 100000 seeds"));
    }
    let samples = if let Samples::Count(n) = protocol.samples { n } else { SAMPLES };
    let protocol = Protocol { samples: Samples::Count(samples), cells: CELLS, tests: cases.len(), ..*protocol };
    protocol.check()?;
    cases.iter().take_while(|_| !interrupt::requested()).for_each(Case::prepare);
    let of_case = |case: &Case| {
        let at = |i| case.examine(&Protocol { seed: protocol.seed.wrapping_add(i), ..protocol }, 0);
        let outcomes = if case.is_large() {
            (0..seeds).map(at).collect::<Result<Vec<Outcome>>>()
        } else {
            (0..seeds).into_par_iter().map(at).collect()
        };
        done(&case.name);
        match outcomes {
            Err(Error::Interrupted) => Ok(None),
            other => other.map(Some),
        }
    };
    let finished = of_each(cases, of_case)?;
    let interrupted = finished.iter().any(Option::is_none);
    let finished: Vec<(&Case, Vec<Outcome>)> =
        cases.iter().zip(finished).filter_map(|(case, outcomes)| Some((case, outcomes?))).collect();
    let own = sidak(0.5 * protocol.level, cases.len());
    let tests: Vec<Calibrated> = finished
        .iter()
        .map(|(case, outcomes)| {
            let p: Vec<f64> = outcomes.iter().filter_map(Outcome::continuous_p).collect();
            let evenness = evenness(&p);
            let fault = outcomes.iter().find_map(|outcome| outcome.fault.clone());
            Calibrated { name: case.name.clone(), evenness, uneven: evenness.p < own, fault }
        })
        .collect();
    let p: Vec<f64> = finished.iter().flat_map(|(_, outcomes)| outcomes).filter_map(Outcome::continuous_p).collect();
    let below = |level: f64| p.iter().filter(|p| **p < level).count() as f64 / p.len().max(1) as f64;
    let all = evenness(&p);
    let uneven = tests.iter().filter(|test| test.uneven || test.fault.is_some()).count();
    Ok(Calibration {
        seeds,
        samples,
        level: protocol.level,
        evenness: all,
        below_5_percent: below(0.05),
        below_1_percent: below(0.01),
        interrupted,
        accepted: !interrupted && uneven == 0 && all.p >= 0.5 * protocol.level,
        tests,
        uneven,
        p,
    })
}

#[cfg(test)]
mod tests {
    use super::super::{select, suite};
    use super::*;
    use crate::stats::{Draw, Line, density, sampler};

    fn skewed(power: f64) -> Case {
        Case::of("skewed", Line::UNIT, move || {
            let draw = move |u: &[f64]| Some(Draw::new(u[0].powf(power)));
            (sampler(1, draw), density(|_: f64| 1.0))
        })
    }

    #[test]
    fn right_samplers_are_even_and_wrong_ones_are_not() {
        let right = select(suite::cases(), &["warp".to_owned()]).unwrap();
        let found = calibrate(&right, &Protocol::default(), 20, &|_| ()).unwrap();
        assert!(found.accepted && found.evenness.count == 20 * right.len(), "{found:?}");
        // 2 % off: each single run would accept most of the time.
        let found = calibrate(&[skewed(1.02)], &Protocol::default(), 40, &|_| ()).unwrap();
        assert!(!found.accepted && found.uneven == 1, "{:?}", found.tests);
        assert!(calibrate(&[skewed(1.0)], &Protocol::default(), 2, &|_| ()).is_err());
    }
}
