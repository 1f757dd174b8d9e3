//! Noisy images compared tile by tile, with each other or with a reference: Welch's t-test.
//!
//! Samples of light have heavy tails, so that single pixels are far from normal; the means of tiles are closer, by the
//! central limit theorem. Variances have no lower limit, which would hide any bias below it. Where there is no noise
//! the values themselves must agree. Source: Welch, "The generalization of 'Student's' problem when several
//! different population variances are involved", Biometrika 34, 1947; for images Jung, Hanika & Dachsbacher, "Detecting
//! Bias in Monte Carlo Renderers using Welch's t-test", JCGT 9(2), 2020.

use crate::extremes::Extremes;
use crate::power::{chi_square_tail, noncentrality};
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

/// What independent samples say about a quantity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mean {
    /// The mean.
    pub value: f64,
    /// The square of the standard error of `value`.
    pub variance: f64,
    /// Degrees of freedom of `variance`; infinite where that is known.
    pub dof: f64,
}

impl Mean {
    /// A value without noise.
    #[must_use]
    pub fn exact(value: f64) -> Self {
        Self { value, variance: 0.0, dof: f64::INFINITY }
    }

    /// The mean of `samples` ≥ 2 samples with its standard error.
    #[must_use]
    pub fn of_samples(samples: u32, value: f64, standard_error: f64) -> Self {
        Self { value, variance: standard_error * standard_error, dof: f64::from(samples) - 1.0 }
    }

    /// The mean of independent replicates, with its error by how they differ; `None` of fewer than two.
    #[must_use]
    pub fn of_replicates(values: &[f64]) -> Option<Self> {
        let n = values.len() as f64;
        let value = values.iter().sum::<f64>() / n;
        let squares: f64 = values.iter().map(|x| (x - value).powi(2)).sum();
        let (variance, dof) = (squares / (n * (n - 1.0)), n - 1.0);
        (values.len() > 1).then_some(Self { value, variance, dof })
    }

    /// The mean of independent means, with Satterthwaite's degrees of freedom (Σ v)²/Σ (v²/dof); `None` of nothing.
    #[must_use]
    pub fn of_means(means: &[Self]) -> Option<Self> {
        let n = means.len() as f64;
        let variance: f64 = means.iter().map(|mean| mean.variance).sum();
        (!means.is_empty()).then(|| Self {
            value: means.iter().map(|mean| mean.value).sum::<f64>() / n,
            variance: variance / (n * n),
            dof: joint_dof(means, variance),
        })
    }
}

/// Satterthwaite's degrees of freedom of a sum of independent means, of variance `variance`.
fn joint_dof(means: &[Mean], variance: f64) -> f64 {
    let squares: f64 = means.iter().map(|mean| mean.variance * mean.variance / mean.dof).sum();
    if squares > 0.0 { variance * variance / squares } else { f64::INFINITY }
}

/// Degrees of freedom of the difference of two means: the fewer of both sides that have noise.
///
/// With these, Student's t is never more likely to be exceeded than stated, whatever the ratio of the variances; with
/// Satterthwaite's it is, by far, where one side has few replicates and the level is small: 2 replicates against 16 exceed the
/// t of probability 10⁻⁵ in 10⁻³ of comparisons. Source: Mickey and Brown, "Bounds on the distribution functions of the
/// Behrens–Fisher statistic", Annals of Mathematical Statistics 37, 1966.
pub(crate) fn fewer_dof(a: Mean, b: Mean) -> f64 {
    let dof = |mean: Mean| if mean.variance > 0.0 { mean.dof } else { f64::INFINITY };
    dof(a).at_most(dof(b))
}

/// Means of the square tiles of an image, row by row: those at the right and lower edge may be smaller, pixels that
/// are `None` do not count, and a tile without pixels is left out together with its partner in `other`.
#[must_use]
pub fn tiles([width, height]: [usize; 2], side: usize, pixel: impl Fn(usize) -> Option<[Mean; 2]>) -> Vec<[Mean; 2]> {
    let corners = (0..height).step_by(side).flat_map(|y| (0..width).step_by(side).map(move |x| (x, y)));
    let tile = |(x0, y0): (usize, usize)| {
        let rows = y0..(y0 + side).min(height);
        let of_row = |y: usize| (x0..(x0 + side).min(width)).map(move |x| y * width + x);
        let pairs: Vec<[Mean; 2]> = rows.flat_map(of_row).filter_map(&pixel).collect();
        let of = |k: usize| Mean::of_means(&pairs.iter().map(|pair| pair[k]).collect::<Vec<_>>());
        Some([of(0)?, of(1)?])
    };
    corners.filter_map(tile).collect()
}

