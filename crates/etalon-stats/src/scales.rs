//! The test of structure finer than the cells: counts in the halves of parts of the domain, scale by scale.
//!
//! Let a part with n samples be halved, and let q be the expected share of its first half. Given n, the count O of this
//! half is binomial, and z = (O − nq)/√(nq(1 − q)) has E z² = 1 and Var z² = 2 + (1 − 6q(1 − q))/(nq(1 − q)), exactly.
//! Halves of different parts, and those of different scales, are independent: each scale has a test of its own, T = Σ z²,
//! whose mean M and variance V are known. Its distribution is taken for that of V/2M · χ² with 2M²/V degrees of freedom.
//!
//! If the relative error of the pdf is a ripple of root mean square w with the period 1/f, then parts of width 2h add
//! λ = N w² r² with r = sin²(πfh)/(πfh) to the mean of T. For periods of 2h to 4h, r is at least 2/π: one of the scales, each
//! twice as fine as the one before, finds a ripple of w = π/2 · √(λ/N) with the power of λ.
//! Source of the sums per scale: Donoho, Johnstone, Kerkyacharian & Picard, "Density estimation by wavelet thresholding",
//! Annals of Statistics 24(2), 1996 (Haar coefficients of a histogram).

use crate::cubature::{LATTICES, Shares};
use crate::domain::Domain;
use crate::extremes::Extremes;
use crate::grid::{Cell, Parts, Subdivision};
use crate::multiple::any_of;
use crate::outcome::Finer;
use crate::power::{FEWEST, chi_square_below, chi_square_tail, noncentrality_near};
use statrs::distribution::{Binomial, DiscreteCDF};
use std::f64::consts::FRAC_PI_2;

/// How far errors of the expected shares may move the mean of a statistic, in its standard deviations.
const SHIFT: f64 = 0.05;
/// The share of all samples that must lie in tested parts for a scale to state what it detects.
const MOST: f64 = 0.5;

/// Standard deviations of one pair of halves, among thousands, that chance does not explain.
const CERTAIN: f64 = 6.0;

/// Parts so few that a pair of them is no place.
const COARSE: usize = 4;

/// What the test of one scale found.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Scale {
    /// What is halved: an axis of the chart, or "cells"; also "ends of the axes" and "order of the samples".
    pub of: String,
    /// The number of parts.
    pub parts: usize,
    /// The statistic.
    pub statistic: f64,
    /// Its expected value if the sampler is right.
    pub dof: f64,
    /// Probability of a statistic at least this large if the sampler is right.
    pub p: f64,
    /// The relative error of the pdf (root mean square) of a ripple as wide as two to four parts that is detected with 90 %
    /// probability.
    pub detectable: Option<f64>,
    /// What was found, in words.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) words: String,
    /// The parts around the worst place, of scales of an axis.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) finer: Option<Finer>,
}

/// The chi-square test of one scale: Σ z² over its pairs of halves.
#[derive(Debug, Clone, Default)]
pub struct ScaleTest {
    pub of: String,
    pub parts: usize,
    sum: f64,
    mean: f64,
    variance: f64,
    /// Samples in the parts that are halved.
    counted: f64,
    /// What errors of the expected shares add to the mean.
    shift: f64,
    /// The largest z² and its pair of halves.
    worst: (f64, usize),
    /// Where this pair is, in words.
    place: String,
    /// The parts around it.
    finer: Option<Finer>,
}

impl ScaleTest {
    /// Adds a pair of halves with these counts, expected shares and errors of these: bounds, or where `are_independent` standard errors,
    /// which add to the variance.
    fn add(&mut self, pair: usize, observed: [u64; 2], expected: [f64; 2], errors: [f64; 2], are_independent: bool) {
        let (n, both) = ((observed[0] + observed[1]) as f64, expected[0] + expected[1]);
        let q = expected[0] / both;
        if is_sparse(n, q) {
            return;
        }
        let variance = n * q * (1.0 - q);
        let error =
            if are_independent { (q * errors[1]).hypot((1.0 - q) * errors[0]) } else { errors[0].at_least(errors[1]) };
        let share = (n * error / both).powi(2) / variance;
        let noise = if are_independent { share } else { 0.0 };
        let z2 = (observed[0] as f64 - n * q).powi(2) / (variance * (1.0 + noise));
        self.sum += z2;
        if z2 > self.worst.0 {
            self.worst = (z2, pair);
        }
        // Variances from few lattices are uncertain themselves, which 1/(1 + noise) adds to the mean of z².
        self.mean += 1.0 + 2.0 / (LATTICES + 1) as f64 * (noise / (1.0 + noise)).powi(2);
        self.variance += 2.0 + (1.0 - 6.0 * q * (1.0 - q)) / variance;
        self.counted += n;
        self.shift += share - noise;
    }

