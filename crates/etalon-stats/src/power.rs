//! Pearson's chi-square test of counts against expected counts, and what it can detect: its power against pdfs that are a
//! little wrong.
//!
//! If the true cell probabilities are qᵢ and the tested ones pᵢ, the statistic of N samples follows the noncentral
//! chi-square distribution with λ = N w², w² = Σ (qᵢ − pᵢ)²/pᵢ: w is the root mean square of the pdf's relative error
//! over the cells. Source: Cohen, "Statistical Power Analysis for the Behavioral Sciences", 1988, chapter 7.

use crate::extremes::Extremes;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// The outcome of a test.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct ChiSquare {
    /// Σ (O − E)² / E over the pooled cells.
    pub statistic: f64,
    /// Pooled cells minus one.
    pub dof: usize,
    /// Probability of a statistic at least this large if the counts follow the expectation.
    pub p: f64,
}

/// Fewest expected counts of a pooled cell.
pub const FEWEST: f64 = 5.0;

/// Tests `observed` against `expected` counts, cell by cell; the totals should agree.
///
/// Cells are pooled in ascending order of expectation until each group expects at least 5; what is left over joins the
/// last group, so nothing is dropped. A count where nothing is expected is impossible: p = 0. `None` when fewer than
/// two groups remain, which means too few samples for any verdict, or when an expectation is not finite.
///
/// The p-value is the survival function itself, not 1 − cdf, which would be 0 below 10⁻¹⁶.
#[must_use]
pub fn chi_square(observed: &[u64], expected: &[f64]) -> Option<ChiSquare> {
    chi_square_of_uncertain(observed, expected, &vec![0.0; expected.len()])
}

/// [`chi_square`] where the expected counts have independent errors of these variances: V adds to the variance E of each count.
pub(crate) fn chi_square_of_uncertain(observed: &[u64], expected: &[f64], variances: &[f64]) -> Option<ChiSquare> {
    if !expected.iter().all(|e| e.is_finite()) {
        return None;
    }
    let cell = |((e, o), v): ((&f64, &u64), &f64)| [*e, *o as f64, *v];
    let mut cells: Vec<[f64; 3]> = expected.iter().zip(observed).zip(variances).map(cell).collect();
    cells.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let impossible = cells.iter().any(|&[e, o, _]| e <= 0.0 && o > 0.0);
    let plus = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|i| a[i] + b[i]);
    let mut groups: Vec<[f64; 3]> = Vec::new();
    let mut open = [0.0; 3];
    for cell in cells.into_iter().filter(|cell| cell[0] > 0.0) {
        open = plus(open, cell);
        if open[0] >= FEWEST {
            groups.push(std::mem::take(&mut open));
        }
    }
    if let Some(last) = groups.last_mut() {
        *last = plus(*last, open);
    }
    let dof = groups.len().checked_sub(1).filter(|dof| *dof > 0)?;
    let statistic: f64 = groups.iter().map(|[e, o, v]| (o - e) * (o - e) / (e + v)).sum();
    let p = if impossible { 0.0 } else { ChiSquared::new(dof as f64).ok()?.sf(statistic) };
    Some(ChiSquare { statistic, dof, p })
}

/// The probability with which an error of the stated size is detected.
pub const POWER: f64 = 0.9;

/// P(X ≥ x) for X chi-square with `dof` degrees of freedom, precise where it is tiny; NaN for `dof` = 0.
#[must_use]
pub fn chi_square_tail(dof: f64, x: f64) -> f64 {
    ChiSquared::new(dof).map_or(f64::NAN, |distribution| distribution.sf(x))
}

/// P(X ≤ x) for X chi-square with `dof` degrees of freedom, precise where it is tiny; NaN for `dof` = 0.
#[must_use]
pub fn chi_square_below(dof: f64, x: f64) -> f64 {
    ChiSquared::new(dof).map_or(f64::NAN, |distribution| distribution.cdf(x))
}

