//! What a test found, and the verdict on it among the others of a run.

use super::grid::Grid;
use super::mass::Integral;
use super::multiple::{fisher, holm};
use crate::error::Result;
use serde::Serialize;
use std::fmt;

/// What is to be made of a test.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    Accept,
    Reject,
    /// Too few samples, or an integral too uncertain, for either. Never to be taken for a pass.
    Inconclusive,
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Accept => "accept",
            Self::Reject => "reject",
            Self::Inconclusive => "inconclusive",
        })
    }
}

/// The counts behind a test.
#[derive(Debug, Clone, PartialEq)]
pub struct Counts {
    /// What the axes of the grid's chart stand for.
    pub axes: [&'static str; 2],
    pub grid: Grid,
    /// Observed and expected counts: of the grid's cells, then of the atoms, then of "no sample".
    pub observed: Vec<u64>,
    pub expected: Vec<f64>,
    pub atoms: usize,
}

/// The findings of one test.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Outcome {
    pub verdict: Verdict,
    /// Pearson's Σ (O − E)²/E, or whatever else `p` belongs to.
    pub statistic: f64,
    pub dof: usize,
    /// Probability of findings at least this bad if the claim is true; of both rounds together after a repetition.
    /// `None` where nothing could be tested.
    pub p: Option<f64>,
    pub samples: u64,
    /// The smallest relative density error (root mean square over the cells) that is found with 90 % probability.
    pub detectable: Option<f64>,
    pub seconds: f64,
    /// The integral of the density and its atoms.
    #[serde(flatten)]
    pub mass: Option<Integral>,
    /// Cells, and groups of them after pooling.
    pub cells: usize,
    pub pooled: usize,
    /// How many of the samples were none.
    pub none: u64,
    /// Whether the test was repeated with fresh numbers.
    pub repeated: bool,
    /// What an exact check found wrong: a reason to reject, whatever `p` says.
    pub fault: Option<String>,
    /// Why no verdict is possible.
    pub doubt: Option<String>,
    /// Whether the process was asked to stop before the test was finished, or before its repetition was.
    pub interrupted: bool,
    #[serde(skip)]
    pub counts: Option<Counts>,
}

impl Outcome {
    /// Of so many samples, with nothing found yet and no verdict.
    #[must_use]
    pub fn open(samples: u64) -> Self {
        Self {
            verdict: Verdict::Inconclusive,
            statistic: 0.0,
            dof: 0,
            p: None,
            samples,
            detectable: None,
            seconds: 0.0,
            mass: None,
            cells: 0,
            pooled: 0,
            none: 0,
            repeated: false,
            fault: None,
            doubt: None,
            interrupted: false,
            counts: None,
        }
    }

    /// Of a test that the process was asked to stop before.
    #[must_use]
    pub fn interrupted() -> Self {
        Self { interrupted: true, ..Self::open(0) }
    }

    #[must_use]
    pub fn is_accepted(&self) -> bool {
        self.verdict == Verdict::Accept
    }

    /// The p-value, if it has a continuous distribution: not where a claim leaves nothing to chance.
    #[must_use]
    pub fn continuous_p(&self) -> Option<f64> {
        self.p.filter(|_| self.dof > 0)
    }

    /// What there is to say beyond numbers.
    #[must_use]
    pub fn remark(&self) -> Option<&str> {
        let interrupted = self.interrupted.then_some("interrupted before the test was finished");
        self.fault.as_deref().or(interrupted).or(self.doubt.as_deref())
    }

    /// Takes the findings of a repetition into account; one that had nothing to test leaves the first as it is.
    fn combine(&mut self, second: &Self) {
        if let Some(second) = second.p {
            self.p = self.p.map(|first| fisher(first, second));
            self.repeated = true;
        }
        self.samples += second.samples;
        self.seconds += second.seconds;
        self.fault = self.fault.take().or_else(|| second.fault.clone());
        self.interrupted |= second.interrupted;
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.verdict)?;
        if let Some(p) = self.p {
            write!(f, ": chi² = {:.1}, {} degrees of freedom, p = {p:.3e}", self.statistic, self.dof)?;
        }
        write!(f, ", {} samples", self.samples)?;
        if let Some(w) = self.detectable {
            write!(f, ", would find a relative density error of {:.2} %", 100.0 * w)?;
        }
        self.remark().map_or(Ok(()), |remark| write!(f, ": {remark}"))
    }
}

/// Decides on the tests of one run, which together reject true claims with probability `level` at most.
///
/// What Holm's step-down rejects is repeated once with fresh numbers by `repeat` (given the test's index), the two
/// p-values are combined by Fisher's method, and the step-down is done again. Nothing is chosen: a repetition always counts, and
/// a test that fails an exact check stays rejected. What was interrupted is inconclusive.
pub fn decide(outcomes: &mut [Outcome], level: f64, mut repeat: impl FnMut(usize) -> Result<Outcome>) -> Result<()> {
    let rejected = |outcomes: &[Outcome]| {
        let p: Vec<f64> = outcomes.iter().map(|o| o.p.unwrap_or(f64::NAN)).collect();
        holm(&p, level)
    };
    for (i, suspect) in rejected(outcomes).into_iter().enumerate() {
        if suspect && outcomes[i].fault.is_none() {
            let second = repeat(i)?;
            outcomes[i].combine(&second);
        }
    }
    let rejected = rejected(outcomes);
    for (outcome, rejected) in outcomes.iter_mut().zip(rejected) {
        outcome.verdict = if outcome.fault.is_some() || rejected && !outcome.interrupted {
            Verdict::Reject
        } else if outcome.interrupted || outcome.doubt.is_some() {
            Verdict::Inconclusive
        } else {
            Verdict::Accept
        };
    }
    Ok(())
}
