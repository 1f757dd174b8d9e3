//! Slopes of a Beckmann surface of α = 1, sampled by inversion: across the view, and along it by visibility.

use crate::math::elementary::polynomial;
use crate::math::{Real, map_array};
use std::f64::consts::FRAC_2_SQRT_PI;

/// Lower bound of u and 1 − u in logarithms, smaller than every random number of 53 bits except 0.
pub(super) const LEAST: f64 = 1e-30;

/// erf⁻¹(2u − 1): a normally distributed slope of variance ½, in f64 to 2·10⁻⁸ of its value.
///
/// With w = −ln(4u(1−u)), erf⁻¹(x)/x is a smooth function of w: a polynomial in w at the centre, √w times one in 1/√w in
/// the tails. Both are Chebyshev fits of this project; the choice of w is that of Giles, "Approximating the erfinv
/// function", GPU Computing Gems 2, 2012.
#[inline(always)]
pub(super) fn gaussian<T: Real>(u: T) -> T {
    let real = T::from_f64;
    // w of both branches, from the smaller of u and 1 − u without cancellation.
    let (below, above) = (u.max(real(LEAST)), (T::one() - u).max(real(LEAST)));
    let w = -(real(4.0) * below * above).logarithm();
    let x = below - above;
    // Evaluate both branches and select, so that a loop vectorizes.
    let centre = polynomial(&map_array(CENTRE, real), w * real(1.0 / 3.0) - T::one());
    let root = w.max(real(6.0)).sqrt();
    const ENDS: [f64; 2] = [1.0 / 9.0, 0.408_248_290_463_863];
    let place = (real(2.0) / root - real(ENDS[0] + ENDS[1])) * real(1.0 / (ENDS[1] - ENDS[0]));
    let tails = root * polynomial(&map_array(TAILS, real), place);
    x * if w < real(6.0) { centre } else { tails }
}

/// Slopes beyond ±9 have a probability below [`LEAST`].
const STEEPEST: f64 = 9.0;

/// The slope s along the view, with density ∝ exp(−s²) max(0, cos − s·slope): the facets visible from the stretched
/// direction (slope, cos), of any length, both ≥ 0 and not both 0. The cumulative probability of the result is `u` to 10⁻⁷,
/// in the far tail to 10⁻⁵ of `u`.
///
/// Solves K(s) = u K(cos/slope) for K(s) = cos (1 + erf s) + slope exp(−s²)/√π by Halley's steps. Their number is fixed
/// and nothing branches, so that a loop over views vectorizes; the last one alone is in f64.
#[inline(always)]
pub(super) fn visible(cos: f64, slope: f64, u: f64) -> f64 {
    let u = u.max(LEAST);
    let slope_over_root_pi = 0.5 * FRAC_2_SQRT_PI * slope;
    // The steepest visible slope; infinite for a view along the normal.
    let limit = cos / slope;
    // Compute the normalization K(limit). The exponent is bounded because underflow is slow.
    let e = (-(limit * limit).min(600.0)).exponential();
    let hidden = e * erfcx(limit);
    let total = cos * (2.0 - hidden) + slope_over_root_pi * e;
    let high = limit.min(STEEPEST);
    let target = Target { cos, slope, slope_over_root_pi, value: u * total, high };
    let single = Target {
        cos: cos as f32,
        slope: slope as f32,
        slope_over_root_pi: slope_over_root_pi as f32,
        value: target.value as f32,
        high: high as f32,
    };
    // Start from a guess, take two of Halley's steps in f32 and one in f64.
    let first = guess(e as f32, high as f32, hidden as f32, u as f32).max(-STEEPEST as f32).min(single.high);
    target.step(f64::from(single.step(single.step(first))).min(high))
}

/// The equation to solve: K(s) = `value`, for s up to `high`.
#[derive(Clone, Copy)]
struct Target<T> {
    cos: T,
    slope: T,
    slope_over_root_pi: T,
    value: T,
    high: T,
}

