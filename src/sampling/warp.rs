//! Maps from the unit square to directions, each with its density and its inverse; the pole is +z.

use glam::DVec3;
use std::f64::consts::PI;

/// Sine and cosine of `turns` · 2π for `turns` in \[0, 1\], to about 10⁻¹⁶.
///
/// A table of 256 steps and one rotation by the small rest: several times faster than the library's functions, and
/// the same bits on every machine.
#[inline]
#[must_use]
pub fn sin_cos_turns(turns: f64) -> (f64, f64) {
    const STEPS: usize = 256;
    static TABLE: std::sync::LazyLock<[[f64; 2]; STEPS + 1]> = std::sync::LazyLock::new(|| {
        std::array::from_fn(|i| {
            let phi = i as f64 / STEPS as f64 * 2.0 * PI;
            [libm::sin(phi), libm::cos(phi)]
        })
    });
    let step = turns * STEPS as f64;
    let i = step as usize;
    let [sin0, cos0] = TABLE[i];
    let d = (step - i as f64) * (2.0 * PI / STEPS as f64);
    let d2 = d * d;
    // Taylor; d < 0.025, so the first terms left out are d⁹/9! and d⁸/8!, below 10⁻¹⁸.
    let sin = d * (1.0 - d2 / 6.0 * (1.0 - d2 / 20.0 * (1.0 - d2 / 42.0)));
    let cos = 1.0 - d2 / 2.0 * (1.0 - d2 / 12.0 * (1.0 - d2 / 30.0));
    (sin0 * cos + cos0 * sin, cos0 * cos - sin0 * sin)
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

/// The angle of (x, y) in turns, in \[0, 1).
#[inline]
#[must_use]
pub fn turns(y: f64, x: f64) -> f64 {
    let t = y.atan2(x) * (0.5 / PI);
    // Adding 1 to a tiny negative angle rounds to 1, which is the seam: 0.
    if t >= 0.0 {
        t
    } else if t + 1.0 < 1.0 {
        t + 1.0
    } else {
        0.0
    }
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

    #[test]
    fn the_seam_is_zero() {
        assert_eq!(turns(-1e-30, 1.0), 0.0);
        assert_eq!(turns(0.0, 1.0), 0.0);
        assert!(turns(-1e-10, 1.0) > 0.999);
    }
}
