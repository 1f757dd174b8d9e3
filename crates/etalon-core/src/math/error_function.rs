//! The error function by way of exp(x²) erfc(x), in straight-line arithmetic for f32 and f64.
//!
//! exp(x²) erfc(x) falls smoothly from 1 to 1/(√π x), so that one polynomial serves all x ≥ 0: after multiplication by
//! 1 + 2x, in t = (x − 3)/(x + 3). The idea is that of Shepherd & Laframboise, "Chebyshev approximation of
//! (1 + 2x) exp(x²) erfc(x) in 0 ≤ x < ∞", Mathematics of Computation 36, 1981; the coefficients are Chebyshev fits of
//! this project, made at 40 digits.

use super::elementary::polynomial;
use num_traits::Float;

/// Ascending coefficients for f32: they leave an error of 2·10⁻⁸.
pub(super) const SINGLE: [f32; 12] = [
    1.253_008_1,
    -0.135_621_07,
    -0.047_562_156,
    0.129_644_11,
    -0.119_275_27,
    0.068_316_57,
    -0.023_763_577,
    0.002_499_116_8,
    0.001_875_079_1,
    -0.000_726_453_7,
    -9.254_517e-5,
    7.731_024e-5,
];

/// Ascending coefficients for f64: they leave an error of 5·10⁻¹⁷.
pub(super) const DOUBLE: [f64; 24] = [
    1.253_008_058_269_729_6,
    -0.135_621_106_124_581_17,
    -0.047_562_294_353_420_38,
    0.129_645_158_702_759_4,
    -0.119_273_663_416_760_02,
    0.068_308_027_344_009_91,
    -0.023_770_514_891_530_09,
    0.002_529_391_815_693_877,
    0.001_888_690_097_744_282_9,
    -0.000_779_832_269_653_685_8,
    -0.000_105_158_312_978_772_09,
    0.000_125_099_342_455_648_4,
    4.944_124_344_138_899e-6,
    -2.010_054_226_116_492e-5,
    -7.187_883_870_781_45e-7,
    3.472_370_931_994_688e-6,
    3.366_979_124_916_258_5e-7,
    -6.166_011_311_670_511e-7,
    -1.205_414_261_946_178e-7,
    1.018_361_953_779_95e-7,
    2.784_388_267_375_666_4e-8,
    -1.331_291_532_026_284e-8,
    -3.181_354_399_447_751e-9,
    9.862_525_850_455_464e-10,
];

/// exp(x²) erfc(x) for `x` ≥ 0, infinity included, from the coefficients of its type.
#[inline(always)]
pub(super) fn erfcx<T: Float, const N: usize>(x: T, coefficients: &[T; N]) -> T {
    let three = T::one() + T::one() + T::one();
    // t = (x − 3)/(x + 3), written so that x = ∞ gives 1.
    let t = T::one() - (three + three) / (x + three);
    polynomial(coefficients, t) / (T::one() + x + x)
}

#[cfg(test)]
mod tests {
    use crate::math::Real;

    /// exp(x²) erfc(x) from the library's erfc; beyond 20 by the asymptotic series.
    fn reference(x: f64) -> f64 {
        if x < 20.0 {
            return (x * x).exp() * libm::erfc(x);
        }
        let y = 0.5 / (x * x);
        [11.0, 9.0, 7.0, 5.0, 3.0, 1.0].iter().fold(1.0, |sum, odd| 1.0 - odd * y * sum)
            / (x * std::f64::consts::PI.sqrt())
    }

    #[test]
    fn erfcx_errs_by_a_few_units_of_the_last_place() {
        let (mut single, mut double) = (0f64, 0f64);
        for i in 0..20_000 {
            let x = (f64::from(i) * 1e-3).powi(3) * 0.01;
            let x32 = x as f32;
            single = single.max((f64::from(x32.erfcx()) / reference(f64::from(x32)) - 1.0).abs());
            // exp(x²) of the reference itself has an error of x² times the last place.
            double = double.max((x.erfcx() / reference(x) - 1.0).abs() / (1.0 + x.min(20.0).powi(2)));
        }
        assert!(single < 4.0 * f64::from(f32::EPSILON), "{single:e}");
        assert!(double < 4.0 * f64::EPSILON, "{double:e}");
        assert_eq!(f32::INFINITY.erfcx(), 0.0);
        assert_eq!(f64::INFINITY.erfcx(), 0.0);
    }

    #[test]
    fn erf_is_that_of_the_library() {
        for i in 0..6000 {
            let x = f64::from(i) * 1e-3;
            assert!((x.error_function() - libm::erf(x)).abs() < 5.0 * f64::EPSILON, "{x}");
            let (single, exact) = (f64::from((x as f32).error_function()), libm::erf(f64::from(x as f32)));
            assert!((single - exact).abs() < 5.0 * f64::from(f32::EPSILON), "{x}");
        }
    }
}
