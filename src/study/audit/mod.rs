//! The errors of the two reports: what they print, the correction, the test that detects the error, and what the error does
//! to an image.

mod glass;
mod lamp;
mod map;
mod metal;

use super::validation::{Case, run};
use crate::error::Result;
use etalon_stats::{Outcome, Protocol, Verdict};
use serde::Serialize;

/// One error of a report. Field names are the CSV columns.
#[derive(Debug, Clone, Serialize)]
pub struct Erratum {
    /// What it is about, in a few words.
    pub title: &'static str,
    /// Which report.
    pub report: &'static str,
    /// As printed.
    pub printed: &'static str,
    /// Corrected.
    pub right: &'static str,
    /// What is tested, for the printed claim and for the corrected one.
    pub test: &'static str,
    /// Verdict on the printed claim, its p-value (none where an exact check decides), and its samples.
    pub verdict: Verdict,
    /// The p-value of that test.
    pub p: Option<f64>,
    /// The samples of that test.
    pub samples: u64,
    /// What an exact check finds wrong with the printed claim.
    pub violation: Option<String>,
    /// Verdict on the corrected claim.
    pub right_verdict: Verdict,
    /// Its p-value.
    pub right_p: Option<f64>,
    /// Relative error that it causes, and of what.
    pub error_in_picture: f64,
    /// What has this error.
    pub error_of: &'static str,
    /// Both formulas as curves.
    #[serde(skip)]
    pub curves: Curves,
}

/// What a table without rows takes its header from.
impl Default for Erratum {
    fn default() -> Self {
        Self {
            title: "",
            report: "",
            printed: "",
            right: "",
            test: "",
            verdict: Verdict::Inconclusive,
            p: None,
            samples: 0,
            violation: None,
            right_verdict: Verdict::Inconclusive,
            right_p: None,
            error_in_picture: 0.0,
            error_of: "",
            curves: Curves::default(),
        }
    }
}

/// The printed formula beside the corrected one.
#[derive(Debug, Clone, Default)]
pub struct Curves {
    /// Labels of the axes, and the step of the ticks of the first.
    pub x: &'static str,
    /// Step of the ticks of the x axis.
    pub every: f64,
    /// Label of the y axis.
    pub y: &'static str,
    /// As printed.
    pub printed: Vec<[f64; 2]>,
    /// Corrected.
    pub right: Vec<[f64; 2]>,
    /// Whether these are scattered points and not curves.
    pub scattered: bool,
}

/// An error before it is tested.
struct Suspect {
    title: &'static str,
    report: &'static str,
    printed: &'static str,
    right: &'static str,
    test: &'static str,
    /// The test of the printed claim, then that of the corrected one.
    cases: Vec<Case>,
    error_in_picture: f64,
    error_of: &'static str,
    curves: Curves,
}

/// Tests all of them in one run.
pub fn audit(protocol: &Protocol) -> Result<Vec<Erratum>> {
    let mut suspects = metal::suspects()?;
    suspects.extend([glass::suspect(), map::pole_rows(), map::corners(), map::gaussian_numbers()?, lamp::suspect()]);
    let cases: Vec<Case> = suspects.iter_mut().flat_map(|suspect| suspect.cases.drain(..)).collect();
    let mut outcomes = run(&cases, protocol, &|_| ())?.tests.into_iter().map(|test| test.outcome);
    let mut errata = Vec::with_capacity(suspects.len());
    for suspect in suspects {
        let Suspect { title, report, printed, right, test, error_in_picture, error_of, curves, .. } = suspect;
        let (Some(outcome), Some(sound)) = (outcomes.next(), outcomes.next()) else { break };
        errata.push(Erratum {
            title,
            report,
            printed,
            right,
            test,
            verdict: outcome.verdict,
            p: outcome.p,
            samples: outcome.samples,
            violation: outcome.violation,
            right_verdict: sound.verdict,
            right_p: sound.p,
            error_in_picture,
            error_of,
            curves,
        });
    }
    Ok(errata)
}

/// The outcome of a deterministic check of `samples` samples, and what it found wrong.
fn exact(violation: Option<String>, samples: u64) -> Outcome {
    Outcome { violation, ..Outcome::open(samples) }
}

/// A function at equal steps from `from` to `to`, ends included.
fn curve(from: f64, to: f64, f: impl Fn(f64) -> f64) -> Vec<[f64; 2]> {
    const STEPS: u32 = 180;
    let at = |i: u32| from + (to - from) * f64::from(i) / f64::from(STEPS);
    (0..=STEPS).map(|i| [at(i), f(at(i))]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_printed_is_rejected_and_what_is_right_is_not() {
        for erratum in audit(&Protocol::default()).unwrap() {
            assert_eq!(erratum.verdict, Verdict::Reject, "{}", erratum.title);
            assert_eq!(erratum.right_verdict, Verdict::Accept, "{}", erratum.title);
            assert!(erratum.error_in_picture.abs() > 0.005, "{}: {}", erratum.title, erratum.error_in_picture);
        }
    }
}
