//! The checks of one configuration, a cheap screen of all and a thorough run of one with fresh random numbers; and the decision on
//! a sweep, in two stages at one level.
//!
//! A sweep has so many tests that a correction for their number would ask for p-values of 10⁻⁹, where the chi-square
//! distribution no longer describes statistics of few expected counts. So p-values of the screen decide nothing: they
//! choose the *survivors*, the tests with p < [`SCREEN_LEVEL`](super::SCREEN_LEVEL). Each survivor is run again with fresh
//! random numbers, and Holm's step-down over the fresh p-values alone rejects.
//!
//! *Level.* Given the screen, the set S of survivors is fixed, and the fresh p-values of the right ones among them are
//! independent of it and uniform (or larger). Holm's step-down keeps the level α for any number of hypotheses: P(a right
//! one is rejected | S) ≤ α, whatever S. The mean over S is ≤ α too. So the familywise level of the whole sweep is α,
//! without a correction for the tests that were screened, and however wrong the p-values of the screen are. The fresh ones
//! must be right down to α/|S|, which is 1/SCREEN_LEVEL times as large as α over the number of tests if all are right. The
//! argument allows any choice of S by the screen alone; so where very many survive, only those with the smallest p-values
//! are run again.
//!
//! *Power.* An error is found if it survives and is rejected: the screen finds the stated error with 90 % probability, and
//! the second run, with six to seven times the samples, finds what survived almost certainly.

use super::space::Configuration;
use crate::bsdf::{ALL, Family};
use crate::error::Result;
use crate::examine::{Protocol, SampleCount};
use crate::multiple::holm;
use crate::outcome::Outcome;
use crate::parallel::each;
use std::collections::BTreeMap;

/// A statistical check survives the screen, to be run again, if its p-value is below this.
pub const SCREEN_LEVEL: f64 = 1e-3;
/// The level for which the samples of the second run are counted: that of one in ten thousand survivors at 1 % for all
/// together.
pub const CONFIRM_LEVEL: f64 = 1e-6;
/// Cells of a test: a quarter of the default number, which takes half of the samples for an error of the same size.
const CELLS: usize = 50;

/// What a check says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum State {
    /// Nothing speaks against the BSDF.
    Holds,
    /// It cannot say.
    Inconclusive,
    /// The p-value of a statistical check is below [`SCREEN_LEVEL`], or it found a violation, which counts as a p-value of
    /// 0: a bound that may fail by chance, such as that of an integral, does not hold.
    Suspicious,
    /// An exact check found something wrong.
    Violated,
}

/// What one check found.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// The index of the check in [`ALL`].
    pub check: usize,
    /// In short.
    pub state: State,
    /// The p-value of a statistical check; 0 for a violation.
    pub p: Option<f64>,
    /// The error that would have been found, with 90 % probability.
    pub detectable: Option<f64>,
    /// What is wrong, or why it cannot say.
    pub message: Option<String>,
}

impl Finding {
    fn new(check: usize, outcome: &Outcome) -> Self {
        let is_statistical = ALL[check].is_statistical;
        let is_violated = outcome.violation.is_some();
        let undecided = outcome.undecided();
        let p = if is_violated && is_statistical { Some(0.0) } else { outcome.p };
        let state = if is_violated && !is_statistical {
            State::Violated
        } else if p.is_some_and(|p| p < SCREEN_LEVEL) {
            State::Suspicious
        } else if undecided.is_some() {
            State::Inconclusive
        } else {
            State::Holds
        };
        let texts = [&outcome.violation, &outcome.diagnosis, &undecided];
        let message = texts.into_iter().flatten().next().filter(|_| state != State::Holds).cloned();
        Self { check, state, p, detectable: outcome.detectable, message }
    }
}

/// Runs all checks that apply, each so that it finds a relative error `detect` with 90 % probability at the level
/// [`SCREEN_LEVEL`].
///
/// # Errors
/// As [`Check::examine`](crate::bsdf::Check::examine), and those of [`Family::with`].
pub fn screen(
    family: &dyn Family,
    configuration: &Configuration,
    detect: f64,
    cancelled: fn() -> bool,
) -> Result<Vec<Finding>> {
    let samples = SampleCount::Detect(detect);
    let protocol =
        Protocol { seed: configuration.seed, samples, level: SCREEN_LEVEL, tests: 1, cells: CELLS, cancelled };
    let bsdf = family.with(&configuration.values)?;
    let wo = configuration.direction(bsdf.properties().precision);
    let mut found = Vec::new();
    for (index, check) in ALL.iter().enumerate() {
        if let Some(outcome) = check.examine(&*bsdf, wo, &protocol, 0)? {
            found.push(Finding::new(index, &outcome));
        }
    }
    Ok(found)
}

