//! The Henyey–Greenstein phase function: what a renderer of fog has, and `tests/phase.rs` tests.

use std::f64::consts::{PI, TAU};

/// The phase function of asymmetry `g` in (−1, 1), over the cosine between the directions before and after scattering.
#[derive(Debug, Clone, Copy)]
pub struct HenyeyGreenstein {
    /// The mean cosine: positive where light keeps going forwards.
    pub g: f64,
}

impl HenyeyGreenstein {
    /// The direction after scattering of light that travels along +z, from two uniform random numbers.
    #[must_use]
    pub fn sample(&self, u: [f64; 2]) -> [f64; 3] {
        let g = self.g;
        // The inverse of the distribution of the cosine, which is 0/0 for g = 0.
        let cos = if g.abs() < 1e-3 {
            1.0 - 2.0 * u[0]
        } else {
            let s = (1.0 - g * g) / (1.0 + g - 2.0 * g * u[0]);
            (1.0 + g * g - s * s) / (2.0 * g)
        };
        let sin = (1.0 - cos * cos).max(0.0).sqrt();
        let (sin_phi, cos_phi) = (TAU * u[1]).sin_cos();
        [sin * cos_phi, sin * sin_phi, cos]
    }

    /// The pdf of [`sample`](Self::sample) per solid angle.
    #[must_use]
    pub fn pdf(&self, w: [f64; 3]) -> f64 {
        let g = self.g;
        (1.0 - g * g) / (4.0 * PI * (1.0 + g * g - 2.0 * g * w[2]).powf(1.5))
    }
}
