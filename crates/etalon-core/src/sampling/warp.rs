//! Maps from the unit square to directions, each with its pdf and its inverse; the pole is +z.

use crate::math::circular::{sin_cos_turns, turns};
use glam::DVec3;
use std::f64::consts::PI;

/// Uniform over the upper hemisphere; pdf 1/(2π).
#[inline]
pub fn uniform_hemisphere(u: [f64; 2]) -> DVec3 {
    let (sin_phi, cos_phi) = sin_cos_turns(u[1]);
    let sin = (u[0] * (2.0 - u[0])).sqrt();
    DVec3::new(sin * cos_phi, sin * sin_phi, 1.0 - u[0])
}

/// Pdf per solid angle of [`uniform_hemisphere`].
pub const UNIFORM_HEMISPHERE_PDF: f64 = 1.0 / (2.0 * PI);

/// The `u` that [`uniform_hemisphere`] maps to `w`.
pub fn invert_uniform_hemisphere(w: DVec3) -> [f64; 2] {
    [1.0 - w.z, turns(w.y, w.x)]
}

/// Uniform over the sphere; pdf 1/(4π).
#[inline]
pub fn uniform_sphere(u: [f64; 2]) -> DVec3 {
    let (sin_phi, cos_phi) = sin_cos_turns(u[1]);
    let sin = 2.0 * (u[0] * (1.0 - u[0])).sqrt();
    DVec3::new(sin * cos_phi, sin * sin_phi, 1.0 - 2.0 * u[0])
}

/// Pdf per solid angle of [`uniform_sphere`].
pub const UNIFORM_SPHERE_PDF: f64 = 0.5 * UNIFORM_HEMISPHERE_PDF;

/// The `u` that [`uniform_sphere`] maps to `w`.
pub fn invert_uniform_sphere(w: DVec3) -> [f64; 2] {
    [0.5 * (1.0 - w.z), turns(w.y, w.x)]
}

/// Cosine-weighted over the upper hemisphere, by the polar map of the disc; pdf cos θ / π.
#[inline]
pub fn cosine_hemisphere(u: [f64; 2]) -> DVec3 {
    let (sin_phi, cos_phi) = sin_cos_turns(u[1]);
    let r = u[0].sqrt();
    DVec3::new(r * cos_phi, r * sin_phi, (1.0 - u[0]).sqrt())
}

/// Pdf per solid angle of [`cosine_hemisphere`] for a direction of that cosine; 0 below the horizon, and a cosine beyond 1 counts as 1.
#[inline]
pub fn cosine_hemisphere_pdf(cos_theta: f64) -> f64 {
    cos_theta.clamp(0.0, 1.0) / PI
}

/// The `u` that [`cosine_hemisphere`] maps to `w`.
pub fn invert_cosine_hemisphere(w: DVec3) -> [f64; 2] {
    [w.x * w.x + w.y * w.y, turns(w.y, w.x)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverses_and_densities() {
        for i in 0..400 {
            let u = [(f64::from(i % 20) + 0.5) / 20.0, (f64::from(i / 20) + 0.5) / 20.0];
            let a = uniform_hemisphere(u);
            let b = cosine_hemisphere(u);
            let c = uniform_sphere(u);
            let inverses = [invert_uniform_hemisphere(a), invert_cosine_hemisphere(b), invert_uniform_sphere(c)];
            for (w, back) in [a, b, c].into_iter().zip(inverses) {
                assert!((w.length() - 1.0).abs() < 1e-15 && (w.z > 0.0 || w == c));
                assert!((back[0] - u[0]).abs() < 1e-13 && (back[1] - u[1]).abs() < 1e-13);
            }
            // Equal shares of u are equal shares of cos θ, and of sin² θ.
            assert!((a.z - (1.0 - u[0])).abs() < 1e-15);
            assert!((b.z * b.z - (1.0 - u[0])).abs() < 1e-15);
            assert!((c.z - (1.0 - 2.0 * u[0])).abs() < 1e-15);
        }
        assert_eq!(cosine_hemisphere_pdf(-0.1), 0.0);
    }
}
