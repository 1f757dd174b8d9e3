//! Lambert's law: the same radiance in every direction.
//!
//! Directions are in the local frame, the normal at +z. `f` is the BSDF value without the cosine.

use crate::raster::Rgb;
use crate::sampling::warp;
use glam::DVec3;
use std::f32::consts::FRAC_1_PI;

/// f = albedo / π.
#[inline]
#[must_use]
pub fn eval(albedo: Rgb) -> Rgb {
    albedo * FRAC_1_PI
}

/// A direction with density cos θ / π.
#[inline]
#[must_use]
pub fn sample(u: [f64; 2]) -> DVec3 {
    warp::cosine_hemisphere(u)
}

/// Density per solid angle of [`sample`] at a direction of that cosine.
#[inline]
#[must_use]
pub fn pdf(cos_theta: f64) -> f64 {
    warp::cosine_hemisphere_pdf(cos_theta)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sampling_cancels_the_cosine_exactly() {
        // f cos / pdf is the albedo for every sample: a white surface neither gains nor loses.
        for i in 0..100 {
            let u = [(f64::from(i) + 0.5) / 100.0, (f64::from(i) * 0.618_034).fract()];
            let wi = sample(u);
            let weight = f64::from(eval(Rgb::ONE).x) * wi.z / pdf(wi.z);
            assert!((weight - 1.0).abs() < 1e-6);
        }
    }
}
