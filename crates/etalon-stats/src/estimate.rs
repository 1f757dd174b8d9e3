//! Means of independent replicates: the interval that holds the true one; two of them compared by Welch's t-test, with the
//! p-value, the difference that would have been found, and dominated replicates.

use crate::extremes::Extremes;
use crate::power::POWER;
use crate::welch::{Mean, deviation, fewer_dof, two_sided};
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

/// A value with its 95 % confidence interval, value ± half_width; both NaN when there was nothing to estimate from.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Estimate {
    /// The estimate.
    pub value: f64,
    /// Half the width of the interval. Infinite from a single replicate.
    pub half_width: f64,
    /// The standard error of `value`.
    pub standard_error: f64,
}

impl Default for Estimate {
    fn default() -> Self {
        Self { value: f64::NAN, half_width: f64::NAN, standard_error: f64::NAN }
    }
}

impl Estimate {
    /// x̄ ± t s/√n with Student's t of n − 1 degrees of freedom.
    #[must_use]
    pub fn mean(replicates: &[f64]) -> Self {
        let n = replicates.len() as f64;
        let value = replicates.iter().sum::<f64>() / n;
        let squares: f64 = replicates.iter().map(|x| (x - value).powi(2)).sum();
        Self::new(value, (squares / (n * (n - 1.0))).sqrt(), n - 1.0)
    }

    /// f of the replicates' mean, its error by leaving one replicate out at a time (the jackknife). Where f is not finite without one
    /// of them, there is no interval: its half width is infinite.
    ///
    /// Source: Efron & Stein, "The Jackknife Estimate of Variance", 1981.
    pub fn jackknife<T>(replicates: &[T], f: impl Fn(&[&T]) -> f64) -> Self {
        let n = replicates.len();
        let all: Vec<&T> = replicates.iter().collect();
        if n < 2 {
            return Self { half_width: f64::INFINITY, standard_error: f64::INFINITY, value: f(&all) };
        }
        let without = |i: usize| {
            let mut others = all.clone();
            others.remove(i);
            f(&others)
        };
        let left: Vec<f64> = (0..n).map(without).collect();
        let mean = left.iter().sum::<f64>() / n as f64;
        let squares: f64 = left.iter().map(|x| (x - mean).powi(2)).sum();
        let error = (squares * (n as f64 - 1.0) / n as f64).sqrt();
        Self::new(f(&all), if error.is_finite() { error } else { f64::INFINITY }, n as f64 - 1.0)
    }

    /// The same value with the interval of another confidence than 95 %, by Student's t of n replicates.
    #[must_use]
    pub fn at_confidence(self, confidence: f64, replicates: usize) -> Self {
        Self::within(self.value, self.standard_error, replicates as f64 - 1.0, confidence)
    }

    fn new(value: f64, standard_error: f64, freedom: f64) -> Self {
        Self::within(value, standard_error, freedom, 0.95)
    }

    fn within(value: f64, standard_error: f64, freedom: f64, confidence: f64) -> Self {
        let Ok(t) = StudentsT::new(0.0, 1.0, freedom) else {
            let unknown = if value.is_nan() { f64::NAN } else { f64::INFINITY };
            return Self { value, half_width: unknown, standard_error: unknown };
        };
        Self { value, half_width: t.inverse_cdf(0.5 + 0.5 * confidence) * standard_error, standard_error }
    }

    /// The lower end of the interval.
    #[must_use]
    pub fn low(&self) -> f64 {
        self.value - self.half_width
    }

    /// The upper end of the interval.
    #[must_use]
    pub fn high(&self) -> f64 {
        self.value + self.half_width
    }

    /// The interval of a value that cannot be negative, from that of its logarithm: value · exp(± half_width / value).
    #[must_use]
    pub fn positive(&self) -> [f64; 2] {
        let factor = (self.half_width / self.value).exp();
        [self.value / factor, self.value * factor]
    }
}

/// The difference of two means.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Difference {
    /// The first mean minus the second.
    pub value: f64,
    /// The standard error of `value`.
    pub standard_error: f64,
    /// Degrees of freedom of `standard_error`: the fewer of both means.
    pub dof: f64,
    /// Differences up to this do not count.
    pub allowance: f64,
}

impl Difference {
    /// The difference of independent means. Up to `allowance`, which the precision of the values leaves open, it does not
    /// count.
    #[must_use]
    pub fn of(a: Mean, b: Mean, allowance: f64) -> Self {
        let standard_error = (a.variance + b.variance).sqrt();
        Self { value: a.value - b.value, standard_error, dof: fewer_dof(a, b), allowance }
    }

    /// Difference by standard error, with the difference's sign: Welch's t. Infinite where values without noise differ, NaN of
    /// two infinities, of NaN, and of a variance that is not finite.
    #[must_use]
    pub fn t(&self) -> f64 {
        // Noise without end would hide everything.
        if !self.standard_error.is_finite() {
            return f64::NAN;
        }
        let excess = (self.value.abs() - self.allowance).at_least(0.0);
        if excess == 0.0 { 0.0 } else { excess.copysign(self.value) / self.standard_error }
    }

