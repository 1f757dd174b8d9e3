//! Circular functions as straight-line arithmetic: a loop over them vectorizes, and every machine gets the same bits.

use super::Real;
use super::elementary::polynomial;
pub use etalon_random::turns;
use std::f32::consts::PI as PI32;
use std::f64::consts::PI;

/// The circular functions that samplers need, in the precision of the type.
pub trait Circular: Real {
    /// Sine and cosine of `turns` · 2π for `turns` in \[0, 1\].
    fn sin_cos_turns(turns: Self) -> (Self, Self);

    /// The angle of (x, y) for y ≥ 0, in \[0, π\].
    fn angle(y: Self, x: Self) -> Self;
}

impl Circular for f32 {
    /// Absolute error below 10⁻⁷.
    #[inline(always)]
    fn sin_cos_turns(turns: f32) -> (f32, f32) {
        // Adding 1.5 · 2²³ rounds to an integer, which then stands in the lowest bits of the sum.
        const ROUND: f32 = 12_582_912.0;
        let rounded = 4.0 * turns + ROUND;
        let quarter = rounded.to_bits();
        // The difference is exact, so that small angles keep their relative precision.
        let x = (turns - 0.25 * (rounded - ROUND)) * (2.0 * PI32);
        let x2 = x * x;
        // Taylor series, |x| ≤ π/4; the first terms left out are below 4 · 10⁻⁸.
        let sin = x * (1.0 + x2 * (-1.0 / 6.0 + x2 * (1.0 / 120.0 + x2 * (-1.0 / 5040.0 + x2 * (1.0 / 362_880.0)))));
        let cos = 1.0 + x2 * (-0.5 + x2 * (1.0 / 24.0 + x2 * (-1.0 / 720.0 + x2 * (1.0 / 40_320.0))));
        // Rotate by the quarter turns: swap sine and cosine in odd quarters, then set the signs.
        let swap = 0u32.wrapping_sub(quarter & 1);
        let (s, c) = (sin.to_bits(), cos.to_bits());
        let (s, c) = ((s & !swap) | (c & swap), (c & !swap) | (s & swap));
        (f32::from_bits(s ^ ((quarter & 2) << 30)), f32::from_bits(c ^ (((quarter + 1) & 2) << 30)))
    }

    /// Relative error below 4 · 10⁻⁷.
    #[inline(always)]
    fn angle(y: f32, x: f32) -> f32 {
        // Reduce to the first octant, then undo the reflections.
        let ax = x.abs();
        let (low, high) = if y <= ax { (y, ax) } else { (ax, y) };
        let ratio = if high > 0.0 { low / high } else { 0.0 };
        let atan = ratio * polynomial(&ARC_TANGENT, ratio * ratio);
        let octant = if y <= ax { atan } else { 0.5 * PI32 - atan };
        if x < 0.0 { PI32 - octant } else { octant }
    }
}

/// Ascending coefficients of atan(r)/r in r² for r ≤ 1: a Chebyshev fit of this project, good to 10⁻¹⁰.
const ARC_TANGENT: [f32; 12] = [
    1.0,
    -0.333_333_3,
    0.199_999,
    -0.142_838_14,
    0.110_919_23,
    -0.089_741_72,
    0.072_282_78,
    -0.053_956_676,
    0.033_826_213,
    -0.015_828_32,
    0.004_732_483,
    -0.000_663_395_2,
];

impl Circular for f64 {
    #[inline(always)]
    fn sin_cos_turns(turns: f64) -> (f64, f64) {
        sin_cos_turns(turns)
    }

    #[inline(always)]
    fn angle(y: f64, x: f64) -> f64 {
        y.atan2(x)
    }
}

/// Sine and cosine of `turns` · 2π for `turns` in \[0, 1\], to about 10⁻¹⁶.
///
/// Straight-line arithmetic: a loop over it vectorizes, and it gives the same bits on every machine.
#[inline(always)]
pub fn sin_cos_turns(turns: f64) -> (f64, f64) {
    // Adding 1.5 · 2⁵² rounds to an integer, which then stands in the lowest bits of the sum.
    const ROUND: f64 = 6_755_399_441_055_744.0;
    let rounded = 4.0 * turns + ROUND;
    let quarter = rounded.to_bits();
    let x = (turns - 0.25 * (rounded - ROUND)) * (2.0 * PI);
    // Taylor series, |x| ≤ π/4; the first terms left out are below 10⁻¹⁶. Estrin's scheme gives the processor more
    // independent operations than Horner's.
    let x2 = x * x;
    let x4 = x2 * x2;
    let x8 = x4 * x4;
    let term = |even: f64, odd: f64| 1.0 / even + x2 * (1.0 / odd);
    let sin = (term(1.0, -6.0) + x4 * term(120.0, -5040.0))
        + x8 * (term(362_880.0, -39_916_800.0) + x4 * term(6_227_020_800.0, -1_307_674_368_000.0));
    let sin = sin * x;
    let cos = (term(1.0, -2.0) + x4 * term(24.0, -720.0))
        + x8 * (term(40_320.0, -3_628_800.0)
            + x4 * (term(479_001_600.0, -87_178_291_200.0) + x4 * (1.0 / 20_922_789_888_000.0)));
    // Rotate by the quarter turns: swap sine and cosine in odd quarters, then set the signs.
    let swap = 0u64.wrapping_sub(quarter & 1);
    let (s, c) = (sin.to_bits(), cos.to_bits());
    let (s, c) = ((s & !swap) | (c & swap), (c & !swap) | (s & swap));
    let sign_s = (quarter & 2) << 62;
    let sign_c = ((quarter + 1) & 2) << 62;
    (f64::from_bits(s ^ sign_s), f64::from_bits(c ^ sign_c))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn single_precision_sines_and_cosines_err_by_less_than_1e_7() {
        for i in 0..=1_000_000 {
            let turns = i as f32 / 1e6;
            let (s, c) = f32::sin_cos_turns(turns);
            let (es, ec) = (f64::from(turns) * std::f64::consts::TAU).sin_cos();
            assert!((f64::from(s) - es).abs() < 1e-7 && (f64::from(c) - ec).abs() < 1e-7, "{turns}: {s} {es} {c} {ec}");
        }
    }

    #[test]
    fn single_precision_angles_err_by_less_than_4e_7() {
        for i in 0..=1_000_000 {
            let angle = f64::from(i) / 1e6 * std::f64::consts::PI;
            let (y, x) = (angle.sin().max(0.0) as f32, angle.cos() as f32);
            let exact = f64::from(y).atan2(f64::from(x));
            let error = (f64::from(f32::angle(y, x)) - exact).abs();
            assert!(error <= 4e-7 * exact, "{y} {x}: {error:e}");
        }
        for (y, x) in [(0.0, 0.0), (0.0, 1.0), (1e-30, 1.0), (1.0, 0.0), (0.0, -1.0), (1e30, -1e-30)] {
            assert!((f32::angle(y, x) - y.atan2(x)).abs() <= 4e-7 * y.atan2(x), "{y} {x}");
        }
    }

    #[test]
    fn double_precision_sines_and_cosines_err_by_rounding() {
        for i in 0..=100_000 {
            let t = f64::from(i) / 100_000.0;
            let (s, c) = sin_cos_turns(t);
            let (es, ec) = (t * 2.0 * PI).sin_cos();
            assert!((s - es).abs() < 1e-15 && (c - ec).abs() < 1e-15, "{t}: {s} {es}, {c} {ec}");
        }
    }
}