impl<T: Real> Target<T> {
    /// A better estimate than `s`.
    #[inline(always)]
    fn step(self, s: T) -> T {
        let real = T::from_f64;
        // The residual K(s) − value. Both terms of K are positive, so that it is precise in the far tail as well.
        let gauss = (-s * s).exponential();
        let tail = erfcx(s.abs()) * gauss;
        let below = if s < T::zero() { tail } else { real(2.0) - tail };
        let residual = self.cos * below + self.slope_over_root_pi * gauss - self.value;
        // Halley's step, multiplied out to a single division: K' = 2/√π exp(−s²) v, K''/K' = −2s − slope/v, v = cos − s slope.
        let visible = self.cos - s * self.slope;
        let curvature = s * visible + real(0.5) * self.slope;
        let step = residual * visible / (real(FRAC_2_SQRT_PI) * gauss * visible * visible + residual * curvature);
        let next = s - step;
        // Go half of the way to an end that the step would pass: from the end itself no step leads back.
        let low = real(-STEEPEST);
        let next = if next < low { real(0.5) * (s + low) } else { next };
        let next = if next > self.high { real(0.5) * (s + self.high) } else { next };
        // At the ends themselves the step is not a number.
        if next.is_nan() { s } else { next }
    }
}

/// A slope near the solution: the quantile of a normal distribution truncated at `limit`, with a correction that makes it
/// right for views along the normal and at grazing angles, and near `limit`. `e` is exp(−limit²), `hidden` erfc(limit). The
/// correction is fitted, not derived: the steps that follow need no more than a slope in the neighbourhood.
#[inline(always)]
fn guess(e: f32, limit: f32, hidden: f32, u: f32) -> f32 {
    let visible = 1.0 - 0.5 * hidden;
    let root_pi = std::f32::consts::PI.sqrt();
    let correction = 0.5 * (root_pi * e * (limit * (2.0 - hidden) + e / root_pi)).sqrt();
    let correction = correction.min(visible);
    gaussian(u * (visible - correction + correction * erfcx((-u.logarithm()).max(0.0).sqrt())))
}

/// Ascending coefficients of erf⁻¹(x)/x in w/3 − 1, for 0 ≤ w ≤ 6.
const CENTRE: [f64; 12] = [
    1.623_542_010_32,
    0.724_891_205_975,
    -0.051_643_496_25,
    -0.022_576_720_556_4,
    0.015_803_255_263_5,
    -0.003_091_644_588_93,
    -0.001_288_506_225_01,
    0.000_989_733_255_683,
    -0.000_127_458_650_102,
    -0.000_117_794_815_197,
    3.986_942_072_78e-5,
    3.965_022_471_6e-6,
];

/// Ascending coefficients of erf⁻¹(x)/(x √w) in the place of 1/√w between 1/9 and 1/√6, for 6 ≤ w ≤ 81.
const TAILS: [f64; 12] = [
    0.958_035_614_449,
    -0.029_189_284_621_7,
    0.002_136_512_641_85,
    0.001_804_490_741_29,
    -0.000_112_460_800_246,
    0.000_579_699_145_997,
    0.000_414_932_448_501,
    1.595_704_354_2e-6,
    -0.000_241_645_024_142,
    -7.792_532_869_36e-5,
    5.206_951_026_03e-5,
    2.527_388_408_28e-5,
];

/// exp(x²) erfc(x) for x ≥ 0, to 10⁻⁸, which is enough here; it has one division fewer than [`Real::erfcx`].
#[inline(always)]
fn erfcx<T: Real>(x: T) -> T {
    let y = T::one() / (x + T::from_f64(3.0));
    polynomial(&map_array(SCALED_TAIL, T::from_f64), T::one() - T::from_f64(6.0) * y) * y
}