/// P(X ≥ x) for X noncentral chi-square: the mean of the central tails with dof + 2j over j ~ Poisson(λ/2).
///
/// Each tail is the one before and the term (x/2)ᵃ e^(−x/2)/Γ(a + 1), a = dof/2 + j: all is positive, so that nothing cancels.
#[must_use]
pub fn noncentral_tail(dof: f64, lambda: f64, x: f64) -> f64 {
    let mean = 0.5 * lambda;
    // Beyond ten standard deviations of j nothing is left; the first ones cannot be skipped when the mean is small.
    let spread = 10.0 * mean.sqrt() + 10.0;
    let (first, last) = ((mean - spread).at_least(0.0).floor(), (mean + spread).ceil());
    let mut tail = chi_square_tail(dof + 2.0 * first, x);
    if mean == 0.0 {
        return tail;
    }
    // yᵃ e^(−y)/Γ(a + 1)
    let term = |y: f64, ln: f64, a: f64| if y > 0.0 { (a * ln - y - libm::lgamma(a + 1.0)).exp() } else { 0.0 };
    let (half, ln_half, ln_mean) = (0.5 * x, (0.5 * x).ln(), mean.ln());
    let mut j = first;
    let mut sum = 0.0;
    while j <= last {
        sum += term(mean, ln_mean, j) * tail;
        tail += term(half, ln_half, 0.5 * dof + j);
        j += 1.0;
    }
    sum
}

/// Where an increasing function passes `target`, between 0 and the first power of two beyond it.
fn passes(target: f64, f: impl Fn(f64) -> f64) -> f64 {
    let mut to = 1.0;
    while f(to) < target && to < 1e12 {
        to *= 2.0;
    }
    let mut from = 0.0;
    for _ in 0..60 {
        let middle = 0.5 * (from + to);
        if f(middle) < target { from = middle } else { to = middle }
    }
    0.5 * (from + to)
}

/// The noncentrality λ that a test at `level` detects with probability [`POWER`].
#[must_use]
pub fn noncentrality(dof: usize, level: f64) -> f64 {
    let dof = dof as f64;
    let critical = passes(-level, |x| -chi_square_tail(dof, x));
    passes(POWER, |lambda| noncentral_tail(dof, lambda, critical))
}

/// [`noncentrality`] for many degrees of freedom and fractions of them, to a few percent and without a sum: the noncentral
/// chi-square distribution is taken for that of a multiple of a central one with the same mean and variance.
///
/// Source: Patnaik, "The Non-Central χ²- and F-Distributions and their Applications", Biometrika 36, 1949.
#[must_use]
pub fn noncentrality_near(dof: f64, level: f64) -> f64 {
    let critical = passes(-level, |x| -chi_square_tail(dof, x));
    passes(POWER, |lambda| {
        let (mean, spread) = (dof + lambda, dof + 2.0 * lambda);
        chi_square_tail(mean * mean / spread, critical * mean / spread)
    })
}

/// The smallest relative error w of the pdf that `samples` samples detect with probability [`POWER`].
#[must_use]
pub fn detectable(dof: usize, level: f64, samples: u64) -> f64 {
    (noncentrality(dof, level) / samples as f64).sqrt()
}

