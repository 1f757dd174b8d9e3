//! The distributions of microfacet normals: Beckmann's, of normally distributed slopes, and GGX, of the normals of an ellipsoid, with wide
//! tails.

use super::smith::{Microfacet, Widths};
use crate::math::{Real, map_array};

/// Slopes of the facets are normally distributed with variance αx²/2 in x and αy²/2 in y.
///
/// * D(m) = exp(−(x²/αx² + y²/αy²)/z²) / (π αx αy z⁴)
/// * Λ(w) = ½ (exp(−A²)/(A √π) − erfc A), A = z/√(αx² x² + αy² y²)
///
/// Source: Beckmann & Spizzichino, 1963; Λ as in Walter et al., "Microfacet Models for Refraction through Rough
/// Surfaces", EGSR 2007, eq. 26 (the exact one, not their rational fit); anisotropic
/// as [`Widths`] says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beckmann<T> {
    alpha: Widths<T>,
}

impl<T: Real> Beckmann<T> {
    /// The isotropic distribution of width `alpha` > 0.
    pub fn new(alpha: T) -> Self {
        Self::anisotropic([alpha; 2])
    }

    /// The distribution of widths `alpha` > 0 along x and y.
    pub fn anisotropic(alpha: [T; 2]) -> Self {
        Self { alpha: Widths::new(alpha) }
    }
}

impl<T: Real> Microfacet<T> for Beckmann<T> {
    /// The square of exp(−tan²/2α²)/(√π α cos²). Squaring last has two advantages: the exponential does not underflow
    /// before D does, and cos⁴, which underflows first and would give 0/0, is not needed.
    #[inline(always)]
    fn widths(&self) -> Widths<T> {
        self.alpha
    }

    #[inline(always)]
    fn d(&self, wm: [T; 3]) -> T {
        let (alpha, z) = (self.alpha.along_x(), wm[2]);
        let az = alpha * z;
        // One unit of the exponent's last place is up to 100 of D's. So compute the exponent in f64, and apply what is
        // lost in rounding it to T as a factor 1 + rest.
        let wide_az = alpha.to_f64() * z.to_f64();
        let wide = -0.5 * self.normal2(map_array(wm, Real::to_f64)) / (wide_az * wide_az);
        let exponent = T::from_f64(wide);
        let rest = T::one() + T::from_f64(wide - exponent.to_f64());
        let e = exponent.max(T::LEAST_EXPONENT).exponential() * rest;
        let root = e * T::FRAC_2_SQRT_PI() * T::from_f64(0.5) / (az * z);
        // D is 0 as well where the exponent is −∞ or NaN: for normals so near the horizon that the division fails.
        if (z > T::zero()) & (exponent > T::LEAST_EXPONENT) { root * root * self.alpha.ratio() } else { T::zero() }
    }

    #[inline(always)]
    fn cos_lambda(&self, w: [T; 3]) -> T {
        let z = w[2].abs();
        let slope = self.alpha.along_x() * self.view2(w).sqrt();
        // ½ exp(−A²) (α sin/√π − z exp(A²) erfc A): A may be infinite, and is 0 on the horizon.
        let a = z / slope;
        let half = T::from_f64(0.5);
        let hidden =
            (-a * a).max(T::LEAST_EXPONENT).exponential() * half * (slope * T::FRAC_2_SQRT_PI() * half - z * a.erfcx());
        // For A ≫ 1 the difference is rounding, of either sign.
        hidden.max(T::zero())
    }
}

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
    pub fn new(alpha: T) -> Self {
        Self::anisotropic([alpha; 2])
    }

    /// The distribution of widths `alpha` > 0 along x and y.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lambda_is_the_published_formula() {
        for alpha in [0.01f64, 0.3, 1.0] {
            let beckmann = Beckmann::new(alpha);
            for degrees in [1.0f64, 30.0, 60.0, 89.0, 89.99] {
                let (s, c) = degrees.to_radians().sin_cos();
                let a = c / (alpha * s);
                let expected = 0.5 * ((-a * a).exp() / (a * std::f64::consts::PI.sqrt()) - libm::erfc(a));
                assert!(
                    (beckmann.lambda([0.0, s, c]) - expected).abs() < 1e-13 * (1.0 + expected),
                    "{alpha} {degrees}"
                );
            }
        }
    }

    #[test]
    fn the_tail_does_not_vanish_early() {
        // At tan² = 95 α² the exponential has three bits left in f32, while D = 2·10⁻³⁶ has them all.
        let alpha = 1e-3f32;
        let tan = alpha * 95f32.sqrt();
        let wm = [tan / (1.0 + tan * tan).sqrt(), 0.0, 1.0 / (1.0 + tan * tan).sqrt()];
        let expected = Beckmann::new(f64::from(alpha)).d(wm.map(f64::from));
        let d = f64::from(Beckmann::new(alpha).d(wm));
        // The exponent is rounded a few times, and a change of 95 in its last place is one of D.
        assert!((d / expected - 1.0).abs() < 4.0 * 95.0 * f64::from(f32::EPSILON), "{d:e} {expected:e}");
    }
}
