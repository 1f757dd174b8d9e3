//! Shading normals that differ from the surface's: what light paths are multiplied by, and which paths have no density of light tracing.
//!
//! Source: Veach, "Robust Monte Carlo Methods for Light Transport Simulation", 1997, section 5.3.

use super::geometry::Surface;
use glam::Vec3;

/// The factor on a light path where the shading normal ns is not the surface's normal n, so that it has the value that a
/// camera path finds: |wo·ns| |wi·n| / (|wo·n| |wi·ns|). `wo` points to the light, `wi` to the camera.
#[inline]
pub fn adjoint_factor(surface: &Surface, wo: Vec3, wi: Vec3) -> f32 {
    let normals = [surface.normal, surface.shading];
    if surface.is_flat() { 1.0 } else { ratio(normals, wo) / ratio(normals, wi) }
}

/// The cosine to the shading normal over that to the surface's normal.
#[inline]
fn ratio([n, ns]: [Vec3; 2], w: Vec3) -> f32 {
    ns.dot(w) / n.dot(w)
}

/// Whether the surface's normal n and the shading normal agree on a direction, up to a factor of 2 in the cosine. Where only
/// one of the cosines is near 0, a light path would leave a single very bright pixel (a firefly).
#[inline]
pub fn is_sound(normals: [Vec3; 2], w: Vec3) -> bool {
    normals[0] == normals[1] || (0.5..=2.0).contains(&ratio(normals, w))
}