/// The number of samples that detect a relative error `w` of the pdf with probability [`POWER`].
#[must_use]
pub fn samples_for(dof: usize, level: f64, w: f64) -> u64 {
    (noncentrality(dof, level) / (w * w)).ceil() as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_textbook_die() {
        // 60 throws: Σ = (5² + 2² + 1² + 2² + 0 + 10²)/10 = 13.4 with 5 degrees of freedom.
        let test = chi_square(&[5, 8, 9, 8, 10, 20], &[10.0; 6]).unwrap();
        assert!((test.statistic - 13.4).abs() < 1e-12);
        assert_eq!(test.dof, 5);
        assert!((test.p - 0.019_905).abs() < 1e-5, "{}", test.p);
    }

    #[test]
    fn nothing_is_dropped_by_pooling() {
        let test = chi_square(&[1, 2, 0, 50, 47], &[1.0, 1.0, 1.0, 48.0, 49.0]).unwrap();
        // The three small cells stay below 5 together, so they join the cell of 48.
        assert_eq!(test.dof, 1);
        assert!((test.statistic - (4.0 / 51.0 + 4.0 / 49.0)).abs() < 1e-12);
    }

    #[test]
    fn impossible_counts_and_too_few_samples() {
        assert_eq!(chi_square(&[1, 50, 49], &[0.0, 50.0, 50.0]).unwrap().p, 0.0);
        assert_eq!(chi_square(&[2, 2], &[2.0, 2.0]), None, "no verdict, rather than a pass");
        assert_eq!(chi_square(&[], &[]), None);
        for wrong in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert_eq!(chi_square(&[50, 50, 7], &[50.0, 50.0, wrong]), None);
        }
    }

    #[test]
    fn tiny_p_values_are_not_zero() {
        let test = chi_square(&[900, 100], &[500.0, 500.0]).unwrap();
        assert!(test.p > 0.0 && test.p < 1e-100);
    }

    #[test]
    fn tails_of_the_noncentral_distribution() {
        // For 2 degrees of freedom the tail is Marcum's Q₁(√λ, √x); Q₁(1, 2) = 0.269012...
        assert!((noncentral_tail(2.0, 1.0, 4.0) - 0.269_012_060_3).abs() < 1e-9, "{}", noncentral_tail(2.0, 1.0, 4.0));
        assert!((noncentral_tail(7.0, 0.0, 9.0) - chi_square_tail(7.0, 9.0)).abs() < 1e-15);
        // One degree: P(|Z + δ| ≥ √x) from the normal distribution.
        let upper = |z: f64| 0.5 * libm::erfc(z / 2f64.sqrt());
        let exact = upper(3.0 - 2.5) + upper(3.0 + 2.5);
        assert!((noncentral_tail(1.0, 6.25, 9.0) - exact).abs() < 1e-9);
        // The sum of tails that are each computed by themselves.
        for (dof, lambda, x) in [(199.0, 60.0, 250.0), (1.0, 40.0, 1e-3), (3.0, 5e4, 4.9e4), (20.0, 1e-3, 1400.0)] {
            let weight = |j: f64| (j * f64::ln(0.5 * lambda) - 0.5 * lambda - libm::lgamma(j + 1.0)).exp();
            let by_itself = |j: u32| weight(f64::from(j)) * chi_square_tail(dof + 2.0 * f64::from(j), x);
            let exact: f64 = (0..30_000).map(by_itself).sum();
            let found = noncentral_tail(dof, lambda, x);
            assert!((found / exact - 1.0).abs() < 1e-9, "{dof} {lambda} {x}: {found} {exact}");
        }
    }

    #[test]
    fn both_tails_are_precise() {
        // Two degrees: e^(−x/2) and 1 − e^(−x/2).
        assert!((chi_square_tail(2.0, 200.0) / (-100f64).exp() - 1.0).abs() < 1e-12);
        assert!((chi_square_below(2.0, 2e-20) / 1e-20 - 1.0).abs() < 1e-12);
        // Sixteen degrees near 0: (x/2)⁸/8!.
        assert!((chi_square_below(16.0, 2e-6) / (1e-48 / 40_320.0) - 1.0).abs() < 1e-5);
        assert!(chi_square_tail(0.0, 1.0).is_nan() && chi_square_below(0.0, 1.0).is_nan());
    }

    #[test]
    fn the_detectable_error_shrinks_with_the_samples() {
        // Figures computed independently, at level 1 %.
        for (dof, samples, expected) in [(199, 100_000, 0.029), (199, 1_000_000, 0.0091), (20401, 1_000_000, 0.027)] {
            let w = detectable(dof, 0.01, samples);
            assert!((w / expected - 1.0).abs() < 0.02, "{dof} {samples}: {w}");
        }
        for (dof, level) in [(1, 1e-4), (20, 1e-6), (199, 0.01), (5000, 1e-3)] {
            let [exact, near] = [noncentrality(dof, level), noncentrality_near(dof as f64, level)];
            assert!((near / exact - 1.0).abs() < 0.05, "{dof}: {near} {exact}");
        }
        let n = samples_for(199, 1e-4, 0.01);
        assert!((detectable(199, 1e-4, n) - 0.01).abs() < 1e-6);
    }
}