    /// P(|T| ≥ |t|) if the expectations agree; NaN where t is.
    #[must_use]
    pub fn p(&self) -> f64 {
        if self.t().is_infinite() { 0.0 } else { two_sided(self.t().abs(), self.dof) }
    }

    /// The normal deviate that is as unlikely as [`Difference::t`], with its sign.
    #[must_use]
    pub fn z(&self) -> f64 {
        deviation(self.p(), self.t().abs()).copysign(self.t())
    }

    /// Half the interval around `value` that holds the true difference with the probability 1 − `level`.
    #[must_use]
    pub fn half_width(&self, level: f64) -> f64 {
        if self.standard_error == 0.0 { 0.0 } else { critical(level, self.dof) * self.standard_error }
    }

    /// The smallest true difference that such a test at `level` finds with 90 % probability; infinite if there is none.
    #[must_use]
    pub fn detectable(&self, level: f64) -> f64 {
        self.detectable_then(level, self)
    }

    /// The same of a test to come, whose standard error `then` is this one's, except for a known factor.
    ///
    /// With the standard errors s₁ of this run and s₂ of a run with the bias λ s₁, it is found if Z + λ s₁/σ > c s₂/σ, c the
    /// critical t. To first order, s/σ has the variance 1/(2ν), so that λ − c = z √(1 + λ²/(2ν₁) + c²/(2ν₂)), z exceeded with
    /// probability 10 % (by Student's t: safe for small ν, the normal deviate for large). The error of s₁ is part of the
    /// statement: nine of ten runs find a bias as large as *their* output states.
    #[must_use]
    pub fn detectable_then(&self, level: f64, then: &Self) -> f64 {
        if then.standard_error == 0.0 {
            return then.allowance;
        }
        let (c, z) = (critical(level, then.dof), critical(2.0 * (1.0 - POWER), self.dof.at_most(then.dof)));
        let [now_k, then_k] = [self.dof, then.dof].map(|dof| 0.5 * z * z / dof);
        let root = c * c - (1.0 - now_k) * (c * c * (1.0 - then_k) - z * z);
        let lambda = (c + root.sqrt()) / (1.0 - now_k);
        if now_k < 1.0 { then.allowance + lambda * then.standard_error } else { f64::INFINITY }
    }
}

/// The t that is exceeded on either side with probability `level`.
fn critical(level: f64, dof: f64) -> f64 {
    if dof < 1e6 {
        StudentsT::new(0.0, 1.0, dof.at_least(1.0)).map_or(f64::INFINITY, |student| -student.inverse_cdf(0.5 * level))
    } else {
        Normal::new(0.0, 1.0).map_or(f64::INFINITY, |normal| -normal.inverse_cdf(0.5 * level))
    }
}

