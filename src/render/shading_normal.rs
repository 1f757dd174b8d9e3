//! Shading normals that differ from the surface's: what light paths are multiplied by, and where they are not used.
//!
//! Source: Veach, "Robust Monte Carlo Methods for Light Transport Simulation", 1997, section 5.3.

use super::geometry::Surface;
use glam::Vec3;

/// The factor on a light path where the shading normal ns is not the surface's normal n, so that it has the value that a
/// camera path finds: |wo·ns| |wi·n| / (|wo·n| |wi·ns|). `None` where the light is left to camera paths. `wo` points to
/// the light, `wi` to the camera.
#[inline]
pub fn adjoint_factor(surface: &Surface, wo: Vec3, wi: Vec3) -> Option<f32> {
    if surface.is_flat() {
        return Some(1.0);
    }
    let ratio = |w: Vec3| surface.shading.dot(w) / surface.normal.dot(w);
    (is_sound_to_camera(surface, wi) && is_sound_to_light(surface, wo)).then(|| ratio(wo) / ratio(wi))
}

/// The least ratio of the cosines to the two normals. Where only one of them is near 0, a light path would leave a single
/// very bright pixel (a firefly).
const LEAST_RATIO: f32 = 0.5;

/// Whether light paths may leave a surface in direction `wi`, towards the camera.
#[inline]
pub fn is_sound_to_camera(surface: &Surface, wi: Vec3) -> bool {
    let (normal, shading) = (surface.normal.dot(wi), surface.shading.dot(wi));
    shading > 0.0 && shading >= LEAST_RATIO * normal
}

/// Whether light paths may arrive at a surface from direction `wo`, where the light is.
#[inline]
pub fn is_sound_to_light(surface: &Surface, wo: Vec3) -> bool {
    let (normal, shading) = (surface.normal.dot(wo), surface.shading.dot(wo));
    shading > 0.0 && normal > 0.0 && normal >= LEAST_RATIO * shading
}
