//! Two means compared by Welch's t-test: the p-value, the difference that would have been found, and dominated replicates.

use crate::extremes::Extremes;
use crate::power::POWER;
use crate::welch::{Mean, deviation, fewer_dof, two_sided};
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

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
    ///
    /// With the standard errors s₁ of this run and s₂ of a run with the bias λ s₁, it is found if Z + λ s₁/σ > c s₂/σ, c the
    /// critical t. To first order, s/σ has the variance 1/(2ν), so that λ − c = z √(1 + (c² + λ²)/(2ν)), z exceeded with
    /// probability 10 % (by Student's t: safe for small ν, the normal deviate for large). The error of s₁ is part of the
    /// statement: nine of ten runs find a bias as large as *their* output states.
    #[must_use]
    pub fn detectable(&self, level: f64) -> f64 {
        if self.standard_error == 0.0 {
            return self.allowance;
        }
        let (c, z) = (critical(level, self.dof), critical(2.0 * (1.0 - POWER), self.dof));
        let k = 0.5 * z * z / self.dof;
        let root = c * c - (1.0 - k) * (c * c * (1.0 - k) - z * z);
        let lambda = (c + root.sqrt()) / (1.0 - k);
        if k < 1.0 { self.allowance + lambda * self.standard_error } else { f64::INFINITY }
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
    fn by_hand() {
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