/// Runs one check again: an exact one as [`screen`] does; a statistical one with fresh random numbers, so many that it
/// finds half the error with 90 % probability at the level [`CONFIRM_LEVEL`], and the whole error almost certainly. `None`
/// where it does not apply.
///
/// # Errors
/// As [`screen`].
pub fn confirm(
    family: &dyn Family,
    configuration: &Configuration,
    check: usize,
    detect: f64,
    cancelled: fn() -> bool,
) -> Result<Option<Finding>> {
    let samples = SampleCount::Detect(0.5 * detect);
    let protocol =
        Protocol { seed: configuration.seed, samples, level: CONFIRM_LEVEL, tests: 1, cells: CELLS, cancelled };
    let bsdf = family.with(&configuration.values)?;
    let wo = configuration.direction(bsdf.properties().precision);
    // An exact check fails at certain random numbers, which are to be met again.
    let round = u64::from(ALL[check].is_statistical);
    let outcome = ALL[check].examine(&*bsdf, wo, &protocol, round)?;
    Ok(outcome.map(|outcome| Finding::new(check, &outcome)))
}

/// A test that survived the screen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Survivor {
    /// The index of the family.
    pub family: usize,
    /// The number of the configuration.
    pub number: u64,
    /// The index of the check in [`ALL`](crate::bsdf::ALL).
    pub check: usize,
    /// The p-value of the screen.
    pub p: f64,
}

/// The survivors of a sweep: of each check of each family a bounded number, those with the smallest p-values.
#[derive(Debug, Clone)]
pub struct Survivors {
    most: usize,
    found: BTreeMap<(usize, usize), Vec<Survivor>>,
    added: u64,
}

/// Survivors of each check of each family that are run again, or twice as many as right BSDFs are expected to have, if
/// that is more.
const FEWEST_RERUN: u64 = 1000;

impl Survivors {
    /// None yet of a sweep of families with at most n configurations each.
    #[must_use]
    pub fn new(configurations: u64) -> Self {
        let most = FEWEST_RERUN.max((2.0 * SCREEN_LEVEL * configurations as f64) as u64) as usize;
        Self { most, found: BTreeMap::new(), added: 0 }
    }

    /// Adds one. The order of additions does not matter.
    pub fn add(&mut self, survivor: Survivor) {
        self.added += 1;
        let group = self.found.entry((survivor.family, survivor.check)).or_default();
        group.push(survivor);
        if group.len() >= 2 * self.most {
            keep(group, self.most);
        }
    }

    /// Those to run again, and the number of those left out.
    #[must_use]
    pub fn chosen(mut self) -> (Vec<Survivor>, u64) {
        self.found.values_mut().for_each(|group| keep(group, self.most));
        let mut chosen: Vec<Survivor> = self.found.into_values().flatten().collect();
        chosen.sort_by_key(|survivor| (survivor.number, survivor.check));
        let left_out = self.added - chosen.len() as u64;
        (chosen, left_out)
    }
}

/// Keeps the `most` smallest p-values.
fn keep(group: &mut Vec<Survivor>, most: usize) {
    group.sort_by(|a, b| a.p.total_cmp(&b.p).then(a.number.cmp(&b.number)));
    group.truncate(most);
}

/// A survivor after its second run.
#[derive(Debug, Clone, PartialEq)]
pub struct Decided {
    /// What the screen found.
    pub survivor: Survivor,
    /// What the second run found; `None` if the check does not apply any more.
    pub fresh: Option<Finding>,
    /// Whether the fresh p-value is rejected at the level of all together.
    pub is_rejected: bool,
}

impl Decided {
    /// Whether the second run could not say.
    #[must_use]
    pub fn is_inconclusive(&self) -> bool {
        !self.is_rejected && self.fresh.as_ref().is_none_or(|fresh| fresh.state == State::Inconclusive)
    }
}