    fn plus(self, other: &Self) -> Self {
        Self {
            sum: self.sum + other.sum,
            mean: self.mean + other.mean,
            variance: self.variance + other.variance,
            counted: self.counted.at_least(other.counted),
            shift: self.shift + other.shift,
            worst: if other.worst.0 > self.worst.0 { other.worst } else { self.worst },
            ..self
        }
    }

    /// The statistic and the degrees of freedom of the chi-square distribution that it is compared with.
    fn scaled(&self) -> [f64; 2] {
        let scale = 2.0 * self.mean / self.variance;
        [self.sum * scale, self.mean * scale]
    }

    /// Whether there is anything to test, with expected shares that are precise enough; `found` is the noncentrality of what
    /// is known of their errors besides.
    fn is_testable(&self, found: f64) -> bool {
        self.mean > 0.0 && self.shift + found <= SHIFT * self.variance.sqrt()
    }

    /// Says where the worst pair is, if chance does not explain it, by the words for a pair.
    fn locate(&mut self, words: impl FnOnce(usize) -> String) {
        let (z2, pair) = self.worst;
        if z2 > CERTAIN * CERTAIN && self.parts > COARSE {
            self.place = format!(", most {}", words(pair));
        }
    }

    /// Probability of a statistic at most this large.
    pub fn below(&self) -> f64 {
        let [statistic, dof] = self.scaled();
        chi_square_below(dof, statistic)
    }

    /// The result; with the error that is detected by a test at `level` of `samples` samples, if there is one.
    pub fn at_level(&self, level: Option<f64>, samples: u64) -> Scale {
        let [statistic, dof] = self.scaled();
        let n = samples as f64;
        let detectable = level
            .filter(|_| self.counted >= MOST * n)
            .map(|level| FRAC_PI_2 * (noncentrality_near(dof, level) / self.counted).sqrt());
        let error = ((self.sum - self.mean).at_least(0.0) / self.counted).sqrt();
        let words = format!(
            "{} parts of {}: neighbours differ by {:.2} % (RMS){}",
            self.parts,
            self.of,
            200.0 * error,
            self.place
        );
        Scale {
            of: self.of.clone(),
            parts: self.parts,
            statistic: self.sum,
            dof: self.mean,
            p: chi_square_tail(dof, statistic),
            detectable,
            words,
            finer: self.finer.clone(),
        }
    }
}

/// The tests of all scales, and that of the ends of the axes.
#[derive(Debug, Clone, Default)]
pub struct Scales {
    /// One for each scale.
    pub tests: Vec<ScaleTest>,
    /// The number of samples in the part at an end of an axis and in its neighbour, of all scales: probability of a number
    /// as far from what is expected.
    ends: Vec<(f64, String, Finer)>,
}

/// Parts on each side of the worst place that are kept.
const AROUND: usize = 16;

