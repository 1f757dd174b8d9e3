//! Many tests at once: levels and p-values that account for their number, and the Kolmogorov–Smirnov test that numbers such as
//! p-values are uniform over \[0, 1\].

use crate::extremes::Extremes;

/// The level of each of `n` tests such that all accept with probability 1 − `level` if all should: 1 − (1 − level)^(1/n).
///
/// Source: Šidák, "Rectangular Confidence Regions for the Means of Multivariate Normal Distributions", 1967.
#[must_use]
pub fn sidak(level: f64, n: usize) -> f64 {
    -((-level).ln_1p() / n.max(1) as f64).exp_m1()
}

/// The level that the p-value of rank `rank` (from 0, ascending) among `tests` must meet under [`holm`] at `level`.
#[must_use]
pub fn holm_level(level: f64, tests: usize, rank: usize) -> f64 {
    sidak(level, tests.saturating_sub(rank))
}

/// Which of the tests with these p-values are rejected at `level` for all together, by Holm's step-down: the smallest
/// meets [`sidak`]'s level of n tests, the next that of n − 1, until one is not rejected. NaN counts as 1.
///
/// Source: Holm, "A Simple Sequentially Rejective Multiple Test Procedure", Scandinavian Journal of Statistics 6, 1979.
#[must_use]
pub fn holm(p: &[f64], level: f64) -> Vec<bool> {
    let mut order: Vec<usize> = (0..p.len()).filter(|&i| !p[i].is_nan()).collect();
    order.sort_by(|&a, &b| p[a].total_cmp(&p[b]));
    let mut rejected = vec![false; p.len()];
    for (rank, &i) in order.iter().enumerate() {
        if p[i] >= holm_level(level, p.len(), rank) {
            break;
        }
        rejected[i] = true;
    }
    rejected
}

/// The p-value of the smallest of `n` p-values: 1 − (1 − p)ⁿ.
#[must_use]
pub fn any_of(p: f64, n: usize) -> f64 {
    -(n as f64 * (-p).ln_1p()).exp_m1()
}

/// The p-value of independent tests of one hypothesis that share its level unequally, from pairs of p-values and weights
/// that sum to 1: 1 − ∏ (1 − wᵢt) with the smallest t = pᵢ/wᵢ. It is below a level as soon as one pᵢ is below wᵢ times the level.
///
/// Source: Genovese, Roeder & Wasserman, "False Discovery Control with p-Value Weighting", Biometrika 93(3), 2006, for the
/// weights.
#[must_use]
pub fn weighted(tests: &[(f64, f64)]) -> f64 {
    let t = tests.iter().map(|(p, weight)| p / weight).fold(f64::INFINITY, f64::at_most);
    -tests.iter().map(|(_, weight)| (-(weight * t).at_most(1.0)).ln_1p()).sum::<f64>().exp_m1()
}

/// The p-value of two independent tests of one hypothesis: P(U₁U₂ ≤ p₁p₂) = p₁p₂ (1 − ln p₁p₂).
///
/// Source: Fisher, "Statistical Methods for Research Workers", 1932, section 21.1.
#[must_use]
pub fn fisher(p1: f64, p2: f64) -> f64 {
    let product = p1 * p2;
    if product > 0.0 { (product * (1.0 - product.ln())).at_most(1.0) } else { 0.0 }
}

/// The outcome of a test for uniformity.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Uniformity {
    /// The largest difference between the share of values up to x and x.
    pub distance: f64,
    /// Probability of a distance at least this large if the values are independent and uniform.
    pub p: f64,
    /// The same of the largest excess of the share over x: small where values are too small, and only there. Of p-values
    /// these are the ones that make false alarms; larger ones are conservative.
    pub p_too_small: f64,
    /// The number of values.
    pub count: usize,
}

/// Tests whether `values` are independent and uniform over \[0, 1\].
///
/// The p-values are Kolmogorov's and Smirnov's limits with Stephens's correction for finite counts, precise to a few 10⁻³ from 5 values on.
/// Source: Stephens, "EDF Statistics for Goodness of Fit and Some Comparisons", JASA 69, 1974.
#[must_use]
pub fn uniformity(values: &[f64]) -> Uniformity {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len() as f64;
    let (mut excess, mut distance) = (0.0, 0.0);
    for (i, x) in sorted.iter().enumerate() {
        excess = f64::at_least(excess, (i + 1) as f64 / n - x);
        distance = f64::at_least(distance, x - i as f64 / n).at_least(excess);
    }
    let corrected = |distance: f64| distance * (n.sqrt() + 0.12 + 0.11 / n.sqrt());
    Uniformity {
        distance,
        p: tail(corrected(distance)),
        p_too_small: one_sided(corrected(excess)),
        count: sorted.len(),
    }
}

