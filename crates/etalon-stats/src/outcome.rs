//! What a test found, and the verdict on it among the others of a run.

use crate::diagnosis::{count, p_value};
use crate::domain::{Domain, Point};
use crate::estimate::Estimate;
use crate::exact::percent;
use crate::grid::{Cell, Grid};
use crate::mass::Integral;
use crate::multiple::{fisher, holm, sidak};
use crate::named_mistake::NamedMistake;
use crate::scales::Scale;
use std::fmt;

/// The decision on a test.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(rename_all = "lowercase"))]
pub enum Verdict {
    /// Nothing speaks against the sampler, and the test would have detected an error of the stated size.
    Accept,
    /// An exact check failed, or the counts do not follow the pdf.
    Reject,
    /// Too few samples, or an integral too uncertain, for either. It is not a pass.
    #[default]
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
    /// The quantities along the axes of the grid's chart.
    pub axes: [String; 2],
    /// How many outcomes the first axis has, if its points are those of a finite set.
    pub outcomes: Option<usize>,
    /// The cells.
    pub grid: Grid,
    /// The cells in coordinates x and y, of a set of numbers or of pairs of numbers.
    pub boxes: Option<Vec<Cell>>,
    /// Observed counts: of the grid's cells, then of the atoms, then of "no sample".
    pub observed: Vec<u64>,
    /// Expected counts, in the same order.
    pub expected: Vec<f64>,
    /// The names of the atoms.
    pub atoms: Vec<String>,
    /// Parts of cells, where these reject and the cells do not.
    pub finer: Option<Finer>,
}

impl Counts {
    /// The counts of the cells of a domain, of the atoms and of "no sample".
    pub(crate) fn new(
        domain: &dyn Domain,
        grid: Grid,
        atoms: Vec<String>,
        observed: Vec<u64>,
        expected: Vec<f64>,
    ) -> Self {
        let (axes, boxes) = (domain.axes().map(str::to_owned), grid.cells().map(|cell| domain.boxed(&cell)).collect());
        Self { axes, outcomes: domain.outcomes(), grid, boxes, observed, expected, atoms, finer: None }
    }
}

/// Counts of equal parts along an axis of the chart, around the place where they differ most from what is expected.
#[derive(Debug, Clone, PartialEq)]
pub struct Finer {
    /// The axis.
    pub axis: usize,
    /// How many such parts the whole axis has.
    pub parts: usize,
    /// The ends of the parts: x or y of a set of numbers or of pairs of numbers, else the chart's coordinate.
    pub ends: Vec<f64>,
    /// Their samples.
    pub observed: Vec<u64>,
    /// The samples that are expected.
    pub expected: Vec<f64>,
}

/// Numbers of an exact check that should be equal, and are not.
#[derive(Debug, Clone, PartialEq)]
pub struct Compared {
    /// What they should obey.
    pub law: String,
    /// The place of each two, what was found and what is expected: the direction `wi` of a BSDF, the sample of a sampler. Directions
    /// around another axis are turned to +z.
    pub places: Vec<(Point, [f64; 2])>,
}

