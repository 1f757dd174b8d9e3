//! The formulas of the two reports that are wrong, approximate or misprinted: what they print, the correction, the test that
//! detects the error, and what the error does to an image.

mod erratum;
mod formulas;
mod map;
mod materials;
mod misprints;

pub use erratum::{Erratum, ErratumCurves, Nature};

use super::validation::{Case, run};
use etalon_core::error::Result;
use etalon_stats::Protocol;
use std::cmp::Ordering;

/// Tests all errors in one run. The most severe come first: by their nature, and by the error of an image.
pub fn audit(protocol: &Protocol) -> Result<Vec<Erratum>> {
    let mut suspects = materials::metals()?;
    suspects.extend(formulas::suspects());
    suspects.extend([materials::glass(), map::pole_rows(), map::corners(), map::gaussian_numbers()?]);
    suspects.push(map::rows_without_sums());
    suspects.extend(misprints::suspects());
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
