//! Assertions for `cargo test`, and the text that says where samples and pdf disagree.

use crate::density::{Density, Mass};
use crate::diagnosis::table;
use crate::domain::Domain;
use crate::examine::{Protocol, validate};
use crate::outcome::Outcome;
use crate::power::POWER;
use crate::sampler::Sampler;
use crate::text::{count, p_value};
use std::fmt::Write;

/// Panics unless the samples of `sampler` follow `density` over `domain`, by the default [`Protocol`].
///
/// The message says what an exact check found wrong, or in which regions of the domain the counts differ most from what the
/// pdf predicts; the size of error that the test detects; and the seed. See [`explain`].
///
/// # Panics
/// If the verdict is not [`Verdict::Accept`](crate::Verdict::Accept), or the test could not be done.
///
/// ```
/// use etalon_stats::prelude::*;
///
/// let triangular = sampler(1, |u| Some(Sample::new(u[0].sqrt())));
/// assert_samples_follow_pdf(&Line::UNIT, &triangular, &density(|x: f64| 2.0 * x));
/// ```
#[track_caller]
pub fn assert_samples_follow_pdf(domain: &dyn Domain, sampler: &dyn Sampler, density: &dyn Density) {
    assert_samples_follow_pdf_by(&Protocol::default(), domain, sampler, density);
}

/// [`assert_samples_follow_pdf`] by a protocol of one's own: another seed, power, level, or number of tests that share the
/// level.
///
/// # Panics
/// As [`assert_samples_follow_pdf`].
#[track_caller]
pub fn assert_samples_follow_pdf_by(
    protocol: &Protocol,
    domain: &dyn Domain,
    sampler: &dyn Sampler,
    density: &dyn Density,
) {
    match validate(domain, sampler, density, protocol) {
        Ok(outcome) if outcome.is_accepted() => {}
        Ok(outcome) => {
            let declared = match density.mass() {
                Mass::Exactly(mass) => format!("declared: {mass}"),
                Mass::AtMostOne => "declared: at most 1".to_owned(),
                Mass::Unknown => "not declared".to_owned(),
            };
            // A wrong mass is the violation already.
            let mass = outcome.mass.filter(|_| outcome.violation.is_none());
            let mass = mass.map_or_else(String::new, |mass| format!("integral of the pdf: {mass}; {declared}\n"));
            panic!("samples do not follow the pdf\n{}{mass}", explain(domain, &outcome, protocol));
        }
        Err(error) => panic!("the samples could not be tested: {error}"),
    }
}

/// What a test found, over several lines: verdict and statistic; the violation of an exact check or the reason for an
/// inconclusive verdict; unless it accepted, the regions in which observed and expected counts differ most; the detectable
/// error, and that of ripples finer than the cells; remarks; the seed.
#[must_use]
pub fn explain(domain: &dyn Domain, outcome: &Outcome, protocol: &Protocol) -> String {
    // Writing to a string cannot fail.
    let mut text = format!("verdict: {}", outcome.verdict);
    if let Some(p) = outcome.continuous_p() {
        let _ = write!(
            text,
            ", {}, chi-square = {:.1} with {}",
            p_value(p),
            outcome.statistic,
            count(outcome.dof, "degree of freedom", "degrees of freedom")
        );
    }
    let _ = writeln!(text, ", {}", count(outcome.samples, "sample", "samples"));
    if let Some(remark) = outcome.remark() {
        let _ = writeln!(text, "reason: {remark}");
    }
    if let Some(diagnosis) = &outcome.diagnosis {
        let _ = writeln!(text, "{diagnosis}");
    }
    if let Some(counts) = outcome.counts.as_ref().filter(|_| !outcome.is_accepted()) {
        text += &table(domain, counts);
    }
    if let Some(error) = outcome.detectable {
        let (error, power) = (100.0 * error, 100.0 * POWER);
        let _ = writeln!(
            text,
            "power: relative errors of the pdf of {error:.2} % (RMS over the cells) are detected with {power:.0} % probability"
        );
    }
    if let Some(finer) = outcome.finer() {
        let _ = writeln!(text, "ripples: {finer}");
    }
    for remark in &outcome.remarks {
        let _ = writeln!(text, "remark: {remark}");
    }
    let _ = writeln!(text, "seed: {} (the same seed gives the same samples)", protocol.seed);
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::density::density;
    use crate::domain::{Directions, Discrete, Pole};
    use crate::sampler::{Sample, sampler};
    use crate::testing::uniform_hemisphere;
    use std::f64::consts::{PI, TAU};

    fn message(domain: &dyn Domain, sampler: &dyn Sampler, density: &dyn Density) -> String {
        let protocol = Protocol { seed: 7, ..Protocol::default() };
        explain(domain, &validate(domain, sampler, density, &protocol).unwrap(), &protocol)
    }

    #[test]
    fn the_message_says_where_samples_and_pdf_disagree() {
        // Uniform samples said to be cosine-weighted: too many at the horizon, too few at the pole.
        let half = Directions::hemisphere(Pole::Z);
        let uniform = sampler(2, |u| Some(Sample::new(uniform_hemisphere(u))));
        let text = message(&half, &uniform, &density(|w: [f64; 3]| w[2] / PI));
        let worst = text.lines().find(|line| line.trim_start().starts_with("theta")).unwrap();
        assert!(worst.contains("..90.00°") && worst.contains("+9"), "{text}");
        assert!(text.starts_with("verdict: reject, p ") && text.contains("seed: 7"), "{text}");
        assert!(text.contains("errors of the pdf of 2.0"), "{text}");
        let accepted = message(&half, &uniform, &density(|_: [f64; 3]| 1.0 / TAU));
        assert!(accepted.starts_with("verdict: accept") && !accepted.contains("region"), "{accepted}");
        // An error in one spot, at phi from 77° to 103°, is blamed on the cells around it and not on their whole row.
        let spot = |w: [f64; 3]| w[2] > 0.5 && w[2] < 0.6 && w[0].abs() < 0.2 && w[1] > 0.0;
        let holey = sampler(2, |u| Some(uniform_hemisphere(u)).filter(|w| !spot(*w)).map(Sample::new));
        let text = message(&half, &holey, &density(|_: [f64; 3]| 1.0 / TAU));
        let worst: Vec<&str> = text.lines().filter(|line| line.trim_start().starts_with("theta")).collect();
        assert!(worst[0].contains("phi 72.00°..108.00°"), "{text}");
    }

    #[test]
    fn outcomes_atoms_and_missing_samples_are_named() {
        let die = sampler(1, |u| Some(Sample::new((u[0] * 6.0) as usize)));
        let loaded = density(|face: usize| if face == 5 { 0.25 } else { 0.15 });
        assert!(message(&Discrete { outcomes: 6 }, &die, &loaded).contains("  outcome 5 "));
        let lazy = sampler(2, |u| (u[0] > 0.01).then(|| Sample::new(uniform_hemisphere(u))));
        let text = message(&Directions::hemisphere(Pole::Z), &lazy, &density(|_: [f64; 3]| 1.0 / TAU));
        assert!(text.contains("  no sample "), "{text}");
    }

    #[test]
    #[should_panic(expected = "reason: the pdf integrates to 1.01")]
    fn a_wrong_mass_fails_the_assertion() {
        let uniform = sampler(2, |u| Some(Sample::new(uniform_hemisphere(u))));
        assert_samples_follow_pdf(&Directions::hemisphere(Pole::Z), &uniform, &density(|_: [f64; 3]| 1.01 / TAU));
    }
}