/// The findings of one test.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Outcome {
    /// The decision; open (inconclusive) until [`decide`] has been called.
    pub verdict: Verdict,
    /// Pearson's Σ (O − E)²/E, or the other statistic that `p` belongs to.
    pub statistic: f64,
    /// Degrees of freedom of `statistic`.
    pub dof: usize,
    /// Probability of findings at least this bad if the sampler is right: of `statistic` and all `scales` together, and of both
    /// rounds after a repetition. `None` where nothing could be tested, and where only an exact check rejects.
    pub p: Option<f64>,
    /// Samples taken, those of a repetition included.
    pub samples: u64,
    /// The smallest relative error of the pdf (root mean square over the cells) that is detected with 90 % probability.
    pub detectable: Option<f64>,
    /// Structure finer than the cells, scale by scale; the ends of the axes; the order of the samples. Of the round with more
    /// samples, as are the counts.
    pub scales: Vec<Scale>,
    /// What users should know though it does not decide.
    pub remarks: Vec<String>,
    /// Wall-clock time of the test.
    pub seconds: f64,
    /// The integral of the density and its atoms.
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub mass: Option<Integral>,
    /// The variance of the weights over the square of their mean, where samples carry weights: of two right samplers the one with less
    /// is the better.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub variance_of_weights: Option<Estimate>,
    /// Cells, atoms and "no sample" included.
    pub cells: usize,
    /// Groups of cells after pooling.
    pub pooled: usize,
    /// Samples that were "no sample".
    pub none: u64,
    /// Whether the test was repeated with fresh random numbers.
    pub repeated: bool,
    /// The usual mistake that explains what is wrong, if one does: "samples follow cos θ/π, not the pdf".
    #[cfg_attr(feature = "serde", serde(rename = "named"))]
    pub mistake: Option<NamedMistake>,
    /// What an exact check found wrong: a reason to reject, independent of `p`.
    pub violation: Option<String>,
    /// Why neither accepting nor rejecting is possible.
    pub inconclusive_reason: Option<String>,
    /// Where observed and expected differ most, in words, if the test rejects; until [`decide`] has been called, if it may.
    pub diagnosis: Option<String>,
    /// Whether a look at a part of the samples ended the test.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub stopped: bool,
    /// Whether the test was cancelled before it, or its repetition, was finished.
    pub interrupted: bool,
    /// The direction `wo` of a check of a surface's BSDF, whose normal is +z.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub wo: Option<[f64; 3]>,
    /// The counts behind it.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub counts: Option<Counts>,
    /// The numbers behind a violation, if it is of numbers.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub compared: Option<Compared>,
}

impl Outcome {
    /// The outcome of `samples` samples with nothing found yet and an open verdict.
    #[must_use]
    pub fn open(samples: u64) -> Self {
        Self { samples, ..Self::default() }
    }

    /// The outcome of a test that was cancelled.
    #[must_use]
    pub fn interrupted() -> Self {
        Self { interrupted: true, ..Self::default() }
    }

    /// Whether the verdict is [`Verdict::Accept`].
    #[must_use]
    pub fn is_accepted(&self) -> bool {
        self.verdict == Verdict::Accept
    }

    /// The p-value, if it has a continuous distribution, which that of a deterministic density has not.
    #[must_use]
    pub fn continuous_p(&self) -> Option<f64> {
        self.p.filter(|_| self.dof > 0)
    }

    /// Why nothing can be said, if that is so: the reason that the test gives, or a number that it could not compute. NaN is
    /// neither above nor below a level, and must not count as a pass.
    pub(crate) fn undecided(&self) -> Option<String> {
        let is_nan = |number: Option<f64>| number.is_some_and(f64::is_nan);
        let names = [(is_nan(self.p), "the p-value"), (is_nan(self.detectable), "the error that would be detected")];
        let nan = names.into_iter().find_map(|(is_nan, name)| is_nan.then(|| format!("{name} is not a number")));
        self.inconclusive_reason.clone().or(nan)
    }

    /// What is wrong, how much and where, without the name of a mistake: what an exact check found, or, where that is nothing, where
    /// counts differ most; else why nothing can be said.
    #[must_use]
    pub fn found(&self) -> Option<&str> {
        if self.is_rejected() {
            return self.violation.as_deref().or(self.places().next());
        }
        let interrupted = self.interrupted.then_some("interrupted before the test was finished");
        interrupted.or(self.inconclusive_reason.as_deref())
    }

    /// Why the test does not accept, in a sentence: the usual mistake that explains it, then what was [found](Self::found).
    #[must_use]
    pub fn reason(&self) -> Option<String> {
        let mistake = self.mistake.as_ref().filter(|_| self.is_rejected()).map(ToString::to_string);
        let all: Vec<String> = mistake.into_iter().chain(self.found().map(str::to_owned)).collect();
        Some(all.join(": ")).filter(|text| !text.is_empty())
    }

    /// The [reason](Self::reason), then the places that it does not have.
    #[must_use]
    pub fn findings(&self) -> Vec<String> {
        self.reason().into_iter().chain(self.other_places().map(str::to_owned)).collect()
    }

    /// How many samples were taken, in words: "8192 samples", or "stopped after 8192 samples" where that many were enough to reject.
    #[must_use]
    pub fn taken(&self) -> String {
        let stopped = if self.is_stopped() { "stopped after " } else { "" };
        format!("{stopped}{}", count(self.samples, "sample", "samples"))
    }

