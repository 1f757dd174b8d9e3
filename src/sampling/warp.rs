//! Maps from the unit square to directions, each with its pdf and its inverse; the pole is +z.

use crate::math::circular::{sin_cos_turns, turns};
use glam::DVec3;
use std::f64::consts::PI;

/// Uniform over the upper hemisphere; pdf 1/(2π).
#[inline]
#[must_use]
pub fn uniform_hemisphere(u: [f64; 2]) -> DVec3 {
    let (sin_phi, cos_phi) = sin_cos_turns(u[1]);
    let sin = (u[0] * (2.0 - u[0])).sqrt();
    DVec3::new(sin * cos_phi, sin * sin_phi, 1.0 - u[0])
}

/// Pdf per solid angle of [`uniform_hemisphere`].
pub const UNIFORM_HEMISPHERE_PDF: f64 = 1.0 / (2.0 * PI);

/// The `u` that [`uniform_hemisphere`] maps to `w`.
#[must_use]
pub fn invert_uniform_hemisphere(w: DVec3) -> [f64; 2] {
    [1.0 - w.z, turns(w.y, w.x)]
}

/// Cosine-weighted over the upper hemisphere, by the polar map of the disc; pdf cos θ / π.
#[inline]
#[must_use]
pub fn cosine_hemisphere(u: [f64; 2]) -> DVec3 {
    let (sin_phi, cos_phi) = sin_cos_turns(u[1]);
    let r = u[0].sqrt();
    DVec3::new(r * cos_phi, r * sin_phi, (1.0 - u[0]).sqrt())
}

/// Pdf per solid angle of [`cosine_hemisphere`] for a direction of that cosine; 0 below the horizon.
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
