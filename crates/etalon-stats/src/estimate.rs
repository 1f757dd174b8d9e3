//! A mean of independent replicates and the interval that holds the true one.

use statrs::distribution::{ContinuousCDF, StudentsT};

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

    /// f of the replicates' mean, its error by leaving one replicate out at a time (the jackknife).
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
        Self::new(f(&all), (squares * (n as f64 - 1.0) / n as f64).sqrt(), n as f64 - 1.0)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stream::{Independent, Stream};

    #[test]
    fn by_hand() {
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
}
