//! A planted fault, which is a test with a mistake and without it, and a run over many: what detected each, and how large its error is.

use super::super::case::Case;
use super::super::run::{Validation, run as run_cases};
use etalon_core::error::Result;
use etalon_stats::power::noncentrality;
use etalon_stats::{Density, Domain, Outcome, Protocol, Sampler, Verdict};
use serde::Serialize;

/// A mistake in its setting.
pub struct PlantedFault {
    /// Family and mistake (`normals/missing-cosine`).
    pub name: &'static str,
    /// What the mistake is, and where it occurs.
    pub mistake: &'static str,
    /// The test of the sampler with the mistake.
    pub(in crate::validation) faulty: Case,
    /// The same test without it.
    pub(in crate::validation) sound: Case,
}

impl PlantedFault {
    /// `make` builds sampler and pdf with the mistake or without it.
    pub(in crate::validation) fn of<D, S, P, F>(name: &'static str, domain: D, make: F) -> Self
    where
        D: Domain + Copy + Send + Sync + 'static,
        S: Sampler,
        P: Density,
        F: Fn(bool) -> (S, P) + Clone + Send + Sync + 'static,
    {
        Self::on(name, || domain, make)
    }

    /// [`of`](Self::of) a domain that each of the two tests makes for itself.
    pub(in crate::validation) fn on<D, S, P, F>(name: &'static str, domain: impl Fn() -> D, make: F) -> Self
    where
        D: Domain + Send + Sync + 'static,
        S: Sampler,
        P: Density,
        F: Fn(bool) -> (S, P) + Clone + Send + Sync + 'static,
    {
        let right = make.clone();
        Self {
            name,
            mistake: "",
            faulty: Case::of(format!("planted/{name}"), domain(), move || make(true)),
            sound: Case::of(format!("sound/{name}"), domain(), move || right(false)),
        }
    }

    pub(in crate::validation) fn mistake(self, mistake: &'static str) -> Self {
        Self { mistake, ..self }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub enum By {
    /// A deterministic check: an integral, a value, a sample outside the support, an inverse.
    #[serde(rename = "exact check")]
    Exact,
    /// The chi-square tests of the samples: of the cells, of finer parts, of the order.
    #[serde(rename = "chi-square")]
    ChiSquare,
    /// Either alone would have sufficed.
    #[serde(rename = "exact check and chi-square")]
    Both,
}

impl By {
    fn of(outcome: &Outcome, level: f64) -> Option<Self> {
        match (outcome.violation.is_some(), outcome.p.is_some_and(|p| p < level)) {
            (true, true) => Some(Self::Both),
            (true, false) => Some(Self::Exact),
            (false, true) => Some(Self::ChiSquare),
            (false, false) => None,
        }
    }

    pub fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::ChiSquare => "chi-square",
            Self::Both => "both",
        }
    }
}

#[derive(Debug, Clone, Serialize)]
pub struct Finding {
    pub name: &'static str,
    pub mistake: &'static str,
    /// Result of the test with the mistake.
    #[serde(flatten)]
    pub outcome: Outcome,
    /// What detected it; `None` if nothing did.
    pub by: Option<By>,
    /// Estimate of the relative error: of the pdf, root mean square over the cells, √((χ² − dof)/N); of the radiance of an
    /// image, as if it were the same everywhere.
    pub error: Option<f64>,
    /// Verdict of the same test without the mistake.
    pub sound: Verdict,
    /// The p-value of that test.
    pub sound_p: Option<f64>,
    /// Why that test did not accept, if it did not.
    pub sound_remark: Option<String>,
}

#[derive(Debug, Clone, Serialize)]
pub struct Findings {
    /// Probability that any of the tests without a mistake is rejected.
    pub level: f64,
    /// One for each planted fault.
    pub tests: Vec<Finding>,
    /// Planted faults that were accepted: should be 0.
    pub accepted: usize,
    /// Planted faults that were rejected: should be all.
    pub rejected: usize,
    /// Planted faults that could not be decided: should be 0.
    pub inconclusive: usize,
    /// Tests without a mistake that were rejected.
    pub false_alarms: usize,
    /// Tests without a mistake that could not be decided.
    pub sound_inconclusive: usize,
    /// Whether the process was asked to stop before all tests were finished.
    pub interrupted: bool,
    /// Wall-clock time of the run.
    pub seconds: f64,
}

impl Findings {
    /// Whether every fault was rejected, and every test without one accepted.
    pub fn is_good(&self) -> bool {
        self.rejected == self.tests.len() && self.false_alarms + self.sound_inconclusive == 0
    }
}

/// Tests all of `planted` with and without their mistakes, in one run, and calls `done` after each test.
pub fn run(planted: Vec<PlantedFault>, protocol: &Protocol, done: &(dyn Fn(&str) + Sync)) -> Result<Findings> {
    let mut about = Vec::new();
    let mut cases: Vec<Case> = Vec::new();
    for PlantedFault { name, mistake, faulty, sound } in planted {
        about.push((name, mistake));
        cases.extend([faulty, sound]);
    }
    let validation = run_cases(&cases, protocol, done)?;
    // Pairs of outcomes: with the mistake, then without it.
    let protocol = Protocol { tests: cases.len(), ..*protocol };
    let mut outcomes = validation.tests.into_iter().map(|test| test.outcome);
    let mut tests = Vec::with_capacity(about.len());
    while let (Some(outcome), Some(sound)) = (outcomes.next(), outcomes.next()) {
        let (name, mistake) = about[tests.len()];
        let by = By::of(&outcome, protocol.own_level());
        let error = error(&outcome, &protocol);
        let remark = sound.reason();
        let (sound, sound_p) = (sound.verdict, sound.p);
        tests.push(Finding { name, mistake, outcome, by, error, sound, sound_p, sound_remark: remark });
    }
    let count = |verdict| tests.iter().filter(|test| test.outcome.verdict == verdict).count();
    let sound = |verdict| tests.iter().filter(|test| test.sound == verdict).count();
    Ok(Findings {
        level: protocol.level,
        accepted: count(Verdict::Accept),
        rejected: count(Verdict::Reject),
        inconclusive: count(Verdict::Inconclusive),
        false_alarms: sound(Verdict::Reject),
        sound_inconclusive: sound(Verdict::Inconclusive),
        interrupted: validation.interrupted,
        seconds: validation.seconds,
        tests,
    })
}

/// The test of one fault with the mistake, then without it, with their counts.
pub fn run_pair(planted: PlantedFault, protocol: &Protocol) -> Result<Validation> {
    let PlantedFault { faulty, sound, .. } = planted;
    run_cases(&[faulty, sound], protocol, &|_| ())
}

/// Estimate of the error from the counts of a round, or else from what is detectable. The mean of the statistic is dof + λ with
/// the noncentrality λ = N w² of the error w, which is known for the detectable error.
fn error(outcome: &Outcome, protocol: &Protocol) -> Option<f64> {
    let found = (outcome.statistic - outcome.dof as f64).max(0.0);
    if let Some(counts) = &outcome.counts {
        let samples: u64 = counts.observed.iter().sum();
        return (outcome.dof > 0).then(|| (found / samples as f64).sqrt());
    }
    let detectable = outcome.detectable.filter(|_| outcome.dof > 0)?;
    Some(detectable * (found / noncentrality(outcome.dof, protocol.own_level())).sqrt())
}