impl Scales {
    /// Counts `observed` in the parts of `subdivision` against the expected `shares`. `found` are the shares of samples in
    /// places that the shares are known to miss: of each cell, where parts are parts of one cell, or of the whole.
    pub fn new(
        subdivision: &Subdivision,
        domain: &dyn Domain,
        observed: &Parts<u64>,
        shares: &Shares,
        found: &[f64],
        samples: u64,
    ) -> Self {
        let mut scales = Self::default();
        let [n, of_cells] = [samples as f64, subdivision.grid.len() as f64];
        // A half that holds V values of a lattice, such as that of f32 numbers, has a share that is off by 1/V; rounding to
        // f32 moves samples over the ends of parts.
        let finite = subdivision.axes.iter().all(|axis| axis.finite);
        let (all, squares) = (found.iter().sum::<f64>(), found.iter().map(|share| share * share).sum::<f64>());
        let is_good = |test: &ScaleTest, values: f64, rounding: f64| {
            let parts = test.parts as f64;
            // At worst all that a cell misses is in one part.
            let missed = (parts * all * all).at_most(parts.at_least(found.len() as f64) * squares);
            let lattice = if finite { 0.0 } else { 1.0 / (values * values) + rounding };
            test.is_testable(n * (missed + lattice))
        };
        for (axis, name) in (0..subdivision.axes.len()).zip(domain.axes()) {
            let ends = subdivision.axes[axis].ends();
            let (mut observed, mut values, mut errors) =
                (observed.axes[axis].clone(), shares.values.axes[axis].clone(), shares.errors.axes[axis].clone());
            for _ in 0..subdivision.axes[axis].bits() {
                let parts = observed.len();
                let width = (ends.len() - 1) / parts;
                let cell = |interval| {
                    if axis == 0 { Cell { x: interval, ..Cell::WHOLE } } else { Cell { y: interval, ..Cell::WHOLE } }
                };
                let (all, of_all) = (observed.clone(), values.clone());
                let factor = all.iter().sum::<u64>() as f64 / of_all.iter().sum::<f64>();
                let around = |part: usize| {
                    let [first, last] = [part.saturating_sub(AROUND), (part + AROUND).min(parts)];
                    let end = |i: usize| {
                        let part = i.min(parts - 1);
                        let own = cell([ends[part * width], ends[(part + 1) * width]]);
                        let own = domain.boxed(&own).unwrap_or(own);
                        [own.x, own.y][axis][usize::from(i == parts)]
                    };
                    Finer {
                        axis,
                        parts,
                        ends: (first..=last).map(end).collect(),
                        observed: all[first..last].to_vec(),
                        expected: of_all[first..last].iter().map(|share| factor * share).collect(),
                    }
                };
                let (mut test, at_ends) = halve(name, shares.are_independent, &mut observed, &mut values, &mut errors);
                let along = &subdivision.axes[axis];
                let values = 1.0 / (along.coincidence * test.parts as f64);
                if is_good(&test, values, along.rounding(test.parts)) {
                    let place = |parts: [usize; 2]| domain.in_words(&cell(parts.map(|part| ends[part * width])));
                    test.finer = Some(around(2 * test.worst.1));
                    test.locate(|pair| place([2 * pair, 2 * (pair + 1)]));
                    scales.tests.push(test);
                    let at_ends = at_ends.into_iter().filter(|_| !shares.are_independent);
                    scales
                        .ends
                        .extend(at_ends.map(|(p, part, words)| {
                            (p, format!("{words}, {}", place([part, part + 1])), around(part))
                        }));
                }
            }
        }
        let (mut observed, mut values, mut errors) =
            (observed.cells.clone(), shares.values.cells.clone(), shares.errors.cells.clone());
        for depth in (1..=subdivision.depth).rev() {
            let (columns, _) = halve("cells", false, &mut observed, &mut values, &mut errors);
            let (rows, _) = halve("cells", false, &mut observed, &mut values, &mut errors);
            let parts = (of_cells * f64::from(1 << (2 * depth))) as usize;
            let pairs = if columns.worst.0 >= rows.worst.0 { parts / 2 } else { parts / 4 };
            let mut test = ScaleTest { parts, ..columns.plus(&rows) };
            test.locate(|pair| {
                let cell = pair * subdivision.grid.len() / pairs;
                subdivision.grid.cells().nth(cell).map_or(String::new(), |cell| domain.in_words(&cell))
            });
            // Columns are about twice as many as rows.
            let coincidence = subdivision.axes.iter().map(|axis| axis.coincidence).fold(0.0, f64::at_least);
            let values = 1.0 / (coincidence * (2.0 * parts as f64).sqrt());
            if is_good(&test, values, subdivision.rounding(depth)) {
                scales.tests.push(test);
            }
        }
        scales
    }

    /// The test of the ends: the smallest of their p-values.
    pub fn ends(&self) -> Option<Scale> {
        let (p, words, finer) = self.ends.iter().min_by(|a, b| a.0.total_cmp(&b.0))?.clone();
        let count = self.ends.len();
        let (of, p) = ("ends of the axes".to_owned(), any_of(p, count));
        Some(Scale { of, parts: count, statistic: 0.0, dof: 0.0, p, detectable: None, words, finer: Some(finer) })
    }
}