/// Runs the survivors again by `confirm`, in parallel if `is_parallel`, and decides at `level` for all together.
///
/// # Errors
/// Those of `confirm`.
pub fn decide(
    survivors: Vec<Survivor>,
    level: f64,
    is_parallel: bool,
    confirm: impl Fn(&Survivor) -> Result<Option<Finding>> + Sync,
) -> Result<Vec<Decided>> {
    let fresh: Vec<Option<Finding>> = if is_parallel {
        each(survivors.len() as u64, |number| confirm(&survivors[number as usize]))?
    } else {
        survivors.iter().map(&confirm).collect::<Result<_>>()?
    };
    let p: Vec<f64> = fresh.iter().map(|fresh| fresh.as_ref().and_then(|f| f.p).unwrap_or(f64::NAN)).collect();
    let decided = survivors.into_iter().zip(fresh).zip(holm(&p, level));
    Ok(decided.map(|((survivor, fresh), is_rejected)| Decided { survivor, fresh, is_rejected }).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::multiple::holm;
    use crate::stream::CounterRng;
    use rand::RngExt;
    use rayon::prelude::*;

    const LEVEL: f64 = 0.05;
    const TESTS: u64 = 50_000;
    const RUNS: u64 = 1000;

    /// The shares of runs over right tests that reject any: in two stages, and by Holm's step-down over the screen alone.
    /// `p` turns uniform random numbers into p-values.
    fn rejecting(p: impl Fn(f64) -> f64 + Sync) -> [f64; 2] {
        let run = |seed: u64| {
            let mut rng = CounterRng::new(seed, 0);
            let screened: Vec<f64> = (0..TESTS).map(|_| p(rng.random())).collect();
            let mut survivors = Survivors::new(TESTS);
            for (number, &p) in screened.iter().enumerate().filter(|(_, p)| **p < SCREEN_LEVEL) {
                survivors.add(Survivor { family: 0, number: number as u64, check: 0, p });
            }
            let fresh = |survivor: &Survivor| {
                let p = p(CounterRng::new(seed, survivor.number + 1).random());
                Ok(Some(Finding { check: 0, state: State::Holds, p: Some(p), detectable: None, message: None }))
            };
            let (chosen, left_out) = survivors.chosen();
            assert_eq!(left_out, 0);
            let decided = decide(chosen, LEVEL, false, fresh).unwrap();
            [decided.iter().any(|decided| decided.is_rejected), holm(&screened, LEVEL).contains(&true)]
        };
        let all: Vec<[bool; 2]> = (0..RUNS).into_par_iter().map(run).collect();
        [0, 1].map(|i| all.iter().filter(|run| run[i]).count() as f64 / RUNS as f64)
    }

    /// Three standard deviations of the share of runs that reject at the level.
    fn chance() -> f64 {
        3.0 * (LEVEL * (1.0 - LEVEL) / RUNS as f64).sqrt()
    }

    #[test]
    fn the_level_of_both_stages_is_that_of_holm() {
        let [two_stages, _] = rejecting(|u| u);
        // Šidák's levels are exact for independent tests, so the share is the level itself.
        assert!((two_stages - LEVEL).abs() < chance(), "{two_stages}");
    }

    #[test]
    fn wrong_far_tails_reject_in_one_stage_and_not_in_two() {
        // Right down to 10⁻⁴, a thousand times too small below.
        let tail = |u: f64| if u < 1e-4 { 1e-3 * u } else { u };
        let [two_stages, one_stage] = rejecting(tail);
        // About fifty survive: the fresh p-values must be right down to 10⁻³.
        assert!(two_stages < LEVEL + chance(), "{two_stages}");
        assert!(one_stage > 0.9, "the tails of this test are not wrong enough: {one_stage}");
    }

    #[test]
    fn wrong_p_values_of_the_screen_do_not_matter() {
        // Ten times too many survive.
        let mut survivors = Survivors::new(100_000);
        for number in 0..1000 {
            survivors.add(Survivor { family: 0, number, check: 0, p: 1e-30 });
        }
        let (chosen, _) = survivors.chosen();
        let rejects = |seed: u64| {
            let fresh = |survivor: &Survivor| {
                let p: f64 = CounterRng::new(seed, survivor.number).random();
                Ok(Some(Finding { check: 0, state: State::Holds, p: Some(p), detectable: None, message: None }))
            };
            decide(chosen.clone(), LEVEL, false, fresh).unwrap().iter().any(|decided| decided.is_rejected)
        };
        let share = (0..RUNS).filter(|&seed| rejects(seed)).count() as f64 / RUNS as f64;
        assert!((share - LEVEL).abs() < chance(), "{share}");
    }

    #[test]
    fn a_wrong_one_among_many_is_rejected() {
        let survivors: Vec<Survivor> =
            (0..100).map(|number| Survivor { family: 0, number, check: 0, p: 1e-4 }).collect();
        let fresh = |survivor: &Survivor| {
            let p = if survivor.number == 17 { 1e-9 } else { 0.3 };
            Ok(Some(Finding { check: 0, state: State::Holds, p: Some(p), detectable: None, message: None }))
        };
        let decided = decide(survivors, LEVEL, true, fresh).unwrap();
        let rejected: Vec<u64> = decided.iter().filter(|d| d.is_rejected).map(|d| d.survivor.number).collect();
        assert_eq!(rejected, [17]);
    }

    #[test]
    fn of_very_many_survivors_the_smallest_remain_in_any_order() {
        let all: Vec<Survivor> = (0..10_000u64)
            .map(|number| Survivor { family: 0, number, check: 0, p: (number * 7919 % 10_000) as f64 * 1e-7 })
            .collect();
        let chosen = |all: &mut dyn Iterator<Item = &Survivor>| {
            let mut survivors = Survivors::new(0);
            all.for_each(|survivor| survivors.add(*survivor));
            survivors.chosen()
        };
        let (forwards, left_out) = chosen(&mut all.iter());
        assert_eq!((forwards.len(), left_out), (1000, 9000));
        assert!(forwards.iter().all(|survivor| survivor.p < 1e-4));
        assert_eq!(chosen(&mut all.iter().rev()).0, forwards);
    }
}
