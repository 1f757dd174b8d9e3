//! Maps from the unit square to directions, each with its density and its inverse; the pole is +z.

use glam::DVec3;
use std::f64::consts::PI;

pub use etalon_stats::warp::turns;

/// Sine and cosine of `turns` · 2π for `turns` in \[0, 1\], to about 10⁻¹⁶.
///
/// Straight-line arithmetic: a loop over it vectorizes, and it gives the same bits on every machine.
#[inline(always)]
#[must_use]
pub fn sin_cos_turns(turns: f64) -> (f64, f64) {
    // Adding 1.5 · 2⁵² rounds to an integer, which then stands in the lowest bits of the sum.
    const ROUND: f64 = 6_755_399_441_055_744.0;
    let rounded = 4.0 * turns + ROUND;
    let quarter = rounded.to_bits();
    let x = (turns - 0.25 * (rounded - ROUND)) * (2.0 * PI);
    // Taylor series, |x| ≤ π/4; the first terms left out are below 10⁻¹⁶. Summed by halves (Estrin's scheme), which
    // leaves the processor more to do at once than Horner's chain.
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
    // Turn by the quarters: swap the two in odd ones, change the signs as they go round.
    let swap = 0u64.wrapping_sub(quarter & 1);
    let (s, c) = (sin.to_bits(), cos.to_bits());
    let (s, c) = ((s & !swap) | (c & swap), (c & !swap) | (s & swap));
    let sign_s = (quarter & 2) << 62;
    let sign_c = ((quarter + 1) & 2) << 62;
    (f64::from_bits(s ^ sign_s), f64::from_bits(c ^ sign_c))
}

/// Uniform over the upper hemisphere; density 1/(2π).
#[inline]
#[must_use]
pub fn uniform_hemisphere(u: [f64; 2]) -> DVec3 {
    let (sin_phi, cos_phi) = sin_cos_turns(u[1]);
    let sin = (u[0] * (2.0 - u[0])).sqrt();
    DVec3::new(sin * cos_phi, sin * sin_phi, 1.0 - u[0])
}

/// Density per solid angle of [`uniform_hemisphere`].
pub const UNIFORM_HEMISPHERE_PDF: f64 = 1.0 / (2.0 * PI);

/// The `u` that [`uniform_hemisphere`] maps to `w`.
#[must_use]
pub fn invert_uniform_hemisphere(w: DVec3) -> [f64; 2] {
    [1.0 - w.z, turns(w.y, w.x)]
}

/// Cosine-weighted over the upper hemisphere, by the polar map of the disc; density cos θ / π.
#[inline]
#[must_use]
pub fn cosine_hemisphere(u: [f64; 2]) -> DVec3 {
    let (sin_phi, cos_phi) = sin_cos_turns(u[1]);
    let r = u[0].sqrt();
    DVec3::new(r * cos_phi, r * sin_phi, (1.0 - u[0]).sqrt())
}

/// Density per solid angle of [`cosine_hemisphere`] for a direction of that cosine; 0 below the horizon.
#[inline]
#[must_use]
pub fn cosine_hemisphere_pdf(cos_theta: f64) -> f64 {
    cos_theta.max(0.0) / PI
}

/// The `u` that [`cosine_hemisphere`] maps to `w`.
#[must_use]
pub fn invert_cosine_hemisphere(w: DVec3) -> [f64; 2] {
    [w.x * w.x + w.y * w.y, turns(w.y, w.x)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sin_cos_is_exact_to_rounding() {
        for i in 0..=100_000 {
            let t = f64::from(i) / 100_000.0;
            let (s, c) = sin_cos_turns(t);
            let (es, ec) = (t * 2.0 * PI).sin_cos();
            assert!((s - es).abs() < 1e-15 && (c - ec).abs() < 1e-15, "{t}: {s} {es}, {c} {ec}");
        }
    }

    #[test]
    fn inverses_and_densities() {
        for i in 0..400 {
            let u = [(f64::from(i % 20) + 0.5) / 20.0, (f64::from(i / 20) + 0.5) / 20.0];
            let a = uniform_hemisphere(u);
            let b = cosine_hemisphere(u);
            for (w, back) in [(a, invert_uniform_hemisphere(a)), (b, invert_cosine_hemisphere(b))] {
                assert!((w.length() - 1.0).abs() < 1e-15 && w.z > 0.0);
                assert!((back[0] - u[0]).abs() < 1e-13 && (back[1] - u[1]).abs() < 1e-13);
            }
            // Equal shares of u are equal shares of cos θ, and of sin² θ.
            assert!((a.z - (1.0 - u[0])).abs() < 1e-15);
            assert!((b.z * b.z - (1.0 - u[0])).abs() < 1e-15);
        }
        assert_eq!(cosine_hemisphere_pdf(-0.1), 0.0);
    }
}
