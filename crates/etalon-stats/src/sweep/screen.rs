//! The checks of one configuration: a cheap screen of all, and a thorough run of one with fresh random numbers.

use super::configuration::Configuration;
use crate::bsdf::{ALL, Family};
use crate::error::Result;
use crate::examine::{Protocol, SampleCount};
use crate::outcome::Outcome;

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