/// Ascending coefficients of (x + 3) exp(x²) erfc(x) in (x − 3)/(x + 3).
const SCALED_TAIL: [f64; 12] = [
    1.074_006_912_31,
    -0.883_394_445_187,
    0.590_227_975_604,
    -0.310_467_489_311,
    0.119_532_300_691,
    -0.026_825_370_112_6,
    -0.001_232_371_041_6,
    0.003_027_424_456_58,
    -0.000_507_850_578_512,
    -0.000_264_983_421_725,
    6.782_963_557_21e-5,
    1.965_591_056_05e-5,
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn erfcx_is_that_of_the_library() {
        for i in 0..1000 {
            let x = f64::from(i) * 0.01;
            assert!((erfcx(x) / ((x * x).exp() * libm::erfc(x)) - 1.0).abs() < 1.2e-8, "{x}");
        }
        assert_eq!(erfcx(f64::INFINITY), 0.0);
    }

    #[test]
    fn the_normal_slope_inverts_erf() {
        let mut worst = 0f64;
        for i in 0..=4000 {
            // From 10⁻²⁹ to ½.
            let u = 0.5 * 10f64.powf(-29.0 * f64::from(i) / 4000.0);
            let s = -gaussian(u);
            // d ln erfc(s) = −2/√π ds / erfcx(s).
            let error = (libm::erfc(s) / (2.0 * u)).ln() * erfcx(s.abs()) / FRAC_2_SQRT_PI;
            worst = worst.max(error.abs() / s.abs().max(1e-3));
            if u > 1e-10 {
                assert!((gaussian(1.0 - u) - s).abs() <= 1e-6 * s, "{u}");
            }
        }
        assert!(worst < 2.5e-8, "{worst:e}");
        assert_eq!(gaussian(0.5), 0.0);
        assert!(gaussian(0.0) < -8.0 && gaussian(0.0f64).is_finite() && gaussian(1.0f64).is_finite());
    }

    #[test]
    fn the_normal_slope_in_single_is_that_in_double() {
        for i in 0..1 << 20 {
            let u = (16 * i + 1) as f32 / (1 << 24) as f32;
            let exact = gaussian(f64::from(u));
            assert!((f64::from(gaussian(u)) - exact).abs() <= 1e-6 * exact.abs(), "{u}: {} {exact}", gaussian(u));
        }
    }

    /// The cumulative probability of the visible slopes up to `s`.
    fn share(cos: f64, slope: f64, s: f64) -> f64 {
        let k = |s: f64| cos * libm::erfc(-s) + 0.5 * FRAC_2_SQRT_PI * slope * (-s * s).exp();
        k(s) / k(cos / slope)
    }

    #[test]
    fn the_visible_slope_inverts_its_distribution() {
        for cot in [0.0, 1e-6, 0.01, 0.1, 0.3, 0.6, 1.0, 1.5, 2.0, 3.0, 5.0, 20.0, 1e4] {
            let mut before = f64::NEG_INFINITY;
            for i in 0..4096 {
                let u = f64::from(i) / 4096.0;
                let s = visible(cot, 1.0, u);
                assert!(s.is_finite() && s <= cot && s >= before, "cot {cot}, u {u}: {s} after {before}");
                if i > 0 {
                    assert!((share(cot, 1.0, s) - u).abs() < 1e-7, "cot {cot}, u {u}: {}", share(cot, 1.0, s));
                }
                before = s;
            }
            for k in 4..17 {
                let u = 10f64.powi(-k);
                assert!((share(cot, 1.0, visible(cot, 1.0, u)) / u - 1.0).abs() < 1e-5, "cot {cot}, u {u}");
            }
        }
    }

    #[test]
    fn the_ends_are_finite() {
        for (cos, slope) in [(1.0, 0.0), (0.0, 1.0), (1e-30, 1.0), (1.0, 1e-30), (0.5, 0.5)] {
            for u in [0.0, 1e-40, 0.5, 1.0 - f64::EPSILON, 1.0] {
                let s = visible(cos, slope, u);
                assert!(s.is_finite() && s * slope <= cos, "{cos} {slope} {u}: {s}");
            }
        }
    }
}
