//! Exponential, logarithm and error function as straight-line arithmetic: a loop over them vectorizes, and every machine gets the
//! same bits.

use num_traits::Float;
use std::f64::consts::{LN_2, LOG2_E};

/// exp(x) for −708 ≤ x ≤ 709, to 2 units of the last place. Source of the scheme: Cody & Waite, *Software Manual for the
/// Elementary Functions*, 1980, chapter 6.
#[inline(always)]
pub fn exp_f64(x: f64) -> f64 {
    // Adding 1.5 · 2⁵² rounds to an integer, which then stands in the lowest bits of the sum.
    const ROUND: f64 = 6_755_399_441_055_744.0;
    // ln 2 in two parts, the first with zeros at the end, so that the product is exact.
    const HIGH: f64 = 0.693_147_180_369_123_8;
    const LOW: f64 = 1.908_214_929_270_587_7e-10;
    // Reduce the argument: x = n ln 2 + r.
    let shifted = x * LOG2_E + ROUND;
    let n = shifted - ROUND;
    let r = (x - n * HIGH) - n * LOW;
    // Taylor series, |r| ≤ 0.3466; the first term left out is below 10⁻¹⁷.
    const TERMS: [f64; 16] = factorials();
    // Add n to the exponent of exp r.
    f64::from_bits(polynomial(&TERMS, r).to_bits().wrapping_add(shifted.to_bits() << 52))
}

/// exp(x) for −87.3 ≤ x ≤ 88, to 2 units of the last place.
#[inline(always)]
pub fn exp_f32(x: f32) -> f32 {
    const ROUND: f32 = 12_582_912.0;
    const HIGH: f32 = 0.693_145_75;
    const LOW: f32 = 1.428_606_8e-6;
    let shifted = x * std::f32::consts::LOG2_E + ROUND;
    let n = shifted - ROUND;
    let r = (x - n * HIGH) - n * LOW;
    // Taylor series; the first term left out is below 6 · 10⁻⁹.
    const TERMS: [f32; 8] = [1.0, 1.0, 0.5, 1.0 / 6.0, 1.0 / 24.0, 1.0 / 120.0, 1.0 / 720.0, 1.0 / 5040.0];
    f32::from_bits(polynomial(&TERMS, r).to_bits().wrapping_add(shifted.to_bits() << 23))
}

/// ln x for normal x > 0, to 10⁻¹⁵ or as much of its value.
#[inline(always)]
pub fn ln_f64(x: f64) -> f64 {
    // x = 2ⁿ m with m from √½ to √2: subtracting the bits of √½ borrows from the exponent where m would be smaller.
    const ROOT: u64 = 0x3fe6_a09e_667f_3bcd;
    const MANTISSA: u64 = (1 << 52) - 1;
    let offset = x.to_bits().wrapping_sub(ROOT);
    let m = f64::from_bits((offset & MANTISSA).wrapping_add(ROOT));
    // An integer below 2⁵² in the lowest bits of 2⁵² is that number added. The exponent is counted from −1024 to stay
    // positive.
    const TWO_52: u64 = 0x4330_0000_0000_0000;
    let exponent = offset.wrapping_add(1024 << 52) >> 52;
    let n = f64::from_bits(exponent | TWO_52) - (4_503_599_627_370_496.0 + 1024.0);
    // ln m = 2 artanh s, s = (m − 1)/(m + 1) ≤ 0.1716.
    let s = (m - 1.0) / (m + 1.0);
    const TERMS: [f64; 12] = odd_reciprocals();
    n * LN_2 + 2.0 * s * polynomial(&TERMS, s * s)
}

/// ln x for normal x > 0, to 2·10⁻⁷ or as much of its value.
#[inline(always)]
pub fn ln_f32(x: f32) -> f32 {
    // As above, but the exponent keeps its sign.
    const ROOT: u32 = 0x3f35_04f3;
    const MANTISSA: u32 = (1 << 23) - 1;
    let offset = x.to_bits().wrapping_sub(ROOT);
    let m = f32::from_bits((offset & MANTISSA) + ROOT);
    let n = (offset.cast_signed() >> 23) as f32;
    let s = (m - 1.0) / (m + 1.0);
    const TERMS: [f32; 4] = [1.0, 1.0 / 3.0, 1.0 / 5.0, 1.0 / 7.0];
    n * std::f32::consts::LN_2 + 2.0 * s * polynomial(&TERMS, s * s)
}

