//! The GGX distribution: the normals of an ellipsoid, with wide tails.

use super::smith::{Microfacet, sin2};
use crate::math::Real;

/// Normals are distributed as on an ellipsoid flattened to height α.
///
/// * D(m) = α² / (π (α² cos²θ + sin²θ)²)
/// * Λ(w) = ½ (√(1 + α² tan²θ) − 1)
///
/// Source: Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007, eq. 33 and 34.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ggx<T> {
    /// Roughness α > 0: the height of the ellipsoid over its width.
    pub alpha: T,
}

impl<T: Real> Ggx<T> {
    /// The distribution of width `alpha` > 0.
    #[must_use]
    pub fn new(alpha: T) -> Self {
        Self { alpha }
    }
}

impl<T: Real> Microfacet<T> for Ggx<T> {
    #[inline(always)]
    fn d(&self, wm: [T; 3]) -> T {
        let az = self.alpha * wm[2];
        let root = self.alpha / (az * az + sin2(wm));
        if wm[2] > T::zero() { root * root * T::FRAC_1_PI() } else { T::zero() }
    }

    #[inline(always)]
    fn cos_lambda(&self, w: [T; 3]) -> T {
        // ½ (√(z² + α² s²) − z), without the difference.
        let z = w[2].abs();
        let slope2 = self.alpha * self.alpha * sin2(w);
        T::from_f64(0.5) * slope2 / (z + (z * z + slope2).sqrt())
    }
}
