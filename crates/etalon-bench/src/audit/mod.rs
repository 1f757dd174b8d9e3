//! The formulas of the two reports that are wrong, approximate or misprinted: what they print, the correction, the test that
//! detects the error, and what the error does to an image.

mod formulas;
mod map;
mod materials;

use crate::validation::{Case, run};
use etalon_core::error::Result;
use etalon_stats::{Outcome, Protocol, Verdict};
use serde::Serialize;
use std::cmp::Ordering;

/// Tests all errors in one run. The most severe come first: by their nature, and by the error of an image.
pub fn audit(protocol: &Protocol) -> Result<Vec<Erratum>> {
    let mut suspects = materials::metals()?;
    suspects.extend(formulas::suspects());
    suspects.extend([materials::glass(), map::pole_rows(), map::corners(), map::gaussian_numbers()?]);
    suspects.push(map::rows_without_sums());
    suspects.extend(formulas::misprints());
    let (mut errata, cases): (Vec<Erratum>, Vec<[Case; 2]>) = suspects.into_iter().unzip();
    let tests = run(&cases.into_iter().flatten().collect::<Vec<_>>(), protocol, &|_| ())?.tests;
    for (erratum, pair) in errata.iter_mut().zip(tests.chunks(2)) {
        let [printed, right] = pair else { break };
        erratum.verdict = printed.outcome.verdict;
        erratum.p = printed.outcome.p;
        erratum.samples = printed.outcome.samples;
        erratum.violation = printed.outcome.violation.clone();
        erratum.right_verdict = right.outcome.verdict;
        erratum.right_p = right.outcome.p;
    }
    let severity = |erratum: &Erratum| (erratum.nature, -erratum.error_in_picture.abs());
    errata.sort_by(|a, b| severity(a).partial_cmp(&severity(b)).unwrap_or(Ordering::Equal));
    Ok(errata)
}

/// What kind of error it is, the most severe first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Nature {
    /// A formula that the report or its course uses and that is wrong.
    #[default]
    Error,
    /// A formula that is meant to be approximate.
    Approximation,
    /// A slip of the text: the images, or words beside the formula, show that the program has it right.
    Misprint,
}

impl Nature {
    pub fn name(self) -> &'static str {
        match self {
            Self::Error => "error",
            Self::Approximation => "approximation",
            Self::Misprint => "misprint",
        }
    }
}

/// One error of a report. Field names are the CSV columns.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Erratum {
    /// What it is about, in a few words.
    pub title: &'static str,
    pub report: &'static str,
    pub nature: Nature,
    pub printed: &'static str,
    pub right: &'static str,
    /// What is tested, for the printed claim and for the corrected one.
    pub test: &'static str,
    /// Verdict on the printed claim, its p-value (none where an exact check decides), and its samples.
    pub verdict: Verdict,
    /// The p-value of that test.
    pub p: Option<f64>,
    pub samples: u64,
    /// The violation that an exact check finds in the printed claim.
    pub violation: Option<String>,
    /// Verdict on the corrected claim.
    pub right_verdict: Verdict,
    pub right_p: Option<f64>,
    /// Relative error that it causes (a misprint: that it would cause if taken at its word), and of what.
    pub error_in_picture: f64,
    /// What has this error.
    pub error_of: &'static str,
    /// Both formulas as curves; none of a misprint, which no program computes.
    #[serde(skip)]
    pub curves: Option<ErratumCurves>,
}

/// The printed formula beside the corrected one.
#[derive(Debug, Clone, Default)]
pub struct ErratumCurves {
    /// Label of the x axis.
    pub x: &'static str,
    /// Step of the ticks of the x axis.
    pub every: f64,
    /// Label of the y axis.
    pub y: &'static str,
    pub printed: Vec<[f64; 2]>,
    pub right: Vec<[f64; 2]>,
    /// Whether these are scattered points and not curves.
    pub scattered: bool,
}

/// An error before it is tested, and the tests of the printed claim and of the corrected one.
type Suspect = (Erratum, [Case; 2]);

/// The outcome of a deterministic check of `samples` samples, and what it found wrong.
fn exact(violation: Option<String>, samples: u64) -> Outcome {
    Outcome { violation, ..Outcome::open(samples) }
}

/// Index of refraction of the reports' glass.
const ETA: f64 = 1.45;
/// Relative difference of equal numbers by rounding.
const ROUNDING: f64 = 1e-9;

/// A test of a formula at all angles on both sides of glass; `wrong` is its error at a cosine and an η.
fn at_all_angles(name: &str, what: &'static str, wrong: impl Fn(f64, f64) -> f64 + Send + Sync + 'static) -> Case {
    const ANGLES: u32 = 9000;
    let cosines = || (0..ANGLES).map(|i| ((f64::from(i) + 0.5) * 90.0 / f64::from(ANGLES)).to_radians().cos());
    Case::new(format!("audit/{name}"), move |_: &Protocol, _| {
        let both = [ETA, 1.0 / ETA];
        let largest = both.iter().flat_map(|&eta| cosines().map(move |cos| (cos, eta)));
        let largest = largest.map(|(cos, eta)| wrong(cos, eta)).fold(0.0, f64::max);
        let violation = (largest > ROUNDING).then(|| format!("{what} {largest:.2}"));
        Ok(exact(violation, 2 * u64::from(ANGLES)))
    })
}

/// A function at equal steps from `from` to `to`, ends included.
fn curve(from: f64, to: f64, f: impl Fn(f64) -> f64) -> Vec<[f64; 2]> {
    const STEPS: u32 = 180;
    let at = |i: u32| from + (to - from) * f64::from(i) / f64::from(STEPS);
    (0..=STEPS).map(|i| [at(i), f(at(i))]).collect()
}

/// The mean over uniform light that meets a surface: 2 ∫ f cos θ d cos θ.
fn mean_by_cosine(f: impl Fn(f64) -> f64) -> f64 {
    const STEPS: u32 = 100_000;
    let step = 1.0 / f64::from(STEPS);
    let at = |i: u32| (f64::from(i) + 0.5) * step;
    (0..STEPS).map(|i| 2.0 * f(at(i)) * at(i) * step).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_stats::Verdict;

    #[test]
    fn what_is_printed_is_rejected_and_what_is_right_is_not() {
        for erratum in audit(&Protocol::default()).unwrap() {
            assert_eq!(erratum.verdict, Verdict::Reject, "{}", erratum.title);
            assert_eq!(erratum.right_verdict, Verdict::Accept, "{}", erratum.title);
            assert!(erratum.error_in_picture.abs() > 0.004, "{}: {}", erratum.title, erratum.error_in_picture);
        }
    }
}