    /// Whether the test rejects, and did so before all samples were taken.
    #[must_use]
    pub fn is_stopped(&self) -> bool {
        self.stopped && self.is_rejected()
    }

    /// Whether the verdict is [`Verdict::Reject`], or will be for what an exact check found.
    fn is_rejected(&self) -> bool {
        self.violation.is_some() || self.verdict == Verdict::Reject
    }

    /// Whether the test rejects, and its counts, or what else its p-value belongs to, do.
    #[must_use]
    pub fn is_rejected_by_p(&self) -> bool {
        self.verdict == Verdict::Reject && self.p.is_some()
    }

    /// The first line on a test: the verdict and its [reason](Self::reason).
    #[must_use]
    pub fn headline(&self) -> String {
        self.reason().map_or_else(|| self.verdict.to_string(), |reason| format!("{}: {reason}", self.verdict))
    }

    /// Where observed and expected differ most, the worst place first.
    pub fn places(&self) -> impl Iterator<Item = &str> {
        self.diagnosis.iter().flat_map(|places| places.split("; "))
    }

    /// The places that the [reason](Self::reason) does not have.
    pub fn other_places(&self) -> impl Iterator<Item = &str> {
        let told = self.violation.is_none() && self.verdict == Verdict::Reject;
        self.places().skip(usize::from(told))
    }

    /// What is detected in structure finer than the cells, for each axis and for the cells: the errors of ripples as wide as two
    /// to four parts, at the coarsest scale, at 1/64 and at the finest.
    #[must_use]
    pub fn finer(&self) -> Option<String> {
        const SHOWN: usize = 64;
        let known = |scale: &&Scale| scale.detectable.is_some();
        let mut known: Vec<&Scale> = self.scales.iter().filter(known).collect();
        known.sort_by_key(|scale| scale.parts);
        let mut names: Vec<&str> = self.scales.iter().map(|scale| scale.of.as_str()).collect();
        names.dedup();
        let of = |name: &str| {
            let scales: Vec<&Scale> = known.iter().copied().filter(|scale| scale.of == name).collect();
            let (first, last) = (scales.first()?.parts, scales.last()?.parts);
            let shown = scales.into_iter().filter(|scale| [first, SHOWN, last].contains(&scale.parts));
            let error = |scale: &Scale| Some(format!("{:.2} % at 1/{}", 100.0 * scale.detectable?, scale.parts));
            Some(format!("{name} {}", shown.filter_map(error).collect::<Vec<_>>().join(", ")))
        };
        let all: Vec<String> = names.into_iter().filter_map(of).collect();
        (!all.is_empty()).then(|| all.join("; "))
    }

    /// Takes the findings of a repetition into account; one that had nothing to test leaves the first as it is. The counts
    /// are those of the round with more samples.
    fn combine(&mut self, mut other: Self) {
        let p = self.p.map(|first| other.p.map_or(first, |second| fisher(first, second)));
        let repeated = other.p.is_some();
        if repeated && other.samples > self.samples {
            std::mem::swap(self, &mut other);
        }
        (self.p, self.repeated) = (p, repeated);
        self.samples += other.samples;
        self.seconds += other.seconds;
        self.mistake = self.mistake.take().or(other.mistake);
        self.violation = self.violation.take().or(other.violation);
        self.diagnosis = self.diagnosis.take().or(other.diagnosis);
        self.stopped |= other.stopped;
        self.interrupted |= other.interrupted;
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.headline())?;
        if let Some(p) = self.continuous_p() {
            let freedom = count(self.dof, "degree of freedom", "degrees of freedom");
            write!(f, "; {}, chi² = {:.1} with {freedom}", p_value(p), self.statistic)?;
        }
        write!(f, ", {}", self.taken())?;
        if let Some(w) = self.detectable.filter(|_| self.verdict != Verdict::Reject) {
            write!(f, ", would detect a relative error of {}", percent(w))?;
        }
        let remarks = self.remarks.iter().map(String::as_str);
        self.other_places().chain(remarks).try_for_each(|finding| write!(f, "; {finding}"))
    }
}