/// Whether one of the replicates makes so much of their variance that normal ones would with a probability of at most `level`.
///
/// Grubbs' test: the largest |x − x̄| exceeds (n − 1)/√n √(t²/(n − 2 + t²)) times the standard deviation, with t exceeded with
/// probability `level`/(2n) by Student's t of n − 2 degrees of freedom. Never of fewer than three.
///
/// Source: Grubbs, "Sample Criteria for Testing Outlying Observations", Annals of Mathematical Statistics 21, 1950.
#[must_use]
pub fn is_dominated(replicates: &[f64], level: f64) -> bool {
    let n = replicates.len() as f64;
    if replicates.len() < 3 {
        return false;
    }
    let mean = replicates.iter().sum::<f64>() / n;
    let squares = replicates.iter().map(|x| (x - mean).powi(2));
    let (sum, largest) = squares.fold((0.0, 0.0), |(sum, largest): (f64, f64), s| (sum + s, largest.at_least(s)));
    let t2 = critical(level / n, n - 2.0).powi(2);
    sum > 0.0 && largest / sum > (n - 1.0) / n * t2 / (n - 2.0 + t2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stream::{Independent, Stream};

    #[test]
    fn intervals_by_hand() {
        // Mean 2, s = 1, t of 2 degrees of freedom 4.302653.
        let e = Estimate::mean(&[1.0, 2.0, 3.0]);
        assert!((e.value - 2.0).abs() < 1e-15 && (e.half_width - 4.302_653 / 3.0_f64.sqrt()).abs() < 1e-5, "{e:?}");
        // For 99 %, 9.924843.
        let wide = e.at_confidence(0.99, 3);
        assert!((wide.half_width - 9.924_843 / 3.0_f64.sqrt()).abs() < 1e-5 && wide.value == e.value, "{wide:?}");
        assert_eq!(Estimate::mean(&[5.0]).half_width, f64::INFINITY);
        assert!(Estimate::mean(&[]).value.is_nan());
        let [low, high] = Estimate { value: 2.0, half_width: 4.0, standard_error: 1.0 }.positive();
        assert!((low - 2.0 * (-2.0_f64).exp()).abs() < 1e-15 && (high - 2.0 * 2.0_f64.exp()).abs() < 1e-13);
    }

    #[test]
    fn the_jackknife_of_a_mean_is_its_standard_error() {
        let values = [1.0, 4.0, 9.0, 16.0];
        let mean = |v: &[&f64]| v.iter().copied().sum::<f64>() / v.len() as f64;
        let (a, b) = (Estimate::jackknife(&values, mean), Estimate::mean(&values));
        assert!((a.value - b.value).abs() < 1e-12 && (a.half_width - b.half_width).abs() < 1e-9, "{a:?} {b:?}");
        // Without the largest value there is none.
        let degenerate = Estimate::jackknife(&values, |v| if v.contains(&&16.0) { mean(v) } else { f64::NAN });
        assert!(degenerate.value == 7.5 && degenerate.half_width == f64::INFINITY, "{degenerate:?}");
    }

    #[test]
    fn nineteen_intervals_of_twenty_hold_the_mean() {
        let covered = (0..2000).filter(|&i| {
            let values: Vec<f64> = (0..6).map(|j| Independent::new(5, i, j).pair(0)[0]).collect();
            let e = Estimate::mean(&values);
            e.low() <= 0.5 && e.high() >= 0.5
        });
        // 1900 ± 10 (one standard deviation) for normal values.
        let covered = covered.count();
        assert!((1850..1940).contains(&covered), "{covered}");
    }

    /// Normal values by Box and Muller's transformation.
    fn normals(seed: u64, run: u64, n: usize) -> Vec<f64> {
        let stream = |i: usize| Independent::new(seed, run, i as u32).pair(0);
        (0..n)
            .map(|i| {
                let [u, v] = stream(i);
                (-2.0 * (1.0 - u).ln()).sqrt() * (std::f64::consts::TAU * v).cos()
            })
            .collect()
    }

    #[test]
    fn differences_by_hand() {
        let [a, b] = [[1.0, 2.0, 3.0], [4.0, 4.0, 7.0]].map(|values| Mean::of_replicates(&values).unwrap());
        assert_eq!([a.value, a.dof, b.value], [2.0, 2.0, 5.0]);
        assert!((a.variance - 1.0 / 3.0).abs() < 1e-15 && (b.variance - 1.0).abs() < 1e-15);
        let found = Difference::of(a, b, 0.0);
        assert!(found.dof == 2.0 && (found.t() + 3.0 / (4.0_f64 / 3.0).sqrt()).abs() < 1e-12);
        assert!((critical(found.p(), found.dof) + found.t()).abs() < 1e-6, "{found:?}");
        assert_eq!(Difference::of(a, b, 3.0).p(), 1.0);
        assert_eq!(Difference::of(Mean::exact(1.0), Mean::exact(2.0), 0.5).p(), 0.0);
        assert!(Mean::of_replicates(&[1.0]).is_none());
    }

    #[test]
    fn nine_of_ten_runs_find_the_bias_that_they_state() {
        const RUNS: u64 = 4000;
        for (n, level) in [(2, 0.01), (4, 1e-3), (16, 1e-3), (16, 1e-5), (64, 1e-3)] {
            let of = |seed, run| Mean::of_replicates(&normals(seed, run, n)).unwrap();
            let found = |run: &u64| {
                let stated = Difference::of(of(1, *run), of(2, *run), 0.0).detectable(level);
                let mut a = of(3, *run);
                a.value += stated;
                Difference::of(a, of(4, *run), 0.0).p() < level
            };
            let share = (0..RUNS).filter(found).count() as f64 / RUNS as f64;
            // The square root of 0.9 · 0.1 / 4000 is 0.5 %.
            println!("{n} replicates at {level}: {share}");
            assert!(share > 0.885, "{n} replicates at {level}: {share}");
        }
    }

    #[test]
    fn the_level_is_kept_and_normal_replicates_are_rarely_dominated() {
        const RUNS: u64 = 20_000;
        let run = |n: usize, run: u64| {
            let (a, b) = (normals(5, run, n), normals(6, run, n));
            let p = Difference::of(Mean::of_replicates(&a).unwrap(), Mean::of_replicates(&b).unwrap(), 0.0).p();
            (p < 0.01, is_dominated(&a, 0.01))
        };
        for n in [4, 16] {
            let runs: Vec<(bool, bool)> = (0..RUNS).map(|k| run(n, k)).collect();
            // 200 expected of each; the standard deviation is 14.
            let count = |f: fn(&(bool, bool)) -> bool| runs.iter().filter(|r| f(r)).count();
            let (rejected, dominated) = (count(|r| r.0), count(|r| r.1));
            assert!(rejected < 250 && (100..250).contains(&dominated), "{n}: {rejected} {dominated}");
        }
        let mut spiked = normals(7, 0, 16);
        assert!(!is_dominated(&spiked, 1e-3));
        spiked[3] = 1000.0;
        assert!(is_dominated(&spiked, 1e-6) && !is_dominated(&[1.0, 9.0], 0.5) && !is_dominated(&[1.0; 9], 0.5));
    }
}