/// The test of one scale, which compares the halves of each part, with the p-values of the halves at the two ends of the
/// axis, their places and words on them. It leaves the sums over the parts for the next scale.
fn halve(
    of: &str,
    are_independent: bool,
    observed: &mut Vec<u64>,
    values: &mut Vec<f64>,
    errors: &mut Vec<f64>,
) -> (ScaleTest, Vec<(f64, usize, String)>) {
    let parts = observed.len();
    let mut test = ScaleTest { of: of.to_owned(), parts, ..ScaleTest::default() };
    let mut ends = Vec::new();
    for pair in 0..parts / 2 {
        let (first, second) = (2 * pair, 2 * pair + 1);
        let (counts, expected) = ([observed[first], observed[second]], [values[first], values[second]]);
        test.add(pair, counts, expected, [errors[first], errors[second]], are_independent);
        for (end, at) in [(0, first), (1, second)] {
            if at == [0, parts - 1][end] {
                ends.extend(end_of(of, parts, end, counts, expected).map(|(p, words)| (p, at, words)));
            }
        }
        let both = if are_independent { errors[first].hypot(errors[second]) } else { errors[first] + errors[second] };
        (observed[pair], values[pair], errors[pair]) = (counts[0] + counts[1], expected[0] + expected[1], both);
    }
    observed.truncate(parts / 2);
    values.truncate(parts / 2);
    errors.truncate(parts / 2);
    (test, ends)
}

/// Whether one of the halves of a part with `n` samples expects fewer than Pearson's test needs.
fn is_sparse(n: f64, q: f64) -> bool {
    let least = n * q.at_most(1.0 - q);
    least.is_nan() || least < FEWEST
}

/// The probability of a count at an end of an axis that is as far from the expected one, on either side.
fn end_of(of: &str, parts: usize, end: usize, counts: [u64; 2], expected: [f64; 2]) -> Option<(f64, String)> {
    let n = counts[0] + counts[1];
    let q = expected[end] / (expected[0] + expected[1]);
    if is_sparse(n as f64, q) {
        return None;
    }
    let (count, binomial) = (counts[end], Binomial::new(q, n).ok()?);
    let below = binomial.cdf(count);
    let above = if count > 0 { binomial.sf(count - 1) } else { 1.0 };
    let name = ["first", "last"][end];
    let words = format!("{count} samples, not {:.0}, in the {name} of {parts} parts of {of}", n as f64 * q);
    Some(((2.0 * below.at_most(above)).at_most(1.0), words))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hash::{mix64, unit_f64};
    use crate::multiple::uniformity;

    #[test]
    fn p_values_of_scales_are_uniform_also_with_few_samples_in_unequal_halves() {
        // 64 parts with 12 to 108 expected samples.
        let run = |seed: u64| {
            let mut observed = vec![0u64; 64];
            for i in 0..3840u64 {
                let u = unit_f64(mix64(mix64(seed) ^ i));
                observed[(u.sqrt() * 64.0) as usize] += 1;
            }
            let mut values: Vec<f64> = (0..64).map(|i| f64::from(2 * i + 1) / 4096.0).collect();
            let (test, _) = halve("x", false, &mut observed, &mut values, &mut vec![0.0; 64]);
            test.at_level(None, 3840).p
        };
        let found = uniformity(&(0..400).map(run).collect::<Vec<_>>());
        assert!(found.p > 1e-3, "{found:?}");
    }

    #[test]
    fn mean_and_variance_are_exact() {
        // All counts of a half that holds 0.3 of 20 samples.
        let binomial = Binomial::new(0.3, 20).unwrap();
        use statrs::distribution::Discrete;
        let (mut mean, mut square) = (0.0, 0.0);
        for count in 0..=20 {
            let mut test = ScaleTest::default();
            test.add(0, [count, 20 - count], [0.3, 0.7], [0.0; 2], false);
            mean += binomial.pmf(count) * test.sum;
            square += binomial.pmf(count) * test.sum * test.sum;
            if count == 20 {
                assert!((mean - test.mean).abs() < 1e-12 && (square - mean * mean - test.variance).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn a_ripple_adds_what_the_formula_says() {
        // cos 2πfx over parts of width 2h, averaged over the phase.
        for (periods, parts) in [(8.0, 16), (8.0, 32), (11.0, 32)] {
            let (mut shift, phases) = (0.0, 64);
            let f = std::f64::consts::TAU * periods;
            let h = 1.0 / f64::from(parts);
            for phase in 0..phases {
                let phase = f64::from(phase) / f64::from(phases) * std::f64::consts::TAU;
                let mass = |i: i32| {
                    ((f * h * f64::from(i + 1) + phase).sin() - (f * h * f64::from(i) + phase).sin()) / (f * h)
                };
                shift += (0..parts / 2).map(|i| (0.5 * (mass(2 * i) - mass(2 * i + 1))).powi(2)).sum::<f64>()
                    / f64::from(parts / 2);
            }
            let a = 0.5 * f * h;
            // w² = ½.
            assert!((shift / f64::from(phases) - 0.5 * (a.sin().powi(2) / a).powi(2)).abs() < 1e-6);
        }
    }
}