/// Decides on the tests of one run, which together reject right samplers with probability `level` at most.
///
/// Tests that Holm's step-down rejects are repeated once with fresh random numbers by `repeat` (given the test's index), the
/// two p-values are combined by Fisher's method, and the step-down is done again. Nothing is selected: a repetition always
/// counts, and is left out only where no p-value of it could change the verdict. A test that fails an exact check stays rejected. Cancelled tests are inconclusive, and so are those with a p-value or
/// a detectable error that is NaN.
///
/// # Errors
/// Those of `repeat`.
pub fn decide<E>(
    outcomes: &mut [Outcome],
    level: f64,
    mut repeat: impl FnMut(usize) -> Result<Outcome, E>,
) -> Result<(), E> {
    let rejected = |outcomes: &[Outcome]| {
        let p: Vec<f64> = outcomes.iter().map(|o| o.p.unwrap_or(f64::NAN)).collect();
        holm(&p, level)
    };
    let strictest = sidak(level, outcomes.len());
    for (i, suspect) in rejected(outcomes).into_iter().enumerate() {
        if suspect && outcomes[i].violation.is_none() {
            let at_most = outcomes[i].p.map(|p| fisher(p, 1.0));
            if at_most.is_some_and(|p| p < strictest) {
                outcomes[i].p = at_most;
            } else {
                let second = repeat(i)?;
                outcomes[i].combine(second);
            }
        }
    }
    let rejected = rejected(outcomes);
    for (outcome, rejected) in outcomes.iter_mut().zip(rejected) {
        // The p-value beside a rejection is that of what rejects.
        outcome.p.take_if(|_| outcome.violation.is_some() && !rejected);
        // A test that rejects has taken enough samples.
        let rejected = rejected || outcome.violation.is_some();
        outcome.inconclusive_reason = if rejected { None } else { outcome.undecided() };
        outcome.verdict = if outcome.violation.is_some() || rejected && !outcome.interrupted {
            Verdict::Reject
        } else if outcome.interrupted || outcome.inconclusive_reason.is_some() {
            Verdict::Inconclusive
        } else {
            Verdict::Accept
        };
        if outcome.verdict != Verdict::Reject {
            (outcome.mistake, outcome.diagnosis) = (None, None);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_a_number_is_no_pass() {
        let right = Outcome { p: Some(0.5), detectable: Some(0.02), ..Outcome::open(100) };
        let mut all = [
            right.clone(),
            Outcome { p: Some(f64::NAN), ..right.clone() },
            Outcome { detectable: Some(f64::NAN), ..right.clone() },
            Outcome { p: Some(0.0), detectable: Some(f64::NAN), ..right },
        ];
        decide(&mut all, 0.01, |i| Ok::<_, ()>(Outcome { p: Some([f64::NAN, 0.0][i / 3]), ..Outcome::open(1) }))
            .unwrap();
        use Verdict::{Accept, Inconclusive, Reject};
        assert_eq!(all.each_ref().map(|outcome| outcome.verdict), [Accept, Inconclusive, Inconclusive, Reject]);
        assert_eq!(all[1].reason().as_deref(), Some("the p-value is not a number"));
    }

    #[test]
    fn a_repetition_is_left_out_only_where_it_cannot_change_the_verdict() {
        let with = |p: f64, samples: u64| Outcome { p: Some(p), detectable: Some(0.02), ..Outcome::open(samples) };
        let mut repeated = Vec::new();
        let mut all = [with(1e-5, 10), with(4e-3, 10), with(0.3, 10)];
        let repeat = |i| {
            repeated.push(i);
            Ok::<_, ()>(with(1.0, 20))
        };
        decide(&mut all, 0.01, repeat).unwrap();
        use Verdict::{Accept, Reject};
        assert_eq!(all.each_ref().map(|outcome| outcome.verdict), [Reject, Accept, Accept]);
        assert_eq!(repeated, [1], "1e-5 and the largest p-value of a repetition make 1.3e-4");
        assert_eq!((all[0].p, all[0].repeated), (Some(fisher(1e-5, 1.0)), false));
        assert_eq!((all[1].samples, all[1].repeated), (30, true));
    }
}