/// Two images compared.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct ImageComparison {
    /// Σ z² over the tiles with noise, chi-square distributed if the images agree.
    pub statistic: f64,
    /// Tiles with noise.
    pub dof: usize,
    /// Probability of a statistic at least this large if the images agree; 1 without noise, NaN where a mean with noise or
    /// its variance is not finite.
    pub p: f64,
    /// Kurtosis of the tiles' z: 3 for normal ones, much more where tails are too heavy for this test.
    pub kurtosis: f64,
    /// Largest difference among the tiles without noise, if there are any.
    pub exact_difference: f64,
    /// p-values of the tiles with noise, uniform if the images agree.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub tiles: Vec<f64>,
    /// Σ (value/standard error)²: the squared signal-to-noise ratio of the whole image.
    #[cfg_attr(feature = "serde", serde(skip))]
    signal: f64,
}

/// Compares tiles in pairs. Differences up to `allowance` (what the second image's own precision leaves open) do not
/// count; it should be small beside the noise.
#[must_use]
pub fn compare(pairs: &[[Mean; 2]], allowance: f64) -> ImageComparison {
    let (mut tiles, mut z, mut signal, mut exact_difference) = (Vec::new(), Vec::new(), 0.0, 0f64);
    for [a, b] in pairs {
        let (difference, variance) = ((a.value - b.value).abs(), a.variance + b.variance);
        if variance == 0.0 {
            exact_difference = exact_difference.at_least(difference);
            continue;
        }
        // Noise without end would hide everything.
        let noise = if variance.is_finite() { variance.sqrt() } else { f64::NAN };
        let t = (difference - allowance).at_least(0.0) / noise;
        let p = two_sided(t, fewer_dof(*a, *b));
        tiles.push(p);
        z.push(deviation(p, t));
        signal += b.value * b.value / variance;
    }
    let statistic = z.iter().fold(0.0, |sum, z| sum + z * z);
    let moment = |power| z.iter().map(|z| z.powi(power)).sum::<f64>() / z.len() as f64;
    ImageComparison {
        statistic,
        dof: z.len(),
        p: if z.is_empty() { 1.0 } else { chi_square_tail(z.len() as f64, statistic) },
        kurtosis: moment(4) / moment(2).powi(2),
        exact_difference,
        tiles,
        signal,
    }
}

impl ImageComparison {
    /// The smallest relative bias of the whole image that a test at `level` finds with 90 % probability; `None` without
    /// noise or without light.
    #[must_use]
    pub fn detectable(&self, level: f64) -> Option<f64> {
        (self.signal > 0.0).then(|| (noncentrality(self.dof, level) / self.signal).sqrt())
    }
}

/// P(|T| ≥ t) for Student's distribution; NaN for NaN.
pub(crate) fn two_sided(t: f64, dof: f64) -> f64 {
    if t.is_nan() || dof.is_nan() {
        return f64::NAN;
    }
    // Beyond this the normal distribution is the same to 10⁻⁶.
    let tail = if dof < 1e6 {
        StudentsT::new(0.0, 1.0, dof.at_least(1.0)).map_or(f64::NAN, |student| student.sf(t))
    } else {
        Normal::new(0.0, 1.0).map_or(f64::NAN, |normal| normal.sf(t))
    };
    (2.0 * tail).at_most(1.0)
}