/// 1/i! for i from 0 to 15.
const fn factorials() -> [f64; 16] {
    let mut terms = [1.0; 16];
    let mut i = 1;
    while i < 16 {
        terms[i] = terms[i - 1] / i as f64;
        i += 1;
    }
    terms
}

/// 1/(2i + 1) for i from 0 to 11.
const fn odd_reciprocals() -> [f64; 12] {
    let mut terms = [1.0; 12];
    let mut i = 1;
    while i < 12 {
        terms[i] = 1.0 / (2 * i + 1) as f64;
        i += 1;
    }
    terms
}

/// The polynomial of ascending coefficients, a multiple of four of them, at `t`.
///
/// Four Horner chains in t⁴ side by side take a third of the time of one.
#[inline(always)]
pub fn polynomial<T: Float, const N: usize>(coefficients: &[T; N], t: T) -> T {
    const { assert!(N.is_multiple_of(4)) };
    let t2 = t * t;
    let t4 = t2 * t2;
    let mut sums = [T::zero(); 4];
    for four in coefficients.as_chunks::<4>().0.iter().rev() {
        for i in 0..4 {
            sums[i] = sums[i] * t4 + four[i];
        }
    }
    (sums[0] + sums[1] * t) + t2 * (sums[2] + sums[3] * t)
}

/// Ascending coefficients of [`erfcx`] for f32: they leave an error of 2·10⁻⁸.
pub(super) const ERFCX_SINGLE: [f32; 12] = [
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

/// Ascending coefficients of [`erfcx`] for f64: they leave an error of 5·10⁻¹⁷.
pub(super) const ERFCX_DOUBLE: [f64; 24] = [
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
///
/// It falls smoothly from 1 to 1/(√π x), so that one polynomial serves all x: times 1 + 2x it is a polynomial of t = (x − 3)/(x + 3). The
/// coefficients are Chebyshev fits of this project, made with 40 digits.
///
/// Source of the idea: Shepherd and Laframboise, "Chebyshev Approximation of (1 + 2x) exp(x²) erfc(x) in 0 ≤ x < ∞", Mathematics of
/// Computation 36, 1981.
#[inline(always)]
pub(super) fn erfcx<T: Float, const N: usize>(x: T, coefficients: &[T; N]) -> T {
    let three = T::one() + T::one() + T::one();
    // t = (x − 3)/(x + 3), written so that x = ∞ gives 1.
    let t = T::one() - (three + three) / (x + three);
    polynomial(coefficients, t) / (T::one() + x + x)
}

#[cfg(test)]
mod tests {
    use super::super::Real;
    use super::*;

    #[test]
    fn exponentials_are_good_to_the_last_places() {
        for i in 0..=1_000_000 {
            let t = f64::from(i) / 1e6;
            let x = -708.0 + 1417.0 * t;
            assert!((exp_f64(x) / x.exp() - 1.0).abs() <= 3.0 * f64::EPSILON, "{x}");
            let y = (-87.3 + 175.3 * t) as f32;
            let exact = f64::from(y).exp();
            assert!((f64::from(exp_f32(y)) / exact - 1.0).abs() <= 2.0 * f64::from(f32::EPSILON), "{y}");
        }
        assert_eq!((exp_f64(0.0), exp_f32(0.0), exp_f64(-0.0)), (1.0, 1.0, 1.0));
    }

    #[test]
    fn logarithms_are_good_to_the_last_places() {
        for i in 0..=1_000_000 {
            let t = f64::from(i) / 1e6;
            for x in [10f64.powf(600.0 * t - 300.0), 0.5 + t, 1.0 + (t - 0.5) * 1e-6] {
                let exact = x.ln();
                assert!(
                    (ln_f64(x) - exact).abs() <= 2e-15 * exact.abs().max(0.5 * (x - 1.0).abs()).max(1e-16),
                    "{x}: {} {exact}",
                    ln_f64(x)
                );
            }
        }
        for i in 0..=1_000_000 {
            let x = 10f32.powf(-37.0 + 74e-6 * i as f32);
            let exact = f64::from(x).ln();
            assert!((f64::from(ln_f32(x)) - exact).abs() <= 2e-7 * exact.abs().max(0.5), "{x}: {}", ln_f32(x));
        }
        assert_eq!((ln_f64(1.0), ln_f32(1.0)), (0.0, 0.0));
    }

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