/// P(K⁺ ≥ x) of Smirnov's limit for differences of one sign, exp(−2x²).
fn one_sided(x: f64) -> f64 {
    (-2.0 * x * x).exp()
}

/// P(K ≥ x) of Kolmogorov's distribution, 2 Σ (−1)ʲ⁻¹ exp(−2 j² x²).
fn tail(x: f64) -> f64 {
    // Below this the series alternates without end, and the tail is 1 to 10⁻⁹.
    if x < 0.27 {
        return 1.0;
    }
    let term = |j: i32| {
        let j = f64::from(j);
        2.0 * (-2.0 * j * j * x * x).exp()
    };
    let sum: f64 = (1..=40).map(|j| if j % 2 == 1 { term(j) } else { -term(j) }).sum();
    sum.within(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_keep_the_level_of_the_whole() {
        for n in [1, 2, 49, 100_000] {
            let level = sidak(0.01, n);
            assert!(((1.0 - level).powi(n as i32) - 0.99).abs() < 1e-9);
        }
    }

    #[test]
    fn the_second_test_is_judged_among_those_left() {
        let level = 0.05;
        // Between Šidák's levels for three and for two tests.
        let p = 0.5 * (sidak(level, 3) + sidak(level, 2));
        assert_eq!(holm(&[0.001, p, 0.9], level), [true, true, false]);
        assert_eq!(holm(&[0.02, p, 0.9], level), [false, false, false]);
        assert_eq!(holm(&[f64::NAN, 0.0], level), [false, true]);
        assert_eq!(holm(&[], level), [false; 0]);
    }

    #[test]
    fn weights_share_the_level() {
        for p in [1e-30, 1e-5, 0.3] {
            assert!((weighted(&[(p, 1.0)]) - p).abs() < 1e-12 * p);
            assert!((weighted(&[(p, 0.25); 4]) - any_of(p, 4)).abs() < 1e-12);
        }
        // At half the level of two tests, the first alone rejects.
        let p = weighted(&[(0.004_999, 0.5), (0.9, 0.25), (0.9, 0.25)]);
        assert!(p < 0.01 && p > 0.0099, "{p}");
        assert_eq!(weighted(&[(1.0, 0.5), (1.0, 0.5)]), 1.0);
    }

    #[test]
    fn two_p_values_make_one() {
        // Against the chi-square distribution with four degrees of freedom.
        for (a, b) in [(0.3, 0.01), (1.0, 1.0), (1e-200, 1e-5)] {
            let expected = crate::power::chi_square_tail(4.0, -2.0 * (f64::ln(a) + f64::ln(b)));
            assert!((fisher(a, b) - expected).abs() <= 1e-9 * expected, "{a} {b}");
        }
        assert_eq!(fisher(0.0, 0.5), 0.0);
    }

    #[test]
    fn known_quantiles() {
        // Tables of Kolmogorov's distribution: K = 1.358 at 5 %, 1.628 at 1 %.
        assert!((tail(1.358) - 0.05).abs() < 2e-4 && (tail(1.628) - 0.01).abs() < 1e-4);
    }

    #[test]
    fn small_values_are_told_from_large_ones() {
        let uniform: Vec<f64> = (0..100).map(|i| (f64::from(i) + 0.5) / 100.0).collect();
        let [small, large] = [2.0, 0.5].map(|power| uniform.iter().map(|x| x.powf(power)).collect::<Vec<_>>());
        let [small, large] = [uniformity(&small), uniformity(&large)];
        assert!(small.p < 1e-4 && small.p_too_small < 1e-4 && large.p < 1e-4 && large.p_too_small > 0.9);
        // Tables of the one-sided statistic: 1.224 at 5 %, 1.517 at 1 %.
        assert!((one_sided(1.224) - 0.05).abs() < 1e-4 && (one_sided(1.517) - 0.01).abs() < 1e-4);
    }

    #[test]
    fn uniform_and_skewed_numbers() {
        let uniform: Vec<f64> = (0..100).map(|i| (f64::from(i) + 0.5) / 100.0).collect();
        assert!((uniformity(&uniform).distance - 0.005).abs() < 1e-12 && uniformity(&uniform).p > 0.999);
        let skewed: Vec<f64> = uniform.iter().map(|x| x * x).collect();
        assert!((uniformity(&skewed).distance - 0.25).abs() < 0.01 && uniformity(&skewed).p < 1e-4);
    }
}