/// The normal deviate that is as unlikely as `p` on both sides; `t` where p is too small to tell, or NaN.
pub(crate) fn deviation(p: f64, t: f64) -> f64 {
    if p < 1e-200 || p.is_nan() {
        return t;
    }
    Normal::new(0.0, 1.0).map_or(f64::NAN, |normal| -normal.inverse_cdf(0.5 * p))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::Difference;
    use crate::multiple::uniformity;
    use crate::stream::{Independent, Stream};

    /// A image of 24×24 pixels of mean 1, whose samples are −ln u: skewed, of variance 1.
    fn image(seed: u64, spp: u32, bias: impl Fn(usize) -> f64) -> Vec<Mean> {
        let pixel = |i: usize| {
            let samples: Vec<f64> =
                (0..spp).map(|s| -(1.0 - Independent::new(seed, i as u64, s).pair(0)[0]).ln()).collect();
            let n = f64::from(spp);
            let mean = samples.iter().sum::<f64>() / n;
            let square: f64 = samples.iter().map(|v| (v - mean) * (v - mean)).sum();
            Mean::of_samples(spp, mean + bias(i), (square / (n * (n - 1.0))).sqrt())
        };
        (0..24 * 24).map(pixel).collect()
    }

    fn test(a: &[Mean], b: &[Mean]) -> ImageComparison {
        compare(&tiles([24, 24], 4, |i| Some([a[i], b[i]])), 0.0)
    }

    #[test]
    fn by_hand() {
        // Means 20 and 22, s²/n 1.5 and 0.5 with 9 and 19 degrees: t = √2 with 9 degrees. Nine terms of variance 2 with 9
        // degrees each have 81.
        let (a, b) = (Mean { value: 20.0, variance: 1.5, dof: 9.0 }, Mean { value: 22.0, variance: 0.5, dof: 19.0 });
        let found = compare(&[[a, b]], 0.0);
        let expected = 2.0 * StudentsT::new(0.0, 1.0, 9.0).unwrap().sf(2f64.sqrt());
        assert!((found.p - expected).abs() < 1e-9 && found.dof == 1, "{found:?} {expected}");
        assert!((Mean::of_means(&[a; 9]).unwrap().dof - 81.0).abs() < 1e-9);
        // A side without noise takes no degrees away.
        assert_eq!([fewer_dof(Mean::exact(1.0), b), fewer_dof(Mean { variance: 0.0, ..a }, b)], [19.0; 2]);
    }

    #[test]
    fn p_values_of_images_that_agree_are_uniform() {
        let p: Vec<f64> = (0..60).map(|k| test(&image(2 * k, 32, |_| 0.0), &image(2 * k + 1, 32, |_| 0.0)).p).collect();
        assert!(uniformity(&p).p > 1e-3, "{:?}", uniformity(&p));
        let one = test(&image(7, 64, |_| 0.0), &vec![Mean::exact(1.0); 24 * 24]);
        assert!(uniformity(&one.tiles).p > 1e-3 && one.p > 1e-3 && one.kurtosis < 8.0, "{one:?}");
    }

    #[test]
    fn biases_are_detected_with_the_stated_power() {
        let truth = vec![Mean::exact(1.0); 24 * 24];
        let bias = test(&image(0, 64, |_| 0.0), &truth).detectable(0.01).unwrap();
        // 36 tiles of 1024 samples of variance 1: λ ≈ 40 = 36864 b².
        assert!((0.02..0.05).contains(&bias), "{bias}");
        let found = (0..50).filter(|&k| test(&image(100 + k, 64, |_| bias), &truth).p < 0.01).count();
        assert!((38..=50).contains(&found), "{found} of 50");
        let spot = |i: usize| if i % 24 < 4 && i / 24 < 4 { 0.3 } else { 0.0 };
        assert!(test(&image(1, 64, spot), &truth).p < 1e-6);
    }

    #[test]
    fn means_that_are_not_finite_agree_with_nothing() {
        let number = Mean { value: 1.0, variance: 0.1, dof: 9.0 };
        for wrong in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for mean in [Mean { value: wrong, ..number }, Mean { variance: wrong.abs(), ..number }] {
                let found = compare(&[[number, number], [mean, mean]], 0.0);
                assert!(found.p.is_nan(), "{mean:?}: {found:?}");
                assert!(!Difference::of(mean, mean, 0.0).p().is_finite(), "{mean:?}");
            }
            let exact = compare(&[[Mean::exact(1.0); 2], [Mean::exact(wrong); 2]], 0.0);
            assert!(exact.exact_difference.is_nan(), "{exact:?}");
        }
    }

    #[test]
    fn without_noise_the_values_are_compared() {
        let uniform = |value: f64| vec![Mean::exact(value); 24 * 24];
        let found = test(&uniform(1.0), &uniform(1.0 + 1e-9));
        assert_eq!((found.dof, found.p), (0, 1.0));
        assert!((found.exact_difference - 1e-9).abs() < 1e-15 && found.detectable(0.01).is_none());
    }
}
