//! The GGX distribution: the normals of an ellipsoid, with wide tails.

use super::smith::Microfacet;
use super::widths::Widths;
use crate::math::Real;

/// Normals are distributed as on an ellipsoid of height 1 and widths 1/αx and 1/αy.
///
/// * D(m) = 1 / (π αx αy (x²/αx² + y²/αy² + z²)²)
/// * Λ(w) = ½ (√(1 + (αx² x² + αy² y²)/z²) − 1)
///
/// Source: Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007, eq. 33 and 34; anisotropic as
/// [`Widths`] says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ggx<T> {
    alpha: Widths<T>,
}

impl<T: Real> Ggx<T> {
    /// The isotropic distribution of width `alpha` > 0.
    #[must_use]
    pub fn new(alpha: T) -> Self {
        Self::anisotropic([alpha; 2])
    }

    /// The distribution of widths `alpha` > 0 along x and y.
    #[must_use]
    pub fn anisotropic(alpha: [T; 2]) -> Self {
        Self { alpha: Widths::new(alpha) }
    }
}

impl<T: Real> Microfacet<T> for Ggx<T> {
    #[inline(always)]
    fn widths(&self) -> Widths<T> {
        self.alpha
    }

    #[inline(always)]
    fn d(&self, wm: [T; 3]) -> T {
        let alpha = self.alpha.along_x();
        let az = alpha * wm[2];
        let root = alpha / (az * az + self.normal2(wm));
        if wm[2] > T::zero() { root * root * T::FRAC_1_PI() * self.alpha.ratio() } else { T::zero() }
    }

    #[inline(always)]
    fn cos_lambda(&self, w: [T; 3]) -> T {
        // ½ (√(z² + α² s²) − z), without the difference.
        let z = w[2].abs();
        let slope2 = self.alpha.along_x() * self.alpha.along_x() * self.view2(w);
        T::from_f64(0.5) * slope2 / (z + (z * z + slope2).sqrt())
    }
}
